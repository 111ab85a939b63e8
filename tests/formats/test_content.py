"""A file that holds something else than its name says is told for what it holds."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from build123d import Box, export_stl
from OCP.BRepTools import BRepTools

from v3dcad.errors import FormatError
from v3dcad.parts import part_from

POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"
TEXTS = {
    "a pointer of Git LFS: .*git lfs pull": POINTER,
    "a web page: download the file": b"\n<!DOCTYPE html>\n<html><body>404</body></html>",
    "G-code: give the part": b";FLAVOR:Marlin\nG21\nG28\n",
    "a picture or a document": b"\x89PNG\r\n\x1a\n" + bytes(100),
}


@pytest.mark.parametrize("ending", ["stl", "obj", "3mf", "step", "brep"])
@pytest.mark.parametrize("words", TEXTS)
def test_no_part_is_told_for_what_it_is(words: str, ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"part.{ending}"
    path.write_bytes(TEXTS[words])
    with pytest.raises(FormatError, match=rf"part\.{ending}: holds {words}"):
        part_from(path)


@pytest.mark.parametrize("ending", ["stl", "obj", "3mf", "step", "brep"])
def test_a_part_with_another_ending_is_told_its_own(
    ending: str, samples: Path, tmp_path: Path
) -> None:
    BRepTools.Write_s(Box(1, 1, 1).wrapped, str(tmp_path / "box.brep"))
    with zipfile.ZipFile(tmp_path / "box.3mf", "w") as archive:
        archive.writestr("read me", "nothing")
    (tmp_path / "box.stl").write_text("solid box\nendsolid\n")
    files = {"step": samples / "wedge.step"}
    files |= {own: tmp_path / f"box.{own}" for own in ("brep", "3mf", "stl")}
    for own, file in files.items():
        if own != ending:
            path = tmp_path / f"other.{ending}"
            path.write_bytes(file.read_bytes())
            with pytest.raises(FormatError, match=rf"other\.{ending}: holds .*name it \.{own}"):
                part_from(path)


def test_what_begins_like_another_but_can_be_read_is_read(tmp_path: Path) -> None:
    """The 80 bytes at the head of a binary STL may say anything."""
    path = tmp_path / "part.stl"
    assert export_stl(Box(1, 1, 1), path)
    path.write_bytes(b"PK\x03\x04".ljust(80) + path.read_bytes()[80:])
    assert part_from(path).contents()["volume"] == "1 mm³"
