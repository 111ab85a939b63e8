"""Draw the pictures of docs/gallery.md: `python samples/gallery.py [BUNNY.stl] [NIST.stp]`.

The bunny and NIST's machined part are not in this repository; without their files, which any STL
and STEP may take the place of, their pictures stay as they are. The same bytes each time.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

from PIL import Image
from thesis.recipes import Recipe, published

import v3dcad
from v3dcad import Structure
from v3dcad.view.figures import part_picture
from v3dcad.view.picture import choose

SAMPLES = Path(__file__).resolve().parent
FOLDER = SAMPLES.parent / "docs" / "gallery"
SIZES, COLOURS, MOST = (640, 480, 360, 240), 48, 64_000
"""Pictures are kept as tall as this (pixels), in so many colours: the first size that takes at most
so many bytes."""


def write(name: str, data: bytes) -> None:
    """Keep a picture, small."""
    with Image.open(io.BytesIO(data)) as picture:
        drawn = picture.convert("RGB")
    for height in SIZES:
        width = height * drawn.width // drawn.height
        small = drawn.resize((width, height), Image.Resampling.LANCZOS)
        kept = io.BytesIO()
        small.quantize(COLOURS, dither=Image.Dither.NONE).save(kept, "PNG", optimize=True)
        if len(kept.getvalue()) <= MOST:
            break
    (FOLDER / f"{name}.png").write_bytes(kept.getvalue())


def draw_thesis(recipe: Recipe) -> None:
    """A part of the thesis from on top and in perspective, whole, as Figs. 4.1 to 4.19 have it."""
    structure = recipe.build()
    layers, mesh = choose(structure.layers).layers, structure.part.mesh()
    name = recipe.name.replace(" ", "-")
    for view, from_top in (("top", True), ("perspective", False)):
        write(f"{name}-{view}", part_picture(layers, mesh, 0.0, from_top=from_top, whole=True))


def draw_foam(name: str, structure: Structure) -> None:
    """A foam with a quarter cut away."""
    write(name, structure.picture())


def main(bunny: Path | None, machined: Path | None) -> None:
    """Draw all pictures whose parts there are."""
    FOLDER.mkdir(exist_ok=True)
    for recipe in published(bunny):
        draw_thesis(recipe)
    bracket, pyramid = SAMPLES / "bracket.step", SAMPLES / "pyramid.step"
    draw_foam("bracket", v3dcad.fill(bracket, cell_size=6))
    draw_foam("graded-height", v3dcad.fill(pyramid, cell_size="ramp(z, 0, 50, 4, 12)"))
    draw_foam("graded-surface", v3dcad.fill(pyramid, cell_size="4 + 0.5 * surface()"))
    foam = v3dcad.fill(pyramid, cell_size=8)
    cell, neighbour = foam.layers[60].diagram.neighbours[60].tolist()
    for target in ("layer", "neighbours", "tree", "cut", "sizes", "overhang", "toolpath"):
        write(f"target-{target}", foam.picture(target, 60, cell, neighbour, ids=target == "layer"))
    if machined is not None:
        draw_foam("nist", v3dcad.fill(machined, layer_height=2.0))


if __name__ == "__main__":
    given = [Path(word) for word in sys.argv[1:]]
    main(
        next((file for file in given if file.suffix.lower() == ".stl"), None),
        next((file for file in given if file.suffix.lower() in (".stp", ".step")), None),
    )
