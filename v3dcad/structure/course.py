"""A triangulation on its way up through the layers: what surrounds the compiled layer loop."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.agenda import STRUTS, with_log
from v3dcad.geometry.flips import NOTHING, POINTS, SENTINELS, TRIANGLES
from v3dcad.geometry.grid import Grid
from v3dcad.geometry.inside import cut_with_room, empty_cut
from v3dcad.geometry.kinetics import end_all, motion_of, with_room
from v3dcad.geometry.polygon import winding_fault
from v3dcad.geometry.tree import empty_tree, tree_with_room
from v3dcad.geometry.triangulation import triangulation
from v3dcad.model import Diagram, Floats, Ints, Layer, Section
from v3dcad.structure.births import no_squares
from v3dcad.structure.holes import no_shortlist
from v3dcad.structure.layers import (
    LAYERS,
    NEEDS_ROOM,
    OPEN_WALK,
    ROOM,
    STATUS,
    Rings,
    Run,
    run,
)
from v3dcad.structure.timed import SiteStates, Timed
from v3dcad.structure.walls import Tracks


class Course:
    """The engine at work: where it has got to, and with which sites.

    Time is whole: the weight, in grid steps², that a site of growth 1 has at a height; `rate` is
    what it gains for each mm.
    """

    def __init__(
        self, grid: Grid, sites: Timed, growth_step: float, heights: Floats, slope: float
    ) -> None:
        """Stand at the first of ascending heights (k,), mm, ready to go to the last.

        Births keep walls from shifting more than `slope` mm per mm of height.
        """
        self.slope = slope
        self.grid = grid
        self.growth_step = growth_step
        self.heights = heights
        self.times = times_of(heights, growth_step, grid)
        self._curve = sites.site_of
        self._born_at = sites.born_at
        self._states = SiteStates(grid, growth_step, sites)
        first, last = int(self.times[0]), int(self.times[-1])
        self.mesh = triangulation(sites.places, sites.base + sites.growth * first)
        growth = np.concatenate([np.zeros(SENTINELS, np.int64), sites.growth])
        self.motion = motion_of(self.mesh, growth, first, last)
        room, slots = len(self.mesh.points), len(self.mesh.triangles)
        self._cut, self._tree = empty_cut(room, slots), empty_tree(room)
        self._squares, self._shortlist = no_squares(room), no_shortlist(slots)
        self.motion.born[SENTINELS:] = sites.born

    def sites(self, start: int = 0) -> Timed:
        """All sites up to now from row `start` on, newborns among them."""
        count, old = int(self.mesh.count[POINTS]) - SENTINELS, len(self._curve)
        rows = slice(SENTINELS + start, SENTINELS + count)
        born = self.motion.born[rows].copy()
        newborn = max(old - start, 0)
        layers = np.searchsorted(self.times, born[newborn:])
        return Timed(
            self.mesh.points[rows, :2].copy(),
            self.motion.base[rows].copy(),
            self.motion.growth[rows].copy(),
            born,
            np.concatenate([self._born_at[start:], self.heights[layers]]),
            np.concatenate([self._curve[start:], np.arange(max(start, old), count)]),
        )

    def run(self, sections: Sequence[Section], index: int, full_cell: float) -> Iterator[Layer]:
        """The layers of sections whose first has an index among the heights.

        Births are given where the area per cell is above `full_cell`, mm². Raises `GeometryError`
        for a section that cannot be filled.
        """
        rings = rings_of(sections)
        _refuse_faults(rings, index)
        done = 0
        while done < len(sections):
            made = self._run_once(_rest(rings, done), index + done, full_cell)
            fault = int(made.outcome[STATUS])
            if fault == NEEDS_ROOM:
                self._make_room(int(made.outcome[ROOM]))
            yield from self._layers(made, sections[done:], index + done)
            done += int(made.outcome[LAYERS])
            if fault == OPEN_WALK:
                raise GeometryError("a ring of its section does not close", layer=index + done)

    def tracks(self) -> Tracks:
        """How all vertices have moved since the beginning; to be asked for once, at the end."""
        triangles = int(self.mesh.count[TRIANGLES])
        rate = self.growth_step / self.grid.pitch**2
        if self.times[0] == self.times[-1]:  # nothing has moved
            corners = self.mesh.triangles[:triangles, :3]
            corners = corners[corners[:, 0] != NOTHING].astype(np.int64)
            spans = np.broadcast_to(self.heights[[0, -1]], (len(corners), 2))
            times = np.full(spans.shape, float(self.times[0]))
        else:
            if len(self.motion.spans) - self.motion.state[STRUTS] < triangles:
                self.motion = with_log(self.motion, triangles)
            end_all(self.mesh, self.motion)
            count = int(self.motion.state[STRUTS])
            corners, times = self.motion.struts[:count].astype(np.int64), self.motion.spans[:count]
            spans = times / rate
        site_of = np.arange(len(self.mesh.points)) - SENTINELS
        site_of[SENTINELS : SENTINELS + len(self._curve)] = self._curve
        ends = np.stack([self._vertices(corners, times[:, k]) for k in range(2)], axis=1)
        return Tracks(site_of[corners], spans, ends)

    def _vertices(self, corners: Ints, times: Floats) -> Floats:
        """The orthocentres (t, 2), mm, of triangles (t, 3) of points at times (t,)."""
        a, b, c = corners.T
        places = self.mesh.points[:, :2]
        base, growth = self.motion.base, self.motion.growth
        bx, by = (places[b] - places[a]).T
        cx, cy = (places[c] - places[a]).T
        of_b = (bx * bx + by * by + base[a] - base[b]) + (growth[a] - growth[b]) * times
        of_c = (cx * cx + cy * cy + base[a] - base[c]) + (growth[a] - growth[c]) * times
        double = 2.0 * (bx * cy - by * cx)
        shift = np.column_stack([cy * of_b - by * of_c, bx * of_c - cx * of_b]) / double[:, None]
        return self.grid.millimetres(places[a] + shift)

    def _make_room(self, births: int) -> None:
        """Make room for more births, or else for more struts."""
        if int(self.mesh.count[POINTS]) + births > len(self.mesh.points):
            some = births + len(self._curve) // 4 + 1
            self.mesh, self.motion = with_room(self.mesh, self.motion, some)
        else:
            some = len(self.motion.spans) + 8 * births + 64
            self.motion = with_log(self.motion, some)

    def _run_once(self, rings: Rings, index: int, full_cell: float) -> Run:
        room = len(self.mesh.points)
        site_of = np.arange(room) - SENTINELS
        site_of[SENTINELS : SENTINELS + len(self._curve)] = self._curve
        if len(self._cut.inside) != len(self.mesh.triangles):
            slots = len(self.mesh.triangles)
            self._cut = cut_with_room(self._cut, room, slots)
            self._tree, self._squares = tree_with_room(self._tree, room), no_squares(room)
            self._shortlist = no_shortlist(slots)
        left, low = self.grid.origin
        times = self.times[index : index + len(rings.layers) - 1]
        reach = self.growth_step / (2 * self.slope) / self.grid.pitch
        made: Run = run(
            self.mesh,
            self.motion,
            self._cut,
            self._tree,
            self._squares,
            self._shortlist,
            site_of,
            rings,
            times,
            float(left),
            float(low),
            self.grid.pitch,
            reach,
            full_cell,
        )
        return made

    def _layers(self, made: Run, sections: Sequence[Section], index: int) -> Iterator[Layer]:
        """The layers of a run, as views of its arrays."""
        self._states.add(self.sites(len(self._states)))
        for array in (made.vertices, made.edges, made.sites, made.tree):
            array.flags.writeable = False  # so that the values need no views of their own
        edge_rows, pair_rows, tree_rows = (
            rows.tolist() for rows in (made.edge_rows, made.pair_rows, made.tree_rows)
        )
        graph = -1
        for layer in range(int(made.outcome[LAYERS])):
            if made.graphs[layer] != graph:
                graph = int(made.graphs[layer])
                row, end = edge_rows[graph], edge_rows[graph + 1]
                edges, edge_sites = made.edges[row:end], made.sites[row:end]
                neighbours = made.sites[row : pair_rows[graph]]
                tree = made.tree[tree_rows[graph] : tree_rows[graph + 1]]
            count, cells = int(made.points[layer]) - SENTINELS, int(made.cells[layer])
            vertices = made.vertices[made.vertex_rows[layer] : made.vertex_rows[layer + 1]]
            yield Layer(
                index + layer,
                sections[layer],
                self._states.at(count, int(self.times[index + layer])),
                Diagram(vertices, edges, edge_sites, neighbours),
                tree,
                float(made.areas[layer]) / max(cells, 1),
            )


def times_of(heights: Floats, growth_step: float, grid: Grid) -> Ints:
    """The whole times of heights (k,), mm."""
    return np.rint(heights * (growth_step / grid.pitch**2)).astype(np.int64)


def rings_of(sections: Sequence[Section]) -> Rings:
    """The rings of sections as long arrays."""
    rings = [ring for section in sections for ring in section.rings]
    layers = np.cumsum([0, *(len(section.rings) for section in sections)])
    starts = np.cumsum([0, *map(len, rings)])
    corners = np.concatenate(rings) if rings else np.empty((0, 2))
    return Rings(np.ascontiguousarray(corners, np.float64), starts, layers)


def _rest(rings: Rings, layers: int) -> Rings:
    return rings._replace(layers=rings.layers[layers:])


def _refuse_faults(rings: Rings, index: int) -> None:
    """Raise `GeometryError` for the first layer whose rings do not bound what is inside."""
    layer, x, y = winding_fault(rings.corners, rings.starts, rings.layers)
    if layer >= 0:
        raise GeometryError(
            f"its rings cross, overlap or run the wrong way round near ({x:g}, {y:g}) mm: repair "
            "the part, or let outer rings run counter-clockwise and holes clockwise",
            layer=index + layer,
        )
