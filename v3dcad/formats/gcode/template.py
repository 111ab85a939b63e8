"""Header and footer of an example G-code file (Algorithm 12 of the thesis).

A slicer that knows the printer writes an example file. What comes before and after its print is
put before and after ours.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from v3dcad.errors import FormatError
from v3dcad.formats.gcode.machine_profile import profile_text

MAX_FILE_BYTES = 500_000_000
MOVE = re.compile(r"G0*[123](?!\d)(?=.*[XY])", re.I)
FED = re.compile(r"E\s*([-+]?[\d.]+)", re.I)
CODE = re.compile(r"[^;(]*")


@dataclass(frozen=True, slots=True)
class Template:
    """What an example file has before and after its print."""

    prepended: str
    appended: str
    first_line: int
    """the marker START or the first extrusion, counted from 1"""
    last_line: int
    """the marker END or the last extrusion"""
    marked: bool
    """whether markers were found; if not, the extrusions were"""

    def finding(self) -> str:
        """How header and footer were found, for the user to know."""
        if self.marked:
            return (
                f"header ends at START (line {self.first_line}), footer begins after END "
                f"(line {self.last_line})"
            )
        return (
            "no START and END markers: header ends before the first extrusion "
            f"(line {self.first_line}), footer begins after the last (line {self.last_line}); "
            "the printer's own priming counts as extrusion: set markers to keep it"
        )


def read_template(path: Path) -> Template:
    """Header and footer of an example file, by its markers or else its extrusions.

    As Algorithm 12 has it, the first line that starts with START ends the header and the last
    that starts with END begins the footer; marker lines belong to neither. Raises
    `FormatError` for text that is not ASCII, one marker without the other, END before START,
    and a file with neither markers nor extrusions.
    """
    lines = _ascii_lines(path)
    starts = [number for number, line in enumerate(lines) if line.startswith("START")]
    ends = [number for number, line in enumerate(lines) if line.startswith("END")]
    marked = bool(starts or ends)
    if marked and not (starts and ends):
        missing = "START" if ends else "END"
        raise FormatError(
            f"a line {missing} is missing; set both markers or none",
            path=str(path),
            line=(starts or ends)[0] + 1,
        )
    if not marked:
        starts = ends = _extrusions(lines)
        if not starts:
            raise FormatError(
                "neither START and END markers nor a move that extrudes; name a sliced file, "
                "or set the markers",
                path=str(path),
            )
    first, last = starts[0], ends[-1]
    if last < first:
        raise FormatError(
            f"END comes before START (line {first + 1}); exchange them",
            path=str(path),
            line=last + 1,
        )
    return Template(
        "".join(f"{line}\n" for line in lines[:first]),
        "".join(f"{line}\n" for line in lines[last + 1 :]),
        first + 1,
        last + 1,
        marked,
    )


def template_profile(template: Template, example: str) -> str:
    """A template as the TOML text of a machine profile; braces in it stand for themselves."""
    blocks = {"start_gcode": template.prepended, "end_gcode": template.appended}
    literal = {name: block.replace("{", "{{").replace("}", "}}") for name, block in blocks.items()}
    return profile_text(literal, f"Header and footer of {example}")


def _ascii_lines(path: Path) -> list[str]:
    with path.open("rb") as stream:
        data = stream.read(MAX_FILE_BYTES + 1)
    if len(data) > MAX_FILE_BYTES:
        raise FormatError("larger than 500 MB; give a shorter example", path=str(path))
    try:
        text = data.decode("ascii")
        wrong = text.find("\0")
    except UnicodeDecodeError as error:
        wrong = error.start
    if wrong >= 0:
        raise FormatError(
            "this is not plain ASCII text; remove other characters, or name another file",
            path=str(path),
            line=data.count(b"\n", 0, wrong) + 1,
        )
    return text.splitlines()


def _extrusions(lines: list[str]) -> list[int]:
    """Lines that move in x or y while E goes forward."""
    found = []
    relative, e = False, 0.0
    for number, line in enumerate(lines):
        match = CODE.match(line)
        code = match[0].strip().upper() if match else ""
        if code.startswith(("M82", "M83")):
            relative = code.startswith("M83")
        fed = FED.search(code)
        if fed is None:
            continue
        try:
            value = float(fed[1])
        except ValueError:
            continue
        if code.startswith("G92"):
            e = value
        elif code.startswith(("G0", "G1", "G2", "G3")):
            if MOVE.match(code) and (value > 0 if relative else value > e):
                found.append(number)
            e = e if relative else value
    return found
