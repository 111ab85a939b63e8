"""What each target of a preview shows (thesis, section 3.3): lines, labels, legend and title.

| target | shows |
|---|---|
| `full` | walls and contours of all layers |
| `layer` | walls and contours of one layer |
| `cell` | one cell on one layer |
| `neighbours` | a cell and all its neighbours on that layer |
| `neighbour` | a cell and one of its neighbours |
| `tree` | the minimum spanning tree of a layer's sites, over the layer |
| `cut` | walls and contours in the plane y = 0 of the bed, which is upright in the part's middle |

Where only a part of a layer is shown, its contours are drawn as `context`. Lines lie where the
part's source lies.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from v3dcad.errors import SettingError
from v3dcad.model import Floats, Ints, Layer, Placement, Value
from v3dcad.view.colours import COLOURS
from v3dcad.view.vertical_cut import vertical_cut

TARGETS = ("full", "layer", "cell", "neighbours", "neighbour", "tree", "cut")


@dataclass(frozen=True, eq=False, slots=True)
class Lines(Value):
    """Lines of one role, and so of one colour."""

    role: str
    """a key of `COLOURS`"""
    points: Floats
    """(n, 3) mm"""
    pairs: Ints
    """(m, 2) which points each line joins"""

    @property
    def colour(self) -> str:
        """Its colour, as #rrggbb."""
        return COLOURS[self.role]


@dataclass(frozen=True, eq=False, slots=True)
class Labels(Value):
    """The numbers of sites, to be written at points."""

    sites: Ints
    """(k,)"""
    points: Floats
    """(k, 3) mm"""


@dataclass(frozen=True, eq=False, slots=True)
class Preview(Value):
    """What is shown of a structure."""

    title: str
    lines: tuple[Lines, ...]
    """what is most important comes last, to be drawn over the others"""
    labels: Labels
    cells: Ints
    """(c,) the sites that have a cell on the layer that is shown; none for `full` and `cut`"""

    @property
    def legend(self) -> dict[str, str]:
        """The colour of each role that is shown."""
        return {lines.role: lines.colour for lines in self.lines}


def preview(
    target: str,
    layers: Sequence[Layer],
    placement: Placement,
    index: int = 0,
    cell: int | None = None,
    neighbour: int | None = None,
) -> Preview:
    """What a target shows of a structure's layers.

    `index` is the layer that is meant, `cell` and `neighbour` are site numbers; targets that need
    none of them leave them unread. Of layers that are computed when they are asked for, only one
    is, but by `full` and `cut`, which go through all. Raises `SettingError` for a target, layer or
    cell that is not there.
    """
    if target not in TARGETS:
        raise SettingError("target", f"target {target!r}: give {', '.join(TARGETS)}")
    if target in ("full", "cut"):
        shown = _full(layers) if target == "full" else _cut(layers)
    else:
        if not 0 <= index < len(layers):
            raise SettingError("layer", f"layer {index}: the layers are 0 to {len(layers) - 1}")
        layer = layers[index]
        if target == "layer":
            shown = _layer(layer)
        elif target == "tree":
            shown = _tree(layer)
        elif target == "cell":
            shown = _cell(layer, _known(layer, cell))
        else:
            shown = _neighbours(layer, _known(layer, cell), target, neighbour)
    return _at_source(shown, placement)


def _full(layers: Sequence[Layer]) -> Preview:
    drawn = [_walls_and_contours(layer) for layer in layers]
    lines = tuple(_joined(role, [one[k] for one in drawn]) for k, role in enumerate(_FULL))
    return Preview(f"the whole structure, {len(layers)} layers", lines, *_UNNUMBERED)


def _cut(layers: Sequence[Layer]) -> Preview:
    found = vertical_cut(layers)
    ends = [layers[index] for index in sorted({0, len(layers) - 1})]
    lines = (
        _joined("context", [_contours(layer) for layer in ends]),
        Lines("contour", found.points, found.contours),
        Lines("wall", found.points, found.walls),
    )
    return Preview("vertical cut through the middle", lines, *_UNNUMBERED)


def _layer(layer: Layer) -> Preview:
    cells = layer.diagram.sites()
    return Preview(_named(layer), _walls_and_contours(layer), _labels(layer, cells), cells)


def _tree(layer: Layer) -> Preview:
    lines = (
        _lines("context", layer.diagram.vertices, layer.diagram.edges, layer.z),
        _lines("tree", layer.state.sites[:, :2], layer.tree, layer.z),
    )
    title = f"minimum spanning tree of {_named(layer)}"
    return Preview(title, lines, _UNLABELLED, layer.diagram.sites())


def _cell(layer: Layer, cell: int) -> Preview:
    lines = _contours(layer), _edges(layer, "cell", _around(layer, cell))
    labels = _labels(layer, np.array([cell]))
    return Preview(f"cell {cell} of {_named(layer)}", lines, labels, layer.diagram.sites())


