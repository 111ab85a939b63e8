"""The picture of the rooms shows the source as it is."""

from __future__ import annotations

import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest

from docs import architecture

PACKAGE = architecture.ROOT / "v3dcad"


def drawn(package: Path) -> list[tuple[str, str]]:
    return architecture.arrows(architecture.knowledge(package))


def test_the_picture_is_that_of_the_source() -> None:
    written = architecture.PICTURE.read_text(encoding="utf-8")
    assert written == architecture.picture(), "run `python docs/architecture.py`"
    ElementTree.fromstring(written)


def test_arrows_and_what_follows_from_them_are_all_imports() -> None:
    known, pairs = architecture.knowledge(PACKAGE), drawn(PACKAGE)
    assert all(other in known[room] for room, other in pairs)
    reached = {room: {other for start, other in pairs if start == room} for room in known}
    for _ in reached:
        for room in reached:
            reached[room] |= set().union(*(reached[other] for other in reached[room]))
    for room, others in known.items():
        assert others <= reached[room].union(architecture.KNOWN_TO_ALL)


def test_a_new_import_is_a_new_arrow_and_a_new_folder_needs_a_place(tmp_path: Path) -> None:
    package = tmp_path / "v3dcad"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    assert ("view", "geometry/graphs") not in drawn(package)
    with (package / "view" / "picture.py").open("a", encoding="utf-8") as file:
        file.write("from v3dcad.geometry.graphs.trails import trails\n")
    assert set(drawn(package)) ^ set(drawn(PACKAGE)) == {("view", "geometry/graphs")}
    (package / "attic").mkdir()
    (package / "attic" / "__init__.py").touch()
    with pytest.raises(SystemExit, match="v3dcad/attic has no place"):
        drawn(package)
