"""What a closed mesh encloses more than once: where bodies overlap, or one goes through itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from v3dcad.geometry.mesh.section import section_mesh
from v3dcad.geometry.section_union import faulty, union
from v3dcad.model import Floats, Mesh, Section

PROBES = 64
"""Planes that tell whether there is any such volume; they miss what lies wholly between two."""

SLABS = 512
"""Most slabs in which it is measured then."""

NEGLIGIBLE = 1e-9
"""Share of the whole volume: less comes of rounding."""


def overlap_volume(mesh: Mesh) -> float:
    """By how much the volume of a closed mesh, mm³, exceeds that of what it winds around at all.

    The difference in area is integrated over the height by Gauss's rule of three points, in slabs
    between the heights of vertices: in one, areas of sections of triangles are quadratic but where
    bodies begin to cross.
    """
    levels = np.unique(mesh.vertices[mesh.triangles.ravel(), 2])
    low, high = levels[0], levels[-1]
    probes = np.linspace(low, high, PROBES + 2)[1:-1]
    found, areas = _excess(section_mesh(mesh, probes))
    if found.sum() <= NEGLIGIBLE * areas.sum():
        return 0.0
    chosen = np.linspace(0, len(levels) - 1, min(len(levels), SLABS + 1)).astype(np.int64)
    slabs = levels[chosen]
    at, weights = np.polynomial.legendre.leggauss(3)
    half = np.diff(slabs)[:, None] / 2
    heights = (slabs[:-1, None] + half * (1 + at)).ravel()
    shares = (half * weights).ravel()
    excess, areas = _excess(section_mesh(mesh, heights))
    overlap = float(excess @ shares)
    return overlap if overlap > NEGLIGIBLE * float(areas @ shares) else 0.0


def _excess(sections: Sequence[Section]) -> tuple[Floats, Floats]:
    """By how much the areas of sections (n,), mm², exceed their unions', and these areas (n,)."""
    areas = np.array([_area(section.rings) for section in sections])
    excess = np.zeros(len(sections))
    for k in faulty(sections):
        excess[k] = areas[k] - _area(union(sections[k], 0.0, touching=False).rings)
    return excess, areas


def _area(rings: tuple[Floats, ...]) -> float:
    """The signed area of rings, mm²."""
    total = 0.0
    for ring in rings:
        x, y = (ring - ring[0]).T
        total += float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    return total
