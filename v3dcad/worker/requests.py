"""What each request does: values from JSON in, calls of v3dcad, values for JSON out."""

from __future__ import annotations

import platform
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import SettingError, V3dcadError
from v3dcad.exports import export, kind_of, print_lines, written_line
from v3dcad.formats.gcode.machine_profile import print_settings
from v3dcad.model import Floats
from v3dcad.pipeline import Structure
from v3dcad.recipes import given_sites, known_settings, part_of, read_ont, sites_of
from v3dcad.report import certificate_line, graded_line
from v3dcad.settings import ExportSettings, FillSettings, PrintSettings
from v3dcad.version import VERSION
from v3dcad.view.targets.whole import all_edges
from v3dcad.watched import Watched
from v3dcad.worker.arrays import Files, read_array
from v3dcad.worker.declarations import chosen, declarations, own
from v3dcad.worker.kept import Kept, Stage

ALONE = ("layer", "cell", "neighbours", "neighbour", "tree", "sizes")
"""Targets for which one layer is enough; the others go through all."""

SHAPES = ("wires", "faces", "cells", "solid", "struts")


class Work:
    """One request and what it needs."""

    def __init__(self, request: dict[str, Any], files: Files, kept: Kept, stage: Stage) -> None:
        self._request, self._files, self._kept, self._stage = request, files, kept, stage

    def result(self) -> dict[str, Any]:
        """Do what is asked for. Raises `V3dcadError` where the request is wrong, or v3dcad does."""
        do = self._needed("do", str)
        if do not in DO:
            raise V3dcadError(f"cannot do {do!r}: ask for {', '.join(DO)}")
        return DO[do](self)

    def hello(self) -> dict[str, Any]:
        """Tell what can be set."""
        return {
            "version": VERSION,
            "python": platform.python_version(),
            "settings": declarations(),
        }

    def fill(self) -> dict[str, Any]:
        """All lines of the structure, its check sum, and its wires where they are few."""
        most = self._needed("shape_up_to", int)
        structure = self._whole()
        edges = all_edges(structure.layers, structure.placement)
        shape = None
        if len(edges.pairs) <= most:
            self._stage("writing wires", 0, 0)
            path = self._files.new(".brep")
            structure.write_brep(path, "wires")
            shape = str(path)
        return {
            "lines": self._files.lines(edges.points, edges.pairs, edges.layer),
            "edges": len(edges.pairs),
            "shape": shape,
            "checksum": structure.checksum().sha256,
            "settings": own(structure.settings),
            "layers": len(structure.layers),
        }

    def report(self) -> dict[str, Any]:
        """What the structure measures and weighs, and how it holds."""
        printing = self._printing()
        structure = self._whole()
        told = self._watched(structure, "checking what holds up each layer").report(printing)
        self._stage("weighing", 0, 0)
        foam = told.get("foam")
        sizes = [f"cell sizes: {graded_line(told['graded'])}"] if "graded" in told else []
        return {
            "layers": told["layers"],
            "cells": told["cells"],
            "cell_size": foam and foam["cell_size_made_mm"],
            "steepest_wall": foam and foam["steepest_wall"]["tilt_deg"],
            "wall_length": told["wall_length_mm"],
            "certificate": certificate_line(told["overhang"]),
            "mass": structure.plastic(printing).mass,
            "findings": [*structure.findings(), *sizes],
        }

    def overhang(self) -> dict[str, Any]:
        """What of the printed beads has nothing under it, as arrays and in words."""
        printing = self._printing()
        watched = self._watched(self._whole(), "checking what holds up each bead")
        found = watched.printed_overhang(printing)
        return {
            "kinds": list(found.kinds),
            "arrays": self._files.named(
                {name: getattr(found, name) for name in found.__dataclass_fields__}
            ),
            "certificate": found.line(),
            "findings": found.findings(),
        }

    def layer(self) -> dict[str, Any]:
        """A preview of one layer, or of one of the other targets."""
        target = self._needed("target", str)
        structure = self._structure() if target in ALONE else self._whole()
        index = self._index(structure)
        shown = structure.preview(
            target, index, self._optional("cell", int), self._optional("neighbour", int),
            self._printing(),
        )  # fmt: skip
        labels = zip(shown.labels.sites.tolist(), shown.labels.points.tolist(), strict=True)
        parts = shown.stepped()
        return {
            "title": shown.title,
            "legend": {name: colour for name, colour, _, _ in parts},
            "parts": [
                {
                    "name": name,
                    "colour": colour,
                    "points": self._files.points(points),
                    "pairs": self._files.pairs(pairs),
                }
                for name, colour, points, pairs in parts
            ],
            "labels": [[str(site), *point] for site, point in labels],
            "layer": index,
            "layers": len(structure.layers),
            "cells": shown.cells.tolist(),
        }

    def brep(self) -> dict[str, Any]:
        """A form of the structure as BREP."""
        from v3dcad.kernel.shapes import EDGE, SOLID, count

        form = self._needed("form", str)
        if form not in SHAPES:
            raise SettingError("form", f"form {form!r}: give {', '.join(SHAPES)}")
        wanted = self._sizes().sizes(form, PrintSettings().bead_width)
        path = self._files.new(".brep")
        structure = self._watched(self._whole(), f"making {form}")
        self._stage(f"making {form}", 0, 0)  # only wires go through the layers
        shape = structure.write_brep(path, form, **wanted)
        return {"shape": str(path), "edges": count(shape, EDGE), "solids": count(shape, SOLID)}

    def export(self) -> dict[str, Any]:
        """Write a file, whole or not at all."""
        file = Path(self._needed("to", str))
        kind = kind_of(file)
        how, printing = self._sizes(), self._printing()
        # As the command line does: a layer by itself has its edges in another order.
        structure = self._named(self._watched(self._structure(), f"writing {file.name}"))
        lines: list[str] = []
        if kind == "gcode":
            printed = structure.write_gcode(file, printing)
            told = {**asdict(printed.totals), "spans": printed.overhang.line()}
            lines += [f"{name}: {said}" for name, said in print_lines(told).items()]
            lines += printed.findings
        else:
            export(structure, kind, file, how, printing.bead_width)
        return {"bytes": file.stat().st_size, "lines": [f"written {written_line(file)}", *lines]}

    def open_ont(self) -> dict[str, Any]:
        """What an `.ont` file holds: the part on the bed, its settings, and its sites if listed."""
        from v3dcad.forms import write_part

        path = self._needed("path", str)
        self._stage("reading", 0, 0)
        recipe = read_ont(path)
        part, sites = part_of(recipe), sites_of(recipe)
        boundary = self._files.new(".brep" if hasattr(part, "shape") else ".stl")
        write_part(part, boundary)
        return {
            "boundary": str(boundary),
            "settings": own(recipe.settings),
            "sites": None if sites is None else self._files.sites(np.asarray(sites)),
            "name": recipe.name,
            "checksum": recipe.checksum and recipe.checksum.sha256,
            "placement": {
                "rotation": recipe.placement.rotation.tolist(),
                "translation": recipe.placement.translation.tolist(),
            },
        }

    def _asked(self) -> tuple[str, FillSettings, Floats | None, PrintSettings, Stage]:
        path = self._optional("sites", str)
        sites = None if path is None else given_sites(read_array(path))
        settings = known_settings(chosen(FillSettings, self._needed("settings", dict)), sites)
        printing = print_settings(self._optional("sized_for", str) or None)
        return self._needed("source", str), settings, sites, printing, self._stage

    def _structure(self) -> Structure:
        return self._kept.structure(*self._asked())

    def _whole(self) -> Structure:
        return self._kept.whole(*self._asked())

    def _watched(self, structure: Structure, stage: str) -> Structure:
        layers = structure.layers
        watched = Watched(layers, lambda done: self._stage(stage, done, len(layers)))
        return replace(structure, layers=watched)

    def _named(self, structure: Structure) -> Structure:
        """The structure of a part of that name, which files carry."""
        name = self._optional("name", str)
        part: Any = structure.part
        return structure if name is None else replace(structure, part=replace(part, name=name))

    def _index(self, structure: Structure) -> int:
        """The layer that is asked for: by its index, or the nearest to a height above the base."""
        height = self._optional("height", float)
        if height is None:
            return self._optional("layer", int) or 0
        settings = structure.settings
        above = (height - settings.section_above()) / settings.layer_height
        return int(np.clip(round(above), 0, max(len(structure.layers) - 1, 0)))

    def _printing(self) -> PrintSettings:
        """Print settings: a profile's, unless the request says otherwise."""
        values = chosen(PrintSettings, self._optional("print", dict) or {})
        profile = self._optional("profile", str) or self._optional("sized_for", str)
        return print_settings(profile or None, **values)

    def _sizes(self) -> ExportSettings:
        """How a structure is exported, as far as the request says: a form, and its sizes."""
        names = [name for name in ExportSettings.__dataclass_fields__ if name in self._request]
        values = {name: self._request[name] for name in names}
        form = self._optional("form", str)
        if form is not None and "to" in self._request:
            takes = {"step": "step_as", "brep": "step_as", "stl": "stl_as", "threemf": "threemf_as"}
            kind = kind_of(Path(self._needed("to", str)))
            if kind in takes:
                values[takes[kind]] = form
        return ExportSettings(**chosen(ExportSettings, values))

    def _needed(self, name: str, kind: type) -> Any:
        value = self._optional(name, kind)
        if value is None:
            raise V3dcadError(f"the request has no {name!r}")
        return value

    def _optional(self, name: str, kind: type) -> Any:
        value = self._request.get(name)
        if kind is float and isinstance(value, int):
            value = float(value)
        if value is not None and (not isinstance(value, kind) or isinstance(value, bool)):
            raise V3dcadError(f"{name!r} of the request is {value!r}, no {kind.__name__}")
        return value


DO: dict[str, Callable[[Work], dict[str, Any]]] = {
    "hello": Work.hello,
    "fill": Work.fill,
    "report": Work.report,
    "overhang": Work.overhang,
    "layer": Work.layer,
    "brep": Work.brep,
    "export": Work.export,
    "open_ont": Work.open_ont,
}
"""What can be asked for."""
