"""What is no material in a 3MF: left out or subtracted, and told; volumes by trimesh's booleans."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

import v3dcad
from tests.test_parts import threemf, volume

BLOCK, PEG = trimesh.creation.box((10, 10, 10)), trimesh.creation.icosphere(2, 4)
PEG.apply_translation((4, 0, 0))
LESS = trimesh.boolean.difference([BLOCK, PEG]).volume


def mesh(*bodies: trimesh.Trimesh) -> str:
    whole = trimesh.util.concatenate(list(bodies))
    corners = "".join(
        f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in whole.vertices.tolist()
    )
    rows = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in whole.faces.tolist())
    return f"<mesh><vertices>{corners}</vertices><triangles>{rows}</triangles></mesh>"


def thing(number: int, content: str, kind: str = "model", more: str = "") -> str:
    return f'<object id="{number}" type="{kind}" {more}>{content}</object>'


def components(*numbers: int) -> str:
    inner = "".join(f'<component objectid="{number}"/>' for number in numbers)
    return f"<components>{inner}</components>"


def with_file(path: Path, name: str, text: str) -> Path:
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(name, text)
    return path


PRUSA_KINDS = ["NegativeVolume", "ParameterModifier", "SupportBlocker", "SupportEnforcer"]
BAMBU_KINDS = ["negative_part", "modifier_part", "support_blocker", "support_enforcer"]


@pytest.mark.parametrize("kind", PRUSA_KINDS)
def test_volumes_of_prusaslicer(kind: str, tmp_path: Path) -> None:
    path = threemf(tmp_path / "a.3mf", thing(1, mesh(BLOCK, PEG)), '<item objectid="1"/>')
    block, peg = len(BLOCK.faces), len(PEG.faces)
    rows = [(0, block - 1, "ModelPart"), (block, block + peg - 1, kind)]
    volumes = "".join(
        f'<volume firstid="{first}" lastid="{last}"><metadata type="volume" key="volume_type" '
        f'value="{role}"/></volume>'
        for first, last, role in rows
    )
    text = f'<config><object id="1" instances_count="1">{volumes}</object></config>'
    part = v3dcad.part_from(with_file(path, "Metadata/Slic3r_PE_model.config", text))
    negative = kind == "NegativeVolume"
    assert volume(part) == pytest.approx(LESS if negative else 1000, rel=1e-5)
    told = "subtracted 1 negative volume" if negative else "left out 1 modifier"
    assert part.findings == (told,)


@pytest.mark.parametrize("kind", BAMBU_KINDS)
def test_parts_of_orca_and_bambu(kind: str, tmp_path: Path) -> None:
    objects = thing(1, mesh(BLOCK)) + thing(2, mesh(PEG)) + thing(3, components(1, 2))
    path = threemf(tmp_path / "a.3mf", objects, '<item objectid="3"/>')
    text = f'<config><object id="3"><part id="1"/><part id="2" subtype="{kind}"/></object></config>'
    part = v3dcad.part_from(with_file(path, "Metadata/model_settings.config", text))
    negative = kind == "negative_part"
    assert volume(part) == pytest.approx(LESS if negative else 1000, rel=1e-5)
    told = "subtracted 1 negative volume" if negative else "left out 1 modifier"
    assert part.findings == (told,)


@pytest.mark.parametrize(
    ("kind", "says"),
    [
        ("other", "left out 1 'other' object"),
        ("surface", "left out 1 'surface' object"),
        ("solidsupport", "left out 1 support object"),
    ],
)
def test_objects_that_are_no_model(kind: str, says: str, tmp_path: Path) -> None:
    objects = thing(1, mesh(BLOCK)) + thing(2, mesh(PEG), kind) + thing(3, components(1, 2))
    part = v3dcad.part_from(threemf(tmp_path / "a.3mf", objects, '<item objectid="3"/>'))
    assert volume(part) == pytest.approx(1000)
    assert part.findings == (says,)


def test_items_that_are_not_printed(tmp_path: Path) -> None:
    objects = thing(1, mesh(BLOCK)) + thing(2, mesh(PEG))
    items = '<item objectid="1"/><item objectid="2" printable="0"/>'
    part = v3dcad.part_from(threemf(tmp_path / "a.3mf", objects, items))
    assert volume(part) == pytest.approx(1000)
    assert part.bounds == pytest.approx(np.array([[-5, -5, -5], [5, 5, 5]]))
    assert part.findings == ("left out 1 unprintable object",)


def test_what_is_no_mesh_is_told(tmp_path: Path) -> None:
    schema = "http://schemas.microsoft.com/3dmanufacturing"
    beams = (
        f'<mesh><vertices/><triangles/><beamlattice xmlns="{schema}/beamlattice/2017/02"/></mesh>'
    )
    path = threemf(tmp_path / "a.3mf", thing(1, beams), '<item objectid="1"/>')
    with pytest.raises(v3dcad.FormatError, match=r"no triangles .*left out 1 beam lattice"):
        v3dcad.part_from(path)
    stack = f'xmlns:s="{schema}/slice/2015/07" s:slicestackid="7"'
    path = threemf(tmp_path / "b.3mf", thing(1, mesh(BLOCK), more=stack), '<item objectid="1"/>')
    part = v3dcad.part_from(path)
    assert volume(part) == pytest.approx(1000)
    assert part.findings == ("left out 1 slice stack",)


def test_a_damaged_list_of_roles_is_told(tmp_path: Path) -> None:
    path = threemf(tmp_path / "a.3mf", thing(1, mesh(BLOCK)), '<item objectid="1"/>')
    with pytest.raises(v3dcad.FormatError, match="damaged"):
        v3dcad.part_from(with_file(path, "Metadata/Slic3r_PE_model.config", "<config><object"))
