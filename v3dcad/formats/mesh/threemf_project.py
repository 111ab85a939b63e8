"""3MF for slicers: the part, and in it its foam as a modifier that is filled wall by wall.

PrusaSlicer lists the volumes of an object, and their settings, in a file of its own beside the
model. In the foam the part is filled by 100 % with lines along the walls ("concentric"), which the
slicer's Arachne engine lays as one bead or two, as wide as the walls are; elsewhere it is empty.
Perimeters and skins are the slicer's.

OrcaSlicer and Bambu Studio read such a file in the same way if the name of the application that
wrote it has PrusaSlicer in it. Their names of the settings stand beside PrusaSlicer's; each slicer
passes over names that it does not know.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

from v3dcad.formats.mesh.threemf_reader import MODEL
from v3dcad.formats.mesh.threemf_roles import PRUSA
from v3dcad.model import Floats, Mesh
from v3dcad.settings import PrintSettings

XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
SLIC3R = "http://schemas.slic3r.org/3mf/2017/06"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
TYPES = f"""{XML}<Types xmlns="{PACKAGE}/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
RELATIONS = f"""{XML}<Relationships xmlns="{PACKAGE}/relationships">
<Relationship Target="/3D/3dmodel.model" Id="model" Type="{MODEL}"/>
</Relationships>
"""
BEGINNING = (1980, 1, 1, 0, 0, 0)
"""The time of files in the archive: the earliest there is, so that the bytes are the same."""
SLIC3R_VERSION = "1"
"""Without it, PrusaSlicer puts volumes elsewhere, as old versions did."""
IDENTITY = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"

FOAM = {
    "fill_density": "100%",
    "fill_pattern": "concentric",
    "solid_infill_below_area": "0",
    "sparse_infill_density": "100%",
    "sparse_infill_pattern": "concentric",
    "minimum_sparse_infill_area": "0",
}
"""Settings of the foam, in the words of PrusaSlicer and then of OrcaSlicer."""


def write_project(path: Path, part: Mesh, foam: Mesh, name: str, layer_height: float) -> None:
    """Write a part and, as a modifier, its foam: closed meshes, mm, bed coordinates.

    They lie in the middle of the default printer's bed, with its perimeters and skins. The same
    meshes give the same bytes.
    """
    printing = PrintSettings()
    count, last = len(part.triangles), len(part.triangles) + len(foam.triangles) - 1
    whole = _told("object", {"name": name, **_shells(layer_height)})
    inside = {"name": "foam", "volume_type": "ParameterModifier", "matrix": IDENTITY, **FOAM}
    outside = {"name": name, "volume_type": "ModelPart", "matrix": IDENTITY}
    volumes = (
        f'<config>\n<object id="1">\n{whole}'
        f'<volume firstid="0" lastid="{count - 1}">\n{_told("volume", outside)}</volume>\n'
        f'<volume firstid="{count}" lastid="{last}">\n{_told("volume", inside)}</volume>\n'
        "</object>\n</config>\n"
    )
    width, depth = printing.bed_size()
    with zipfile.ZipFile(path, "w") as archive:
        for file, text in {
            "[Content_Types].xml": TYPES,
            "_rels/.rels": RELATIONS,
            "3D/3dmodel.model": XML + _model(part, foam, width / 2, depth / 2),
            PRUSA: XML + volumes,
        }.items():
            entry = zipfile.ZipInfo(file, BEGINNING)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)


def _shells(layer_height: float) -> dict[str, str]:
    """Settings of the whole object: shells as v3dcad prints them by default, nothing in between."""
    printing = PrintSettings()
    height, walls = f"{layer_height:g}", str(printing.perimeters)
    below, above = (str(count) for count in printing.solid_layers())
    return {
        "layer_height": height,
        "perimeters": walls,
        "bottom_solid_layers": below,
        "top_solid_layers": above,
        "fill_density": "0%",
        "perimeter_generator": "arachne",
        "wall_loops": walls,
        "bottom_shell_layers": below,
        "top_shell_layers": above,
        "sparse_infill_density": "0%",
        "wall_generator": "arachne",
    }


def _told(kind: str, values: Mapping[str, str]) -> str:
    return "".join(
        f'<metadata type="{kind}" key="{key}" value={quoteattr(value)}/>\n'
        for key, value in values.items()
    )


def _model(part: Mesh, foam: Mesh, x: float, y: float) -> str:
    """The model with both meshes as one, since the volumes are ranges of its triangles."""
    return (
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}" '
        f'xmlns:slic3rpe="{SLIC3R}">\n'
        f'<metadata name="slic3rpe:Version3mf">{SLIC3R_VERSION}</metadata>\n'
        '<metadata name="Application">v3dcad, a project for PrusaSlicer</metadata>\n'
        '<resources>\n<object id="1" type="model">\n<mesh>\n<vertices>\n'
        f"{_vertices(part.vertices)}{_vertices(foam.vertices)}</vertices>\n<triangles>\n"
        f"{_triangles(part, 0)}{_triangles(foam, len(part.vertices))}</triangles>\n</mesh>\n"
        "</object>\n</resources>\n"
        f'<build>\n<item objectid="1" transform="1 0 0 0 1 0 0 0 1 {x:g} {y:g} 0"/>\n</build>\n'
        "</model>\n"
    )


def _vertices(points: Floats) -> str:
    return "".join(
        f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>\n' for x, y, z in points.tolist()
    )


def _triangles(mesh: Mesh, first: int) -> str:
    return "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in (mesh.triangles + first).tolist()
    )
