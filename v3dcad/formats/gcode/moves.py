"""From a toolpath's steps to the words of G-code lines, rounded so that no error adds up."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from v3dcad.errors import SettingError
from v3dcad.formats.gcode.lines import COLUMNS, IJ, XYZ, E, F, Lines
from v3dcad.model import EXTRUDE, FEATURES, RETRACT, TRAVEL, UNRETRACT, Floats, Ints, Toolpath
from v3dcad.settings import PrintSettings

MAX_EXTRUSION = 10**5
"""mm: beyond this a printer's 32-bit E no longer resolves 0.01 mm."""
MAX_ARC_ANGLE = 0.9 * math.pi
"""Arcs are ended soon after this angle: G2 and G3 are exact and unmistakable up to half a turn."""

Groups = tuple[Ints, Ints]
Flags = NDArray[np.bool_]


def origin(settings: PrintSettings) -> Floats:
    """(3,) mm: where the bed's centre lies in the printer's coordinates."""
    width, depth = settings.bed_size() if settings.bed_origin == "corner" else (0.0, 0.0)
    return np.array([width / 2, depth / 2, 0.0])


class MoveWriter:
    """Turns toolpaths into lines, layer by layer; keeps what the printer already knows."""

    def __init__(self, settings: PrintSettings) -> None:
        self.settings = settings
        self._origin = origin(settings)
        self._position: Ints | None = None
        self._feed = -1
        self._laid = 0.0
        self._extruded = 0

    def lines(self, toolpath: Toolpath) -> tuple[Lines, Ints]:
        """A layer's lines, and for each the step (n,) of the toolpath that it begins with.

        Steps along one arc are one line; steps too short for three decimals are left out, and their
        filament goes to the next. In absolute E the caller resets E at each layer.
        Raises `SettingError` where E would overflow.
        """
        points = toolpath.points + self._origin
        first, last = _arc_groups(toolpath) if self.settings.arcs else _each(len(points))
        position = np.rint(points[last] * 1000).astype(np.int64)
        before = np.vstack(
            [position[:1] - 1 if self._position is None else self._position, position[:-1]]
        )
        kind = toolpath.kind[last]
        written = (position != before).any(axis=1) | (kind == RETRACT) | (kind == UNRETRACT)
        # A step left out ends where the one before does, so `before` stays true.
        first, last, position, before, kind = (
            column[written] for column in (first, last, position, before, kind)
        )
        words = np.zeros((len(last), COLUMNS), dtype=np.int64)
        present = np.zeros((len(last), COLUMNS), dtype=bool)
        commands = np.where(kind == TRAVEL, 0, 1).astype(np.int64)

        words[:, XYZ] = position
        present[:, XYZ] = position != before
        self._set_arcs(toolpath, last, before, commands, words, present)
        self._set_extrusion(toolpath, last, kind, words, present)
        self._set_feed(toolpath, last, kind, commands, words, present)

        self._position = position[-1:] if len(position) else self._position
        return Lines(commands, words, present, self._comments(toolpath, last, kind)), first

    def _set_arcs(
        self,
        toolpath: Toolpath,
        last: Ints,
        before: Ints,
        commands: Ints,
        words: Ints,
        present: Flags,
    ) -> None:
        centre = toolpath.centre[last] + self._origin[:2]
        arc = np.isfinite(centre[:, 0]) & self.settings.arcs
        away = centre[arc] - before[arc, :2] / 1000
        onward = words[arc, :2] / 1000 - before[arc, :2] / 1000
        # The centre lies on the left of an arc that turns left.
        left = onward[:, 0] * away[:, 1] - onward[:, 1] * away[:, 0] > 0
        commands[arc] = np.where(left, 3, 2)
        words[arc, IJ] = np.rint(away * 1000)
        present[arc, :2] = present[arc, IJ] = True

    def _set_extrusion(
        self, toolpath: Toolpath, last: Ints, kind: Ints, words: Ints, present: Flags
    ) -> None:
        area = self.settings.filament_area()
        filament = (self._laid + np.cumsum(toolpath.volume))[last] / area
        self._laid += float(toolpath.volume.sum())
        reached = np.rint(filament * 10**5).astype(np.int64)
        from_here = self._extruded
        if self.settings.counts_from_before():
            words[:, E] = np.diff(reached, prepend=from_here)
        else:
            words[:, E] = reached - from_here
        self._extruded = int(reached[-1]) if len(reached) else from_here
        pulled = round(self.settings.retraction * 10**5)
        words[kind == RETRACT, E] -= pulled
        if self.settings.counts_from_before():
            words[kind == UNRETRACT, E] += pulled
        present[:, E] = kind != TRAVEL
        if np.abs(words[:, E]).max(initial=0) >= MAX_EXTRUSION * 10**5:
            raise SettingError(
                "extrusion",
                f"layer {toolpath.layer[0]} takes {filament[-1] / 1000:.0f} m of filament, more "
                "than the printer can count; set --extrusion relative, or check --bead-width, "
                "--flow and --filament-diameter",
            )

    def _set_feed(
        self,
        toolpath: Toolpath,
        last: Ints,
        kind: Ints,
        commands: Ints,
        words: Ints,
        present: Flags,
    ) -> None:
        feed = np.maximum(np.rint(toolpath.speed[last] * 60), 1).astype(np.int64)
        moves = np.ones(len(feed), dtype=bool)
        if self.settings.retraction_by == "firmware":
            moves = (kind == TRAVEL) | (kind == EXTRUDE)
            commands[kind == RETRACT], commands[kind == UNRETRACT] = 10, 11
            present[~moves] = False
        words[:, F] = feed
        present[moves, F] = np.diff(feed[moves], prepend=self._feed) != 0
        self._feed = int(feed[moves][-1]) if moves.any() else self._feed

    def _comments(self, toolpath: Toolpath, last: Ints, kind: Ints) -> Ints:
        """(n,) the feature where a line extrudes another than the one before; else 0.

        Where a travel has to be told its acceleration, FEATURES before the first of several.
        """
        travels = (kind == TRAVEL) & self.settings.switches_for_travel()
        moves = np.nonzero((kind == EXTRUDE) | travels)[0]
        what = np.where(travels, FEATURES, toolpath.feature[last])[moves].astype(np.int64)
        changed = np.diff(what, prepend=0) != 0
        comments = np.zeros(len(last), dtype=np.int64)
        comments[moves[changed]] = what[changed]
        return comments


