"""The targets of a preview (thesis, section 3.3, and what came since), each declared once."""

from __future__ import annotations

from typing import NamedTuple

from v3dcad.errors import SettingError


class Target(NamedTuple):
    """What a target shows, in words, and what has to be chosen for it."""

    shows: str
    asks: tuple[str, ...] = ()
    """of "layer", "cell" and "neighbour" """


TARGETS = {
    "full": Target("walls and contours of all layers"),
    "layer": Target("walls and contours of one layer", ("layer",)),
    "cell": Target("one cell on a layer", ("layer", "cell")),
    "neighbours": Target("a cell and all its neighbours on a layer", ("layer", "cell")),
    "neighbour": Target("a cell and one of its neighbours", ("layer", "cell", "neighbour")),
    "tree": Target("the minimum spanning tree of a layer's sites, over the layer", ("layer",)),
    "cut": Target("walls and contours in the upright plane through the part's middle"),
    "sizes": Target("the cells of a layer, coloured by their size", ("layer",)),
    "overhang": Target("walls of all layers, coloured by how far they lean"),
    "toolpath": Target("how a layer is printed: perimeters, beads, travel, seams", ("layer",)),
}
"""By name, in the order in which they are offered."""


def target_of(name: str) -> Target:
    """The target of a name; `SettingError` where there is none."""
    if name not in TARGETS:
        raise SettingError("target", f"--target {name}: give {', '.join(TARGETS)}")
    return TARGETS[name]
