"""Commands that fill parts and tell what they hold."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from v3dcad.commands.compiling import load_engine
from v3dcad.commands.filled import SitesFile, Verify, filled
from v3dcad.commands.outputs import check_outputs
from v3dcad.commands.part_options import (
    AsBrep,
    PartFile,
    Repair,
    Rotate,
    Scale,
    Unit,
    Up,
    part_of,
)
from v3dcad.commands.print_options import Profile, print_settings
from v3dcad.commands.progress import Progress
from v3dcad.commands.rows import print_rows
from v3dcad.errors import SettingError
from v3dcad.notes import noted
from v3dcad.options import given, with_options
from v3dcad.settings import ExportSettings, FillSettings, PrintSettings
from v3dcad.warm_up import PRINT

if TYPE_CHECKING:
    from v3dcad.pipeline import Structure
    from v3dcad.report import Print

OUTPUTS = ("gcode", "ont", "step", "png", "report")
"""What `fill --out` writes; the one that may refuse the part comes first."""

MORE = ("stl", "threemf", "brep", "svg")
"""What it writes when asked for by name."""

ENDINGS = {"report": "json"}

OutputFile = Annotated[Path | None, typer.Option(metavar="FILE", help="Write just this file.")]


@with_options(FillSettings, PrintSettings, ExportSettings)
def fill(
    part: PartFile,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for all five files.")
    ] = None,
    sites_file: SitesFile = None,
    profile: Profile = None,
    ont: OutputFile = None,
    gcode: OutputFile = None,
    step: OutputFile = None,
    png: OutputFile = None,
    report: OutputFile = None,
    stl: OutputFile = None,
    threemf: Annotated[
        Path | None, typer.Option("--3mf", metavar="FILE", help="Write just this file.")
    ] = None,
    brep: OutputFile = None,
    svg: OutputFile = None,
    verify: Verify = True,
    rotate: Rotate = None,
    up: Up = None,
    repair: Repair = False,
    as_brep: AsBrep = False,
    unit: Unit = None,
    scale: Scale = None,
    **settings: Any,
) -> None:
    """Fill PART and write .ont, G-code, STEP, a picture and a report."""
    named = {"ont": ont, "gcode": gcode, "step": step, "png": png, "report": report}
    named |= {"stl": stl, "threemf": threemf, "brep": brep, "svg": svg}
    files = _files(part, out, named)
    exporting = ExportSettings(**given(ExportSettings, settings))
    chosen = given(FillSettings, settings)
    from v3dcad.limits import check_limits
    from v3dcad.parts import BREP, ONT, STEP, check_readable
    from v3dcad.recipes import known_settings

    check_readable(part)
    printing = print_settings(profile, settings)
    if part.suffix.lower() not in ONT:
        known = known_settings(chosen)  # all that can be known before the part is read
        if "gcode" in files:
            check_limits(known, printing)
    if part.suffix.lower() in (*STEP, *BREP) or files.keys() & {"step", "brep"}:
        import_module("v3dcad.kernel")  # where it is missing, that is told before anything is done
    # Loading, filling, the certificate (with the report), and each other file; where no G-code is
    # traced, spans are looked for by themselves.
    certified = "gcode" not in files and not isinstance(printing.fail_over, str)
    steps = 3 + certified + len(files.keys() - {"report"})
    with noted() as notes, Progress(f"filling {part.name}", steps) as progress:
        progress.start("loading the engine")
        load_engine(PRINT)
        from v3dcad.exports import export

        structure = filled(
            part, chosen, printing, progress, sites_file=sites_file, verify=verify,
            gcode=files.get("gcode"), rotate=rotate, up=up, repair=repair, as_brep=as_brep,
            unit=unit, scale=scale,
        )  # fmt: skip
        watched = replace(structure, layers=progress.watch(structure.layers))
        printed: Print | None = None
        if certified:
            progress.start("checking what holds up each bead")
            watched.printed_overhang(printing)
        for kind, file in files.items():
            if kind != "report":
                progress.start(f"writing {file}")
            if kind == "gcode":
                printed = watched.write_gcode(file, printing)
            elif kind != "report":
                export(watched, kind, file, exporting, printing.bead_width, printed)
        progress.start("checking what holds up each layer")
        if "report" in files:
            summary = watched.write_report(files["report"], printing, printed)
        else:
            summary = watched.report(printing, printed)
    _print_summary(structure, notes, summary, files)


def _files(part: Path, out: Path | None, named: dict[str, Path | None]) -> dict[str, Path]:
    files: dict[str, Path] = {}
    for kind in (*OUTPUTS, *MORE):
        file = named[kind]
        if file is None and out is not None and kind in OUTPUTS:
            file = out / f"{part.stem}.{ENDINGS.get(kind, kind)}"
        if file is not None:
            files[kind] = file
    if not files:
        raise SettingError("out", "nothing to write: give --out DIR, or a file such as --gcode F")
    check_outputs(part, files)
    return files


def _print_summary(
    structure: Structure, notes: list[str], summary: dict[str, Any], files: dict[str, Path]
) -> None:
    from v3dcad.exports import print_lines, written_line
    from v3dcad.report import certificate_line

    width, depth, height = summary["size_mm"]
    print_rows(
        [
            ("part", f"{summary['part']}, {width:.6g} × {depth:.6g} × {height:.6g} mm"),
            ("layers", f"{summary['layers']}"),
            ("cells", f"{summary['cells']}, at most {summary['most_cells_in_a_layer']} in a layer"),
            ("wall length", f"{summary['wall_length_mm'] / 1000:.3f} m in all layers"),
            *_method_rows(summary),
            *_expected_rows(structure),
            ("overhang", certificate_line(summary["overhang"])),
            *(print_lines(summary["print"]).items() if "print" in summary else ()),
            *(("written", written_line(file)) for file in files.values()),
            *(("note", note) for note in (*structure.findings(), *notes)),
            *(("note", finding) for finding in summary.get("print", {}).get("findings", ())),
        ],
        files.values(),
    )


def _expected_rows(structure: Structure) -> list[tuple[str, str]]:
    """What a cell size that was found for a density or a mass is expected to come to."""
    expected, size = structure.expected, structure.settings.cell_size
    if expected is None:
        return []
    line = f"{100 * expected.density:.3g} % of the part's volume, {expected.mass:.4g} g"
    return [("expected", line if isinstance(size, str) else f"{line}, by --cell-size {size:g}")]


def _method_rows(summary: dict[str, Any]) -> list[tuple[str, str]]:
    from v3dcad.report import foam_lines, graded_line

    if "foam" in summary:
        rows = list(foam_lines(summary["foam"]).items())
        if "graded" in summary:
            rows.insert(0, ("cell sizes", graded_line(summary["graded"])))
        return rows
    return [
        ("births", f"{len(summary['births'])}"),
        ("offset", f"{summary['settings']['offset']:.6g} mm² a layer"),
    ]


def info(file: PartFile, repair: Repair = False, unit: Unit = None, scale: Scale = None) -> None:
    """Tell what a part or an .ont file holds."""
    from v3dcad.recipes import describe, describe_ont

    part = part_of(file, repair=repair, unit=unit, scale=scale)
    print_rows((describe_ont(file) if part is None else describe(part)).items())
