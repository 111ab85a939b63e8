"""Fuzz the reader of `.ont` with atheris: nothing but `FormatError` may come out of it.

`pip install atheris`, then `python tests/fuzz/fuzz_ont.py -max_total_time=600` from the root of
the repository. Takes libFuzzer's options; it stops where an input takes more than 20 s or 2 GiB.
An input is a whole file, or else what is packed in one, a compact mesh: mutations of files would
never reach that behind its check sum.
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import atheris

with atheris.instrument_imports(include=["v3dcad"]):
    from v3dcad.errors import FormatError
    from v3dcad.formats.mesh.stl import welded
    from v3dcad.formats.ont.document import ont_text, recipe_in
    from v3dcad.formats.ont.mesh_codec import mesh_bytes, mesh_in

import numpy as np

from v3dcad.model import Brep, Checksum, Mesh, Placement, Recipe
from v3dcad.settings import FillSettings

MESH = Mesh(
    np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1 / 3]]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
)
BREP = Brep(b"\nOpen CASCADE Topology V4, (c) Open Cascade\n", np.array([[-1.0] * 3, [1.0] * 3]))
FILE, MESH_CODE = 0, 1


def one_input(data: bytes) -> None:
    """Read one input."""
    kind, content = data[:1], data[1:]
    if kind == bytes([MESH_CODE]):
        with suppress(ValueError, FormatError):
            mesh = mesh_in(content)
            welded(mesh.vertices[mesh.triangles], "fuzz.ont")
    else:
        with suppress(FormatError):
            recipe_in(content, "fuzz.ont")


def seeds() -> list[bytes]:
    """Good files of every form, from which the fuzzer starts."""
    sites = np.array([[0.1, 0.2, 0.0], [1 / 3, 1e-17, 0.0]])
    checksum = Checksum(
        layers=1, cells=2, walls=2, sites="0" * 8, weights="1" * 8, topology="2" * 8,
        sha256="ab" * 32,
    )  # fmt: skip
    recipe = Recipe(
        name="x",
        settings=FillSettings(method="thesis", offset=0.1, sites=2),
        sites=sites,
        boundary=MESH,
        placement=Placement(np.eye(3), np.array([1.0, 2.0, 3.0])),
        checksum=checksum,
        software="v3dcad 0",
    )
    solid = Recipe(
        name="x",
        settings=FillSettings(cell_size=4.0, stretch=1.25),
        sites=None,
        boundary=BREP,
        placement=Placement.none(),
        software="v3dcad 0",
    )
    texts = [ont_text(recipe, "stl"), ont_text(recipe, "exact"), ont_text(solid, "exact")]
    files = [bytes([FILE]) + text.encode() for text in texts]
    return [*files, bytes([MESH_CODE]) + mesh_bytes(MESH, np.zeros(3))]


def main() -> None:
    """Run until libFuzzer's options say to stop."""
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory() as corpus:
        for number, seed in enumerate(seeds()):
            (Path(corpus) / f"{number}").write_bytes(seed)
        limits = ["-timeout=20", "-rss_limit_mb=2048", "-max_len=20000"]
        atheris.Setup([sys.argv[0], *limits, *sys.argv[1:], corpus], one_input)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
