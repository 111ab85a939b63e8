"""How layers are printed, in numbers, and what the user should know of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely

from v3dcad.geometry import arcs
from v3dcad.model import EXTRUDE, RETRACT, Floats, Ints, Layer, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.toolpath.certificate import printed_overhang
from v3dcad.toolpath.first_layer import stand_width, stands_badly
from v3dcad.toolpath.overhang import Hanging
from v3dcad.toolpath.perimeters import inset, outermost_depth
from v3dcad.toolpath.plan import Plan
from v3dcad.words import counted

MOST_NAMED = 5
"""Cells named in a finding; there may be thousands."""

LEAST_TOLD = 0.01
"""mm² that stay empty in all: the finding shows two decimals, and less is what rounding leaves."""


@dataclass(frozen=True, slots=True)
class LayerReport:
    """How one layer is printed; lengths in mm."""

    layer: int
    extruded: float
    retraced: float
    """passed twice, with half a bead each time"""
    travelled: float
    """moved off the beads, in x and y"""
    strokes: int
    retractions: int
    joined_edges: int
    """edges left out for being shorter than `minimum_edge`"""
    narrow_cells: tuple[int, ...]
    """sites whose cells a bead fills: it is wider than twice their gap"""
    narrow_area: float
    """mm² of the section too narrow for a perimeter"""
    level: float
    """mm above the bed; 0 where nothing is printed yet, since the first sections have no room"""
    area: float
    """mm² of the section"""
    stand_width: float
    """mm: the least width of what lies on the bed; 0 on other layers"""
    seconds: float
    """how long it takes"""
    hurried: bool
    """whether it takes less than `minimum_layer_time`, even at the slowest speed"""
    hanging: tuple[Hanging, ...]
    """what hangs over the layer below, for each kind of beads of which some does"""
    bridged: float
    """mm of walls and inner perimeters that are bridges, since they hang"""


def layer_report(
    toolpath: Toolpath,
    before: Floats,
    strokes: int,
    plan: Plan,
    seconds: float,
    hanging: tuple[Hanging, ...],
    bridged: float,
) -> LayerReport:
    """What a layer's toolpath, which began at `before` (3,) and takes `seconds`, comes to.

    Some of its beads are `hanging`; so many mm of walls are `bridged`.
    """
    division, level = plan.division, plan.division.level
    flat = np.vstack([before, toolpath.points])[:, :2]
    length = arcs.lengths(flat[:-1], flat[1:], toolpath.centre)
    extruding = toolpath.kind == EXTRUDE
    return LayerReport(
        layer=plan.layer.index,
        extruded=float(length[extruding].sum()),
        retraced=plan.retraced,
        travelled=float(length[~extruding].sum()),
        strokes=strokes,
        retractions=int(np.count_nonzero(toolpath.kind == RETRACT)),
        joined_edges=plan.joined,
        narrow_cells=tuple(narrow_cells(plan.layer, plan.settings).tolist()),
        narrow_area=narrow_area(division.area, outermost_depth(plan.settings)),
        level=level,
        area=float(division.area.area),
        stand_width=stand_width(division.area) if division.first and level else 0.0,
        seconds=seconds,
        hurried=bool(extruding.any()) and seconds < plan.settings.minimum_layer_time,
        hanging=hanging,
        bridged=bridged,
    )


@lru_cache(maxsize=64)
def narrow_area(area: shapely.Geometry, depth: float) -> float:
    """mm² of an area that a perimeter `depth` inside it cannot reach, being too narrow there.

    Known for a while, as insets are.
    """
    missed = float(area.area - inset(inset(area, depth), -depth).area)
    return missed if missed > 1e-6 * area.area else 0.0


def narrow_cells(layer: Layer, settings: PrintSettings) -> Ints:
    """Site ids of the cells whose gap is less than half a bead, where both print one wall.

    With two beads to a wall there are none: cells too small for a loop are left out. A cell's gap
    is taken as 4 · area ÷ perimeter, which for a regular polygon is the diameter of the circle
    inside it.
    """
    if settings.wall_beads == 2:
        return np.empty(0, np.int64)
    width = settings.bead_width
    count = len(layer.state.sites)
    areas = layer.diagram.areas(count)
    lengths, inner = layer.diagram.lengths(), layer.diagram.inner()
    around = np.bincount(layer.diagram.edge_sites[:, 1], lengths, count)
    around += np.bincount(layer.diagram.edge_sites[inner, 0], lengths[inner], count)
    return np.nonzero((around > 0) & (width * around > 8 * areas))[0]


def findings(reports: Iterable[LayerReport]) -> list[str]:
    """What the user should know of a print, a sentence each; nothing where all is well."""
    narrow: dict[int, list[int]] = {}
    unreached, unreached_on, joined = 0.0, 0, 0
    hurried: list[LayerReport] = []
    stand: LayerReport | None = None
    height = largest = 0.0
    told = list(reports)
    for report in told:
        for site in report.narrow_cells:
            narrow.setdefault(site, []).append(report.layer)
        unreached += report.narrow_area
        unreached_on += report.narrow_area > 0
        joined += report.joined_edges
        stand = report if report.stand_width else stand
        height, largest = max(height, report.level), max(largest, report.area)
        if report.hurried:
            hurried.append(report)
    found = printed_overhang(told).findings()
    if stand and stands_badly(stand.area, stand.stand_width, height, largest):
        found.append(
            f"the part stands on {stand.area:.3g} mm², {stand.stand_width:.2g} mm wide, and is "
            f"{height:.3g} mm high: it may come loose. Another side down (--up, --rotate), a "
            "raft of solid layers under it in the CAD model, or a wider --brim-width helps"
        )
    if narrow:
        named = ", ".join(
            f"cell {site} (layers {layers[0]} to {layers[-1]})"
            for site, layers in list(narrow.items())[:MOST_NAMED]
        )
        more = f" and {len(narrow) - MOST_NAMED} more" if len(narrow) > MOST_NAMED else ""
        found.append(
            f"the bead is wider than twice the gap of {named}{more}: they print solid "
            "there; use a narrower bead or larger cells"
        )
    if unreached >= LEAST_TOLD:
        found.append(
            f"{unreached:.2f} mm² on {counted(unreached_on, 'layer')} stay empty, too narrow for a "
            "bead; use a narrower bead, or --contour centre"
        )
    if hurried:
        shortest = min(hurried, key=lambda report: report.seconds)
        found.append(
            f"--minimum-layer-time is more than {counted(len(hurried), 'layer')} can take even at "
            f"the slowest speed; the shortest, layer {shortest.layer}, takes "
            f"{shortest.seconds:.1f} s: print several parts at once, or lower --slowest-speed"
        )
    if joined:
        edges = counted(joined, "edge")
        found.append(f"joined {edges} shorter than --minimum-edge to the neighbours")
    return found
