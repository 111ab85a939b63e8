"""What docs/ont.md shows is read, and says the truth."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

import v3dcad
from v3dcad import ont
from v3dcad.formats import numbers
from v3dcad.formats.ont import armor as packing
from v3dcad.formats.ont import document as form
from v3dcad.formats.ont import mesh_codec as mesh_code
from v3dcad.formats.ont import sections as ont_sections
from v3dcad.model import Checksum

TEXT = (Path(__file__).parent.parent / "docs" / "ont.md").read_text(encoding="utf-8")
EXACT, THESIS = re.findall(r"```ont\n(.*?)```", TEXT, re.S)


def test_the_exact_example_makes_its_structure(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "cone.ont").write_text(EXACT, encoding="utf-8")
    assert ont.check(tmp_path / "cone.ont")["result"] == "the structure is the one that was written"
    read = v3dcad.fill(tmp_path / "cone.ont")
    made = v3dcad.fill(samples / "cone.step", layer_height=0.5, cell_size=10, random_seed=3)
    assert read.checksum() == made.checksum()
    read.write_ont(tmp_path / "again.ont")
    assert (tmp_path / "again.ont").read_text(encoding="utf-8") == EXACT


def test_the_example_in_the_thesis_s_form_is_filled(tmp_path: Path) -> None:
    (tmp_path / "tetrahedron.ont").write_text(THESIS, encoding="utf-8")
    structure = v3dcad.fill(tmp_path / "tetrahedron.ont")
    assert structure.given.tolist() == [[-0.2, -0.2], [0.1, 0.25]]
    assert structure.settings.method == "thesis"
    assert np.ptp(structure.part.bounds, axis=0).tolist() == [1, 1, 1]
    assert len(structure.layers) == 4


def test_limits_and_names_are_those_of_the_code() -> None:
    assert form.MAX_FILE_BYTES == 256 << 20
    assert packing.MAX_UNPACKED_BYTES == 128 << 20
    assert mesh_code.MAX_TRIANGLES == 4_000_000
    assert form.MAX_SITES == 10_000_000
    assert ont_sections.MAX_SECTIONS == ont_sections.MAX_FIELDS == 200
    assert numbers.MAX_CHARACTERS == 800
    for word in (*Checksum.COUNTS, *Checksum.DIGITS, form.PACKING, form.OURS, form.BOUNDARY):
        assert f"`{word}`" in TEXT
