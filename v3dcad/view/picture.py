"""A picture of a filled part in space: the part translucent, its walls, a quarter cut away."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from v3dcad.geometry.section_area import section_area
from v3dcad.model import Floats, Layer, Mesh
from v3dcad.view.colours import BLUE, GREY, ramp, rgb
from v3dcad.view.outline import outline
from v3dcad.view.perspective import ABOVE, ON_TOP, Areas, Eye, Strips, contour_strips, wall_strips
from v3dcad.view.targets.shown import Scale
from v3dcad.view.targets.whole import edge_tilts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

MOST_WALLS, MOST_LAYERS = 75_000, 100
"""Of about how many edges walls are painted, and how many layers: of more, every so many layers."""

FINE = 5e-4
"""What of a contour is smaller than this share of the part's size cannot be seen."""

WIDTH = 0.9
"""Of the edges of strips, points: walls that are seen edge-on are lines."""

MARGIN = 0.03
"""Of the picture's sides, around the part."""

LIGHT = np.array([0.35, -0.45, 0.82])
"""Where light comes from; a unit vector."""

SHADE, GLOSS = (0.45, 0.7), (0.6, 0.2)
"""How much of its colour a wall in the shade keeps, and how far towards white the light takes it;
second: the same where colours mean values, and have to be known again."""

INK = (*rgb(BLUE) * 0.3, 1.0)
"""The colour of edges where walls are cut, or end."""

SKIN = (*rgb(GREY), 0.08)
"""The colour of each side of the part, and how opaque it is."""

OUTLINE = (*rgb(GREY) * 0.7, 0.8)


class Paint(NamedTuple):
    """Polygons in the order in which they are painted."""

    corners: Floats
    """(p, 4, 2) in the picture"""
    faces: Floats
    """(p, 4) red, green, blue and opacity"""
    edges: Floats
    """(p, 4)"""


class Chosen(NamedTuple):
    """The layers that are painted, of all."""

    layers: list[Layer]
    step: int
    """every how many layers one is painted"""
    cells: int
    """how many sites have a cell on any layer, painted or not"""
    thinned: bool
    """whether layers are so many that what is left out may be missed"""


