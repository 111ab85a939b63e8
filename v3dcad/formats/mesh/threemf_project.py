"""3MF for slicers: the part, and in it its foam as a modifier that is filled wall by wall.

In the foam the part is filled by 100 % with lines along the walls ("concentric"), which the
slicer's Arachne engine lays as one bead or two, as wide as the walls are; elsewhere it is empty.
Perimeters and skins are the slicer's.

No one model does for all slicers: PrusaSlicer takes the volumes of an object as ranges of one
mesh's triangles, OrcaSlicer as components, each a mesh of its own; what each is, and its settings,
stand in a file beside the model, with names of the slicer's own. So the package holds both, and by
their sources each slicer comes across one of them:

- PrusaSlicer before 2.7.2 reads what is called `.model` in the folder 3D, later ones all that is
  called so: the second model must not be. What the package names as its model is the first one, so
  that viewers, too, see what they see of PrusaSlicer's projects.
- OrcaSlicer (and Bambu Studio, from which it has its reader) takes the first relation whose type
  begins and ends as that of a model does; others know no such relation, and pass it over. Where
  the application is PrusaSlicer, it would take the first model, and drop all settings.
"""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

from v3dcad.formats.mesh.threemf_reader import MODEL
from v3dcad.formats.mesh.threemf_roles import BAMBU, PRUSA
from v3dcad.model import Mesh
from v3dcad.settings import PrintSettings

XML = '<?xml version="1.0" encoding="UTF-8"?>\n'
CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
SLIC3R = "http://schemas.slic3r.org/3mf/2017/06"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
TYPES = f"""{XML}<Types xmlns="{PACKAGE}/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
<Default Extension="config" ContentType="application/xml"/>
<Default Extension="xml" ContentType="application/xml"/>
</Types>
"""
RANGES, PARTS = "3D/3dmodel.model", "OrcaSlicer/3dmodel.xml"
"""The model whose volumes are ranges of triangles, and the one whose volumes are components."""
PARTS_RELATION = "http://schemas.microsoft.com/3dmanufacturing/OrcaSlicer/3dmodel"
"""A relation of no standard, which OrcaSlicer takes for that of a model."""
RELATIONS = f"""{XML}<Relationships xmlns="{PACKAGE}/relationships">
<Relationship Target="/{PARTS}" Id="parts" Type="{PARTS_RELATION}"/>
<Relationship Target="/{RANGES}" Id="model" Type="{MODEL}"/>
</Relationships>
"""
BEGINNING = (1980, 1, 1, 0, 0, 0)
"""The time of files in the archive: the earliest there is, so that the bytes are the same."""
SLIC3R_VERSION = "1"
"""Without it, PrusaSlicer puts volumes elsewhere, as old versions did."""
IDENTITY = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"

PART, FOAM, OBJECT = "2", "3", "4"
"""Numbers of objects in the model of components; that of ranges has one, 1."""


def write_project(path: Path, part: Mesh, foam: Mesh, name: str, layer_height: float) -> None:
    """Write a part and, as a modifier, its foam: closed meshes, mm, bed coordinates.

    They lie in the middle of the default printer's bed, with its perimeters and skins. The same
    meshes give the same bytes.
    """
    printing = PrintSettings()
    width, depth = printing.bed_size()
    centre, vertices = (width / 2, depth / 2), (_vertices(part), _vertices(foam))
    shells, filled = _shells(printing, layer_height), _filled(printing)
    with zipfile.ZipFile(path, "w") as archive:
        for file, text in {
            "[Content_Types].xml": TYPES,
            "_rels/.rels": RELATIONS,
            RANGES: _ranges_model(part, foam, vertices, centre),
            PRUSA: _ranges_settings(part, foam, name, shells, filled),
            PARTS: _parts_model(part, foam, vertices, centre),
            BAMBU: _parts_settings(name, shells, filled),
        }.items():
            entry = zipfile.ZipInfo(file, BEGINNING)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)


class Told(NamedTuple):
    """A setting by its names in both slicers; `None` where one needs no such setting."""

    prusa: str | None
    orca: str
    value: str


def _shells(printing: PrintSettings, layer_height: float) -> list[Told]:
    """What holds for the whole part: shells as v3dcad prints them by default, else nothing."""
    below, above = printing.solid_layers()
    return [
        Told("layer_height", "layer_height", f"{layer_height:g}"),
        Told("perimeters", "wall_loops", str(printing.perimeters)),
        Told("bottom_solid_layers", "bottom_shell_layers", str(below)),
        Told("top_solid_layers", "top_shell_layers", str(above)),
        Told("fill_density", "sparse_infill_density", "0%"),
        Told("perimeter_generator", "wall_generator", "arachne"),
    ]


