"""Draw the pictures of docs/gallery.md and docs/printing-well.md.

`python samples/gallery.py [BUNNY.stl] [NIST.stp]`, with PYTHONPATH=.:samples in a checkout.

The bunny and NIST's machined part are not in this repository; without their files, which any STL
and STEP may take the place of, their pictures stay as they are. The same bytes each time.
"""

from __future__ import annotations

import io
import sys
from itertools import product
from pathlib import Path

from PIL import Image
from thesis.recipes import Recipe, published

import v3dcad
from v3dcad import Structure
from v3dcad.view.figures import part_picture
from v3dcad.view.picture import choose

SAMPLES = Path(__file__).resolve().parent
GALLERY, PRINTING = (SAMPLES.parent / "docs" / name for name in ("gallery", "printing-well"))
SIZES, COLOURS, MOST = (640, 480, 360, 240), (48, 24, 16), 64_000
"""Pictures are kept as tall as this (pixels), in so many colours: of the first size that takes at
most so many bytes the most colours."""


def write(file: Path, data: bytes) -> None:
    """Keep a picture, small."""
    with Image.open(io.BytesIO(data)) as picture:
        drawn = picture.convert("RGB")
    for height, colours in product(SIZES, COLOURS):
        width = height * drawn.width // drawn.height
        small = drawn.resize((width, height), Image.Resampling.LANCZOS)
        kept = io.BytesIO()
        small.quantize(colours, dither=Image.Dither.NONE).save(kept, "PNG", optimize=True)
        if len(kept.getvalue()) <= MOST:
            break
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(kept.getvalue())


def draw_thesis(recipe: Recipe) -> None:
    """A part of the thesis from on top and in perspective, whole, as Figs. 4.1 to 4.19 have it."""
    structure = recipe.build()
    layers, mesh = choose(structure.layers).layers, structure.part.mesh()
    name = recipe.name.replace(" ", "-")
    for view, from_top in (("top", True), ("perspective", False)):
        picture = part_picture(layers, mesh, 0.0, from_top=from_top, whole=True)
        write(GALLERY / f"{name}-{view}.png", picture)


def draw_foam(name: str, structure: Structure) -> None:
    """A foam with a quarter cut away."""
    write(GALLERY / f"{name}.png", structure.picture())


def main(bunny: Path | None, machined: Path | None) -> None:
    """Draw all pictures whose parts there are."""
    for recipe in published(bunny):
        draw_thesis(recipe)
    bracket, pyramid = SAMPLES / "bracket.step", SAMPLES / "pyramid.step"
    draw_foam("bracket", v3dcad.fill(bracket, cell_size=6))
    draw_foam("graded-height", v3dcad.fill(pyramid, cell_size="ramp(z, 0, 50, 4, 12)"))
    draw_foam("graded-surface", v3dcad.fill(pyramid, cell_size="4 + 0.5 * surface()"))
    foam = v3dcad.fill(pyramid, cell_size=8)
    cell, neighbour = foam.layers[60].diagram.neighbours[60].tolist()
    for target in ("layer", "neighbours", "tree", "cut", "sizes", "overhang", "toolpath"):
        picture = foam.picture(target, 60, cell, neighbour, ids=target == "layer")
        write(GALLERY / f"target-{target}.png", picture)
    plain = v3dcad.fill(bracket)
    for name, layer in (("skin", 1), ("walls", 20), ("roof", 37)):
        write(PRINTING / f"{name}.png", plain.picture("toolpath", layer))
    if machined is not None:
        draw_foam("nist", v3dcad.fill(machined, layer_height=2.0))


if __name__ == "__main__":
    given = [Path(word) for word in sys.argv[1:]]
    main(
        next((file for file in given if file.suffix.lower() == ".stl"), None),
        next((file for file in given if file.suffix.lower() in (".stp", ".step")), None),
    )