def choose(layers: Sequence[Layer], most: int | None = None) -> Chosen:
    """The layers to paint, with about `most` edges of walls. Goes through all layers once.

    The layer in the middle stands for all when they are counted.
    """
    middle = layers[len(layers) // 2]
    walls = len(layers) * np.count_nonzero(middle.diagram.inner())
    needed = math.ceil(len(layers) / MOST_LAYERS)
    step = max(math.ceil(walls / (most or MOST_WALLS)), needed)
    chosen: list[Layer] = []
    seen = np.zeros(len(middle.state.sites) + 1, np.bool_)  # the last is OUTSIDE, which is −1
    for place, layer in enumerate(layers):
        seen[layer.diagram.edge_sites] = True
        if place % step == 0:
            chosen.append(layer)
    return Chosen(chosen, step, int(np.count_nonzero(seen[:-1])), step > needed)


def eye_on(part: Mesh, from_top: bool) -> Eye:
    """The eye that looks at a part."""
    low, high = part.vertices.min(axis=0), part.vertices.max(axis=0)
    return Eye((low + high) / 2, float(np.linalg.norm(high - low)), ON_TOP if from_top else ABOVE)


def draw(
    axes: Axes,
    layers: Sequence[Layer],
    part: Mesh,
    base: float,
    *,
    from_top: bool = False,
    whole: bool = False,
    tilts: bool = False,
) -> Scale | None:
    """Paint some layers and the part that they fill, both in bed coordinates.

    A layer begins `base` mm over its section (`FillSettings.layer_span`), and reaches up to the
    next that is painted. The quarter of the walls that is nearest to the eye is cut away, unless
    they are wanted `whole`. With `tilts` each wall has the colour of how far it leans, on the scale
    that is returned.
    """
    from matplotlib.collections import LineCollection

    eye = eye_on(part, from_top)
    corner = None if whole else eye.middle[:2]
    bottom, top = float(part.vertices[:, 2].min()), float(part.vertices[:, 2].max())
    leans = [edge_tilts(layer) if tilts else np.zeros(len(layer.diagram.edges)) for layer in layers]
    scale = Scale("tilt", "°", 0.0, max(map(_greatest, leans), default=0.0)) if tilts else None
    spans = _spans(layers, base, top)
    areas = [section_area(layer.section) for layer in layers]
    ends = [*areas[:1], *areas, *areas[-1:]]
    walls = [
        wall_strips(layer, span, lean, corner, Areas(*beside))
        for layer, span, lean, *beside in zip(
            layers, spans, leans, ends[:-2], areas, ends[2:], strict=True
        )
    ]
    if layers:
        axes.add_patch(_floor(layers[0], bottom, eye))
        painted = [
            _painted(strips, contour_strips(layer, span, FINE * eye.size), above, eye, scale)
            for layer, span, strips, above in zip(
                layers, spans, walls, [*areas[1:], None], strict=True
            )
        ]
        axes.add_collection(_polygons(painted), autolim=False)
    # The quarter that is cut away is the nearest to the eye: nothing hides what it lays open.
    sides = np.concatenate([np.empty((0, 2, 3)), *(strips.sides() for strips in walls)])
    for lines, colour, width in ((sides, INK, 1.4), (outline(part, eye), OUTLINE, 0.8)):
        flat, _ = eye.seen(lines)
        drawn = LineCollection(list(flat), colors=[colour], linewidths=width, capstyle="round")
        axes.add_collection(drawn, autolim=False)
    _fit(axes, eye.seen(part.vertices)[0])
    return scale


def _spans(layers: Sequence[Layer], base: float, top: float) -> list[tuple[float, float]]:
    """From where to where layers reach, mm: up to the next, and the last up to the part's top."""
    floors = [layer.z + base for layer in layers]
    return [
        (floor, max(floor, ceiling))
        for floor, ceiling in zip(floors, [*floors[1:], top], strict=False)
    ]


def _polygons(painted: Iterable[Paint]) -> PolyCollection:
    """Polygons as matplotlib paints them, one after the other."""
    from matplotlib.collections import PolyCollection

    paint = Paint(*map(np.concatenate, zip(*painted, strict=True)))
    return PolyCollection(
        paint.corners,  # type: ignore[arg-type]
        facecolors=paint.faces,
        edgecolors=paint.edges,
        linewidths=WIDTH,
        joinstyle="round",
        rasterized=True,
    )


def _fit(axes: Axes, points: Floats) -> None:
    """Show just the part, whose corners (n, 2) are given."""
    low, high = points.min(axis=0), points.max(axis=0)
    margin = MARGIN * (high - low).max()
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _greatest(values: Floats) -> float:
    return float(np.max(values, initial=0.0, where=~np.isnan(values)))


def _painted(
    walls: Strips,
    contours: Strips,
    above: shapely.Geometry | None,
    eye: Eye,
    scale: Scale | None,
) -> Paint:
    """The strips of one layer, the farthest first, and the upper ends of walls that go no higher.

    `above` is the section of the layer that is painted next.
    """
    ends = walls.corners[_end(walls, above)][:, [2, 2, 3, 3]]
    corners = np.concatenate([walls.corners, ends, contours.corners])
    counts = [len(ends), len(contours.corners)]
    colours = _lit(walls, eye, scale)
    ink, skin = (np.tile(one, (count, 1)) for one, count in zip((INK, SKIN), counts, strict=True))
    flat, depth = eye.seen(corners)
    order = np.argsort(-depth.mean(axis=1), kind="stable")
    return Paint(
        flat[order],
        np.concatenate([colours, ink, skin])[order],
        np.concatenate([colours, ink, 0 * skin])[order],
    )


def _end(walls: Strips, above: shapely.Geometry | None) -> NDArray[np.bool_]:
    """(s,) which strips have nothing of the part over them."""
    if above is None:
        return np.ones(len(walls.corners), np.bool_)
    shapely.prepare(above)
    x, y = walls.corners[:, :2, :2].mean(axis=1).T
    return np.asarray(~shapely.contains_xy(above, x, y))


def _lit(walls: Strips, eye: Eye, scale: Scale | None) -> Floats:
    """(s, 4) the colours of walls: the side that the eye sees is the one that has light or not."""
    first, second, _, over = np.moveaxis(walls.corners, 1, 0)
    normals = np.cross(second - first, over - first)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    light = np.where(normals @ eye.towards() < 0, -1, 1) * (normals @ LIGHT)
    plain = rgb(BLUE) if scale is None else ramp(scale.shares(walls.values))
    share = np.clip((light + 0.4) / 1.4, 0, 1)[:, None]
    means = int(scale is not None)
    dark, bright = SHADE[means] * plain, plain + GLOSS[means] * (1 - plain)
    lit = dark + share * (bright - dark)
    return np.column_stack([lit, np.ones(len(lit))])


def _floor(layer: Layer, height: float, eye: Eye) -> Patch:
    """The base of the part: the contours of its first layer, at a height, mm."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    rings = [
        eye.seen(np.column_stack([ring, np.full(len(ring), height)]))[0]
        for ring in layer.section.rings
    ]
    outlines = [Path(np.vstack([ring, ring[:1]]), closed=True) for ring in rings]
    return PathPatch(Path.make_compound_path(*outlines), facecolor=SKIN, linewidth=0)
