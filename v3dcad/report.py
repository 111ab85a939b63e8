"""The report of a structure: what was made, how it holds, how it is printed."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from v3dcad.formats.gcode.blocks import Totals
from v3dcad.model import Layer, Part
from v3dcad.settings import FillSettings
from v3dcad.structure.fill import Filling
from v3dcad.structure.overhang import Overhang
from v3dcad.structure.thesis.loop import ThesisFilling
from v3dcad.toolpath.report import LayerReport


@dataclass(frozen=True, eq=False, slots=True)
class Print:
    """What a print takes, and how each layer is traced."""

    totals: Totals
    layers: list[LayerReport]
    findings: list[str]


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
    rows = [_row(layer) for layer in layers]
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
        "cells": max((row["cells"] for row in rows), default=0),
        "walls": sum(row["walls"] for row in rows),
        "wall_length_mm": sum(row["wall_length_mm"] for row in rows),
        "contour_length_mm": sum(row["contour_length_mm"] for row in rows),
        **(_insertions(filling) if isinstance(filling, ThesisFilling) else {}),
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
