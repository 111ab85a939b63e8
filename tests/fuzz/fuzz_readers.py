"""Fuzz the readers of STL, OBJ, 3MF and G-code with atheris: only v3dcad's errors may come out.

`pip install atheris`, then `python tests/fuzz/fuzz_readers.py -max_total_time=600` from the root of
the repository. Takes libFuzzer's options; it stops where an input takes more than 20 s or 2 GiB.
An input's first byte says which reader gets the rest. What is packed in a 3MF file is an input by
itself: mutations of an archive would never reach it behind its check sums.
"""

from __future__ import annotations

import io
import sys
import tempfile
import warnings
import zipfile
from contextlib import suppress
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import atheris

from v3dcad.geometry import print_time  # noqa: F401  compiled code cannot be instrumented

with atheris.instrument_imports(include=["v3dcad.formats", "v3dcad.parts"]):
    from v3dcad.errors import V3dcadError
    from v3dcad.formats.gcode.reader import read_gcode
    from v3dcad.formats.mesh.stl import ascii_stl, binary_stl
    from v3dcad.parts import part_from

import numpy as np

from v3dcad.model import Mesh

MESH = Mesh(
    np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
)
ENDINGS = (".stl", ".obj", ".3mf", ".gcode", ".xml")
"""By first byte; the last is the model in a 3MF file."""

MODEL, RELATIONS = "3D/3dmodel.model", "_rels/.rels"

RELATION = (
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    f'<Relationship Target="/{MODEL}" Id="r" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def archive(model: bytes) -> bytes:
    """A 3MF file around a model."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr(RELATIONS, RELATION)
        packed.writestr(MODEL, model)
    return made.getvalue()


def model() -> bytes:
    """The model of a 3MF file with a part, placed twice, and a component."""
    points = "".join('<vertex x="{}" y="{}" z="{}"/>'.format(*row) for row in MESH.vertices)
    corners = "".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*row) for row in MESH.triangles)
    return (
        '<model unit="millimeter" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
        f'<resources><object id="1" type="model"><mesh><vertices>{points}</vertices>'
        f"<triangles>{corners}</triangles></mesh></object>"
        '<object id="2"><components><component objectid="1" transform="1 0 0 0 1 0 0 0 1 20 0 0"/>'
        "</components></object></resources>"
        '<build><item objectid="1"/><item objectid="2"/></build></model>'
    ).encode()


def seeds() -> list[bytes]:
    """Good files of every kind, from which the fuzzer starts."""
    points = "".join("v {} {} {}\n".format(*row) for row in MESH.vertices)
    faces = "".join("f {}/1/1 {}//1 {}\n".format(*row) for row in MESH.triangles + 1)
    gcode = (
        "G21\nG90\nM83\nM204 S500\nG28\nG92 E0\nG1 Z0.2 F600\nG1 X10 Y10 E1.5 F1200 ; bead\n"
        "G2 X20 Y20 I5 J5 E1\nG91\nG0 X1\nM104 S200\nT0\nG1 E-1 F2400\n"
    )
    files = [
        (0, binary_stl(MESH)),
        (0, ascii_stl(MESH, "x").encode()),
        (1, f"# x\no a\n{points}{faces}f -1 -2 -3 \\\n -4\n".encode()),
        (2, archive(model())),
        (3, gcode.encode()),
        (4, model()),
    ]
    return [bytes([kind]) + data for kind, data in files]


def one_input(data: bytes, folder: Path) -> None:
    """Read one input."""
    if not data:
        return
    ending, content = ENDINGS[data[0] % len(ENDINGS)], data[1:]
    if ending == ".xml":
        ending, content = ".3mf", archive(content)
    file = folder / f"fuzz{ending}"
    file.write_bytes(content)
    with suppress(V3dcadError):
        if ending == ".gcode":
            read_gcode(file)
        else:
            part_from(file).contents()


def main() -> None:
    """Run until libFuzzer's options say to stop."""
    warnings.simplefilter("error")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "corpus").mkdir()
        for number, seed in enumerate(seeds()):
            (folder / "corpus" / f"{number}").write_bytes(seed)
        limits = ["-timeout=20", "-rss_limit_mb=2048", "-max_len=20000"]
        options = [sys.argv[0], *limits, *sys.argv[1:], str(folder / "corpus")]
        atheris.Setup(options, lambda data: one_input(data, folder))
        atheris.Fuzz()


if __name__ == "__main__":
    main()
