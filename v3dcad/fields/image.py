"""The grey of images as a field."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from v3dcad.errors import FormatError, SettingError
from v3dcad.model import Floats
from v3dcad.settings import Field

VIEWS = ("top", "front")
"""What an image shows: the part from above, its x and y; or from the front, its x and z."""

LARGEST = 100_000_000
"""Pixels."""


def image_field(paths: list[Path], view: str, box: Floats) -> Field:
    """The grey of an image stretched over the box (2, 3), mm: from 0, black, to 1, white.

    Of several, each shows the part from above at a height: the first at the bottom, the last at the
    top, the others evenly between. Raises `SettingError` for an unknown view, `FormatError` for
    what is not an image.
    """
    if view not in VIEWS:
        raise SettingError("cell_size", f"image: view {view!r}; give {' or '.join(VIEWS)}")
    if len(paths) > 1 and view != "top":
        raise SettingError("cell_size", "image: several images show the part from the top")
    stack = [_grey(path) for path in paths]
    if len({grey.shape for grey in stack}) > 1:
        raise SettingError("cell_size", "image: images of a stack must have the same size")
    # As (layer, row from below, column).
    greys = np.stack([grey[::-1] for grey in stack])
    across, up = (0, 1) if view == "top" else (0, 2)

    def field(x: Floats, y: Floats, z: Floats) -> Floats:
        from scipy.ndimage import map_coordinates

        at = np.stack([x, y, z], axis=-1)
        size = np.where(np.ptp(box, axis=0) > 0, np.ptp(box, axis=0), 1.0)
        share = np.clip((at - box[0]) / size, 0, 1)
        layers, rows, columns = greys.shape
        places = [
            share[..., 2] * (layers - 1),
            share[..., up] * rows - 0.5,
            share[..., across] * columns - 0.5,
        ]
        return np.asarray(map_coordinates(greys, places, order=1, mode="nearest"))

    return field


def _grey(path: Path) -> Floats:
    """The grey (rows, columns) of an image, from 0 to 1; where it is transparent, as on white."""
    from PIL import Image

    try:
        with Image.open(path) as image:
            if image.width * image.height > LARGEST:
                raise FormatError(f"over {LARGEST:,} pixels; make it smaller", path=str(path))
            return _levels(image)
    except FormatError:
        raise
    except OSError as error:
        reason = error.strerror or "not an image that can be read"
        raise FormatError(f"{reason}; give a PNG, TIFF or JPEG", path=str(path)) from error
    except Exception as error:  # Pillow raises what its decoders raise
        raise FormatError("not an image that can be read", path=str(path)) from error


def _levels(image: Any) -> Floats:
    from PIL import Image

    if image.mode.startswith("I;16") or image.mode == "I":
        return np.asarray(image, np.float64) / 65535
    if image.mode == "F":
        return np.clip(np.asarray(image, np.float64), 0, 1)
    white = Image.new("RGBA", image.size, "white")
    white.alpha_composite(image.convert("RGBA"))
    return np.asarray(white.convert("L"), np.float64) / 255
