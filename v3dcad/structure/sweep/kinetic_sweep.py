"""A triangulation on its way up through the layers: what surrounds the compiled layer loop."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.clipping.interior import cut_with_room, empty_cut
from v3dcad.geometry.clipping.planar_graph import Frame
from v3dcad.geometry.clipping.ring_validity import winding_fault
from v3dcad.geometry.graphs.dynamic_spanning_tree import empty_tree, tree_with_room
from v3dcad.geometry.power_diagram.ending import Ending
from v3dcad.geometry.power_diagram.epochs import FIRST, Epoch
from v3dcad.geometry.power_diagram.event_queue import ALWAYS, with_log
from v3dcad.geometry.power_diagram.grid import HEAVIEST, UTMOST, Grid
from v3dcad.geometry.power_diagram.kinetic_triangulation import (
    advance,
    all_ended,
    motion_of,
    resumed,
    with_room,
)
from v3dcad.geometry.power_diagram.regular_triangulation import triangulation
from v3dcad.geometry.power_diagram.triangle_mesh import ABSENT, SENTINELS
from v3dcad.model import Diagram, Floats, Ints, Layer, Section
from v3dcad.structure.holes import no_shortlist
from v3dcad.structure.rim import rim_of
from v3dcad.structure.spacing import no_squares
from v3dcad.structure.sweep.growing_sites import SiteStates, Timed
from v3dcad.structure.sweep.layer_loop import (
    Run,
    pages,
    run,
    walks,
)
from v3dcad.structure.sweep.ring_arrays import Rings, rings_of
from v3dcad.structure.walls import Tracks, joined


class Course:
    """The engine at work: where it has got to, and with which sites.

    Time is whole: the weight, in grid steps², that a site of growth 1 has at a height. Where
    weights would leave the safe range a new epoch begins (`epochs.py`).
    """

    def __init__(
        self,
        grid: Grid,
        sites: Timed,
        growth_step: float,
        heights: Floats,
        slope: float,
        box: Floats,
        *,
        epoch: Epoch = FIRST,
        top: float | None = None,
    ) -> None:
        """Stand at the first of ascending heights (k,), mm, ready to go to the last, or on to a
        `top` where no layer is.

        Births keep walls from shifting more than `slope` mm per mm of height; those from outside
        come into the `box`, the base rectangle's corners low and high (2, 2), mm. `epoch` is the
        one that the first height lies in, unless the sites weigh too much in it by then.
        """
        self.slope = slope
        self._extent = (box[1] - box[0]) / grid.pitch
        self._leaps: list[float] = []
        self.grid = grid
        self.growth_step = growth_step
        self.heights = heights
        self.times = times_of(heights, growth_step, grid)
        self.top = float(heights[-1]) if top is None else top
        self._curve = sites.site_of
        self._sites = sites
        self._newborns: list[Timed] = []
        self._states = SiteStates(grid, growth_step, sites)
        self._pieces: list[Tracks] = []
        self._crossings = 64
        first = int(self.times[0])
        weights = sites.base + sites.growth * first
        base, growth = epoch.counts(sites.base, sites.growth, sites.born)
        if np.abs(base + growth * (first - epoch.start)).max(initial=0) > HEAVIEST:
            epoch = Epoch(first, int(weights.max()))
        self.epochs: list[Epoch] = []
        self._stand(epoch, first, epoch.start / self._rate if epoch.start else 0.0)

    def _stand(self, epoch: Epoch, time: int, bottom: float) -> None:
        """Stand at a whole time of an epoch that begins at a height of `bottom` mm."""
        sites, now = self.sites(), time - epoch.start
        last = int(times_of(np.array([self.top]), self.growth_step, self.grid)[0]) - epoch.start
        base, growth = epoch.counts(sites.base, sites.growth, sites.born)
        self.mesh = triangulation(sites.places, base + growth * now)
        still = np.zeros(SENTINELS, np.int64)
        until = max(now, min(last, epoch.last(growth)))
        self.motion = motion_of(self.mesh, np.concatenate([still, growth]), now, until)
        self.motion.born[SENTINELS:] = np.maximum(sites.born - epoch.start, ALWAYS)
        self.motion.state.most_growth = UTMOST // max(int(self.times[-1]), 1) - epoch.growth
        self._bottom = bottom
        self.epochs.append(epoch)
        self._cut_nothing()

    def _cut_nothing(self) -> None:
        """Forget what there was of a cut, for a triangulation built anew."""
        room, slots = len(self.mesh.points), len(self.mesh.triangles)
        self._cut, self._tree = empty_cut(room, slots), empty_tree(room)
        self._squares, self._shortlist = no_squares(room), no_shortlist(slots)

    @property
    def _rate(self) -> float:
        """Units of time per mm of height."""
        return self.growth_step / self.grid.pitch**2

    def sites(self) -> Timed:
        """All sites up to now, newborns among them."""
        if self._newborns:
            self._sites, self._newborns = self._sites.and_newborn(self._newborns), []
        return self._sites

    def _enter_newborns(self) -> None:
        """Enter the sites born since this was last asked for."""
        count, epoch = int(self.mesh.counts.points) - SENTINELS, self.epochs[-1]
        if count == len(self._states):
            return
        number = np.arange(len(self._states), count)
        rows = SENTINELS + number
        born = self.motion.born[rows] + epoch.start
        growth = self.motion.growth[rows] + epoch.growth
        base = self.motion.base[rows] + epoch.weight - growth * epoch.start
        heights = self.heights[np.searchsorted(self.times, born)]
        newborns = Timed(self.mesh.points[rows, :2], base, growth, born, heights, number)
        self._states.add(newborns)
        self._newborns.append(newborns)

    def _reach(self, time: int) -> None:
        """Begin new epochs until the present one holds a time."""
        while (epoch := self.epochs[-1]).start + int(self.motion.state.last) < time:
            self._end_epoch()
            now = int(self.motion.state.last)
            rows = slice(SENTINELS, int(self.mesh.counts.points))
            lives = self.mesh.triangle_of[rows] != ABSENT
            following = Epoch(
                epoch.start + now,
                epoch.weight + epoch.growth * now + int(self.mesh.points[rows, 2].max()),
                epoch.growth + int(self.motion.growth[rows][lives].min()),
            )
            self._stand(following, following.start, self._bottom + now / self._rate)

    def _end_epoch(self) -> None:
        """Go to where the epoch ends, and note how the vertices have moved in it."""
        while ended := advance(self.mesh, self.motion, self.motion.state.last):
            self.motion = resumed(self.mesh, self.motion, ended)
        self.motion = all_ended(self.mesh, self.motion)
        count = int(self.motion.state.struts)
        corners, times = self.motion.struts[:count].astype(np.int64), self.motion.spans[:count]
        spans = self._bottom + times / self._rate
        lasts = spans[:, 0] < spans[:, 1]  # heights are coarser than times
        self._pieces.append(self._tracks(corners[lasts], times[lasts], spans[lasts]))

    def run(self, sections: Sequence[Section], index: int, full_cell: float) -> Iterator[Layer]:
        """The layers of sections whose first has an index among the heights.

        Births are given where the area per cell is above `full_cell`, mm². Raises `GeometryError`
        for a section that cannot be filled.
        """
        rings = rings_of(sections, self.grid)
        refuse_faults(rings, index)
        done = needed = 0
        while done < len(sections):
            self._reach(int(self.times[index + done]))
            rest = _rest(rings, done)
            made = pages(len(rest.areas), max(self._usual_rows(rest), needed))
            self._run_once(rest, index + done, full_cell, made)
            self._enter_newborns()
            fault = int(made.outcome.ending)
            needed = int(made.outcome.room) if fault == Ending.OUTPUT_FULL else 0
            if fault == Ending.CROSSINGS_FULL:
                self._crossings *= 4
            if fault in (Ending.POINTS_FULL, Ending.LOG_FULL):
                self._make_room(int(made.outcome.room))
            if fault == Ending.NO_FLIP:
                self.motion = resumed(self.mesh, self.motion, fault)
                self._cut_nothing()
            yield from self._layers(made, rest.areas.tolist(), sections[done:], index + done)
            done += int(made.outcome.layers)
            if fault == Ending.RING_OPEN:
                raise GeometryError("a ring of its section does not close", layer=index + done)

    def tracks(self) -> Tracks:
        """How all vertices have moved since the beginning; to be asked for once, at the end."""
        last = int(times_of(np.array([self.top]), self.growth_step, self.grid)[0])
        if self.times[0] == last:  # nothing has moved
            corners = self.mesh.triangles[: self.mesh.counts.triangles, :3]
            corners = corners[corners[:, 0] != ABSENT].astype(np.int64)
            spans = np.tile([self.heights[0], self.top], (len(corners), 1))
            times = np.full(spans.shape, float(last - self.epochs[-1].start))
            return self._tracks(corners, times, spans)
        self._reach(last)
        self._end_epoch()
        return joined(self._pieces)

    def _tracks(self, corners: Ints, times: Floats, spans: Floats) -> Tracks:
        """The tracks of triangles (t, 3) of points from time to time (t, 2) of the epoch, which
        are heights (t, 2), mm.
        """
        site_of = np.arange(len(self.mesh.points)) - SENTINELS
        site_of[SENTINELS : SENTINELS + len(self._curve)] = self._curve
        ends = np.stack([self._vertices(corners, times[:, k]) for k in range(2)], axis=1)
        return Tracks(site_of[corners], spans, ends, tuple(self._leaps))

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
        if int(self.mesh.counts.points) + births > len(self.mesh.points):
            some = births + len(self._curve) // 4 + 1
            self.mesh, self.motion = with_room(self.mesh, self.motion, some)
        else:
            some = len(self.motion.spans) + 8 * births + 64
            self.motion = with_log(self.motion, some)

    def _usual_rows(self, rings: Rings) -> int:
        """For how many vertices a run should have room: a few more than on the last layer."""
        state, triangles = self._cut.state, int(self.mesh.counts.triangles)
        inner = int(state.vertices + 2 * state.crossed) or triangles
        return len(rings.areas) * (inner + 64) + 2 * len(rings.corners) + triangles

    def _run_once(self, rings: Rings, index: int, full_cell: float, made: Run) -> None:
        room = len(self.mesh.points)
        site_of = np.arange(room) - SENTINELS
        site_of[SENTINELS : SENTINELS + len(self._curve)] = self._curve
        if len(self._cut.inside) != len(self.mesh.triangles):
            slots = len(self.mesh.triangles)
            self._cut = cut_with_room(self._cut, room, slots)
            self._tree, self._squares = tree_with_room(self._tree, room), no_squares(room)
            self._shortlist = no_shortlist(slots)
        left, low = self.grid.origin
        rim = rim_of(self._extent, self._crossings, room)
        run(
            self.mesh,
            self.motion,
            self._cut,
            self._tree,
            self._squares,
            self._shortlist,
            rim,
            site_of,
            rings,
            self.times[index : index + len(rings.areas)] - self.epochs[-1].start,
            walks(self._crossings, len(rings.starts), room),
            made,
            Frame(float(left), float(low), self.grid.pitch),
            self.growth_step / (2 * self.slope) / self.grid.pitch,
            full_cell,
        )
        self._leaps += (self._bottom + rim.born[: rim.counts[0]] / self._rate).tolist()

    def _layers(
        self, made: Run, areas: list[float], sections: Sequence[Section], index: int
    ) -> Iterator[Layer]:
        """The layers of a run, as views of its arrays; `areas`, mm², are those of the sections."""
        for array in (made.vertices, made.edges, made.sites, made.tree):
            array.flags.writeable = False  # so that the values need no views of their own
        points, cells, graphs, vertex_rows, edge_rows, pair_rows, tree_rows = made.rows.T.tolist()
        graph = -1
        for layer in range(int(made.outcome.layers)):
            if graphs[layer] != graph:
                graph = graphs[layer]
                row, end = edge_rows[graph], edge_rows[graph + 1]
                edges, edge_sites = made.edges[row:end], made.sites[row:end]
                neighbours = made.sites[row : pair_rows[graph]]
                tree = made.tree[tree_rows[graph] : tree_rows[graph + 1]]
            vertices = made.vertices[vertex_rows[layer] : vertex_rows[layer + 1]]
            yield Layer(
                index + layer,
                sections[layer],
                self._states.at(points[layer] - SENTINELS, int(self.times[index + layer])),
                Diagram(vertices, edges, edge_sites, neighbours),
                tree,
                areas[layer] / max(cells[layer], 1),
            )


def times_of(heights: Floats, growth_step: float, grid: Grid) -> Ints:
    """The whole times of heights (k,), mm."""
    return np.rint(heights * (growth_step / grid.pitch**2)).astype(np.int64)


def _rest(rings: Rings, layers: int) -> Rings:
    return rings._replace(layers=rings.layers[layers:], areas=rings.areas[layers:])


def refuse_faults(rings: Rings, index: int) -> None:
    """Raise `GeometryError` for the first layer whose rings do not bound what is inside."""
    layer, x, y = winding_fault(rings.corners, rings.starts, rings.layers)
    if layer >= 0:
        raise GeometryError(
            f"its rings cross, overlap or run the wrong way round near ({x:g}, {y:g}) mm: repair "
            "the part, or let outer rings run counter-clockwise and holes clockwise",
            layer=index + layer,
        )
