"""Files are written whole or not at all, through links and into devices."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from v3dcad.commands.outputs import check_outputs
from v3dcad.errors import SettingError, V3dcadError
from v3dcad.files import is_stdout, is_stream, written_beside


def write(path: Path, text: str) -> None:
    with written_beside(path) as beside:
        beside.write_text(text)


def write_half(path: Path) -> None:
    with written_beside(path) as beside:
        beside.write_text("ha")
        assert beside.suffix == path.suffix
        raise ValueError("half")


def test_a_file_is_there_whole_or_as_it_was(tmp_path: Path) -> None:
    file = tmp_path / "new" / "a.gcode"
    write(file, "one")
    file.chmod(0o640)
    with pytest.raises(ValueError, match="half"):
        write_half(file)
    assert file.read_text() == "one"
    write(file, "three")
    assert file.read_text() == "three"
    assert file.stat().st_mode & 0o777 == 0o640
    assert os.listdir(file.parent) == ["a.gcode"]


def test_what_another_process_left_is_left_alone(tmp_path: Path) -> None:
    left = tmp_path / f".v3dcad-{os.getpid()}-0.ont"
    left.write_text("left")
    write(tmp_path / "a.ont", "mine")
    assert left.read_text() == "left"
    assert (tmp_path / "a.ont").read_text() == "mine"
    assert len(os.listdir(tmp_path)) == 2


def test_a_name_may_be_as_long_as_the_system_allows(tmp_path: Path) -> None:
    file = tmp_path / f"{251 * 'a'}.ont"
    write(file, "x")
    assert os.listdir(tmp_path) == [file.name]


def test_a_link_is_written_through(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    link, target = tmp_path / "a.ont", tmp_path / "there" / "b.ont"
    link.symlink_to(target)
    for text in ("one", "two"):  # the target is not there at first
        write(link, text)
        assert link.is_symlink()
        assert target.read_text() == text
    assert os.listdir(tmp_path / "there") == ["b.ont"]
    loop = tmp_path / "loop.ont"
    loop.symlink_to(loop)
    with pytest.raises(V3dcadError, match="cannot be written"):
        write(loop, "x")


def test_a_device_stays_a_device(tmp_path: Path) -> None:
    null = Path("/dev/null")
    write(null, "x")
    assert is_stream(null)
    (tmp_path / "null.ont").symlink_to(null)
    write(tmp_path / "null.ont", "x")
    assert is_stream(null)
    assert (tmp_path / "null.ont").is_symlink()


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"])
def test_standard_output_gets_the_whole_where_it_stands(name: str, tmp_path: Path) -> None:
    """Also where it is a file that has something in it already."""
    assert is_stdout(Path(name))
    code = (
        "from pathlib import Path\n"
        "from v3dcad.files import written_beside\n"
        "print('before', flush=True)\n"
        f"with written_beside(Path({name!r})) as beside: beside.write_text('whole\\n')\n"
        "print('after')\n"
    )
    with (tmp_path / "out").open("w") as out:
        subprocess.run([sys.executable, "-c", code], stdout=out, check=True)
    assert (tmp_path / "out").read_text() == "before\nwhole\nafter\n"


def test_a_pipe_gets_the_whole(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = subprocess.Popen(["cat", pipe], stdout=subprocess.PIPE, encoding="utf-8")
    write(pipe, "whole")
    assert reader.communicate(timeout=20)[0] == "whole"
    assert pipe.is_fifo()


def test_what_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for path in (tmp_path, tmp_path / "file" / "a.ont", Path("/proc/a.ont")):
        with pytest.raises(V3dcadError, match="cannot be written"):
            write(path, "x")
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.parametrize(
    ("files", "says"),
    [
        ({"gcode": "a.gcode", "ont": "a.gcode"}, "--ont a.gcode: --gcode names the same file"),
        ({"gcode": "a.gcode", "report": "./a.gcode"}, "--report a.gcode: --gcode names the same"),
        ({"gcode": "link.gcode", "step": "a.gcode"}, "--step a.gcode: --gcode names the same"),
        ({"ont": "part.stl"}, "would overwrite the part"),
        ({"gcode": ""}, "--gcode .: a folder; name a file"),
        ({"png": "a.jpg"}, "--png a.jpg: ends as another kind of file; name it a.png"),
        ({"threemf": "a.stl"}, "--3mf a.stl: ends as another kind of file; name it a.3mf"),
        ({"report": "a.svg"}, "--report a.svg: ends as another kind of file; name it a.json"),
    ],
)
def test_files_that_cannot_all_be_written(
    files: dict[str, str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("link.gcode").symlink_to("a.gcode")
    with pytest.raises(SettingError) as error:
        check_outputs(Path("part.stl"), {kind: Path(file) for kind, file in files.items()})
    assert says in error.value.message


def test_files_that_can_all_be_written() -> None:
    null = Path("/dev/null")
    check_outputs(Path("a.stl"), {"gcode": null, "ont": null, "step": Path("a.txt")})
