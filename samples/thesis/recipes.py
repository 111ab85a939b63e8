"""The thesis's published cases: its parts, with the parameters of Tables 4.1 and 4.2.

`python samples/thesis/recipes.py FOLDER [BUNNY.stl]` writes each as `.ont`. The bunny is not
part of this repository: any STL of it will do.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from build123d import Box, Cone, Plane, Rectangle, extrude

from v3dcad import FillSettings, Structure, build
from v3dcad.parts import part_from


@dataclass(frozen=True)
class Recipe:
    """A part and how the thesis fills it."""

    name: str
    source: Callable[[], Any]
    """makes a shape, or names a file"""
    settings: FillSettings

    def build(self) -> Structure:
        """The filled part; its layers are computed when they are gone through."""
        return build(part_from(self.source()), self.settings)


def settings(layer_height: float, offset: float, sites: int, random_seed: int = 0) -> FillSettings:
    """The thesis's method with the parameters that its tables state."""
    return FillSettings(
        method="thesis",
        layer_height=layer_height,
        offset=offset,
        sites=sites,
        random_seed=random_seed,
    )


def published(bunny: Path | None = None) -> list[Recipe]:
    """The parts of Table 4.1, in its order; the bunny only where its file is given."""
    cases = [
        Recipe("cone", lambda: Cone(20, 15, 30), settings(0.2, 0.2, 40)),
        Recipe("truncated pyramid", lambda: _pyramid(67, 50), settings(0.2, 0.5, 10)),
        Recipe("large truncated pyramid", lambda: _pyramid(180, 30), settings(0.2, 0.2, 300)),
        Recipe("bunny", lambda: bunny, settings(0.25, 0.4, 40)),
        Recipe("prism", lambda: Box(1000, 1000, 40), settings(2.0, 0.1, 4000)),
    ]
    return [case for case in cases if bunny is not None or case.name != "bunny"]


def cubes() -> list[Recipe]:
    """The two cubes of Table 4.2, with sites whose cells keep their corners up to the top."""
    return [
        Recipe("cube", lambda: Box(50, 50, 50), settings(0.2, 0.3, 8, random_seed=2)),
        Recipe("fine cube", lambda: Box(50, 50, 50), settings(0.1, 0.15, 8, random_seed=2)),
    ]


def pyramid_of_50() -> Recipe:
    """The example of §3.2.1: Figs. 3.9 and 3.11 to 3.16."""
    return Recipe("pyramid of 50", lambda: _pyramid(67, 50), settings(0.2, 0.1, 50))


def prism_of_300() -> Recipe:
    """Not of the thesis: a part whose section stays, so that many sites are inserted."""
    return Recipe("prism of 300", lambda: Box(100, 100, 40), settings(0.2, 0.5, 300))


def _pyramid(side: float, height: float) -> Any:
    return extrude(Plane.XY * Rectangle(side, side), height, taper=10)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    stl = Path(sys.argv[2]) if len(sys.argv) == 3 else None
    for case in [*published(stl), *cubes(), pyramid_of_50()]:
        case.build().write_ont(folder / f"{case.name.replace(' ', '_')}.ont")
