"""The contours of a layer, stretch by stretch: which of its edges lie on which exact curve."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from v3dcad.model import CurveRun, Diagram, Section

Corner = tuple[int, int]
"""A ring of a section and the number of a corner in it, which is also that of the next segment."""

STRAIGHT = CurveRun(-1, 0, 0, "line", -1, ())
"""Where a section has no curves (triangles), every segment of a ring is a line."""


class Stretch(NamedTuple):
    """Part of a contour that lies on one curve, between two points where walls or curves end."""

    chain: list[int]
    """vertex ids of the diagram along it; only the first and the last belong to others too"""
    run: CurveRun


def contours(section: Section, diagram: Diagram) -> list[list[Stretch]]:
    """The closed contours of a layer, each as its stretches in the order of the ring.

    A stretch ends where the ring passes from one run to the next, and where a wall ends on it.
    """
    corners_at: dict[tuple[float, ...], list[Corner]] = {}
    for ring, corners in enumerate(section.rings):
        for index, corner in enumerate(corners.tolist()):
            corners_at.setdefault(tuple(corner), []).append((ring, index))
    run_at = _runs_by_segment(section)
    corners_of = [corners_at.get(tuple(vertex), []) for vertex in diagram.vertices.tolist()]
    walls_end = set(np.unique(diagram.edges[diagram.inner()]).tolist())
    return [
        list(_stretches(chain, _runs_along(chain, corners_of, run_at, section), walls_end))
        for chain in _closed_chains(diagram)
    ]


def _runs_by_segment(section: Section) -> dict[Corner, CurveRun]:
    """The run of each segment (ring, index of its first corner)."""
    return {
        (run.ring, index % len(section.rings[run.ring])): run
        for run in section.runs
        for index in range(run.start, run.stop)
    }


def _closed_chains(diagram: Diagram) -> list[list[int]]:
    """The boundary edges chained into closed lists of vertex ids, the first id repeated last.

    Where contours touch in a vertex, each way through it is taken once.
    """
    ways: dict[int, list[int]] = {}
    for start, stop in diagram.edges[~diagram.inner()].tolist():
        ways.setdefault(start, []).append(stop)
    chains = []
    for start in list(ways):
        while ways[start]:
            chain = [start, ways[start].pop()]
            while chain[-1] != start:
                chain.append(ways[chain[-1]].pop())
            chains.append(chain)
    return chains


def _runs_along(
    chain: list[int],
    corners_of: list[list[Corner]],
    run_at: dict[Corner, CurveRun],
    section: Section,
) -> list[CurveRun]:
    """The run that each edge of a closed chain lies on: that of the last corner passed."""
    passed = next((corners_of[vertex][0] for vertex in reversed(chain) if corners_of[vertex]), None)
    runs = []
    for vertex in chain[:-1]:
        found = corners_of[vertex]
        if found and passed:
            ring, index = passed
            following = (ring, (index + 1) % len(section.rings[ring]))
            # Where rings touch, a vertex is a corner of both: stay on the one we came along.
            passed = following if following in found else found[0]
        runs.append(run_at.get(passed, STRAIGHT) if passed else STRAIGHT)
    return runs


def _stretches(chain: list[int], runs: list[CurveRun], walls_end: set[int]) -> Iterator[Stretch]:
    """Cut one closed chain where its run changes and where walls end on it."""
    count = len(runs)
    cuts = [k for k in range(count) if chain[k] in walls_end or runs[k] != runs[k - 1]] or [0]
    for first, last in zip(cuts, [*cuts[1:], cuts[0] + count], strict=True):
        around = [chain[k % count] for k in range(first, last + 1)]
        yield Stretch(around, runs[first])
