"""Neither a triangulation built afresh on the way up, nor a want of room, nor the rows of the mesh
can be seen afterwards.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.structure.test_fill import SIDE, SQUARE, foam, same
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.model import Floats, Ints, Section
from v3dcad.structure.foam import explicit
from v3dcad.structure.sweep import kinetic_sweep, sites
from v3dcad.structure.sweep.layer_loop import run, walks

pytestmark = pytest.mark.slow

JAMS = (7, 8, 30)
TIMES, MADE = 5, 7
"""Which of the arguments of the compiled loop these are."""

SCATTERED = np.random.default_rng(3).uniform([-4, -4, -6], [SIDE + 4, SIDE + 4, 30], (160, 3))
LATTICE = np.stack(np.meshgrid(*[np.arange(-4.0, 21, 4)] * 2, np.arange(-4.0, 33, 4)), -1)
SITES = {"scattered": SCATTERED, "lattice": LATTICE.reshape(-1, 3)}


@pytest.fixture(params=[0, 1000], ids=["by reach", "always there"], autouse=True)
def few(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether sites enter and leave the mesh, or are always there."""
    monkeypatch.setattr(explicit, "FEW", request.param)


def filled(widening: float, where: Floats) -> Any:
    sections = [
        Section(0.4 * k, (SQUARE * (1 + widening * k) - SIDE / 2 * k * widening,))
        for k in range(60)
    ]
    return foam(sections, where, layer_height=0.4)


@pytest.mark.parametrize("name", sorted(SITES))
@pytest.mark.parametrize("widening", [0.0, 0.01])
def test_a_triangulation_built_afresh_does_not_show(
    widening: float, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    layers = list(filled(widening, SITES[name]).layers)
    jammed: list[int] = []
    made = 0

    def jamming(*given: Any) -> None:
        """The compiled loop, which now and then says that no flip is possible before a layer."""
        nonlocal made
        times, found = given[TIMES], given[MADE]
        stops = [
            jam - made for jam in JAMS if jam not in jammed and made <= jam < made + len(times)
        ]
        some = min(stops, default=len(times))
        run(*given[:TIMES], times[:some], *given[TIMES + 1 :])
        made += int(found.outcome.layers)
        if stops and found.outcome.ending == Ending.DONE:
            found.outcome.ending = Ending.NO_FLIP
            jammed.append(made)

    monkeypatch.setattr(kinetic_sweep, "run", jamming)
    found = list(filled(widening, SITES[name]).layers)
    assert jammed == list(JAMS)
    for before, after in zip(layers, found, strict=True):
        same(before, after)


@pytest.mark.parametrize("name", sorted(SITES))
@pytest.mark.parametrize("widening", [0.0, 0.01])
def test_a_want_of_room_does_not_show(
    widening: float, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    layers = list(filled(widening, SITES[name]).layers)
    ended: list[int] = []

    def noting(*given: Any) -> None:
        run(*given)
        ended.append(int(given[MADE].outcome.ending))

    monkeypatch.setattr(kinetic_sweep, "run", noting)
    monkeypatch.setattr(
        kinetic_sweep, "walks", lambda crossings, *rest: walks(crossings // 64, *rest)
    )
    monkeypatch.setattr(kinetic_sweep.Sweep, "_usual_rows", lambda *_: 1)
    for before, after in zip(layers, filled(widening, SITES[name]).layers, strict=True):
        same(before, after)
    assert ended.count(Ending.CROSSINGS_FULL) >= 2
    assert ended.count(Ending.OUTPUT_FULL) > len(layers) / 2


@pytest.mark.parametrize("name", sorted(SITES))
@pytest.mark.parametrize("seed", range(4))
def test_rows_of_the_mesh_do_not_show(
    name: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ties go by the sites' numbers, whatever order they enter in."""
    layers = list(filled(0.0, SITES[name]).layers)
    random = np.random.default_rng(seed)

    def any_order(places: Ints) -> Ints:
        return random.permutation(len(places))

    monkeypatch.setattr(sites, "curve_order", any_order)
    for before, after in zip(layers, filled(0.0, SITES[name]).layers, strict=True):
        same(before, after)


@pytest.mark.parametrize("first", [0, 3])
@pytest.mark.parametrize("seed", range(6))
def test_corners_on_walls_belong_to_the_first_site(
    first: int, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The square's corners lie on the walls between mirrored sites, wherever its ring begins."""
    pair = np.array([[2.0, 6, 0], [6, 2, 0], [3, 13, 0], [13, 3, 0], [11, 14, 0], [14, 11, 0]])
    order = np.random.default_rng(seed).permutation(len(pair))
    sections = [Section(0.5 * k, (np.roll(SQUARE, first, axis=0),)) for k in range(3)]
    layers = list(foam(sections, pair[order]).layers)
    for turn in range(4):
        monkeypatch.setattr(sites, "curve_order", lambda places, turn=turn: np.roll(
            np.arange(len(places)), turn
        ))  # fmt: skip
        for before, after in zip(layers, foam(sections, pair[order]).layers, strict=True):
            same(before, after)
