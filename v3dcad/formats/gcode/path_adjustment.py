"""Path adjustment of an NC file (Algorithm 13 of the thesis, as written).

The thesis's path generator lifts the nozzle, travels and comes down wherever it meets a line
already printed, and the NC file it gets extrudes on the way. The algorithm takes the lift and
its two next lines out, and sets E of the line before. In the thesis's figures that line is
`G92 E0`, which becomes `G92 E-1`: this changes the filament's coordinate and moves nothing, so
no filament is pulled back. v3dcad's own G-code retracts by real moves; this module only repeats
what the thesis did.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from v3dcad.settings import Declared

HOP = 1.0
"""mm: a greater rise between two lines with Z is a travel's, as layers are lower."""
MOVE = re.compile(r"\s*G0*1(?!\d)", re.I)
NUMBER = r"\s*([-+]?(?:\d+\.?\d*|\.\d+))"
WORDS = {axis: re.compile(axis + NUMBER, re.I) for axis in "XYZE"}
COMMENT = re.compile(r"[;(].*")


@dataclass(slots=True)
class Adjusted:
    """How much was changed."""

    hops: int = 0
    """lifts taken out, each with its next two lines"""
    retractions: int = 0
    """lines whose E was set; a hop whose line before has no E has none"""
    still: int = 0
    """moves to where the nozzle already is, left out"""


def adjust(
    lines: Iterable[str], retraction: float, counted: Adjusted | None = None
) -> Iterator[str]:
    """Lines of an NC file, without their ends, as Algorithm 13 leaves them.

    `retraction` is in mm of filament. Comments are ignored. After a line without X or Y, such as
    `G92 E0`, the position is unknown. One line is held back; memory does not grow. Raises
    `SettingError` for a retraction that is not a number from 0 to 50.
    """
    Declared("", unit="mm", least=0, most=50).checked("retraction", retraction)
    counted = counted if counted is not None else Adjusted()
    held: str | None = None
    height: float | None = None
    place: tuple[float | None, float | None] = (None, None)
    skipped = 0
    for line in lines:
        if skipped:
            skipped -= 1
            continue
        code = COMMENT.sub("", line)
        moves = MOVE.match(code) is not None
        z = _value(code, "Z") if moves else None
        if z is not None:
            hops = height is not None and z - height > HOP
            height = z
            if hops:
                counted.hops += 1
                skipped = 2
                if held is not None:
                    retracted = _with_extrusion(held, -retraction)
                    counted.retractions += retracted is not None
                    held = held if retracted is None else retracted
                continue
        now = (_value(code, "X"), _value(code, "Y"))
        if moves and _value(code, "E") is None and now == place and None not in now:
            counted.still += 1
            continue
        place = now
        if held is not None:
            yield held
        held = line
    if held is not None:
        yield held


def _value(code: str, axis: str) -> float | None:
    match = WORDS[axis].search(code)
    return float(match[1]) if match else None


def _with_extrusion(line: str, value: float) -> str | None:
    """The line with E set to a value; None where it has no E."""
    match = WORDS["E"].search(COMMENT.sub("", line))
    if match is None:
        return None
    # Adding zero makes −0 a plain 0.
    return f"{line[: match.start()]}E{value + 0.0:g}{line[match.end() :]}"
