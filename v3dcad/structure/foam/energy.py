"""How far walls lean too much, and which way sites must move.

E = `WEIGHT` Σ (perimeter / r) (violation / r) + `PUSH` Σ (1 − d / (`DISTANCE` · r))²,

over walls that lean too much and over pairs of sites at a distance d that are near each other;
r is the radius of the smaller site. The violation is |Δz| / τ − |Δxy|. Its first power makes the
penalty exact: it falls to zero at a finite weight, by turning a wall upright or by making it
vanish. The gradient goes through the corners of each wall, where three bisectors meet.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from v3dcad.geometry.compiled.arrays import (
    BoolArray,
    FloatArray,
    FloatRows,
    IntArray,
    IntRows,
    WordArray,
)
from v3dcad.geometry.compiled.options import INTERNAL, compiled
from v3dcad.geometry.voronoi.bins import Bins
from v3dcad.geometry.voronoi.wall import OPEN, Polygon, in_space, wall

WEIGHT = 20.0
PUSH = 0.3
DISTANCE = 1.15

SMALLEST = 1e-7
"""In radii: walls of a smaller perimeter have no gradient that could be computed."""

FLATTEST = 1e-5
"""In cubed radii: a corner where bisectors meet under a smaller determinant is left alone."""


class Foam(NamedTuple):
    """Sites that are being relaxed, with all that is known of them and room to work in."""

    bins: Bins
    places: FloatRows
    """(n, 3) float64: the sites, within the periods"""
    held: int
    """so many of the first sites do not move"""
    radii: FloatArray
    """(n,) float64: the distance that neighbours of each site should keep"""
    low: FloatArray
    high: FloatArray
    """(3,) float64: the box whose walls count"""
    lists: IntRows
    """(n, k) int64: the nearest sites of each"""
    steep: BoolArray
    """(n,) bool: which sites have a wall that leans too much"""
    ages: IntArray
    """(n,) int64: for how many steps that has been so"""
    speeds: FloatRows
    """(n, 3) float64"""
    gradients: FloatRows
    """(n, 3) float64"""
    active: BoolArray
    """(n,) bool: sites whose walls are looked at"""
    touched: BoolArray
    """(n,) bool: sites that have a gradient or a speed"""
    checked: BoolArray
    """(n,) bool: sites whose walls may have changed"""
    active_rows: IntArray
    touched_rows: IntArray
    checked_rows: IntArray
    """(n,) int64: the same as lists"""
    counts: IntArray
    """(3,) int64: how long these lists are"""
    names: IntArray
    offsets: FloatRows
    squares: FloatArray
    """(m,), (m, 3), (m,): the neighbours of one site"""
    polygon: Polygon
    points: FloatRows
    """(c, 3) float64: the corners of one wall"""
    pulls: FloatRows
    """(c, 3) float64: the energy's gradient by these corners"""
    random: WordArray
    """(1,) uint64: the state of random numbers"""


ACTIVE, TOUCHED, CHECKED = range(3)
"""Entries of `Foam.counts`."""


@compiled(INTERNAL)
def look_around(foam: Foam, site: int) -> None:
    """Write the offsets of a site's neighbours, each the nearest of its copies."""
    places, periods = foam.places, foam.bins.periods
    for row in range(foam.lists.shape[1]):
        other = foam.lists[site, row]
        for axis in range(3):
            offset = places[other, axis] - places[site, axis]
            if periods[axis] > 0:
                offset -= periods[axis] * np.floor(offset / periods[axis] + 0.5)
            foam.offsets[row, axis] = offset


@compiled(INTERNAL)
def is_listed(foam: Foam, site: int, other: int) -> bool:
    """Whether a site is in the list of another: where sizes differ, often only one lists both."""
    for row in range(foam.lists.shape[1]):  # noqa: SIM110
        if foam.lists[other, row] == site:
            return True
    return False


@compiled(INTERNAL)
def touch(foam: Foam, site: int) -> None:
    """Note that a site has a gradient or a speed."""
    if not foam.touched[site]:
        foam.touched[site] = True
        foam.touched_rows[foam.counts[TOUCHED]] = site
        foam.counts[TOUCHED] += 1


@compiled(INTERNAL)
def pull(foam: Foam, site: int, x: float, y: float, z: float) -> None:
    """Add to a site's gradient."""
    touch(foam, site)
    foam.gradients[site, 0] += x
    foam.gradients[site, 1] += y
    foam.gradients[site, 2] += z