def _filled(printing: PrintSettings) -> list[Told]:
    """What holds in the foam: lines no wider than a wall of one bead, which else is left out."""
    width = f"{printing.bead_width:g}"
    return [
        Told("fill_density", "sparse_infill_density", "100%"),
        Told("fill_pattern", "sparse_infill_pattern", "concentric"),
        Told("infill_extrusion_width", "sparse_infill_line_width", width),
        # OrcaSlicer takes an infill of 100 % for solid.
        Told(None, "internal_solid_infill_pattern", "concentric"),
        Told(None, "internal_solid_infill_line_width", width),
        Told("solid_infill_below_area", "minimum_sparse_infill_area", "0"),
    ]


def _prusa(settings: list[Told]) -> dict[str, str]:
    return {told.prusa: told.value for told in settings if told.prusa}


def _orca(settings: list[Told]) -> dict[str, str]:
    return {told.orca: told.value for told in settings}


def _ranges_settings(
    part: Mesh, foam: Mesh, name: str, shells: list[Told], filled: list[Told]
) -> str:
    """What PrusaSlicer is told."""
    outside = {"name": name, "volume_type": "ModelPart", "matrix": IDENTITY}
    inside = {"name": "foam", "volume_type": "ParameterModifier", "matrix": IDENTITY}
    count, last = len(part.triangles), len(part.triangles) + len(foam.triangles) - 1
    return (
        f'{XML}<config>\n<object id="1">\n{_rows({"name": name} | _prusa(shells), "object")}'
        f'<volume firstid="0" lastid="{count - 1}">\n{_rows(outside, "volume")}</volume>\n'
        f'<volume firstid="{count}" lastid="{last}">\n'
        f"{_rows(inside | _prusa(filled), 'volume')}</volume>\n"
        "</object>\n</config>\n"
    )


def _parts_settings(name: str, shells: list[Told], filled: list[Told]) -> str:
    """What OrcaSlicer is told."""
    titled = {"name": name}
    return (
        f'{XML}<config>\n<object id="{OBJECT}">\n{_rows(titled | _orca(shells))}'
        f'<part id="{PART}" subtype="normal_part">\n{_rows(titled)}</part>\n'
        f'<part id="{FOAM}" subtype="modifier_part">\n'
        f"{_rows({'name': 'foam'} | _orca(filled))}</part>\n"
        "</object>\n</config>\n"
    )


def _rows(values: Mapping[str, str], kind: str | None = None) -> str:
    of = f'type="{kind}" ' if kind else ""
    return "".join(
        f"<metadata {of}key={quoteattr(key)} value={quoteattr(value)}/>\n"
        for key, value in values.items()
    )


def _ranges_model(
    part: Mesh, foam: Mesh, vertices: tuple[str, str], centre: tuple[float, float]
) -> str:
    """The model with both meshes as one."""
    triangles = _triangles(part, 0) + _triangles(foam, len(part.vertices))
    return _model(_object("1", _mesh("".join(vertices), triangles)), "1", centre)


def _parts_model(
    part: Mesh, foam: Mesh, vertices: tuple[str, str], centre: tuple[float, float]
) -> str:
    """The model with each mesh an object, and an object made of both."""
    meshes = "".join(
        _object(number, _mesh(corners, _triangles(mesh, 0)))
        for number, corners, mesh in zip((PART, FOAM), vertices, (part, foam), strict=True)
    )
    both = "".join(f'<component objectid="{number}"/>\n' for number in (PART, FOAM))
    whole = _object(OBJECT, f"<components>\n{both}</components>\n")
    return _model(meshes + whole, OBJECT, centre)


def _model(objects: str, built: str, centre: tuple[float, float]) -> str:
    """A model of objects, of which the one with the number `built` is printed around a centre."""
    x, y = centre
    return (
        f'{XML}<model unit="millimeter" xml:lang="en-US" xmlns="{CORE}" '
        f'xmlns:slic3rpe="{SLIC3R}">\n'
        f'<metadata name="slic3rpe:Version3mf">{SLIC3R_VERSION}</metadata>\n'
        '<metadata name="Application">v3dcad</metadata>\n'
        f"<resources>\n{objects}</resources>\n"
        f'<build>\n<item objectid="{built}" transform="1 0 0 0 1 0 0 0 1 {x:g} {y:g} 0"/>\n'
        "</build>\n</model>\n"
    )


def _object(number: str, held: str) -> str:
    return f'<object id="{number}" type="model">\n{held}</object>\n'


def _mesh(vertices: str, triangles: str) -> str:
    return (
        f"<mesh>\n<vertices>\n{vertices}</vertices>\n"
        f"<triangles>\n{triangles}</triangles>\n</mesh>\n"
    )


def _vertices(mesh: Mesh) -> str:
    return "".join(
        f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>\n' for x, y, z in mesh.vertices.tolist()
    )


def _triangles(mesh: Mesh, first: int) -> str:
    return "".join(
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>\n' for a, b, c in (mesh.triangles + first).tolist()
    )
