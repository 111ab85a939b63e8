"""The command line as a user meets it: exit codes, one line for each mistake, no debris."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from build123d import Box, Pos, export_step

from v3dcad.cli import main
from v3dcad.commands.compiling import NOTICE
from v3dcad.report import certificate_line, foam_lines
from v3dcad.settings import FillSettings, declared, option

pytestmark = pytest.mark.slow


def run(
    *words: object, cwd: Path | None = None, columns: int = 80
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", "from v3dcad.cli import main; main()", *map(str, words)],
        capture_output=True,
        encoding="utf-8",
        cwd=cwd,
        check=False,
        env={
            **os.environ,
            "PYTHONPATH": str(Path(__file__).parent.parent),
            "COLUMNS": str(columns),
        },
    )


def mistake(capsys: pytest.CaptureFixture[str], *words: object) -> str:
    """What a failing command says; it must be one line, with exit code 2."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["v3dcad", *map(str, words)])
        with pytest.raises(SystemExit) as stop:
            main()
    assert stop.value.code == 2
    said = capsys.readouterr().err
    begun, _, rest = said.partition("\n")
    said = (
        rest if begun.startswith(("filling ", "cutting ", "drawing ")) else said
    )  # found while at work
    said = said.removeprefix(f"{NOTICE}\n")
    assert said.count("\n") == 1, said
    assert said.startswith("v3dcad: ")
    return said


def test_one_command_makes_all_five_files(samples: Path, tmp_path: Path) -> None:
    done = run("fill", samples / "bracket.step", "--out", tmp_path / "out", "--layer-height", 0.4)
    assert done.returncode == 0, done.stderr
    assert done.stderr.replace(f"{NOTICE}\n", "") == "filling bracket.step\n"
    files = sorted(file.name for file in (tmp_path / "out").iterdir())
    assert files == [f"bracket.{end}" for end in ("gcode", "json", "ont", "png", "step")]
    for word in ("layers", "cells", "steepest", "wall length", *files):
        assert word in done.stdout
    again = run("fill", tmp_path / "out" / "bracket.ont", "--report", tmp_path / "again.json")
    assert again.returncode == 0, again.stderr
    told = run("info", tmp_path / "out" / "bracket.ont")
    assert "0.4 mm" in told.stdout


def test_the_summary_says_what_the_report_says(samples: Path, tmp_path: Path) -> None:
    report = tmp_path / "a.json"
    fill = ("fill", samples / "pyramid.stl", "--layer-height", 2, "--report", report)
    done = run(*fill, "--cell-size", 12)
    told = json.loads(report.read_text(encoding="utf-8"))
    most = told["most_cells_in_a_layer"]
    assert f"cells         {told['cells']}, at most {most} in a layer\n" in done.stdout
    for name, line in foam_lines(told["foam"]).items():
        assert f"{name:<12}  {line}\n" in done.stdout
    assert "12 mm asked" in done.stdout
    assert certificate_line(told["overhang"]) in done.stdout
    assert "births" not in done.stdout
    assert "offset" not in done.stdout


def test_no_insertion_is_obeyed(samples: Path, tmp_path: Path) -> None:
    csv, report = tmp_path / "sites.csv", tmp_path / "a.json"
    random = np.random.default_rng(4)
    csv.write_text("".join(f"{x},{y}\n" for x, y in random.uniform(-33.5, 33.5, (50, 2))))
    births = {}
    for word in ("--insertion", "--no-insertion"):
        done = run(
            *("fill", samples / "pyramid.stl", "--method", "thesis", "--sites-file", csv),
            *("--layer-height", 2.5, "--offset", 10, "--report", report, word),
        )
        births[word] = len(json.loads(report.read_text(encoding="utf-8"))["births"])
        assert f"births        {births[word]}\n" in done.stdout
        assert "offset        10 mm² a layer\n" in done.stdout
    assert births["--insertion"] > births["--no-insertion"] == 0


