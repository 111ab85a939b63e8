"""Whole pictures as the bytes of PNG or SVG files: what is drawn, under its title.

The same input gives the same bytes. No display is needed, and neither the user's matplotlib
settings nor what others drew before have a say.
"""

from __future__ import annotations

import io
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from v3dcad.model import Floats, Layer, Mesh
from v3dcad.view import drawing, picture
from v3dcad.view.targets.shown import Preview
from v3dcad.view.targets.sizes import SizeDistribution

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI = 150
"""Pixels per inch of PNG files, and of what is painted within SVG files."""

SIDE, FLATTEST, WORDS = 8.0, 3.0, 1.2
"""Inches: how wide a picture is, and how tall at most and at least; one with two panels is wider.
What words and axes need of the height."""

LETTERS_IN_LINE = 88
"""About how many letters of a title fit into a line."""


def part_picture(
    layers: Sequence[Layer],
    part: Mesh,
    base: float,
    name: str = "",
    facts: str = "",
    kind: str = "png",
    *,
    pixels: int = 1200,
    from_top: bool = False,
    whole: bool = False,
    tilts: bool = False,
) -> bytes:
    """A filled part in space, of layers and a part in bed coordinates; see `picture.draw`.

    `name` and `facts` are its title; a picture without a name, such as a thumbnail, has none, and
    is square.
    """
    width = pixels / DPI
    seen, _ = picture.eye_on(part, from_top).seen(part.vertices)
    with _figure(width, _height(seen, width) if name else width) as figure:
        axes = figure.add_subplot()
        scale = picture.draw(axes, layers, part, base, from_top=from_top, whole=whole, tilts=tilts)
        if scale is not None:
            drawing.draw_scale(axes, scale)
            facts = f"walls lean up to {scale.high:.1f}{scale.unit}; {facts}"
        if name:
            figure.suptitle(_title(name, facts))
        return _bytes(figure, kind)


def plane_picture(
    shown: Preview,
    name: str,
    kind: str = "png",
    *,
    ids: bool = False,
    distribution: SizeDistribution | None = None,
) -> bytes:
    """What a target shows of a layer, or of a cut, in bed coordinates; see `drawing.draw`.

    With a `distribution` a second panel shows the sizes of cells over the height.
    """
    panels = 1 if distribution is None else 2
    drawn = np.concatenate([one.points for one in shown.lines])[:, drawing.plane_of(shown)]
    height = SIDE if distribution is not None else _height(drawn, SIDE)
    with _figure(SIDE + 4 * (panels - 1), height) as figure:
        axes, *others = figure.subplots(1, panels, squeeze=False, width_ratios=[2, 1][:panels])[0]
        drawing.draw(axes, shown, ids)
        if shown.scale is not None:
            drawing.draw_scale(axes, shown.scale)
        for other in others:
            assert distribution is not None
            drawing.draw_sizes(other, distribution, float(shown.labels.points[0, 2]))
        figure.suptitle(_title(name, shown.title))
        return _bytes(figure, kind)


def _height(points: Floats, width: float) -> float:
    """Inches: how tall a picture of so many is in which points (n, 2) are to be seen."""
    if not len(points):
        return width
    across, upwards = np.ptp(points, axis=0).tolist()
    share = upwards / across if across > 0 else 1.0
    return float(np.clip(width * share + WORDS, min(FLATTEST, width), width))


def _title(name: str, facts: str) -> str:
    """A name, which may hold any letters, above what is told of it."""
    lines = [*textwrap.wrap(name, LETTERS_IN_LINE), *textwrap.wrap(facts, LETTERS_IN_LINE)]
    return "\n".join(lines)


@contextmanager
def _figure(width: float, height: float) -> Iterator[Figure]:
    """A figure of so many inches, drawn with matplotlib's own settings, whatever the user's are."""
    import matplotlib
    from matplotlib.figure import Figure

    own: Any = {
        "axes.spines.right": False,
        "axes.spines.top": False,
        "figure.titlesize": 12,
        "savefig.dpi": DPI,
        "svg.fonttype": "none",
        "svg.hashsalt": "v3dcad",
        "text.parse_math": False,
    }
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(own)
        yield Figure(figsize=(width, height), dpi=DPI, layout="constrained")


def _bytes(figure: Figure, kind: str) -> bytes:
    stream = io.BytesIO()
    unnamed = {"Software": None} if kind == "png" else {"Date": None, "Creator": None}
    figure.savefig(stream, format=kind, metadata=unnamed)
    return stream.getvalue()
