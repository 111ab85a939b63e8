"""A plane on its way up through the sites: what surrounds the compiled layer loop.

Time is whole. It is divided into blocks of equal length. In each the mesh holds only the sites that
may have a cell there, and times and weights are counted from the block's beginning: so weights stay
within the grid's safe range and memory goes with the section, however tall a part is. Which block a
layer lies in depends on its time alone; so a layer by itself is the layer of the loop, to the last
bit.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.clipping.interior import empty_cut
from v3dcad.geometry.clipping.planar_graph import Frame
from v3dcad.geometry.clipping.ring_validity import winding_fault
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.geometry.power_diagram.grid import Grid
from v3dcad.geometry.power_diagram.kinetic_triangulation import motion_of
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.geometry.power_diagram.triangle_mesh import SENTINELS
from v3dcad.model import Diagram, Ints, Section
from v3dcad.structure.sweep.layer_loop import Output, Queue, output, run, walks
from v3dcad.structure.sweep.ring_arrays import Rings, rings_of
from v3dcad.structure.sweep.sites import SweptSites

CROSSINGS = 64
"""Room for so many crossings of rings and edges at first."""

Sliced = tuple[Diagram, float]
"""A diagram, and the section's area for each of its cells, mm²."""


class Sweep:
    """Slices of sites at ascending times, by blocks of `block` time units (even)."""

    def __init__(self, grid: Grid, sites: SweptSites, times: Ints, block: int) -> None:
        """Be ready for sections at ascending whole `times` (k,)."""
        self.grid, self._sites, self._times, self._block = grid, sites, times, block
        self._crossings = CROSSINGS
        self._standing: int | None = None

    def run(self, sections: Sequence[Section], index: int) -> Iterator[Sliced]:
        """Slice sections, of which the first has an index among the times.

        Raises `GeometryError` for a section that cannot be filled.
        """
        rings = rings_of(sections, self.grid)
        refuse_faults(rings, index)
        done = needed = 0
        while done < len(sections):
            times = self._times[index + done : index + len(sections)]
            block = int(times[0]) // self._block
            times = times[: int(np.searchsorted(times, (block + 1) * self._block))]
            if self._standing != block:
                self._stand(block, int(times[0]))
            rest = _from(rings, done, len(times))
            made = output(len(times), max(self._usual_rows(rest), needed))
            self._run_once(rest, times - self._origin, made)
            needed = int(made.outcome.room)
            if made.outcome.ending == Ending.CROSSINGS_FULL:
                self._crossings *= 4
            yield from _slices(made, rest.areas.tolist())
            done += int(made.outcome.layers)
            if made.outcome.ending == Ending.RING_OPEN:
                raise GeometryError("a ring of its section does not close", layer=index + done)
            if made.outcome.ending == Ending.NO_FLIP:
                self._stand(block, int(self._times[index + done]))

    def _stand(self, block: int, time: int) -> None:
        """Build the mesh of a block at one of its times."""
        self._standing, self._origin = block, block * self._block
        last = self._origin + self._block - 1
        present = self._sites.present(time, last).since(self._origin)
        now = time - self._origin
        later = self._times[np.searchsorted(self._times, time) :] - self._origin
        sites, there = present.in_order(later[: max(1, int(np.searchsorted(later, self._block)))])
        self.mesh = triangulation(sites.places, sites.weights_at(now), sites.numbers, there)
        still = np.zeros(SENTINELS, np.int64)
        growth = np.concatenate([still, sites.heights])
        self.motion = motion_of(self.mesh, growth, now, self._block - 1)
        room = len(self.mesh.points)
        self._queue = Queue(
            np.concatenate([still, sites.opens]),
            np.concatenate([still, sites.closes]),
            self.mesh.hidden.copy(),
            np.array([self.mesh.counts.hidden]),
        )
        self._cut = empty_cut(room, len(self.mesh.triangles))

    def _usual_rows(self, rings: Rings) -> int:
        """For how many vertices a run should have room: a few more than on the last layer."""
        state, triangles = self._cut.state, int(self.mesh.counts.triangles)
        inner = int(state.vertices + 2 * state.crossed) or triangles
        return len(rings.areas) * (inner + 64) + 2 * len(rings.corners) + triangles

    def _run_once(self, rings: Rings, times: Ints, made: Output) -> None:
        left, low = self.grid.origin
        run(
            self.mesh,
            self.motion,
            self._queue,
            self._cut,
            rings,
            times,
            walks(self._crossings, len(rings.starts), len(self.mesh.points)),
            made,
            Frame(float(left), float(low), self.grid.pitch),
        )


def _slices(made: Output, areas: list[float]) -> Iterator[Sliced]:
    """The slices of a run, as views of its arrays; `areas`, mm², are those of the sections."""
    for array in (made.vertices, made.edges, made.sites):
        array.flags.writeable = False  # so that the values need no views of their own
    cells, graphs, vertex_rows, edge_rows, pair_rows = made.rows.T.tolist()
    graph = -1
    for layer in range(int(made.outcome.layers)):
        if graphs[layer] != graph:
            graph = graphs[layer]
            row, end = edge_rows[graph], edge_rows[graph + 1]
            edges, edge_sites = made.edges[row:end], made.sites[row:end]
            neighbours = made.sites[row : pair_rows[graph]]
        vertices = made.vertices[vertex_rows[layer] : vertex_rows[layer + 1]]
        diagram = Diagram(vertices, edges, edge_sites, neighbours)
        yield diagram, areas[layer] / max(cells[layer], 1)


def _from(rings: Rings, layer: int, layers: int) -> Rings:
    """Some layers' rings."""
    return rings._replace(
        layers=rings.layers[layer : layer + layers + 1], areas=rings.areas[layer : layer + layers]
    )


def refuse_faults(rings: Rings, index: int) -> None:
    """Raise `GeometryError` for the first layer whose rings do not bound what is inside."""
    layer, x, y = winding_fault(rings.corners, rings.starts, rings.layers)
    if layer >= 0:
        raise GeometryError(
            f"its rings cross, overlap or run the wrong way round near ({x:g}, {y:g}) mm: repair "
            "the part, or let outer rings run counter-clockwise and holes clockwise",
            layer=index + layer,
        )