def test_help_shows_each_setting_once_with_its_method() -> None:
    shown: list[tuple[str, list[str]]] = []
    for line in run("fill", "--help", columns=160).stdout.splitlines():
        words = line.strip("│ ").split()
        if words and words[0].startswith("--"):
            shown.append((words[0], []))
        if shown:
            shown[-1][1].extend(words)
    for name in FillSettings.__dataclass_fields__:
        (says,) = [" ".join(words) for flag, words in shown if flag == option(name)]
        method = declared(FillSettings, name).method
        told = re.findall(r"Method (\w+) only\.", says)
        assert told == ([] if method is None else [method]), name


def test_warm_up_says_when_it_is_done() -> None:
    done = run("warm-up")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "the engine is compiled\n"
    assert done.stderr in ("", f"{NOTICE}\n")


def test_info_tells_what_a_part_holds(samples: Path) -> None:
    told = run("info", samples / "islands.step").stdout
    for word in ("B-rep", "solids", "2", "15541.2", "56 × 24 × 20 mm"):
        assert word in told


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--layer-height", 0], "--layer-height 0.0: give a number above 0 mm"),
        (["--layer-height", -1], "--layer-height -1"),
        (["--layer-height", "nan"], "finite"),
        (["--layer-height", 0.5], "give at most 0.4"),
        (["--method", "thesis", "--sites", 0], "--sites 0: give a number of at least 1"),
        (["--method", "thesis", "--offset", -0.1], "--offset -0.1"),
        (["--method", "thesis", "--offset", "much"], "--offset 'much': give a number or auto"),
        (["--cell-size", 0], "--cell-size 0.0: give a number above 0 mm"),
        (["--cell-size", "small"], "'small' is not known; give a number, auto, or an expression"),
        (["--cell-size", 50], "--cell-size 50: larger than the part"),
        (["--cell-size", 0.5], "--cell-size 0.5: cells smaller than two beads of 0.45 mm"),
        (["--bead-width", 1.2], "--bead-width 1.2: a nozzle of 0.4 mm lays beads of 0.24 to 1 mm"),
        (["--travel-speed", 600], "--travel-speed 600: more than the 500 mm/s of the machine"),
        (["--profile", "prusa-mk3s", "--travel-speed", 250], "more than the 200 mm/s of"),
        (["--print-speed", 250], "take 20.4 mm³/s, and the hot end melts 15"),
        (["--stretch", 1.1], "--stretch 1.1: walls would lean more than 45°; give at least 1.25"),
        (["--stretch", 0.5], "--stretch 0.5: give a number of at least 1"),
        (["--stretch", "tall"], "--stretch 'tall': give a number or auto or columns"),
        (["--max-overhang", 5], "--max-overhang 5.0: give a number of at least 10 °"),
        (["--max-overhang", 85], "--max-overhang 85.0: give a number of at most 80 °"),
        (["--sites", 40], "--sites is a setting of --method thesis, not of foam"),
        (["--offset", 0.2], "--offset is a setting of --method thesis, not of foam"),
        (["--no-insertion"], "--insertion is a setting of --method thesis, not of foam"),
        (["--interpolate"], "--interpolate is a setting of --method thesis, not of foam"),
        (["--method", "thesis", "--cell-size", 6], "--cell-size is a setting of --method foam"),
        (["--method", "thesis", "--stretch", 2], "--stretch is a setting of --method foam"),
        (["--bed", "220"], "such as 220x220"),
        (["--layer-height", 1e-9], "--layer-height 1e-09: 3e+10 layers, more than 1,000,000"),
        (["--minimum-edge", 100], "--minimum-edge 100.0: give a number of at most 2 mm"),
        (["--acceleration", 1e-9], "--acceleration 1e-09: give a number of at least 1 mm/s²"),
        (["--print-speed", 1e-9], "--print-speed 1e-09: give a number of at least 0.1 mm/s"),
        (["--start-gcode", "{"], "--start-gcode: a brace by itself; write {name}"),
        (["--end-gcode", "M84 {fan"], "--end-gcode: a brace by itself"),
        (["--bed", "30x220"], "10.00 mm too large in x"),
        (["--print-speed", 0], "--print-speed"),
        (["--chord-tolerance", 0], "--chord-tolerance 0.0: give a number above 0 mm"),
        (["--base-clearance", -1], "--base-clearance -1"),
        (["--rotate", "1,2"], "--rotate 1,2: give three angles"),
        (["--rotate", "1,2,x"], "such as 90,0,0"),
        (["--up", "w"], "--up w: give x, y, z or the number of a face"),
        (["--up", 9], "the part's faces are 0 to 2"),
    ],
)
def test_settings_out_of_range(
    words: list[object],
    says: str,
    samples: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    said = mistake(capsys, "fill", samples / "cone.step", "--out", tmp_path / "out", *words)
    assert says in said
    assert not list(tmp_path.rglob("*.*")), "something was left behind"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--layer-height", 99], "only 30 mm high"),
        (["--cell-size", 0.0001], "--cell-size 0.0001: the grid of a part of 40"),
        (["--cell-size", 0.05], "cells are more than memory holds"),
    ],
)
def test_what_no_structure_can_have(
    words: list[object],
    says: str,
    samples: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    said = mistake(capsys, "fill", samples / "cone.step", "--ont", tmp_path / "a.ont", *words)
    assert says in said
    assert not list(tmp_path.rglob("*.*")), "something was left behind"


def test_slice_writes_sections_alone(samples: Path, tmp_path: Path) -> None:
    done = run(
        *("slice", samples / "bracket.step", "--layer-height", 2, "--up", "x"),
        *("--rotate", "0,0,30", "--base-clearance", 0.1),
        *("--step", tmp_path / "a.step", "--svg", tmp_path / "a.svg"),
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.replace(f"{NOTICE}\n", "") == "cutting bracket.step\n"
    for line in ("sections      30", "contours      44, at most 3", "a.step (", "a.svg ("):
        assert line in done.stdout
    assert (tmp_path / "a.svg").read_text().count("<path") == 30
    assert (tmp_path / "a.step").read_text().count("PRODUCT('section ") == 30


def test_mistakes_in_slicing(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cone, svg, gcode = samples / "cone.step", tmp_path / "a.svg", tmp_path / "a.gcode"
    assert "--step FILE or --svg FILE" in mistake(capsys, "slice", cone)
    assert "overwrite the part" in mistake(capsys, "slice", cone, "--step", cone)
    said = mistake(capsys, "slice", cone, "--svg", svg, "--chord-tolerance", 0)
    assert "--chord-tolerance 0.0" in said
    ont = tmp_path / "a.ont"
    ont.write_text("hello")
    assert "fill makes its structure" in mistake(capsys, "slice", ont, "--svg", svg)
    for command in ("slice", "fill"):
        out = ("--svg", svg) if command == "slice" else ("--gcode", gcode)
        said = mistake(capsys, command, ont, *out, "--repair")
        assert "--repair: an .ont file holds its part" in said
    assert not svg.exists()
    assert not gcode.exists()


def test_a_mesh_with_a_hole_is_mended_where_asked(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    facets, found, _ = (samples / "pyramid.stl").read_text().rpartition("facet normal")
    assert found
    (tmp_path / "a.stl").write_text(facets + "endsolid\n")
    fill = ("fill", tmp_path / "a.stl", "--layer-height", 10, "--report", tmp_path / "a.json")
    assert "3 boundary edges" in mistake(capsys, *fill)
    done = run(*fill, "--repair", "--as-brep")
    assert "note          closed 1 hole with" in done.stdout
    assert "note          made a B-rep of 6 plane faces of 12 triangles" in done.stdout


NOT_PARTS = {
    "empty.step": b"",
    "words.step": b"hello",
    "cut.step": b"ISO-10303-21;\nHEADER;\n",
    "words.stl": b"hello",
    "words.brep": b"hello",
    "words.3mf": b"hello",
    "words.obj": b"hello",
    "words.ont": b"hello",
    "part.docx": b"hello",
}


@pytest.mark.parametrize("name", NOT_PARTS)
def test_files_that_are_no_parts(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / name).write_bytes(NOT_PARTS[name])
    said = mistake(capsys, "fill", tmp_path / name, "--out", tmp_path / "out")
    assert name in said
    assert not (tmp_path / "out").exists()


def test_missing_file_and_nothing_to_write(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "No such file" in mistake(capsys, "fill", tmp_path / "no.step", "--out", tmp_path / "o")
    assert "--out DIR" in mistake(capsys, "fill", samples / "cone.step")
    assert "cannot be read" in mistake(capsys, "info", tmp_path)
    stl = samples / "pyramid.stl"
    assert "overwrite the part" in mistake(capsys, "fill", stl, "--gcode", stl)


def test_a_step_file_without_a_solid(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from build123d import Rectangle, export_step

    export_step(Rectangle(10, 10).face(), tmp_path / "sheet.step")
    said = mistake(capsys, "fill", tmp_path / "sheet.step", "--out", tmp_path / "out")
    assert "sheet.step: contains no solid" in said


def test_sites_from_a_file(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    csv = tmp_path / "sites.csv"
    fill = ("fill", samples / "cone.step", "--layer-height", 10, "--sites-file", csv)
    report = ("--report", tmp_path / "a.json")
    csv.write_text("x,y\n1,2\n-3,4.5\n0,0\n", encoding="utf-8")
    done = run(*fill, *report)
    assert done.returncode == 0, done.stderr
    assert "cells         3, at most 3 in a layer" in done.stdout
    assert "every wall is upright" in done.stdout
    csv.write_text("x,y,z\n1,2,0\n\n0,0,25\n9,0,12\n", encoding="utf-8")
    done = run(*fill, *report, "--stretch", 4)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert told["foam"]["sites"] == 3
    assert told["foam"]["steepest_wall"]["sites"] == [0, 1]
    lean = np.degrees(np.arctan2(25 / 4**2, np.hypot(1, 2)))
    assert told["foam"]["steepest_wall"]["tilt_deg"] == pytest.approx(lean, abs=1e-4)
    two, three = "1,2\n", "1,2,3\n"
    for text, more, says in (
        ("x,y\n", [], "no sites"),
        (f"{two}3\n", [], "line 2: write one `x,y,z` in mm, or `x,y` for columns"),
        (f"{two}3,4,5,6\n", [], "line 2: write one `x,y,z`"),
        (f"{two}\n3,4,5\n", [], "line 3: 3 numbers; lines before have 2"),
        (f"x,y,z\n{three}3,4\n", [], "line 3: 2 numbers; lines before have 3"),
        (f"{two}3,inf\n", [], "line 2: a coordinate is not a finite"),
        ("500,500\n", [], "all sites lie outside"),
        (two, ["--cell-size", 6], "--cell-size 6.0: sites are given"),
        (two, ["--stretch", 2], "--stretch 2: sites of x, y are columns"),
        (three, [], "--stretch auto: sites in space need a number; give it"),
        (three, ["--stretch", "columns"], "--stretch columns: sites in space need a number"),
        (three, ["--method", "thesis"], "--method thesis takes sites as rows of x, y"),
        (f"{three}1,3,9\n", ["--stretch", 2], "the wall between sites 0 and 1 leans 56.31°, more"),
    ):
        csv.write_text(text, encoding="utf-8")
        assert says in mistake(capsys, *fill, "--report", tmp_path / "b.json", *more)
    assert not (tmp_path / "b.json").exists()


def test_a_folder_that_cannot_be_written(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "out").write_text("a file where the folder should be", encoding="utf-8")
    said = mistake(capsys, "fill", samples / "cone.step", "--out", tmp_path / "out")
    assert "cannot be written" in said
    assert [file.name for file in tmp_path.iterdir()] == ["out"]


def test_without_libgl_the_remedy_is_named(
    samples: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class NoKernel:
        @staticmethod
        def find_spec(name: str, path: object = None, target: object = None) -> None:
            if name.split(".")[0] == "OCP":
                raise ImportError("libGL.so.1: cannot open shared object file")

    for name in [
        name for name in sys.modules if name.split(".")[0] == "OCP" or "v3dcad.kernel" in name
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [NoKernel, *sys.meta_path])
    said = mistake(capsys, "fill", samples / "cone.step", "--out", tmp_path / "out")
    assert "apt-get install -y libgl1" in said


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_a_signal_while_the_kernel_is_imported_is_no_missing_kernel(name: str) -> None:
    """C++ modules make an ImportError of what ends them."""
    program = f"""
import os, signal, sys
class Stops:
    def find_spec(self, name, *_):
        if name == "OCP":
            try:
                os.kill(os.getpid(), signal.{name})
            except BaseException as error:
                raise ImportError("initialization failed") from error
sys.meta_path.insert(0, Stops())
signal.signal(signal.{name}, signal.{USUAL[name]})
from v3dcad import cli
@cli.app.command()
def make() -> None:
    import v3dcad.kernel
cli.main()
"""
    done = subprocess.run(
        [sys.executable, "-c", program, "make"], capture_output=True, encoding="utf-8", timeout=100
    )
    assert done.returncode == {"SIGINT": 130, "SIGTERM": 143}[name]
    assert done.stderr == ""


def test_a_signal_before_the_command_is_read_goes_untold(monkeypatch: pytest.MonkeyPatch) -> None:
    from v3dcad import cli

    def stopped(**_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "app", stopped)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 130


USUAL = {"SIGINT": "default_int_handler", "SIGTERM": "SIG_DFL", "SIGHUP": "SIG_DFL"}
"""What becomes of signals in a shell. pytest-xdist and nohup ignore them; children inherit that."""


@pytest.mark.parametrize(("number", "code"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_signals_leave_nothing_behind(
    number: str, code: int, samples: Path, tmp_path: Path
) -> None:
    import signal
    import time

    program = (
        f"import signal; signal.signal(signal.{number}, signal.{USUAL[number]}); "
        "from v3dcad.cli import main; main()"
    )
    child = subprocess.Popen(
        [sys.executable, "-c", program, "fill", str(samples / "pyramid.stl"),
         "--out", str(tmp_path / "out"), "--layer-height", "0.01"],
        stderr=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8", cwd=samples.parent,
    )  # fmt: skip
    out = tmp_path / "out"
    while child.poll() is None and not (out.is_dir() and any(out.iterdir())):
        time.sleep(0.05)
    child.send_signal(getattr(signal, number))
    # A signal waits until the function that is being compiled is done.
    _, said = child.communicate(timeout=200)
    assert child.returncode == code, said
    assert "Traceback" not in said
    assert not list(tmp_path.rglob(".*.*")), "a half-written file was left behind"


def signalled(script: str, number: str) -> tuple[int, str, str]:
    """How a script ends that a signal comes to once it has begun, and what it says after that."""
    import signal

    child = subprocess.Popen(
        [sys.executable, "-c", script.format(number=number, usual=USUAL[number]), "make"],
        stderr=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8",
    )  # fmt: skip
    assert child.stdout is not None
    assert child.stdout.readline() == "begun\n"
    child.send_signal(getattr(signal, number))
    told, said = child.communicate(timeout=100)
    return child.returncode, told, said


HALF_MADE = """
import signal, time
from v3dcad import cli

class Half:
    def __init__(self):
        print("begun", flush=True)
        time.sleep(100)
        self.whole = True
    def __del__(self):
        assert self.whole

@cli.app.command()
def make() -> None:
    Half()

signal.signal(signal.{number}, signal.{usual})
cli.main()
"""


@pytest.mark.parametrize(("number", "code"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_what_a_signal_leaves_half_made_goes_untold(number: str, code: int) -> None:
    assert signalled(HALF_MADE, number) == (code, "", "")


SWALLOWED = """
import signal, time
from v3dcad import cli

class Slow:
    def __del__(self):
        print("begun", flush=True)
        time.sleep(100)

@cli.app.command()
def make() -> None:
    Slow()
    time.sleep(10)
    print("went on")

signal.signal(signal.{number}, signal.{usual})
cli.main()
"""


@pytest.mark.parametrize(("number", "code"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_a_signal_that_a_destructor_swallows_ends_the_command(number: str, code: int) -> None:
    assert signalled(SWALLOWED, number) == (code, "", "")


def test_other_forms_and_ont_commands(samples: Path, tmp_path: Path) -> None:
    names = ("a.ont", "a.step", "a.3mf", "a.stl", "a.brep", "a.svg")
    ont, step, threemf, stl, brep, svg = (tmp_path / name for name in names)
    done = run(
        "fill", samples / "cone.step", "--layer-height", 3, "--cell-size", 12, "--step-as", "cells",
        "--threemf-as", "solid", "--stl-as", "solid", "--thickness", 1.5, "--ont", ont,
        "--step", step, "--3mf", threemf, "--stl", stl, "--brep", brep, "--svg", svg,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert all((tmp_path / name).stat().st_size > 500 for name in names)
    assert "B-rep" in run("ont", "info", ont).stdout
    assert "the one that was written" in run("ont", "check", ont).stdout
    assert run("ont", "convert", ont, tmp_path / "b.ont", "--boundary", "stl").returncode == 0
    assert "triangles" in run("ont", "info", tmp_path / "b.ont").stdout


@pytest.mark.parametrize(("form", "told"), [("walls", True), ("solid", False)])
def test_an_stl_of_walls_is_told_to_be_no_solid(
    form: str, told: bool, samples: Path, tmp_path: Path
) -> None:
    fill = ("fill", samples / "pyramid.stl", "--layer-height", 10, "--cell-size", 20)
    done = run(*fill, "--stl", tmp_path / "a.stl", "--stl-as", form)
    assert done.returncode == 0, done.stderr
    assert ("note          the STL holds walls without thickness" in done.stdout) == told


def test_what_forms_refuse(
    samples: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fill = ("fill", samples / "cone.step", "--layer-height", 5)
    step = ("--step", tmp_path / "a.step", "--step-as")
    assert "--thickness 0" in mistake(capsys, *fill, *step, "solid", "--thickness", 0)
    assert "give wires or faces" in mistake(capsys, *fill, *step, "foam")
    thesis = mistake(capsys, *fill, *step, "faces", "--method", "thesis")
    assert "thesis" in thesis
    assert not (tmp_path / "a.step").exists()


def test_gcode_and_nc_commands(samples: Path, tmp_path: Path) -> None:
    gcode = tmp_path / "a.gcode"
    done = run("fill", samples / "cone.step", "--layer-height", 0.4, "--gcode", gcode)
    assert done.returncode == 0, done.stderr
    told = json.loads(run("gcode", "info", gcode, "--json").stdout)
    assert told["layers"] == 75
    assert told["time_s"] > 60
    assert run("nc", "template", gcode, "--out", tmp_path / "p.toml").returncode == 0
    again = ("--gcode", tmp_path / "b.gcode", "--profile", tmp_path / "p.toml")
    assert run("fill", samples / "cone.step", "--layer-height", 0.4, *again).returncode == 0
    adjusted = run("nc", "adjust", gcode, tmp_path / "c.gcode", "--retraction", 1)
    assert "hops" in adjusted.stdout


def test_view_draws_pictures(samples: Path, tmp_path: Path) -> None:
    png, svg = tmp_path / "a.png", tmp_path / "a.svg"
    how = ("--layer-height", 5, "--cell-size", 12)
    done = run(
        *("view", samples / "pyramid.stl", "--target", "layer", "--layer", 3, "--ids", *how),
        *("--png", png, "--svg", svg),
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("written") == 2
    assert png.read_bytes().startswith(b"\x89PNG")
    assert "layer 3, " in svg.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--svg", "a.svg", "--target", "none"), "--target none: give full, layer, cell, "),
        (("--svg", "a.svg", "--target", "layer", "--layer", 99), "the layers are 0 to 4"),
        (("--svg", "a.svg", "--target", "cell"), "no cell is chosen: the cells of layer 2 are "),
        (("--svg", "a.svg", "--target", "cell", "--cell", 9999), "cell 9999: the cells of layer 2"),
    ],
)
def test_what_cannot_be_drawn_is_told_in_one_line(
    words: tuple[object, ...],
    said: str,
    samples: Path,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert said in mistake(
        capsys, "view", samples / "pyramid.stl", "--layer-height", 10, "--cell-size", 12, *words
    )
    assert not list(tmp_path.iterdir())


def test_a_page_in_a_pipe_is_nothing_else(samples: Path) -> None:
    how = ("--layer-height", 10, "--cell-size", 12, "--html", "/dev/stdout")
    done = run("view", samples / "pyramid.stl", *how)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("<!doctype html>")
    assert done.stdout.endswith("</html>\n")
    assert "written" in done.stderr


def test_view_takes_no_file_of_another_kind(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    other, png = tmp_path / "a.txt", tmp_path / "a.png"
    other.write_text("hello", encoding="utf-8")
    assert "not a kind of file that can be filled" in mistake(capsys, "view", other, "--png", png)
    assert "would overwrite the part itself" in mistake(capsys, "view", other, "--png", other)


def test_unit_and_scale(capsys: pytest.CaptureFixture[str], samples: Path, tmp_path: Path) -> None:
    pyramid = samples / "pyramid.stl"

    def size(*words: object) -> float:
        done = run("info", pyramid, *words)
        assert done.returncode == 0, done.stderr
        (row,) = (row for row in done.stdout.splitlines() if row.startswith("size"))
        return float(row.split()[1])

    assert size("--unit", "inch", "--scale", 2) == pytest.approx(50.8 * size(), rel=1e-4)
    assert "states its unit" in mistake(capsys, "info", samples / "bracket.step", "--unit", "cm")
    (tmp_path / "a.ont").touch()
    for words in (["--unit", "mm"], ["--scale", 1], ["--repair"]):
        said = mistake(capsys, "info", tmp_path / "a.ont", *words)
        assert "holds its part as it was filled" in said


@pytest.mark.parametrize("size", [(0.3, 0.3, 0.3), (20.0, 0.15, 1.0)])
def test_a_part_of_which_nothing_is_printed(
    size: tuple[float, ...], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    export_step(Box(*size), tmp_path / "a.step")
    said = mistake(capsys, "fill", tmp_path / "a.step", "--out", tmp_path / "out")
    assert "nothing of the part is printed: all of it is narrower than beads of 0.45 mm" in said
    assert not list((tmp_path / "out").iterdir())


def test_a_span_over_air_is_told_and_fails_where_that_is_asked(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    table = Box(10, 12, 4) + Pos(0, 0, 4) * Box(30, 12, 4)
    export_step(table, tmp_path / "a.step")
    fill = "fill", tmp_path / "a.step", "--layer-height", 0.4, "--cell-size", 8
    done = run(*fill, "--gcode", tmp_path / "a.gcode", columns=250)
    assert done.returncode == 0, done.stderr
    assert "spans" in done.stdout
    assert "of perimeters over air at z 4.2" in done.stdout
    assert "turn the part (--up, --rotate)" in done.stdout
    for kind in ("gcode", "ont"):
        written = tmp_path / f"b.{kind}"
        said = mistake(capsys, *fill, f"--{kind}", written, "--fail-over", 6)
        assert "over air (x" in said
        assert "more than --fail-over 6: turn the part" in said
        assert not written.exists()
