"""Explicit sites from a CSV file of x and y in mm, in bed coordinates."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.model import Floats


def read_sites(path: Path) -> Floats:
    """Sites (n, 2), mm, one `x,y` a line; a first line without numbers is taken as a heading.

    Further columns are an error, so that a list of X,Y,Z is not misread.
    """
    sites: list[tuple[float, float]] = []
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            for number, row in enumerate(csv.reader(file), start=1):
                if not row:
                    continue
                try:
                    x, y = map(float, row)
                except ValueError:
                    if number == 1:
                        continue
                    raise FormatError(
                        "write one `x,y` in mm", path=str(path), line=number
                    ) from None
                if not (math.isfinite(x) and math.isfinite(y)):
                    raise FormatError(
                        "a coordinate is not a finite number", path=str(path), line=number
                    )
                sites.append((x, y))
    except (UnicodeDecodeError, csv.Error) as error:
        raise FormatError(f"not a CSV text file ({error})", path=str(path)) from error
    if not sites:
        raise FormatError("contains no sites; write one `x,y` in mm a line", path=str(path))
    return np.array(sites)
