"""The thesis's layer loop (Algorithm 1): each layer from the one below it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from v3dcad.model import Diagram, Floats, Ints, Layer, Section, SiteState
from v3dcad.settings import FillSettings
from v3dcad.structure.growth import spanning_tree
from v3dcad.structure.thesis.cells import present, rings
from v3dcad.structure.thesis.insert import inserted, shared_vertex
from v3dcad.structure.thesis.inset import STEP, inset
from v3dcad.structure.thesis.proximity import cells_on_boundary
from v3dcad.structure.thesis.settle import settle
from v3dcad.structure.thesis.state import INITIAL, UNTOUCHED, Engine, State, initial_state
from v3dcad.structure.thesis.tree import tagged, walked

EQUAL = 1e-9
"""Areas per cell that differ by less than this share are equal: no rounding calls for a site."""


@dataclass(frozen=True, eq=False, slots=True)
class ThesisLayer(Layer):
    """A layer with what the thesis's plug-in puts out besides; `diagram` is the one after inset.

    DL is `area_per_cell` of the layers, MST their `tree`, VT their `cells()`.
    """

    diagram_before_inset: Diagram
    """POT: the power diagram, whose cells are convex where the section's boundary lets them"""
    inserted: Ints
    """(i,) IPL: ids of the inserted sites up to this layer, in order of insertion"""
    cell_order: Ints
    """(c,) CVT: ids of the cells in the order in which Prim's algorithm reaches them"""
    inset_distance: Floats
    """(n,) POL: mm by which each cell is drawn in"""
    unanswered: bool
    """whether a site was to be inserted, but no cell qualified"""

    @property
    def neighbours(self) -> Ints:
        """NT: (m, 2) site ids, i < j, of the cells that share an edge."""
        return self.diagram_before_inset.neighbours

    def cells(self) -> dict[int, list[Floats]]:
        """Each cell's rings (k, 2), mm, after the inset, in the order of `cell_order`."""
        return {
            site: [self.diagram.vertices[ring] for ring in rings(self.diagram, site)]
            for site in self.cell_order.tolist()
        }


class ThesisLayers(Sequence[Layer]):
    """The layers of a structure by the thesis's method, held one at a time.

    Going through them in order computes each once. A single one costs all those below it, but
    for the first asked for after one below it.
    """

    def __init__(
        self,
        sections: Sequence[Section],
        sites: Floats,
        settings: FillSettings,
        diagram_of: Engine,
    ) -> None:
        self.sections = sections
        self.sites = sites
        self.settings = settings
        self.diagram_of = diagram_of
        self._reached: ThesisLayer | None = None
        self._onward: Iterator[ThesisLayer] = iter(())

    def __len__(self) -> int:
        return len(self.sections)

    def __iter__(self) -> Iterator[ThesisLayer]:
        return thesis_layers(self.sections, self.sites, self.settings, self.diagram_of)

    def __getitem__(self, index: int) -> ThesisLayer:  # type: ignore[override]
        """Layer `index`; negative ones count from the top."""
        index = range(len(self))[index]
        layer = self._reached
        if layer is None or layer.index > index:
            self._onward = iter(self)
            layer = next(self._onward)
        while layer.index < index:
            layer = next(self._onward)
        self._reached = layer
        return layer


def thesis_layers(
    sections: Sequence[Section], sites: Floats, settings: FillSettings, diagram_of: Engine
) -> Iterator[ThesisLayer]:
    """The layers of sections, ascending in z, with sites (n, 2), mm, one after the other.

    Where area per cell lies above that of the first layer, the next layer gets one more site,
    unless `settings.insertion` is off. Layers without area count for nothing in that.
    """
    offset, tolerance = settings.offset, settings.boundary_tolerance
    state = initial_state(sites)
    first: ThesisLayer | None = None
    below: ThesisLayer | None = None
    for index, section in enumerate(sections):
        wanted = False
        place: tuple[int, int] | None = None
        if index:
            state = state.grown(offset)
        if first is not None and below is not None and settings.insertion:
            wanted = below.area_per_cell > first.area_per_cell * (1 + EQUAL)
        if wanted and below is not None:
            before = below.diagram_before_inset
            touching = cells_on_boundary(before, below.section, len(state.sites), tolerance)
            place = shared_vertex(state, before, touching)
            if place is not None:
                state = inserted(state, before, *place, index, offset)
        state, diagram = settle(state, section, diagram_of, settings.weight_step or offset)
        state, after = inset(state, diagram, section, tolerance)
        weighing = state
        if not index:
            tags = tagged(len(sites), _growing_pairs(sites, diagram_of))
            state = replace(state, tags=tags).grown(offset)
        layer = _layer(index, sections, settings, replace(weighing, tags=state.tags), diagram)
        layer = replace(layer, diagram=after, unanswered=wanted and place is None)
        yield layer
        below = layer if section.rings else None
        first = first or below


def _growing_pairs(sites: Floats, diagram_of: Engine) -> Ints:
    """SL of the whole Voronoi diagram of the sites, not cut by a section."""
    low, high = sites.min(axis=0) - 1.0, sites.max(axis=0) + 1.0
    around = Section(0.0, (np.array([low, [high[0], low[1]], high, [low[0], high[1]]]),))
    whole = diagram_of(sites, np.zeros(len(sites)), around)
    return walked(np.arange(len(sites)), spanning_tree(sites, whole.neighbours), sites)[1]


def _layer(
    index: int,
    sections: Sequence[Section],
    settings: FillSettings,
    state: State,
    diagram: Diagram,
) -> ThesisLayer:
    areas = diagram.areas(len(state.sites))
    cells = int(present(diagram, len(state.sites)).sum())
    tree = spanning_tree(state.sites, diagram.neighbours)
    heights = np.array([sections[layer].z for layer in state.born_in.tolist()])
    return ThesisLayer(
        index=index,
        section=sections[index],
        state=SiteState(
            sites=state.sites,
            weights=state.weights,
            growth=np.multiply(
                state.tags, settings.offset / settings.layer_height, dtype=np.float64
            ),
            born_at=np.where(state.born_in == INITIAL, 0.0, heights),
        ),
        diagram=diagram,
        tree=tree,
        area_per_cell=float(areas.sum()) / max(cells, 1),
        diagram_before_inset=diagram,
        inserted=state.inserted(),
        cell_order=walked(diagram.sites(), tree, state.sites)[0],
        inset_distance=np.where(state.inset_steps == UNTOUCHED, 0, state.inset_steps) * STEP,
        unanswered=False,
    )
