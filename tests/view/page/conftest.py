"""A structure to show in a browser."""

from __future__ import annotations

from pathlib import Path

import pytest

import v3dcad

HOSTILE = "</script><script>alert('<b>ı&amp;$title')</script><!--"
"""The name of the part: it must be shown letter by letter, and do nothing."""


@pytest.fixture(scope="session")
def structure(samples: Path) -> v3dcad.Structure:
    """A small foam, whose part has a hostile name."""
    found = v3dcad.place_on_bed(samples / "pyramid.stl")
    part = v3dcad.parts.MeshPart(HOSTILE, found.mesh())
    return v3dcad.fill(part, layer_height=2.0, cell_size=12.0)


@pytest.fixture(scope="session")
def page_file(structure: v3dcad.Structure, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The structure's page as a file."""
    file = tmp_path_factory.mktemp("page") / "page.html"
    structure.write_html(file)
    return file
