"""An independent reading of absolute-E G-code: every move with its ends and its E."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass
class Moves:
    starts: np.ndarray
    """(m, 3) mm"""
    stops: np.ndarray
    """(m, 3) mm"""
    extruded: np.ndarray
    """(m,) mm of filament"""

    def printing(self) -> np.ndarray:
        return (self.extruded > 0) & np.any(self.starts != self.stops, axis=1)


def read_moves(text: str) -> Moves:
    position, e = [0.0, 0.0, 0.0], 0.0
    absolute = True
    rows = []
    for line in text.splitlines():
        words = line.split(";")[0].split()
        if not words:
            continue
        values = {word[0]: float(word[1:]) for word in words[1:] if len(word) > 1}
        if words[0] in ("G90", "G91"):
            absolute = words[0] == "G90"
        elif words[0] == "G92":
            e = values["E"]
        elif words[0] in ("G0", "G1"):
            start = list(position)
            for axis, letter in enumerate("XYZ"):
                if letter in values:
                    position[axis] = values[letter] + (0 if absolute else position[axis])
            after = values.get("E", e)
            rows.append((start, list(position), after - e))
            e = after
    return Moves(*(np.array(column) for column in zip(*rows, strict=True)))
