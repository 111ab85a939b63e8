"""2D linear interpolation (thesis §3.5.6): the first and the last layer, lofted.

For the thesis's method only, whose layers come one from the other. Those of a foam are functions
of the height: each can be computed alone, which is their exact loft.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.model import OUTSIDE, Diagram, Floats, Ints, Layer, Section
from v3dcad.structure.lazy_layers import LayerSequence
from v3dcad.structure.thesis.cells import corner_signatures, rings
from v3dcad.structure.thesis.loop import ThesisFilling
from v3dcad.structure.thesis.sites import PlaneSites

STRAIGHT = 1e-6
"""mm; a ring's point this close to the line of the two beside it makes no corner."""


@dataclass(frozen=True, eq=False, slots=True)
class LoftedLayers(LayerSequence):
    """Layers between two, every corner on the straight line between its two places."""

    first: Layer
    last: Layer
    """its diagram's vertices and edges in the order of the first one's"""
    sites: PlaneSites
    """as they are on the first layer"""
    grown: Floats
    """(n,) mm²: weights on the last layer"""
    heights: Floats
    """(l,) mm, where the layers are"""
    contours: tuple[Ints, ...]
    """vertex ids of the contour's rings, each (k,)"""

    def __len__(self) -> int:
        return len(self.heights)

    def __iter__(self) -> Iterator[Layer]:
        return (self[index] for index in range(len(self)))

    def layer(self, index: int) -> Layer:
        """Layer `index`, all its corners on their ways."""
        z = float(self.heights[index])
        span = self.last.z - self.first.z
        share = (z - self.first.z) / span if span else 0.0
        start, stop = self.first, self.last
        below = start.diagram
        vertices = (1 - share) * below.vertices + share * stop.diagram.vertices
        diagram = Diagram(vertices, below.edges, below.edge_sites, below.neighbours)
        contours = tuple(vertices[ring] for ring in self.contours)
        weights = (1 - share) * self.sites.weights + share * self.grown
        state = replace(self.sites, weights=weights)
        return Layer(
            index=index,
            section=Section(z, contours),
            state=state,
            diagram=diagram,
            area_per_cell=_area_per_cell(diagram, len(state.sites)),
        )


def lofted(filling: ThesisFilling, heights: Floats) -> LoftedLayers:
    """Layers at heights (l,), mm, lofted between the first and the last section of a filling.

    On the last one, growing sites weigh offset × number of layers. Raises `GeometryError` where
    a cell has not the same corners on both (see `matching_vertices`). Points of a ring where it
    does not turn are no corners.
    """
    start, stop = _straightened(filling.sections[0]), _straightened(filling.sections[-1])
    growth = np.where(filling.grows, filling.offset / filling.settings.layer_height, 0.0)
    weightless = np.zeros(len(growth))
    grown = np.where(filling.grows, filling.offset * len(heights), 0.0)
    below = filling.diagram_of(filling.sites, weightless, start)
    above = filling.diagram_of(filling.sites, grown, stop)
    order = matching_vertices(below, above)
    above = Diagram(above.vertices[order], below.edges, below.edge_sites, below.neighbours)
    sites = PlaneSites(filling.grid, filling.sites, weightless, growth)

    def layer(index: int, section: Section, state: PlaneSites, diagram: Diagram) -> Layer:
        return Layer(index, section, state, diagram, _area_per_cell(diagram, len(growth)))

    first = layer(0, start, sites, below)
    last = layer(len(heights) - 1, stop, replace(sites, weights=grown), above)
    return LoftedLayers(first, last, sites, grown, heights, tuple(rings(below, OUTSIDE)))


def _area_per_cell(diagram: Diagram, count: int) -> float:
    return float(diagram.areas(count).sum()) / max(len(diagram.sites()), 1)


def _straightened(section: Section) -> Section:
    """The section without the points of its rings that lie on the line of the two beside them."""
    kept = []
    for ring in section.rings:
        before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
        chord, leg = after - before, ring - before
        aside = np.abs(chord[:, 0] * leg[:, 1] - chord[:, 1] * leg[:, 0])
        kept.append(ring[aside > STRAIGHT * np.hypot(*chord.T)])
    return Section(section.z, tuple(kept))


def matching_vertices(first: Diagram, last: Diagram) -> Ints:
    """(v,) for each vertex of the first diagram the one of the last that it moves to.

    Cells match where they have as many corners, which is the thesis's own check, and the corners
    lie between the same cells in the same order. Where that leaves a choice, the least movement
    decides. Raises `GeometryError` naming the first cell that does not match.
    """
    signatures, wanted = corner_signatures(first), corner_signatures(last)
    order = np.full(len(first.vertices), -1)
    for site in np.union1d(first.sites(), last.sites()).tolist():
        here, there = rings(first, site), rings(last, site)
        if not here or not there:
            where = "last" if here else "first"
            raise _cannot(site, f"has no cell on the {where} layer")
        if len(here) > 1 or len(there) > 1:
            raise _cannot(site, "has a cell that is not one polygon")
        if len(here[0]) != len(there[0]):
            raise _cannot(
                site,
                f"has a cell with {len(here[0])} corners on the first layer "
                f"and {len(there[0])} on the last",
            )
        turns = [
            turned
            for turned in (np.roll(there[0], turn) for turn in range(len(there[0])))
            if [signatures[v] for v in here[0].tolist()] == [wanted[v] for v in turned.tolist()]
            and ((order[here[0]] == -1) | (order[here[0]] == turned)).all()
        ]
        if not turns:
            raise _cannot(site, "has a cell whose neighbours change from the first layer to last")
        places = first.vertices[here[0]]
        order[here[0]] = min(
            turns, key=lambda turned: float(((last.vertices[turned] - places) ** 2).sum())
        )
    return order


def _cannot(site: int, why: str) -> GeometryError:
    return GeometryError(
        f"{why}, so that the two cannot be lofted; leave --interpolate out", site=site
    )
