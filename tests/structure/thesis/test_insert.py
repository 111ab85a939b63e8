from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from v3dcad.model import Diagram
from v3dcad.structure.thesis.insert import inserted, shared_vertex, symmetric_sequence
from v3dcad.structure.thesis.state import GROWS, SHRINKS, STAYS, State, initial_state

# Four cells around two corners: 0, 1 and 2 meet in corner 0; 0, 2 and 3 in corner 1.
#
#        1   |   0        corner 0 lies at (0, 0), corner 1 at (4, 0)
#      ------0---------1------
#        2         2   |   3
FOUR = Diagram(
    vertices=np.array([[0.0, 0], [4, 0], [0, 5], [-5, 0], [9, 0], [4, -5]]),
    edges=np.array([[2, 0], [3, 0], [0, 1], [1, 4], [5, 1]]),
    edge_sites=np.array([[0, 1], [1, 2], [0, 2], [0, 3], [2, 3]]),
    neighbours=np.array([[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]),
)
NOWHERE = np.zeros(4, dtype=bool)


def with_tags(*tags: int) -> State:
    return replace(initial_state(np.zeros((4, 2))), tags=np.array(tags))


@pytest.mark.parametrize(
    ("count", "sequence"),
    [(0, []), (1, [0]), (2, [0, 1]), (4, [0, 3, 1, 2]), (5, [0, 4, 1, 3, 2])],
)
def test_sequence_by_hand(count: int, sequence: list[int]) -> None:
    assert symmetric_sequence(count).tolist() == sequence


def test_the_first_growing_cell_of_the_sequence_is_the_target() -> None:
    """The sequence is 0, 3, 1, 2. Where 3 and 1 grow, 3 comes first: its corner with 0 and 2."""
    assert shared_vertex(with_tags(STAYS, GROWS, STAYS, GROWS), FOUR, NOWHERE) == (3, 1)
    assert shared_vertex(with_tags(STAYS, GROWS, STAYS, STAYS), FOUR, NOWHERE) == (1, 0)


def test_the_search_goes_on_past_a_neighbour_that_does_not_serve() -> None:
    """Target 0, neighbours 1, 2, 3 in that order: 1 grows too, so corner 1 with 2 and 3 it is.

    With 3 on the boundary as well, 2 has nobody left to share a corner with.
    """
    state = with_tags(GROWS, GROWS, STAYS, STAYS)
    assert shared_vertex(state, FOUR, NOWHERE) == (0, 1)
    assert shared_vertex(state, FOUR, np.array([False, False, False, True])) is None


def test_what_disqualifies_a_cell() -> None:
    """Target 1 needs 0 and 2 both: neither may lie on the boundary, grow or be inserted."""
    state = with_tags(STAYS, GROWS, STAYS, STAYS)
    for other in (0, 1, 2):
        assert shared_vertex(state, FOUR, np.arange(4) == other) is None
    assert shared_vertex(with_tags(GROWS, GROWS, GROWS, GROWS), FOUR, NOWHERE) is None
    assert shared_vertex(with_tags(STAYS, STAYS, STAYS, STAYS), FOUR, NOWHERE) is None
    late = initial_state(np.zeros((3, 2))).with_site(np.zeros(2), 0.0, 2)
    tags = np.array([STAYS, STAYS, STAYS, GROWS])
    assert shared_vertex(replace(late, tags=tags), FOUR, NOWHERE) is None, "3 is inserted"
    tags = np.array([GROWS, STAYS, STAYS, SHRINKS])
    assert shared_vertex(replace(late, tags=tags), FOUR, np.arange(4) == 1) is None


def test_weights_and_tags_of_an_insertion() -> None:
    """In layer 3 with offset 0.1 both weigh (3 − 1) · 0.1; the target no longer grows."""
    state = with_tags(STAYS, STAYS, STAYS, GROWS)
    after = inserted(state, FOUR, 3, 1, layer=3, offset=0.1)
    assert after.sites[4].tolist() == [4, 0]
    assert after.weights == pytest.approx([0, 0, 0, 0.2, 0.2])
    assert after.tags.tolist() == [STAYS, STAYS, STAYS, STAYS, GROWS]
    assert after.inserted().tolist() == [4]
    assert after.born_in[4] == 3
    assert state.tags[3] == GROWS, "the state before is not touched"
