"""Compute the bending of the sample bar beside this script: `python samples/cantilever.py`.

The bar is 80 × 16 × 16 mm, held at x = 0 and pressed down by 100 N at its other end. CalculiX's
`ccx` has to be there (Debian: calculix-ccx); FreeCAD's FEM workbench calls the same. Writes
cantilever.frd, with the stress at each node.
"""

import subprocess
import tempfile
from itertools import product
from pathlib import Path

HERE = Path(__file__).parent
SIZE = 80.0, 16.0, 16.0
"""mm; x begins at 0, y and z in the middle and at the base"""
PARTS = 16, 3, 3
FORCE = 100.0
"""N."""


def deck() -> str:
    """The input of CalculiX: bricks without locking (C3D8I), aluminium."""
    counts = [count + 1 for count in PARTS]
    at = list(product(*map(range, counts)))
    number = {place: k for k, place in enumerate(at, start=1)}
    lines = ["*NODE, NSET=ALL"]
    for (i, j, k), name in number.items():
        x, y, z = (
            size * share / count for size, share, count in zip(SIZE, (i, j, k), PARTS, strict=True)
        )
        lines.append(f"{name}, {x:g}, {y - SIZE[1] / 2:g}, {z:g}")
    lines.append("*ELEMENT, TYPE=C3D8I, ELSET=BAR")
    around = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for name, (i, j, k) in enumerate(product(*map(range, PARTS)), start=1):
        corners = [number[i + a, j + b, k + up] for up in (0, 1) for a, b in around]
        lines.append(", ".join(map(str, [name, *corners])))
    held = [name for (i, _, _), name in number.items() if i == 0]
    pressed = [name for (i, _, _), name in number.items() if i == PARTS[0]]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", "70000, 0.33"]
    lines += ["*SOLID SECTION, ELSET=BAR, MATERIAL=M", "*BOUNDARY"]
    lines += [f"{name}, 1, 3" for name in held]
    lines += ["*STEP", "*STATIC", "*CLOAD"]
    lines += [f"{name}, 3, {-FORCE / len(pressed):g}" for name in pressed]
    return "\n".join([*lines, "*EL FILE", "S", "*END STEP", ""])


def main() -> None:
    """Run CalculiX and keep its result."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "cantilever.inp").write_text(deck(), encoding="ascii")
        subprocess.run(["ccx", "cantilever"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        result = (Path(folder) / "cantilever.frd").read_text(encoding="ascii")
    # The head has the date and the user's name.
    kept = [line for line in result.splitlines() if not line.startswith("    1U")]
    (HERE / "cantilever.frd").write_text("\n".join(kept) + "\n", encoding="ascii")


if __name__ == "__main__":
    main()
