"""The stored pictures that those of today are compared with: `python -m tests.view.references`.

Look at them before they are committed.
"""

from __future__ import annotations

import io
from functools import cache
from pathlib import Path

import numpy as np
from PIL import Image

import v3dcad
from v3dcad import Structure
from v3dcad.model import Floats
from v3dcad.view.targets.declared import TARGETS

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(__file__).parent / "references"
LAYER, CELLS = 6, 3
PIXELS = 300


@cache
def pyramid() -> Structure:
    """The thesis's truncated pyramid with a foam of a few cells."""
    return v3dcad.fill(ROOT / "samples" / "pyramid.stl", cell_size=14, layer_height=2.0)


def picture(target: str) -> bytes:
    """A target of the pyramid, PNG."""
    cell, neighbour = pyramid().layers[LAYER].diagram.neighbours[CELLS].tolist()
    return pyramid().picture(target, LAYER, cell, neighbour, ids=True)


def small(data: bytes) -> Image.Image:
    """A picture in so few pixels that letters of another font make no difference."""
    image = Image.open(io.BytesIO(data)).convert("RGB")
    return image.resize((PIXELS * image.width // image.height, PIXELS), Image.Resampling.BOX)


def stored_picture(target: str) -> Image.Image:
    """The picture that was looked at."""
    with Image.open(FOLDER / f"{target}.png") as image:
        return image.convert("RGB")


def channels(image: Image.Image) -> Floats:
    """The colours (h, w, 3), 0 … 1, of a picture."""
    return np.asarray(image, np.float64) / 255


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for name in TARGETS:
        small(picture(name)).quantize(32).save(FOLDER / f"{name}.png", optimize=True)
