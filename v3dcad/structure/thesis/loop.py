"""The thesis's layer loop (Algorithm 1): each layer from the one below it."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from v3dcad.arguments import rows
from v3dcad.errors import GeometryError, SettingError
from v3dcad.geometry.graphs.spanning_tree import spanning_tree
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.model import Checksum, Diagram, Floats, Ints, Layer, Section
from v3dcad.settings import FillSettings
from v3dcad.structure.checksum import thesis_checksum
from v3dcad.structure.growth import growing, settled_offset
from v3dcad.structure.lazy_layers import LayerSequence
from v3dcad.structure.overhang import all_neighbours
from v3dcad.structure.sites import scatter_sites
from v3dcad.structure.sweep.kinetic_sweep import refuse_faults
from v3dcad.structure.sweep.one_layer import Engine, diagrams_on
from v3dcad.structure.sweep.ring_arrays import rings_of
from v3dcad.structure.thesis.cells import present
from v3dcad.structure.thesis.insert import inserted, shared_vertex
from v3dcad.structure.thesis.inset import STEP, inset
from v3dcad.structure.thesis.proximity import cells_on_boundary
from v3dcad.structure.thesis.settle import settle
from v3dcad.structure.thesis.sites import PlaneSites
from v3dcad.structure.thesis.state import GROWS, STAYS, UNTOUCHED, State, initial_state
from v3dcad.structure.thesis.tree import walked

EQUAL = 1e-9
"""Areas per cell that differ by less than this share are equal: no rounding calls for a site."""


@dataclass(frozen=True, eq=False, slots=True)
class ThesisLayer(Layer):
    """A layer with what the thesis's plug-in puts out besides; `diagram` is the one after inset.

    DL is `area_per_cell` of the layers, MST their `tree`, VT their `diagram.cells()`.
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
    def tree(self) -> Ints:
        """MST: of the cells before the inset."""
        return self.state.spanning_tree(self.neighbours)

    @property
    def neighbours(self) -> Ints:
        """NT: (m, 2) site ids, i < j, of the cells that share an edge."""
        return self.diagram_before_inset.neighbours


class ThesisLayers(LayerSequence):
    """The layers of a structure by the thesis's method, held one at a time.

    Going through them in order computes each once. A single one costs all those below it, but
    for the first asked for after one below it.
    """

    def __init__(self, filling: ThesisFilling) -> None:
        self._filling = filling
        self._reached: ThesisLayer | None = None
        self._onward: Iterator[ThesisLayer] = iter(())

    def __len__(self) -> int:
        return len(self._filling.sections)

    def __iter__(self) -> Iterator[ThesisLayer]:
        return self._filling.climb()

    def layer(self, index: int) -> ThesisLayer:
        """Layer `index`, after those below it."""
        layer = self._reached
        if layer is None or layer.index > index:
            self._onward = iter(self)
            layer = next(self._onward)
        while layer.index < index:
            layer = next(self._onward)
        self._reached = layer
        return layer


def _no_space(what: str) -> SettingError:
    return SettingError("method", f"--method thesis: its layers have no {what}; take --method foam")


