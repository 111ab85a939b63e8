"""Targets that show one layer: the layer, its tree, one cell, neighbours, sizes.

Where only a part of a layer is shown, its contours are drawn as `context`. All lies on the bed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import chain

import numpy as np
import shapely
from numpy.typing import NDArray

from v3dcad.errors import SettingError
from v3dcad.model import Floats, Ints, Layer
from v3dcad.view.targets.shown import Areas, Labels, Lines, Preview, Scale
from v3dcad.words import counted


def layer_alone(layer: Layer) -> Preview:
    """Walls and contours of the layer."""
    cells = layer.diagram.sites()
    return Preview(
        target="layer",
        title=_named(layer),
        lines=walls_and_contours(layer),
        labels=_labels(layer, cells),
        cells=cells,
    )


def tree(layer: Layer) -> Preview:
    """The minimum spanning tree of the layer's sites, over the layer."""
    lines = (
        _lines("context", layer.diagram.vertices, layer.diagram.edges, layer.z),
        _lines("tree", layer.state.sites[:, :2], layer.tree, layer.z),
    )
    return Preview(
        target="tree",
        title=f"minimum spanning tree of {_named(layer)}",
        lines=lines,
        labels=Labels.none(),
        cells=layer.diagram.sites(),
    )


def sizes(layer: Layer) -> Preview:
    """The cells of the layer by their size: the side of a square of the same area, mm."""
    cells = layer.diagram.sites()
    values = cell_sizes(layer)[cells]
    rings = layer.diagram.cells()
    count = [len(rings[site]) for site in cells.tolist()]
    every = [*chain.from_iterable(rings[site] for site in cells.tolist())]
    flat = np.concatenate([np.empty((0, 2)), *every])
    areas = Areas(
        sites=cells,
        values=values,
        points=_raised(flat, layer.z),
        starts=np.cumsum([0, *map(len, every)]),
        of=np.repeat(np.arange(len(cells)), count),
    )
    return Preview(
        target="sizes",
        title=f"size of the cells of {_named(layer)}",
        lines=(_edges(layer, "context", np.ones(len(layer.diagram.edges), np.bool_)),),
        labels=_labels(layer, cells),
        cells=cells,
        areas=areas,
        scale=Scale.of("size", "mm", values),
    )


SHOWS: dict[str, Callable[[Layer], Preview]] = {
    "layer": layer_alone,
    "tree": tree,
    "sizes": sizes,
}


def around_cell(target: str, layer: Layer, cell: int | None, neighbour: int | None) -> Preview:
    """A `cell` alone, with its `neighbours`, or with one `neighbour`.

    Raises `SettingError` for a cell or neighbour that is not there.
    """
    known = _known(layer, cell)
    if target == "cell":
        return Preview(
            target=target,
            title=f"cell {known} of {_named(layer)}",
            lines=(contours(layer), _edges(layer, "cell", _around(layer, known))),
            labels=_labels(layer, np.array([known])),
            cells=layer.diagram.sites(),
        )
    return _neighbours(layer, known, target, neighbour)


def _neighbours(layer: Layer, cell: int, target: str, neighbour: int | None) -> Preview:
    """A cell and all its neighbours, or one of them; the walls between belong to the cell."""
    pairs = layer.diagram.neighbours
    beside = np.unique(pairs[(pairs == cell).any(axis=1)])
    beside = beside[beside != cell]
    title = f"{counted(len(beside), 'neighbour')} of cell {cell}"
    if target == "neighbour":
        if neighbour not in beside:
            asked = "no neighbour is chosen" if neighbour is None else f"neighbour {neighbour}"
            raise SettingError(
                "neighbour",
                f"{asked}: the neighbours of cell {cell} on layer {layer.index} are "
                f"{_listed(beside)}",
            )
        beside = np.array([neighbour])
        title = f"cell {cell} and its neighbour {neighbour}"
    own = _around(layer, cell)
    others = np.isin(layer.diagram.edge_sites, beside).any(axis=1) & ~own
    return Preview(
        target=target,
        title=f"{title}, {_named(layer)}",
        lines=(contours(layer), _edges(layer, "neighbour", others), _edges(layer, "cell", own)),
        labels=_labels(layer, np.sort(np.append(beside, cell))),
        cells=layer.diagram.sites(),
    )


def _known(layer: Layer, cell: int | None) -> int:
    """A site that has a cell on the layer; `SettingError` for any other."""
    cells = layer.diagram.sites()
    if cell is None or cell not in cells:
        asked = "no cell is chosen" if cell is None else f"cell {cell}"
        raise SettingError(
            "cell", f"{asked}: the cells of layer {layer.index} are {_listed(cells)}"
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


def cell_sizes(layer: Layer) -> Floats:
    """(n,) the side of a square as large as each site's cell, mm; 0 where it has none."""
    return np.sqrt(np.maximum(layer.diagram.areas(len(layer.state.sites)), 0.0))


def walls_and_contours(layer: Layer) -> tuple[Lines, Lines]:
    """The contours of a layer, and its walls."""
    inner = layer.diagram.inner()
    return _edges(layer, "contour", ~inner), _edges(layer, "wall", inner)


def contours(layer: Layer) -> Lines:
    """The contours of a layer as context."""
    return _edges(layer, "context", ~layer.diagram.inner())


def _around(layer: Layer, cell: int) -> NDArray[np.bool_]:
    """(e,) which edges bound a cell."""
    return np.asarray((layer.diagram.edge_sites == cell).any(axis=1))


def _edges(layer: Layer, role: str, which: NDArray[np.bool_]) -> Lines:
    return _lines(role, layer.diagram.vertices, layer.diagram.edges[which], layer.z)


def _lines(role: str, plane: Floats, pairs: Ints, z: float) -> Lines:
    """Lines between points (n, 2) at a height; of the points, only those that lines end in."""
    return Lines.of(role, _raised(plane, z), pairs)


def _raised(plane: Floats, z: float) -> Floats:
    """Points (n, 2) at a height, (n, 3)."""
    return np.column_stack([plane, np.full(len(plane), z)])


def _labels(layer: Layer, sites: Ints) -> Labels:
    """The numbers of sites, each inside its cell."""
    rings = layer.diagram.cells()
    places = np.reshape([_inside(rings[site]) for site in sites.tolist()], (-1, 2))
    return Labels(sites, _raised(places, layer.z))


def _inside(rings: Sequence[Floats]) -> Floats:
    """(2,) a point inside a cell, in the middle of a wide place of it; of one without area, on it.

    A middle of corners would not do: a section may leave a bent cell, pieces, or a ring.
    """
    closed = [shapely.linestrings(np.vstack([ring, ring[:1]])) for ring in rings]
    point = shapely.point_on_surface(shapely.build_area(shapely.multilinestrings(closed)))
    place: Floats = rings[0][0] if shapely.is_empty(point) else shapely.get_coordinates(point)[0]
    return place
