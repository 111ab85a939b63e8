"""The report of a structure: what was made, how it holds, how it is printed."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from v3dcad.formats.gcode.blocks import Totals
from v3dcad.geometry.voronoi.cells import voronoi_cells
from v3dcad.geometry.voronoi.measures import extents
from v3dcad.model import Diagram, Floats, Ints, Layer, Part
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import Filling
from v3dcad.structure.foam.sites import FoamSites
from v3dcad.structure.foam.space import steepest_in, tilt
from v3dcad.structure.overhang import Overhang
from v3dcad.structure.thesis.loop import ThesisFilling

if TYPE_CHECKING:
    from v3dcad.structure.foam.graded import Graded
    from v3dcad.toolpath.certificate import PrintedOverhang
    from v3dcad.toolpath.report import LayerReport

MEASURED = 1000
"""How many cells are measured to say how tall they are; more would not change the mean."""


@dataclass(frozen=True, eq=False, slots=True)
class Print:
    """What a print takes, and how each layer is traced."""

    totals: Totals
    layers: list[LayerReport]
    findings: list[str]

    @property
    def overhang(self) -> PrintedOverhang:
        """What of the printed beads has nothing under it."""
        from v3dcad.toolpath.certificate import printed_overhang

        return printed_overhang(self.layers)


def report(
    part: Part,
    filling: Filling | ThesisFilling,
    layers: Iterable[Layer],
    certificate: Overhang,
    bead_width: float,
    printed: Print | None = None,
) -> dict[str, Any]:
    """The report as plain values for JSON; lengths in mm, angles in degrees.

    `certificate` is for beads of `bead_width`, mm; `printed` is what writing G-code told.
    """
    rows = []
    has_cell = np.zeros(0, np.bool_)
    area = corners = 0.0
    for layer in layers:
        rows.append(_row(layer))
        sites = layer.diagram.sites()
        beyond = sites.max(initial=-1) + 1 - len(has_cell)
        has_cell = np.append(has_cell, np.zeros(max(int(beyond), 0), np.bool_))
        has_cell[sites] = True
        area += _area(layer.diagram)
        corners += _corners(layer.diagram)
    cells = np.flatnonzero(has_cell)
    for name in ("wall_tilt", "strut_tilt", "distance", "unsupported", "outside"):
        for row, value in zip(rows, getattr(certificate, name).tolist(), strict=True):
            row[name] = value
    told = {
        "part": part.name,
        "size_mm": np.ptp(part.bounds, axis=0).tolist(),
        "findings": list(part.findings),
        "settings": {
            name: getattr(filling.settings, name) for name in FillSettings.__dataclass_fields__
        },
        "layers": len(rows),
        "cells": len(cells),
        "most_cells_in_a_layer": max((row["cells"] for row in rows), default=0),
        "walls": sum(row["walls"] for row in rows),
        "wall_length_mm": sum(row["wall_length_mm"] for row in rows),
        "contour_length_mm": sum(row["contour_length_mm"] for row in rows),
        **(
            _insertions(filling)
            if isinstance(filling, ThesisFilling)
            else {"foam": _foam(filling, part.bounds, cells, area, corners)}
        ),
        "overhang": {
            "bead_width_mm": bead_width,
            "largest_wall_tilt_deg": float(certificate.wall_tilt.max(initial=0)),
            "largest_strut_tilt_deg": float(certificate.strut_tilt.max(initial=0)),
            "largest_distance_mm": float(certificate.distance.max(initial=0)),
            "unsupported_wall_mm": float(certificate.unsupported.sum()),
            "walls_outside_section_below_mm": float(certificate.outside.sum()),
        },
        "by_layer": rows,
    }
    if printed is not None:
        told["print"] = dataclasses.asdict(printed.totals) | {
            "bounds": printed.totals.bounds.tolist(),
            "spans": printed.overhang.line(),
            "findings": printed.findings,
            "by_layer": [dataclasses.asdict(layer) for layer in printed.layers],
        }
    return told


def _insertions(filling: ThesisFilling) -> dict[str, Any]:
    """Which layers got sites, and which were to get one, but no cell qualified."""
    births = filling.births.tolist()
    return {
        "births": [{"layer": layer, "site": site} for layer, site in births],
        "layers_without_candidate": filling.unanswered.tolist(),
    }


def _foam(
    filling: Filling, box: Floats, cells: Ints, area: float, corners: float
) -> dict[str, Any]:
    """A foam's cells (c,) in the part's box (2, 3): size, shape and steepest wall.

    `area`, mm², is that of all sections, `corners` what `_corners` counts in them. Where three
    walls meet in each corner, a plane has half as many cells as corners; and corners, unlike cells,
    are not cut by contours. Sites that are given ask for no cell size, and columns have no height.
    """
    foam, settings = filling.foam, filling.settings
    asked = None if isinstance(settings.cell_size, str) else settings.cell_size
    in_space = asked is not None and settings.stretch != "columns"
    wall = steepest_in(foam, *box)
    upright = wall.rise == 0
    return {
        "sites": len(foam.places),
        "cell_size_asked_mm": asked,
        "cell_size_made_mm": math.sqrt(area / corners) if corners else None,
        "height_by_width": _height_by_width(foam, cells) if in_space else None,
        "steepest_wall": {
            "tilt_deg": 0.0 if upright else tilt(wall, foam.stretch),
            "sites": [] if upright else list(wall.sites),
        },
    }


def _height_by_width(foam: FoamSites, cells: Ints) -> float | None:
    """How tall cells (c,) are by their mean width in x and y, on average; whole, not as cut."""
    if not len(cells):
        return None
    some = cells[np.linspace(0, len(cells) - 1, min(MEASURED, len(cells))).astype(np.int64)]
    low, high = extents(voronoi_cells(foam.places.astype(np.float64), some))
    x, y, z = (high - low).T
    return float(np.mean(2 * foam.stretch * z / (x + y)))


def _area(diagram: Diagram) -> float:
    """The area of a section, mm², by Green's theorem over its boundary."""
    a, b = np.moveaxis(diagram.vertices[diagram.edges[~diagram.inner()]], 1, 0)
    return float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / 2)