class ThesisFilling:
    """Sections filled by the thesis's method: each layer comes from the one below."""

    def __init__(
        self,
        sections: Sequence[Section],
        places: Ints,
        grid: Grid,
        settings: FillSettings,
        diagram_of: Engine | None = None,
    ) -> None:
        """Sites stand on places (n, 2) of a grid; any function may make the diagrams."""
        self.sections = sections
        self.grid = grid
        self.diagram_of = diagram_of or diagrams_on(grid)
        self.sites = grid.millimetres(places)
        """(n, 2) mm: the sites at the start, as snapped to the grid"""
        pairs = all_neighbours(places, np.zeros(len(places), np.int64))
        self.grows = growing(len(places), spanning_tree(places, pairs))
        """(n,) which of them grow: odd levels of the tree of the whole diagram"""
        self.offset = settled_offset(
            settings, self.sites, self.grows, grid.heaviest / (len(sections) + 1)
        )
        """mm² a layer"""
        self.settings = replace(settings, offset=self.offset)
        """the settings, with the offset that "auto" stands for"""
        self._told: tuple[Ints, Ints] | None = None

    @property
    def layers(self) -> ThesisLayers:
        """The layers, one for each section."""
        return ThesisLayers(self)

    def checksum(self, layers: Iterable[Layer]) -> Checksum:
        """The check sum of the filling's layers, or of lofted ones; goes through them once."""
        return thesis_checksum(layers, self.grid)

    @property
    def births(self) -> Ints:
        """(b, 2) which layer gave birth to which site; goes through the layers where nobody has."""
        return self._history()[0]

    @property
    def unanswered(self) -> Ints:
        """(u,) the layers that were to get a site, but no cell qualified."""
        return self._history()[1]

    @property
    def walls(self) -> NoReturn:
        """Refused: layers that come one from the other are not slices of walls in space."""
        raise _no_space("walls")

    @property
    def strut_axes(self) -> NoReturn:
        """Refused, like the walls."""
        raise _no_space("strut axes")

    def facets(self, box: Floats) -> NoReturn:
        """Refused, like the walls."""
        raise _no_space("walls")

    def sites_at(self, points: Floats) -> NoReturn:
        """Refused, like the walls."""
        raise _no_space("walls")

    def at(self, z: float, section: Section | None = None) -> NoReturn:
        """Refused, like the walls."""
        raise _no_space("diagrams between layers")

    def _history(self) -> tuple[Ints, Ints]:
        if self._told is None:
            for _ in self.climb():
                pass
        assert self._told is not None
        return self._told

    def climb(self) -> Iterator[ThesisLayer]:
        """The layers from the first to the last, one at a time (Algorithm 1).

        Where area per cell lies above that of the first layer, the next layer gets one more
        site, unless `settings.insertion` is off. Layers without area count for nothing in that.
        """
        tolerance = self.settings.boundary_tolerance
        step = self.settings.weight_step or self.offset
        state = initial_state(self.sites)
        first: ThesisLayer | None = None
        below: ThesisLayer | None = None
        unanswered: list[int] = []
        for index, section in enumerate(self.sections):
            refuse_faults(rings_of([section], self.grid), index)
            state = state.grown(self.offset)
            wanted = (
                self.settings.insertion
                and first is not None
                and below is not None
                and below.area_per_cell > first.area_per_cell * (1 + EQUAL)
            )
            born = self._with_insertion(state, below, index) if wanted and below else None
            state, diagram = settle(born or state, section, self.diagram_of, step)
            state, after = inset(state, diagram, section, tolerance)
            if not index:
                state = replace(state, tags=np.where(self.grows, GROWS, STAYS))
            layer = self._layer(index, state, diagram)
            layer = replace(layer, diagram=after, unanswered=wanted and born is None)
            unanswered += [index] * layer.unanswered
            yield layer
            if not index:
                # As line 39 has it: once after the first layer's diagram, again on the next.
                state = state.grown(self.offset)
            below = layer if section.rings else None
            first = first or below
        newborn = state.inserted()
        births = np.column_stack([state.born_in[newborn], newborn])
        self._told = births, np.array(unanswered, np.int64)

    def _with_insertion(self, state: State, below: ThesisLayer, index: int) -> State | None:
        """The state with one more site for layer `index`; None where no cell qualifies."""
        diagram, tolerance = below.diagram_before_inset, self.settings.boundary_tolerance
        touching = cells_on_boundary(diagram, below.section, len(state.sites), tolerance)
        place = shared_vertex(state, diagram, touching)
        return place and inserted(state, diagram, *place, index, self.offset)

    def _layer(self, index: int, state: State, diagram: Diagram) -> ThesisLayer:
        areas = diagram.areas(len(state.sites))
        cells = int(present(diagram, len(state.sites)).sum())
        speed = self.offset / self.settings.layer_height
        growth = np.multiply(state.tags, speed, dtype=np.float64)
        sites = PlaneSites(self.grid, state.sites, state.weights, growth)
        tree = sites.spanning_tree(diagram.neighbours)
        return ThesisLayer(
            index=index,
            section=self.sections[index],
            state=sites,
            diagram=diagram,
            area_per_cell=float(areas.sum()) / max(cells, 1),
            diagram_before_inset=diagram,
            inserted=state.inserted(),
            cell_order=walked(diagram.sites(), tree, state.sites),
            inset_distance=np.where(state.inset_steps == UNTOUCHED, 0, state.inset_steps) * STEP,
            unanswered=False,
        )


def thesis_filling(
    sections: Sequence[Section], sites: Floats | None, settings: FillSettings, box: Floats
) -> ThesisFilling:
    """Fill sections by the thesis's method: sites (n, 2), mm, or else scattered in the box (2, 2).

    The grid lies around box and sites. Sites on the same grid point are merged, with a warning.
    Raises `GeometryError` for a site that cannot be computed with.
    """
    if sites is None:
        sites = scatter_sites(box, settings.sites, settings.random_seed)
    sites = rows("sites", sites, "x, y")
    if not len(sites):
        raise SettingError("sites", "--method thesis takes sites: give at least one")
    low, high = _around(sites, box)
    grid = Grid.around(low, high)
    places = grid.snap(sites)
    kept = np.sort(np.unique(places, axis=0, return_index=True)[1])
    if len(kept) < len(places):
        warnings.warn(
            f"{len(places) - len(kept)} of {len(places)} sites lie on others "
            f"(within {grid.pitch:.2g} mm) and were merged with them",
            stacklevel=3,
        )
    return ThesisFilling(sections, places[kept], grid, settings)


def _around(sites: Floats, box: Floats) -> tuple[Floats, Floats]:
    """The box low, high (2,), mm, around another and all sites that are finite numbers.

    Raises `GeometryError` for one so far outside that the grid around all would be coarse.
    """
    reach = 100 * (box[1] - box[0]).max()
    if reach > 0:
        far = (sites < box[0] - reach) | (sites > box[1] + reach)
        for site in np.nonzero((far & np.isfinite(sites)).any(axis=1))[0]:
            x, y = sites[site]
            raise GeometryError(
                f"({x:g}, {y:g}) mm is more than {reach:g} mm outside the part's base rectangle, "
                f"({box[0, 0]:g}, {box[0, 1]:g}) to ({box[1, 0]:g}, {box[1, 1]:g}) mm: move it "
                "nearer",
                site=int(site),
            )
    sound = sites[np.isfinite(sites).all(axis=1)]
    low = np.minimum(box[0], sound.min(axis=0, initial=np.inf))
    return low, np.maximum(box[1], sound.max(axis=0, initial=-np.inf))
