"""A drawing of what a target shows in a plane: a layer from above, a cut from the front."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from v3dcad.view.colours import BLUE, RAMP
from v3dcad.view.targets.shown import Areas, Preview, Scale
from v3dcad.view.targets.sizes import QUANTILES, SizeDistribution

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTHS = {"context": 0.7, "travel": 0.5, "wall": 1.1, "neighbour": 1.8, "cell": 2.4, "tree": 1.8}
"""How wide lines of a role are drawn, points; of all others:"""
WIDTH = 1.1

CROWDED = 3000
"""Of more lines than so many, each is drawn thinner, down to a third."""

LETTERS = (3.5, 9.0)
"""The least and greatest size of a number in its cell, points."""


def plane_of(shown: Preview) -> list[int]:
    """Which of x, y and z are drawn to the right and upwards: a cut is seen from the front."""
    return [0, 2] if shown.target == "cut" else [0, 1]


def draw(axes: Axes, shown: Preview, ids: bool) -> None:
    """Draw a preview in bed coordinates: x and y, or x and z where it is a cut.

    With `ids` each cell has the number of its site; a cell that was chosen, and its neighbours,
    always have theirs.
    """
    from matplotlib.collections import LineCollection

    plane = plane_of(shown)
    axes.set_aspect("equal")
    axes.set(xlabel="x (mm)", ylabel=f"{'xyz'[plane[1]]} (mm)")
    if shown.areas is not None and shown.scale is not None:
        axes.add_collection(_filled(shown.areas, shown.scale))
    count = sum(len(one.pairs) for one in shown.lines)
    thinner = float(np.clip((CROWDED / max(count, 1)) ** 0.5, 1 / 3, 1))
    for one in shown.lines:
        axes.add_collection(
            LineCollection(
                list(one.points[one.pairs][:, :, plane]),
                colors="white" if shown.areas is not None else one.colour,
                linewidths=thinner * WIDTHS.get(one.role, WIDTH),
                linestyles="dashed" if one.role == "travel" else "solid",
                capstyle="butt" if one.role == "travel" else "round",
                label="_" if one.role == "context" else one.role,  # it speaks for itself
            )
        )
    for mark in shown.marks:
        x, y = mark.points[:, plane].T
        axes.plot(x, y, "o", color=mark.colour, markersize=3.5, label=mark.role)
    axes.autoscale_view()
    chosen = shown.target in ("cell", "neighbours", "neighbour")
    if ids or chosen:
        _number(axes, shown, plane)
    if len(shown.legend.keys() - {"context"}) > 1:  # one role alone needs no words
        _explain(axes)


def draw_scale(axes: Axes, scale: Scale) -> None:
    """Draw beside some axes what the colours of a scale mean."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    colours = ScalarMappable(Normalize(scale.low, scale.high), _colour_map())
    bar = axes.figure.colorbar(colours, ax=axes, shrink=0.6, pad=0.02)
    bar.set_label(f"{scale.name} ({scale.unit})")
    bar.outline.set_visible(False)


def draw_sizes(axes: Axes, found: SizeDistribution, z: float) -> None:
    """Draw how sizes and areas of whole cells are distributed over the height; mark a height.

    Cells that a contour cuts have no say: how large they are is chance.
    """
    from matplotlib.ticker import MaxNLocator

    sizes = found.sizes
    for k, shade in ((0, 0.18), (1, 0.35)):
        axes.fill_betweenx(
            found.z,
            sizes[:, k],
            sizes[:, -1 - k],
            color=BLUE,
            alpha=shade,
            linewidth=0,
            label=f"{1 - 2 * QUANTILES[k]:.0%} of whole cells",
        )
    axes.plot(sizes[:, 2], found.z, color=BLUE, linewidth=1.5, label="median")
    axes.axhline(z, color="black", linewidth=0.8, linestyle="dotted", label="this layer")
    axes.set(xlabel="size of whole cells (mm)", ylabel="z (mm)")
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    areas = axes.secondary_xaxis("top", functions=(_square, _root))
    areas.set_xlabel("area of whole cells (mm²)")
    areas.xaxis.set_major_locator(MaxNLocator(4))
    _explain(axes)


def _explain(axes: Axes) -> None:
    """Write below the picture what the colours in some axes mean."""
    handles, words = axes.get_legend_handles_labels()
    axes.figure.legend(handles, words, loc="outside lower center", ncols=len(words), frameon=False)


def _square(sizes: Any) -> Any:
    return np.square(sizes)


def _root(areas: Any) -> Any:
    return np.sqrt(np.maximum(areas, 0.0))


def _colour_map() -> Any:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("v3dcad", RAMP)


def _filled(areas: Areas, scale: Scale) -> Any:
    """The cells as one collection: each a path of its rings, holes among them."""
    from matplotlib.collections import PathCollection
    from matplotlib.path import Path

    rings = np.split(areas.points[:, :2], areas.starts[1:-1])
    owned: list[list[Path]] = [[] for _ in areas.sites]
    for ring, owner in zip(rings, areas.of.tolist(), strict=True):
        owned[owner].append(Path(np.vstack([ring, ring[:1]]), closed=True))
    cells = [Path.make_compound_path(*paths) for paths in owned]
    colours = _colour_map()(scale.shares(areas.values))
    return PathCollection(cells, facecolors=colours, linewidths=0)


def _number(axes: Axes, shown: Preview, plane: list[int]) -> None:
    """Write numbers of sites in their cells, the smaller the more cells there are."""
    points = np.concatenate([one.points for one in shown.lines])[:, plane]
    spread = float(np.ptp(points, axis=0).prod() / max(len(shown.cells), 1)) ** 0.5
    scale = axes.transData.transform([[0, 0], [spread, 0]])
    room = float(scale[1, 0] - scale[0, 0]) * 72 / axes.figure.dpi
    size = float(np.clip(0.3 * room, *LETTERS))
    places = shown.labels.points[:, plane].tolist()
    for site, (x, y) in zip(shown.labels.sites.tolist(), places, strict=True):
        axes.text(x, y, f"{site}", size=size, ha="center", va="center", clip_on=True)
