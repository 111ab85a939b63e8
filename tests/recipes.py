"""Recipes for tests, and the thesis's own importer to read them with."""

from __future__ import annotations

import numpy as np

from v3dcad.model import Brep, Checksum, Mesh, Placement, Recipe
from v3dcad.settings import FillSettings

TETRAHEDRON = Mesh(
    np.array([[0.0, 0, 0], [0, 0, 1 / 3], [0, 1, 0], [1, 0, 0]]),
    np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]),
)
SITES = np.array([[0.1, 0.2, 0.0], [1 / 3, 1e-17, 0.0]])
BREP = Brep(
    b"\nOpen CASCADE Topology V4, and so on", np.array([[-1.0, -2, 0], [1, 2, 50.00000000000342]])
)
CHECKSUM = Checksum(
    layers=3, cells=5, walls=12, sites="0" * 8, weights="1" * 8, topology="2" * 8, sha256="ab" * 32
)


def recipe(
    boundary: Mesh | Brep = TETRAHEDRON,
    places: np.ndarray | None = SITES,
    checksum: Checksum | None = CHECKSUM,
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0),
    **settings: object,
) -> Recipe:
    """A recipe that is good unless told otherwise; by the thesis's method unless told otherwise."""
    known = {"method": "thesis", "layer_height": 0.15, "random_seed": 7, **settings}
    if known["method"] == "thesis":
        known = {"offset": 0.1, **known}
        if places is not None:
            known["sites"] = len(places)
    return Recipe(
        name="a",
        settings=FillSettings(**known),
        sites=places,
        boundary=boundary,
        placement=Placement(np.eye(3), np.array(shift)),
        checksum=checksum,
        software="v3dcad 1.2.3",
    )


def algorithm_10(text: str) -> tuple[float, float, list[list[float]], list[list[float]]]:
    """Algorithm 10 of the thesis, line for line: offset, layer height, sites, mesh vertices."""
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
            while not lines[i + 1].startswith("["):
                i += 1
                x, y, z = lines[i].split(",")
                sites.append([float(x), float(y), float(z)])
        elif line.startswith("solid"):
            i += 1
            while not lines[i].strip().startswith("endsolid"):
                words = lines[i].split()
                if words[0] == "vertex":
                    mesh.append([float(word) for word in words[1:]])
                i += 1
        i += 1
    return offset, height, sites, mesh
