"""Lines in, answers out: one answer to each line, errors in words."""

from __future__ import annotations

import json
import math
import sys
import traceback
from collections.abc import Iterable
from pathlib import Path
from typing import Any, BinaryIO

from v3dcad.errors import SettingError, V3dcadError
from v3dcad.notes import noted
from v3dcad.worker.arrays import Files
from v3dcad.worker.kept import Kept
from v3dcad.worker.requests import Work

STEPS = 50
"""How many lines, at most, tell of the progress of one stage."""


class Answers:
    """What is written about one request: first how far it is, then its result or its error."""

    def __init__(self, stream: BinaryIO, number: Any) -> None:
        self._stream, self._id = stream, number
        self._last: tuple[str, int] | None = None

    def stage(self, stage: str, done: int = 0, of: int = 0) -> None:
        """Tell how far a stage is; `of` is 0 where nobody knows."""
        step = (stage, done * STEPS // of if of else 0)
        if step != self._last:
            self._last = step
            self._write(stage=stage, done=done, of=of)

    def result(self, result: dict[str, Any]) -> None:
        """Give the result."""
        self._write(result=result)

    def error(self, error: BaseException) -> None:
        """Say in one line what went wrong, and with which setting."""
        setting = error.name if isinstance(error, SettingError) else None
        self._write(error=" ".join(_words(error).split()), setting=setting)

    def _write(self, **what: Any) -> None:
        line = json.dumps({"id": self._id, **what}, ensure_ascii=False, allow_nan=False)
        self._stream.write(line.encode("utf-8", "surrogatepass") + b"\n")
        self._stream.flush()


def _words(error: BaseException) -> str:
    if isinstance(error, V3dcadError):
        return error.message
    if isinstance(error, MemoryError):
        return "not enough memory for this: take larger cells, or layers farther apart"
    if isinstance(error, OSError):
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{error.strerror or error}"
    return f"a fault of v3dcad, please report it: {type(error).__name__}: {error}"


def serve(requests: Iterable[bytes], stream: BinaryIO, folder: Path) -> None:
    """Answer lines of JSON in their order, with files in a folder, until there are no more."""
    kept, files = Kept(), Files(folder)
    try:
        for line in requests:
            _answer(line, stream, files, kept)
    except BrokenPipeError:
        pass  # nobody is left to be told anything


def _answer(line: bytes, stream: BinaryIO, files: Files, kept: Kept) -> None:
    number = None
    try:
        request = _parsed(line)
        number = request.get("id")
        answers = Answers(stream, number)
        with noted() as notes:
            result = Work(request, files, kept, answers.stage).result()
        answers.result({**result, "notes": notes})
    except Exception as error:  # whatever it is, somebody waits for an answer
        if not isinstance(error, (V3dcadError, MemoryError, OSError)):
            traceback.print_exc(file=sys.stderr)
        Answers(stream, number).error(error)


def _number(text: str) -> int | float:
    """A number of JSON; `ValueError` for one that is too large for a float, Infinity and NaN."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is no finite number")
    return int(text) if text.lstrip("-").isdecimal() else number


def _parsed(line: bytes) -> dict[str, Any]:
    try:
        request = json.loads(line, parse_int=_number, parse_float=_number, parse_constant=_number)
    except (ValueError, RecursionError) as error:
        raise V3dcadError(f"the request is not JSON ({error})") from error
    if not isinstance(request, dict):
        raise V3dcadError('the request is no object: write {"id": 1, "do": "hello"}')
    return request
