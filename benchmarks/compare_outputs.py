"""Every output of two checkouts, compared: `python -m benchmarks.compare_outputs OTHER [NAMES]`.

Runs the same commands in this checkout and in OTHER, writes what they make to two temporary
folders and compares all files byte by byte, and what was printed line by line. Ends with exit
code 1 where files differ. NAMES run only the commands whose names begin so.

Clocks must not show: a command's own time and progress are taken out of what it printed.
"""

from __future__ import annotations

import difflib
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent

RUN = "import sys; from v3dcad.cli import main; sys.exit(main())"

ALL_FORMS = "--out . --3mf p.3mf --stl p.stl --brep p.brep --svg p.svg --diameter 1"

COARSE = "--layer-height 0.4 --cell-size 12"

COMMANDS = {
    "bracket": f"fill SAMPLES/bracket.step {ALL_FORMS} {COARSE}",
    "cone": f"fill SAMPLES/cone.step {ALL_FORMS} {COARSE}",
    "islands": f"fill SAMPLES/islands.step {ALL_FORMS} {COARSE}",
    "pyramid": f"fill SAMPLES/pyramid.step {ALL_FORMS} --layer-height 0.4 --cell-size 9",
    "triangles": "fill SAMPLES/pyramid.stl --out . --stl p.stl --svg p.svg --layer-height 0.4",
    "default": "fill SAMPLES/bracket.step --out .",
    "columns": f"fill SAMPLES/bracket.step --out . --stretch columns {COARSE}",
    **{
        f"step-{form}": f"fill SAMPLES/bracket.step --step p.step --step-as {form} --cell-size 16 "
        "--layer-height 0.6 --thickness 1 --diameter 1"
        for form in ("faces", "cells", "solid", "struts", "beads")
    },
    **{
        f"mesh-{form}": f"fill SAMPLES/bracket.step --3mf p.3mf --threemf-as {form} --stl p.stl "
        f"--stl-as {form} --stl-ascii --cell-size 16 --layer-height 2 --thickness 1 --diameter 1"
        for form in ("solid", "struts", "beads")
    },
    "thesis-cone": "fill SAMPLES/cone.step --out . --method thesis --base-clearance 0.1 "
    "--layer-height 0.4 --sites 15",
    "thesis-pyramid": "fill SAMPLES/pyramid.stl --out . --method thesis --layer-height 0.4",
    "thesis-loft": "fill SAMPLES/islands.step --ont p.ont --method thesis --interpolate --offset 0",
    "one-bead": f"fill SAMPLES/bracket.step --gcode p.gcode --wall-beads 1 {COARSE}",
    "tree": "fill SAMPLES/islands.step --gcode p.gcode --profile thesis --contour centre "
    "--method thesis --layer-height 2",
    "profile": f"fill SAMPLES/bracket.step --gcode p.gcode --profile ender3v2 --arcs "
    f"--perimeters 2 --bead-shape rounded {COARSE}",
    "klipper": f"fill SAMPLES/islands.step --gcode p.gcode --profile generic-klipper {COARSE}",
    "turned": f"fill SAMPLES/bracket.step --ont p.ont --step p.step --up x --rotate 0,0,9 {COARSE}",
    "as-brep": "fill SAMPLES/pyramid.stl --as-brep --ont p.ont --step p.step --layer-height 2",
    "slice-bracket": "slice SAMPLES/bracket.step --layer-height 0.4 --step s.step --svg s.svg",
    "slice-cone": "slice SAMPLES/cone.step --layer-height 0.4 --step s.step --svg s.svg",
    "slice-mesh": "slice SAMPLES/pyramid.stl --layer-height 2 --svg s.svg",
    "info": "info SAMPLES/bracket.step",
    "info-mesh": "info SAMPLES/pyramid.stl",
    "ont-info": "info bracket/bracket.ont",
    "ont-check": "ont check bracket/bracket.ont",
    "ont-convert": "ont convert bracket/bracket.ont p.ont --boundary stl",
    "gcode-info": "gcode info bracket/bracket.gcode --json",
    "nc-template": "nc template bracket/bracket.gcode --out p.toml",
}
"""What is run, by name: each in a folder of its name, where it may also read the folders of those
before it. SAMPLES is the folder of sample parts."""

CLOCKS = re.compile(r"\d+(\.\d+)? (s|ms|min)\b|\d+:\d\d:\d\d|[━╸╺]+|\d+ *%|\d+/\d+")
"""What tells the time, or how far something was when it was drawn."""


def run(checkout: Path, name: str, folder: Path) -> int:
    """Run a command of a checkout in a folder of its name below another; keep what it printed.

    Returns its exit code.
    """
    own = folder / name
    own.mkdir()
    before = {str(file.relative_to(folder)) for file in folder.glob("*/*")}
    words = [f"../{word}" if word in before else word for word in COMMANDS[name].split()]
    words = [word.replace("SAMPLES", str(HERE / "samples")) for word in words]
    path = {"PYTHONPATH": str(checkout), "COLUMNS": "200", "PYTHONHASHSEED": "0"}
    done = subprocess.run(
        [sys.executable, "-c", RUN, *words], cwd=own, env={**os.environ, **path},
        capture_output=True, encoding="utf-8", check=False,
    )  # fmt: skip
    said = [CLOCKS.sub("", line).rstrip() for line in (done.stdout + done.stderr).splitlines()]
    text = "\n".join(line for line in [f"exit code {done.returncode}", *said] if line)
    text = re.sub(r"\.py:\d+", ".py", text.replace(str(own), "HERE").replace(str(checkout), ""))
    (own / "printed").write_text(text, encoding="utf-8")
    return done.returncode


def differences(here: Path, there: Path) -> list[str]:
    """A line for each file that is not the same in two folders, and for each line printed."""
    names = sorted({file.name for folder in (here, there) for file in folder.iterdir()})
    found = []
    for name in names:
        one, other = here / name, there / name
        if not (one.exists() and other.exists()):
            found.append(f"{here.name}/{name} is only {'here' if one.exists() else 'there'}")
        elif one.read_bytes() != other.read_bytes():
            found.append(f"{here.name}/{name} differs")
            if name == "printed":
                texts = [file.read_text(encoding="utf-8").splitlines() for file in (other, one)]
                found += list(difflib.unified_diff(*texts, "there", "here", n=0, lineterm=""))
    return found


def main(words: list[str]) -> int:
    """Compare; say for each command how many files it made, and what differs."""
    other, chosen = Path(words[0]).resolve(), tuple(words[1:]) or ("",)
    count = 0
    with tempfile.TemporaryDirectory() as work:
        here, there = Path(work, "here"), Path(work, "there")
        here.mkdir()
        there.mkdir()
        for name in COMMANDS:
            if not name.startswith(chosen):
                continue
            code = run(HERE, name, here)
            run(other, name, there)
            wrong = [f"exit code {code}"] * (code != 0) + differences(here / name, there / name)
            count += len(wrong)
            files = len(list((here / name).iterdir())) - 1
            print(f"{name}: {files} files" + ("" if wrong else ", the same"))
            print(*(f"    {line}" for line in wrong), sep="\n", end="\n" * bool(wrong), flush=True)
    print("all the same" if not count else f"{count} differences")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
