"""Explicit sites from a CSV file of x, y and z in mm, in bed coordinates."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from v3dcad.errors import FormatError
from v3dcad.model import Floats
from v3dcad.words import counted


def read_sites(path: Path) -> Floats:
    """Sites (n, 3), mm, one `x,y,z` a line, or (n, 2), one `x,y` a line for columns.

    A first line without numbers is taken as a heading. Lines of different lengths are an error.
    """
    sites: list[list[float]] = []
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            for number, row in enumerate(csv.reader(file), start=1):
                if not row:
                    continue
                try:
                    site = [float(word) for word in row]
                except ValueError:
                    if number == 1:
                        continue
                    site = []
                if len(site) not in (2, 3):
                    raise FormatError(
                        "write one `x,y,z` in mm, or `x,y` for columns", path=str(path), line=number
                    )
                if sites and len(site) != len(sites[0]):
                    raise FormatError(
                        f"{counted(len(site), 'number')}; lines before have {len(sites[0])}",
                        path=str(path), line=number,
                    )  # fmt: skip
                if not all(map(math.isfinite, site)):
                    raise FormatError(
                        "a coordinate is not a finite number", path=str(path), line=number
                    )
                sites.append(site)
    except (UnicodeDecodeError, csv.Error) as error:
        raise FormatError(f"not a CSV text file ({error})", path=str(path)) from error
    if not sites:
        raise FormatError("contains no sites; write one `x,y,z` in mm a line", path=str(path))
    return np.array(sites)
