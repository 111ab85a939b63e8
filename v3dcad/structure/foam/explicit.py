"""Sites that a user gives, as a foam's."""

from __future__ import annotations

import math
import warnings

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.geometry.voronoi.reach import cell_reaches
from v3dcad.model import Floats, Ints
from v3dcad.structure.foam.sites import FoamSites
from v3dcad.structure.sweep.sites import ALWAYS

FEW = 1000
"""So many sites are always in the mesh."""


def explicit_sites(points: Floats, stretch: float, low: Floats, high: Floats) -> FoamSites:
    """Sites at points (n, 3), mm, bed coordinates, for a part in the box low … high (3,), mm.

    The grid lies around box and sites. Sites on the same grid point are merged, with a warning.
    Raises `GeometryError` where there are none, and for one that is no finite number or so far
    outside that the grid would be coarse.
    """
    points = np.ascontiguousarray(points, np.float64).reshape(-1, 3)
    if not len(points):
        raise GeometryError("there are no sites: give at least one")
    squeezed = np.array([1, 1, 1 / stretch])
    places, low, high = points * squeezed, low * squeezed, high * squeezed
    _refuse_far(points, places, low, high)
    lowest, highest = np.minimum(places.min(axis=0), low), np.maximum(places.max(axis=0), high)
    # No weight of a layer is above the square of the height, nor that of the farthest site.
    grid = Grid.around(lowest[:2], highest[:2], 4 * float(max(highest[2] - lowest[2], 0.0)) ** 2)
    whole = np.column_stack([grid.snap(places[:, :2]), np.rint(places[:, 2] / grid.pitch)])
    whole = whole.astype(np.int64)
    _, first = np.unique(whole, axis=0, return_index=True)
    if len(first) < len(whole):
        warnings.warn(
            f"{len(whole) - len(first)} of {len(whole)} sites lie on others "
            f"(within {grid.pitch:.2g} mm) and were merged with them",
            stacklevel=3,
        )
        whole = whole[np.sort(first)]
    return FoamSites(grid, stretch, whole, _spans(whole, grid, low, high))


def column_sites(points: Floats, low: Floats, high: Floats) -> FoamSites:
    """Sites at points (n, 2), mm, whose cells are upright columns, as `explicit_sites`.

    Cells of sites at one height are the same with any stretch. This one makes the part as flat as a
    cell is wide, so that only what is near in the plane is near in space.
    """
    size = high - low
    spacing = math.sqrt(size[0] * size[1] / max(1, len(points)))
    stretch = max(1.0, float(size[2]) / spacing) if spacing > 0 else 1.0
    return explicit_sites(np.column_stack([points, np.zeros(len(points))]), stretch, low, high)


def _spans(places: Ints, grid: Grid, low: Floats, high: Floats) -> Ints:
    """Between which heights (n, 2) cells may be in the box low … high (3,), stretched space.

    Few sites may all be in the mesh at once. Of many, it is bounded how far cells reach, which
    takes about as long as to find their walls.
    """
    if len(places) <= FEW:
        return np.tile([-ALWAYS, ALWAYS], (len(places), 1))
    corner = np.append(grid.origin, 0.0)
    box = [np.asarray((end - corner) / grid.pitch) for end in (low, high)]
    _, reach = cell_reaches(places.astype(np.float64), *box)
    spans: Ints = places[:, 2:] + np.ceil(reach).astype(np.int64)[:, None] * np.array([-1, 1])
    spans[reach == 0] = ALWAYS, -ALWAYS
    return spans


def _refuse_far(points: Floats, places: Floats, low: Floats, high: Floats) -> None:
    """Raise `GeometryError` for a site that is not finite, or too far from the box."""
    finite = np.isfinite(points).all(axis=1)
    for site in np.nonzero(~finite)[0]:
        raise GeometryError("its coordinates are not finite numbers", site=int(site))
    reach = 100 * float((high - low).max())
    if reach > 0:
        far = (places < low - reach) | (places > high + reach)
        for site in np.nonzero(far.any(axis=1))[0]:
            x, y, z = points[site]
            raise GeometryError(
                f"({x:g}, {y:g}, {z:g}) mm is more than {reach:g} mm outside the part: move it "
                "nearer",
                site=int(site),
            )
