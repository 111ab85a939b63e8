"""Where a new site goes (Algorithms 5 and 6): at the corner that three cells share."""

from __future__ import annotations

from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from v3dcad.model import Diagram, Ints
from v3dcad.structure.thesis.state import GROWS, INITIAL, STAYS, State


def symmetric_sequence(count: int) -> Ints:
    """(count,) the ids 0, count − 1, 1, count − 2, … (Algorithm 5)."""
    ids = np.arange(count)
    sequence = np.empty(count, dtype=np.int64)
    sequence[0::2] = ids[: (count + 1) // 2]
    sequence[1::2] = ids[::-1][: count // 2]
    return sequence


def shared_vertex(
    state: State, diagram: Diagram, on_boundary: NDArray[np.bool_]
) -> tuple[int, int] | None:
    """The first target cell that qualifies, and the vertex where its new neighbour goes.

    Algorithm 6: the target is an initial cell that grows and lies off the boundary; the vertex
    is shared with two of its neighbours, both off the boundary, not growing and not inserted.
    `on_boundary` (n,) says which cells lie on the boundary or are none. None where no cell
    qualifies.
    """
    corners: dict[int, set[int]] = {}
    for edge, pair in zip(diagram.edges.tolist(), diagram.edge_sites.tolist(), strict=True):
        for site in pair:
            corners.setdefault(site, set()).update(edge)
    still = (state.tags != GROWS) & (state.born_in == INITIAL) & ~on_boundary
    beside: dict[int, list[int]] = {}
    for i, j in diagram.neighbours.tolist():
        if still[j]:
            beside.setdefault(i, []).append(j)
        if still[i]:
            beside.setdefault(j, []).append(i)
    for target in symmetric_sequence(int(np.count_nonzero(state.born_in == INITIAL))).tolist():
        if state.tags[target] != GROWS or on_boundary[target]:
            continue
        for first, second in permutations(sorted(beside.get(target, [])), 2):
            shared = corners[target] & corners[first] & corners[second]
            if shared:
                return target, min(shared)
    return None


def inserted(
    state: State, diagram: Diagram, target: int, vertex: int, layer: int, offset: float
) -> State:
    """The state with a site at a vertex of the layer below, and the target frozen.

    Both get the weight (layer − 1) · offset; the new site grows from here on, the target no
    more (Algorithm 6, lines 44 to 50).
    """
    weight = (layer - 1) * offset
    frozen = state.with_values(target, weights=weight, tags=STAYS)
    return frozen.with_site(diagram.vertices[vertex], weight, layer)