@compiled(INTERNAL)
def pull_corners(foam: Foam, size: int, scale: float, radius: float) -> float:
    """The perimeter of the wall in `foam.points`; writes its gradient by the corners, scaled.

    −1 for a wall that has no gradient: one that is cut off by no site, or too small.
    """
    points, pulls, perimeter = foam.points, foam.pulls, 0.0
    pulls[:size] = 0.0
    for corner in range(size):
        if foam.polygon.edges[corner] == OPEN:
            return -1.0
        following = corner + 1 if corner + 1 < size else 0
        x = points[corner, 0] - points[following, 0]
        y = points[corner, 1] - points[following, 1]
        z = points[corner, 2] - points[following, 2]
        length = np.sqrt(x * x + y * y + z * z)
        perimeter += length
        if length > 1e-12 * radius:
            share = scale / length
            pulls[corner, 0] += share * x
            pulls[corner, 1] += share * y
            pulls[corner, 2] += share * z
            pulls[following, 0] -= share * x
            pulls[following, 1] -= share * y
            pulls[following, 2] -= share * z
    return perimeter if perimeter >= SMALLEST * radius else -1.0


@compiled(INTERNAL)
def pull_sites(foam: Foam, site: int, row: int, size: int, radius: float) -> None:
    """Hand what pulls at the corners of a wall on to the sites around, by the chain rule.

    A corner v is where the bisectors of the site with three others a, b, c meet: a linear system
    in v, so that Cramer's rule gives how it moves with each of the four.
    """
    offsets, edges = foam.offsets, foam.polygon.edges
    ax, ay, az = offsets[row, 0], offsets[row, 1], offsets[row, 2]
    for corner in range(size):
        b, c = edges[corner - 1 if corner > 0 else size - 1], edges[corner]
        if b == c:
            continue
        bx, by, bz = offsets[b, 0], offsets[b, 1], offsets[b, 2]
        cx, cy, cz = offsets[c, 0], offsets[c, 1], offsets[c, 2]
        x, y, z = by * cz - cy * bz, bz * cx - cz * bx, bx * cy - cx * by
        volume = ax * x + ay * y + az * z
        if abs(volume) < FLATTEST * radius * radius * radius:
            continue
        px, py, pz = foam.pulls[corner, 0], foam.pulls[corner, 1], foam.pulls[corner, 2]
        of_a = (px * x + py * y + pz * z) / volume
        of_b = px * (cy * az - cz * ay) + py * (cz * ax - cx * az) + pz * (cx * ay - cy * ax)
        of_c = px * (ay * bz - az * by) + py * (az * bx - ax * bz) + pz * (ax * by - ay * bx)
        of_b, of_c = of_b / volume, of_c / volume
        of_all = of_a + of_b + of_c
        vx, vy, vz = foam.points[corner, 0], foam.points[corner, 1], foam.points[corner, 2]
        pull(foam, site, of_all * vx, of_all * vy, of_all * vz)
        pull(foam, foam.lists[site, row], of_a * (ax - vx), of_a * (ay - vy), of_a * (az - vz))
        pull(foam, foam.lists[site, b], of_b * (bx - vx), of_b * (by - vy), of_b * (bz - vz))
        pull(foam, foam.lists[site, c], of_c * (cx - vx), of_c * (cy - vy), of_c * (cz - vz))


@compiled(INTERNAL)
def add_gradients(foam: Foam, lean: float, slack: float) -> None:
    """Add the energy's gradient over all pairs with an active site.

    `lean` is 1 / τ; `slack`, in squared radii, makes walls larger than they are.
    """
    for index in range(foam.counts[ACTIVE]):
        site = foam.active_rows[index]
        look_around(foam, site)
        for row in range(foam.lists.shape[1]):
            other = foam.lists[site, row]
            radius = min(foam.radii[site], foam.radii[other])
            x, y, z = foam.offsets[row, 0], foam.offsets[row, 1], foam.offsets[row, 2]
            across = np.sqrt(x * x + y * y)
            distance = np.sqrt(x * x + y * y + z * z)
            near = DISTANCE * radius
            violation = (lean * abs(z) - across) / radius
            if distance >= near and violation <= 0:
                continue
            # Most pairs are through by now: to look for them in both lists would take most time.
            if other <= site and foam.active[other] and is_listed(foam, site, other):
                continue
            if 0 < distance < near:
                push = 2 * PUSH * (1 - distance / near) / (near * distance)
                pull(foam, site, push * x, push * y, push * z)
                pull(foam, other, -push * x, -push * y, -push * z)
            if violation <= 0:
                continue
            reach = 4 * max(foam.radii[site], foam.radii[other])
            loose = slack * radius * radius
            size = wall(foam.offsets, foam.lists.shape[1], row, reach, loose, foam.polygon)
            if size == 0:
                continue
            in_space(foam.polygon, size, foam.points)
            perimeter = pull_corners(foam, size, WEIGHT * violation / radius, radius)
            if perimeter < 0:
                continue
            pull_sites(foam, site, row, size, radius)
            # The violation's own gradient.
            weight = WEIGHT * perimeter / radius / radius
            x, y = (x / across, y / across) if across > 1e-9 * radius else (1.0, 0.0)
            x, y, z = weight * x, weight * y, -weight * lean * (1.0 if z > 0 else -1.0)
            pull(foam, site, x, y, z)
            pull(foam, other, -x, -y, -z)