def _neighbours(layer: Layer, cell: int, target: str, neighbour: int | None) -> Preview:
    """A cell and all its neighbours, or one of them; the walls between belong to the cell."""
    pairs = layer.diagram.neighbours
    beside = np.unique(pairs[(pairs == cell).any(axis=1)])
    beside = beside[beside != cell]
    title = f"{len(beside)} neighbours of cell {cell}"
    if target == "neighbour":
        if neighbour not in beside:
            raise SettingError(
                "neighbour",
                f"neighbour {neighbour}: the neighbours of cell {cell} on layer {layer.index} are "
                f"{_listed(beside)}",
            )
        beside = np.array([neighbour])
        title = f"cell {cell} and its neighbour {neighbour}"
    own = _around(layer, cell)
    others = np.isin(layer.diagram.edge_sites, beside).any(axis=1) & ~own
    lines = (
        _contours(layer), _edges(layer, "neighbour", others), _edges(layer, "cell", own)
    )  # fmt: skip
    labels = _labels(layer, np.sort(np.append(beside, cell)))
    return Preview(f"{title}, {_named(layer)}", lines, labels, layer.diagram.sites())


def _known(layer: Layer, cell: int | None) -> int:
    """A site that has a cell on the layer; `SettingError` for any other."""
    cells = layer.diagram.sites()
    if cell is None or cell not in cells:
        raise SettingError(
            "cell", f"cell {cell}: the cells of layer {layer.index} are {_listed(cells)}"
        )
    return cell


_MOST_LISTED = 12


def _listed(sites: Ints) -> str:
    """Site numbers in words, the first few of many."""
    first = ", ".join(map(str, sites[:_MOST_LISTED].tolist()))
    more = len(sites) - _MOST_LISTED
    return (f"{first} and {more} more" if more > 0 else first) or "none"


def _named(layer: Layer) -> str:
    return f"layer {layer.index}, {layer.z:g} mm above the bed"


_FULL = ("contour", "wall")


def _walls_and_contours(layer: Layer) -> tuple[Lines, Lines]:
    inner = layer.diagram.inner()
    return _edges(layer, "contour", ~inner), _edges(layer, "wall", inner)


def _contours(layer: Layer) -> Lines:
    return _edges(layer, "context", ~layer.diagram.inner())


def _around(layer: Layer, cell: int) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(e,) which edges bound a cell."""
    return np.asarray((layer.diagram.edge_sites == cell).any(axis=1))


def _edges(layer: Layer, role: str, which: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Lines:
    return _lines(role, layer.diagram.vertices, layer.diagram.edges[which], layer.z)


def _lines(role: str, plane: Floats, pairs: Ints, z: float) -> Lines:
    """Lines between points (n, 2) at a height; of the points, only those that lines end in."""
    used, places = np.unique(pairs, return_inverse=True)
    points = np.column_stack([plane[used], np.full(len(used), z)])
    return Lines(role, points, places.reshape(-1, 2))


def _joined(role: str, drawn: Sequence[Lines]) -> Lines:
    """Several lines as one."""
    if not drawn:
        return Lines(role, np.empty((0, 3)), np.empty((0, 2), np.int64))
    first = np.cumsum([0, *(len(lines.points) for lines in drawn[:-1])])
    pairs = [lines.pairs + start for lines, start in zip(drawn, first.tolist(), strict=True)]
    return Lines(role, np.concatenate([lines.points for lines in drawn]), np.concatenate(pairs))


_UNLABELLED = Labels(np.empty(0, np.int64), np.empty((0, 3)))
_UNNUMBERED = _UNLABELLED, _UNLABELLED.sites
"""The labels and the cells of what shows no layer by itself."""


def _labels(layer: Layer, sites: Ints) -> Labels:
    """The numbers of sites, each inside its cell."""
    rings = layer.diagram.cells()
    places = np.reshape([_inside(rings[site]) for site in sites.tolist()], (-1, 2))
    return Labels(sites, np.column_stack([places, np.full(len(sites), layer.z)]))


def _inside(rings: Sequence[Floats]) -> Floats:
    """(2,) a point inside a cell, in the middle of a wide place of it; of one without area, on it.

    A middle of corners would not do: a section may leave a bent cell, pieces, or a ring.
    """
    closed = [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in rings]
    point = shapely.point_on_surface(shapely.build_area(shapely.multilinestrings(closed)))
    place: Floats = rings[0][0] if shapely.is_empty(point) else shapely.get_coordinates(point)[0]
    return place


def _at_source(shown: Preview, placement: Placement) -> Preview:
    """What is shown, moved from the bed to where the source lies."""
    lines = tuple(replace(one, points=placement.to_source(one.points)) for one in shown.lines)
    points = placement.to_source(shown.labels.points)
    return replace(shown, lines=lines, labels=replace(shown.labels, points=points))


def all_lines(layers: Iterable[Layer], placement: Placement) -> tuple[Floats, Ints, Ints]:
    """All edges of a structure: points (n, 3), mm, where the source lies, pairs (m, 2), and the
    layer (m,) of each. Goes through the layers once.
    """
    points, pairs, indices = [np.empty((0, 3))], [np.empty((0, 2), np.int64)], [np.empty(0, int)]
    first = 0
    for layer in layers:
        diagram = layer.diagram
        corners = len(diagram.vertices)
        points.append(np.column_stack([diagram.vertices, np.full(corners, layer.z)]))
        pairs.append(diagram.edges + first)
        indices.append(np.full(len(diagram.edges), layer.index))
        first += corners
    return (
        placement.to_source(np.concatenate(points)), np.concatenate(pairs), np.concatenate(indices)
    )  # fmt: skip
