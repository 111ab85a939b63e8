"""The files that answers name: arrays and lines, a new name for each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from v3dcad.errors import V3dcadError
from v3dcad.model import Floats


class Files:
    """Files of one answer after the other in a folder; whoever reads them may delete them."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._made = 0

    def new(self, ending: str) -> Path:
        """A path that no answer has named before."""
        self._made += 1
        return self._folder / f"{self._made}{ending}"

    def points(self, points: Floats) -> str:
        """Write points as `.npy`, float32."""
        return self._array(points.astype(np.float32))

    def pairs(self, pairs: NDArray[Any]) -> str:
        """Write whole numbers as `.npy`, int32."""
        return self._array(pairs.astype(np.int32))

    def sites(self, sites: Floats) -> str:
        """Write sites as `.npy`, float64: to the last bit."""
        return self._array(sites)

    def lines(self, points: Floats, pairs: NDArray[Any], layer: NDArray[Any]) -> str:
        """Write lines as `.npz`: points float32, the rest int32."""
        return self.named(
            {
                "points": points.astype(np.float32),
                "pairs": pairs.astype(np.int32),
                "layer": layer.astype(np.int32),
            }
        )

    def named(self, arrays: dict[str, Any]) -> str:
        """Write arrays by their names as `.npz`, not compressed."""
        path = self.new(".npz")
        np.savez(path, **arrays)
        return str(path)

    def _array(self, array: NDArray[Any]) -> str:
        path = self.new(".npy")
        np.save(path, array)
        return str(path)


def read_array(path: str) -> NDArray[Any]:
    """An array in an `.npy` file; `V3dcadError` where there is none."""
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except (OSError, ValueError) as error:
        raise V3dcadError(f"{path}: cannot be read as an array ({error})") from error
