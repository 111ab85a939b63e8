from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from v3dcad.errors import FormatError
from v3dcad.formats.ont import ont_text, read_ont
from v3dcad.model import Mesh, Recipe

TETRAHEDRON = Mesh(
    np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1 / 3]]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
)
SITES = np.array([[0.1, 0.2, 0.0], [1 / 3, 1e-17, 0.0]])
GOOD = ont_text(Recipe(0.1, 0.15, SITES, TETRAHEDRON, "x"))

FIGURE_3_20 = """\
[OFFSET_VALUE]
0.1 //Example double value for offset

[LAYER_HEIGHT]
0.15 //Example double value for layer height

[INITIAL_LAYER_VORONOI_SEED_COORDINATES]
X,Y,Z
1.0,2.0,3.0
4.0,5.0,6.0
7.0,8.0,9.0

[BREP_PART_STL]
solid part_name
  facet normal 0 0 1
    outer loop
      vertex 0 0 0
      vertex 1 0 0
      vertex 0 1 0
    endloop
  endfacet
endsolid part_name
"""


def written(tmp_path: Path, text: str | bytes) -> Path:
    path = tmp_path / "a.ont"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


@given(
    st.lists(st.tuples(*[st.floats(-1e6, 1e6)] * 3), min_size=1, max_size=9),
    st.floats(0, 1e3),
    st.floats(1e-3, 1e3),
)
def test_every_number_comes_back(
    tmp_path_factory: pytest.TempPathFactory,
    sites: list[tuple[float, float, float]],
    offset: float,
    height: float,
) -> None:
    recipe = Recipe(offset, height, np.array(sites), TETRAHEDRON, "x")
    again = read_ont(written(tmp_path_factory.mktemp("ont"), ont_text(recipe)))
    assert (again.offset, again.layer_height) == (offset, height)
    assert again.sites.tolist() == recipe.sites.tolist()
    there = again.boundary.vertices[again.boundary.triangles]
    assert sorted(there.tolist()) == sorted(TETRAHEDRON.vertices[TETRAHEDRON.triangles].tolist())


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_the_figure_of_the_thesis_is_read(tmp_path: Path, ends: str) -> None:
    recipe = read_ont(written(tmp_path, FIGURE_3_20.replace("\n", ends)))
    assert (recipe.offset, recipe.layer_height) == (0.1, 0.15)
    assert recipe.sites.tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert len(recipe.boundary.triangles) == 1


def algorithm_10(text: str) -> tuple[float, float, list[list[float]], list[list[float]]]:
    """The thesis's importer, line for line."""
    lines = text.split("\n")
    offset = height = 0.0
    sites: list[list[float]] = []
    mesh: list[list[float]] = []
    i = 0
    while i < len(lines):
        line = lines[i].strip()
        if line == "[OFFSET_VALUE]":
            i += 1
            offset = float(lines[i])
        elif line == "[LAYER_HEIGHT]":
            i += 1
            height = float(lines[i])
        elif line == "[VORONOI_SEED_COORDINATES]":
            while i + 1 < len(lines) and not lines[i + 1].startswith("["):
                i += 1
                if lines[i].strip():
                    sites.append([float(word) for word in lines[i].split(",")])
        elif line.startswith("solid"):
            while not lines[i].strip().startswith("endsolid"):
                i += 1
                words = lines[i].split()
                if words[0] == "vertex":
                    mesh.append([float(word) for word in words[1:]])
        i += 1
    return offset, height, sites, mesh


def test_the_thesis_reads_what_we_write() -> None:
    offset, height, sites, mesh = algorithm_10(GOOD)
    assert (offset, height, sites) == (0.1, 0.15, SITES.tolist())
    assert mesh == TETRAHEDRON.vertices[TETRAHEDRON.triangles].reshape(-1, 3).tolist()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (GOOD.encode() + b"\xff", "UTF-8"),
        ("hello", "line 1: not an .ont file"),
        (GOOD.replace("[LAYER_HEIGHT]", "[HEIGHT]"), r"section \[LAYER_HEIGHT\]: is missing"),
        (GOOD + "[OFFSET_VALUE]\n1\n", r"section \[OFFSET_VALUE\]: stands here a second time"),
        (GOOD.replace("]\n0.15", "]\n0.15 mm"), r"line 5, section \[LAYER_HEIGHT\].*'0.15 mm'"),
        (GOOD.replace("]\n0.15", "]\n-0.15"), "not above 0"),
        (GOOD.replace("]\n0.15", "]\n0"), "not above 0"),
        (GOOD.replace("]\n0.1\n", "]\n-0.1\n"), "not 0 or more"),
        (GOOD.replace("]\n0.15", "]\nnan"), "finite"),
        (GOOD.replace("]\n0.15", "]\n1\n2"), "2 lines"),
        (GOOD.replace("]\n0.15", "]\n"), "0 lines"),
        (GOOD.replace("0.1,0.2,0.0", "0.1,0.2"), r"line 8.*2 numbers"),
        (GOOD.replace("0.1,0.2,0.0", "0.1,inf,0.0"), "line 8.*'inf'"),
        (
            GOOD.replace("0.1,0.2,0.0\n", "").replace("0.3333333333333333,1e-17,0.0\n", ""),
            "holds no sites",
        ),
        (GOOD[: len(GOOD) // 2], "cut off"),
        (GOOD.replace("vertex 1.0 0.0", "vertex one 0.0", 1), "line 17: 'one'"),
    ],
)
def test_damaged_files_are_refused(tmp_path: Path, text: str | bytes, says: str) -> None:
    with pytest.raises(FormatError, match=says) as caught:
        read_ont(written(tmp_path, text))
    assert "a.ont" in str(caught.value)
