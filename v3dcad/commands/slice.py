"""The command that cuts a part into sections and does nothing else."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from v3dcad.commands.compiling import tell_of_compiling
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
from v3dcad.commands.progress import Progress
from v3dcad.commands.rows import print_rows
from v3dcad.errors import FormatError, SettingError
from v3dcad.options import given, with_options
from v3dcad.settings import SectionSettings
from v3dcad.warm_up import SURFACES

OutputFile = Annotated[Path | None, typer.Option(metavar="FILE", help="Write the sections here.")]


@with_options(SectionSettings)
def slice_part(
    part: PartFile,
    step: OutputFile = None,
    svg: OutputFile = None,
    rotate: Rotate = None,
    up: Up = None,
    repair: Repair = False,
    as_brep: AsBrep = False,
    unit: Unit = None,
    scale: Scale = None,
    **settings: Any,
) -> None:
    """Cut PART into sections: STEP with exact lines and arcs, SVG."""
    named = {"step": step, "svg": svg}
    files = {kind: file for kind, file in named.items() if file is not None}
    if not files:
        raise SettingError("step", "nothing to write: give --step FILE or --svg FILE")
    check_outputs(part, files)
    chosen = SectionSettings(**given(SectionSettings, settings))
    from v3dcad.parts import check_readable

    check_readable(part)
    with Progress(f"cutting {part.name}", 2 + len(files)) as progress:
        progress.start("reading the part")
        tell_of_compiling(SURFACES)
        from v3dcad.exports import written_line
        from v3dcad.model import size_words
        from v3dcad.slicing import section, write_sections_step, write_sections_svg

        found = part_of(part, rotate, up, repair, as_brep, unit, scale)
        if found is None:
            message = "slice the part that it was made from; fill makes its structure"
            raise FormatError(message, path=str(part))
        sections = section(found, **asdict(chosen))
        watched = progress.watch(sections)
        if step is not None:
            progress.start(f"writing {step}")
            write_sections_step(watched, step, sections.part)
        if svg is not None:
            progress.start(f"writing {svg}")
            write_sections_svg(watched, svg)
        progress.start("counting")
        counts = [(len(cut.rings), sum(map(len, cut.rings))) for cut in watched]
    rings, points = zip(*counts, strict=True)
    print_rows(
        [
            ("part", f"{sections.part.name}, {size_words(sections.part)}"),
            ("sections", len(sections)),
            ("contours", f"{sum(rings)}, at most {max(rings)} in one section"),
            ("points", sum(points)),
            *(("written", written_line(file)) for file in files.values()),
            *(("note", finding) for finding in sections.part.findings),
        ],
        files.values(),
    )
