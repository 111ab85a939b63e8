"""What a page holds of a structure: arrays, and the words beside them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from v3dcad.model import Floats, Layer, Mesh, Toolpath
from v3dcad.settings import PrintSettings
from v3dcad.view.colours import COLOURS, RAMP
from v3dcad.view.page.document import document
from v3dcad.view.page.first import WHOLE, First
from v3dcad.view.page.motion import Motion, motion, motion_arrays
from v3dcad.view.page.packing import pack
from v3dcad.view.page.segments import UPRIGHT, Arrays, LayerArrays, layer_arrays
from v3dcad.view.targets.declared import TARGETS
from v3dcad.view.targets.shown import Lines
from v3dcad.view.targets.whole import Span, cut

MOST_SEGMENTS = 1_000_000
"""As many edges, and as many steps of a toolpath, a page holds; of more, layers are left out."""


def page(
    title: str,
    layers: Sequence[Layer],
    span: tuple[float, float],
    mesh: Mesh,
    facts: Mapping[str, str],
    toolpaths: Iterable[Toolpath] = (),
    printing: PrintSettings | None = None,
    first: First = WHOLE,
    *,
    most: int = MOST_SEGMENTS,
    live: int = 0,
) -> str:
    """A structure as one HTML file that needs nothing else, in bed coordinates.

    `span` is how high a layer is and where it begins (`FillSettings.layer_span`), `mesh` the part's
    surface, `facts` what is told of the structure, by name. The toolpath, one
    for each layer, was traced with the settings `printing`. Goes through the layers twice. Where
    they or their toolpaths have more than `most` segments, only every so many layers are shown,
    evenly, and the page says so. `first` is what it shows when it is opened;
    `live` the number of a page that is served, and hears of later ones.
    """
    layer_height, base = span
    every, volumes = _told(layers, layer_height)
    motions = _motions(toolpaths, printing or PrintSettings())
    edges, steps = sum(one.edges() for one in every), sum(len(one.points) for one in motions)
    step = max(math.ceil(max(edges, steps) / most), 1)
    bounds = np.array([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])
    arrays = layer_arrays(every[::step], bounds)
    arrays |= {
        "volumes": volumes.astype(np.float32),
        "site_heights": layers[0].state.sites[:, 2].astype(np.float32),
        "part_vertices": mesh.vertices.astype(np.float32),
        "part_triangles": mesh.triangles.astype(np.uint32),
        **_cut(layers, span),
        **(motion_arrays(motions[::step]) if motions else {}),
    }
    told = {
        "facts": [*facts.items(), ("cells", f"{np.count_nonzero(volumes)}")],
        "note": _thinned(step, len(every), max(edges, steps), most),
        "bounds": bounds.tolist(),
        "span": [base, base + layer_height * step],
        "last": len(every) - 1,
        "first": first.values(len(every), step, "layer" in TARGETS[first.target].asks),
        "steepest": _steepest(arrays),
        "colours": {**COLOURS, "ramp": RAMP},
        "targets": [[name, target.shows] for name, target in TARGETS.items()],
    }
    return document(title, told, pack(arrays), live=live)


def _told(layers: Iterable[Layer], layer_height: float) -> tuple[list[LayerArrays], Floats]:
    """What layers tell, and the volume of each site's cell (n,), mm³, over all of them."""
    every: list[LayerArrays] = []
    volumes = np.zeros(0)
    for layer in layers:
        areas = layer.diagram.areas(len(layer.state.sites))
        volumes = areas * layer_height + (volumes if every else 0.0)
        every.append(LayerArrays.of(layer))
    return every, volumes


def _motions(toolpaths: Iterable[Toolpath], printing: PrintSettings) -> list[Motion]:
    motions: list[Motion] = []
    before: Floats | None = None
    for toolpath in toolpaths:
        if before is None:
            before = toolpath.points[0] if len(toolpath.points) else np.zeros(3)
        motions.append(motion(toolpath, before, printing))
        before = motions[-1].points[-1]
    return motions


def _cut(layers: Sequence[Layer], span: Span) -> Arrays:
    """The lines of the vertical cut as x, y, z of both ends, mm."""
    shown = cut(layers, span)

    def ends(role: str) -> Floats:
        found: Floats = np.concatenate([_ends(one) for one in shown.lines if one.role == role])
        return found

    return {f"cut_{role}s": ends(role).astype(np.float32) for role in ("wall", "contour")}


def _ends(lines: Lines) -> Floats:
    return lines.points[lines.pairs].reshape(-1, 6)


def _steepest(arrays: Arrays) -> int:
    """Degrees from the vertical, of the wall that leans most."""
    return int(np.abs(arrays["wall_leans"].astype(int) - UPRIGHT).max(initial=0))


def _thinned(step: int, layers: int, segments: int, most: int) -> str:
    if step == 1:
        return ""
    shown = len(range(0, layers, step))
    return (
        f"Thinned: {shown} of {layers} layers are shown, one in {step}. All of them have "
        f"{segments:,} segments, and this page holds at most {most:,}. Volumes are those of all."
    )