def _corners(diagram: Diagram) -> float:
    """Half the number of corners inside a section; those of more than three walls count more."""
    walls = np.bincount(diagram.edges.ravel(), minlength=len(diagram.vertices))
    on_contour = np.zeros(len(diagram.vertices), np.bool_)
    on_contour[diagram.edges[~diagram.inner()]] = True
    return float((walls[~on_contour] / 2 - 1).sum())


def _row(layer: Layer) -> dict[str, Any]:
    diagram = layer.diagram
    lengths, inner = diagram.lengths(), diagram.inner()
    return {
        "layer": layer.index,
        "z_mm": layer.z,
        "cells": len(diagram.sites()),
        "walls": len(diagram.neighbours),
        "wall_length_mm": float(lengths[inner].sum()),
        "contour_length_mm": float(lengths[~inner].sum()),
        "area_per_cell_mm2": layer.area_per_cell,
    }


def graded_report(graded: Graded) -> dict[str, Any]:
    """How cells of many sizes differ from what was asked."""
    return {
        "asked_mm": list(graded.asked),
        "made_mm": list(graded.made),
        "finest_share_of_asked": graded.finest,
        "finer_share_of_box": graded.finer,
    }


def graded_line(graded: dict[str, Any]) -> str:
    """The sizes of cells in one line."""
    low, high = graded["asked_mm"]
    line = f"{low:.4g} to {high:.4g} mm asked"
    if graded["finer_share_of_box"]:
        line += (
            f"; smaller than asked in {100 * graded['finer_share_of_box']:.2g} % of the part's box,"
            f" down to {100 * graded['finest_share_of_asked']:.2g} %, where the size changes more "
            "steeply than cells can follow"
        )
    return line


def certificate_line(overhang: dict[str, float]) -> str:
    """The certificate in one line."""
    unsupported = overhang["unsupported_wall_mm"]
    support = (
        "every wall lies within half a bead of what is below"
        if unsupported == 0
        else f"{unsupported:.1f} mm of wall lie farther than half a bead from what is below"
    )
    outside = overhang["walls_outside_section_below_mm"]
    part = f"; {outside:.1f} mm over the part's own overhang" if outside else ""
    struts = overhang["largest_strut_tilt_deg"]
    lean = f", struts up to {struts:.1f}°" if struts else ""
    return (
        f"walls lean up to {overhang['largest_wall_tilt_deg']:.1f}°{lean}, and rest within "
        f"{overhang['largest_distance_mm']:.3f} mm: {support}{part}"
    )


def foam_lines(foam: dict[str, Any]) -> dict[str, str]:
    """A foam's size, shape and steepest wall, as lines to show."""
    asked, made, tall = (
        foam[name] for name in ("cell_size_asked_mm", "cell_size_made_mm", "height_by_width")
    )
    size = [
        *([] if asked is None else [f"{asked:.4g} mm asked"]),
        *([] if made is None else [f"{made:.4g} mm made"]),
        *([] if tall is None else [f"cells {tall:.2f} times as tall as wide"]),
    ]
    wall = foam["steepest_wall"]
    steepest = "every wall is upright"
    if wall["sites"]:
        i, j = wall["sites"]
        steepest = f"wall between sites {i} and {j}, {wall['tilt_deg']:.2f}° (certified)"
    return {**({"cell size": ", ".join(size)} if size else {}), "steepest": steepest}


def hours_text(seconds: float) -> str:
    """A duration as people plan with it, such as 3 h 05 min."""
    hours, minutes = divmod(round(seconds / 60), 60)
    return f"{hours} h {minutes:02d} min"