def _each(count: int) -> Groups:
    return np.arange(count), np.arange(count)


def _arc_groups(toolpath: Toolpath) -> Groups:
    """First and last step of each stretch that one line can express: an arc, or a single step."""
    points, centre = toolpath.points, toolpath.centre
    start = np.vstack([points[:1], points[:-1]])
    away, onward = start[:, :2] - centre, points[:, :2] - centre
    turned = np.arctan2(
        away[:, 0] * onward[:, 1] - away[:, 1] * onward[:, 0], (away * onward).sum(axis=1)
    )
    alike = np.column_stack(
        [centre, np.sign(turned), toolpath.kind, toolpath.speed, toolpath.feature, points[:, 2]]
    )
    # NaN equals nothing, so straight steps stay on their own.
    begins = np.concatenate([[True], (alike[1:] != alike[:-1]).any(axis=1)])[: len(points)]
    total = np.cumsum(np.where(np.isnan(turned), 0, np.abs(turned)))
    run = np.nonzero(begins)[0]
    since = total - np.repeat(total[run] - np.abs(turned[run]), np.diff([*run, len(points)]))
    turn = np.floor(np.where(np.isnan(since), 0, since) / MAX_ARC_ANGLE)
    begins[1:] |= turn[1:] != turn[:-1]
    first = np.nonzero(begins)[0]
    return first, np.concatenate([first[1:], [len(points)]]) - 1
