"""How commands are used: mistakes in a command's words, the version, completion."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

import v3dcad
from v3dcad.cli import app, main
from v3dcad.errors import GeometryError, SettingError, with_arguments
from v3dcad.settings import PrintSettings, declared


def said_by(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["v3dcad", *words])
        with pytest.raises(SystemExit) as stop:
            main()
    code = stop.value.code
    assert isinstance(code, int | None)
    return code or 0, *capsys.readouterr()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["fil"], "no such command 'fil'; did you mean 'fill'?"),
        (["fill"], "missing argument 'PART'; see v3dcad fill --help"),
        (["ont", "convert", "a.ont"], "missing argument 'OUT'; see v3dcad ont convert --help"),
        (["fill", "a", "b"], "got unexpected extra argument(s) (b); see v3dcad fill --help"),
        (["fill", "a", "--layer-hight", "2"], "no such option: --layer-hight; did you mean --l"),
        (["fill", "a", "--out"], "option '--out' requires an argument; see v3dcad --help"),
        (["fill", "a", "--strict=3"], "option '--strict' does not take a value; see v3dcad"),
        (["fill", "a", "--layer-height", "x"], "--layer-height x: give a number"),
        (["fill", "a", "--perimeters", "2.5"], "--perimeters 2.5: give a whole number"),
        (["-x"], "no such option: -x; see v3dcad --help"),
        (["nc", "adjust", "a", "b", "--retraction", "x"], "invalid value for '--retraction'"),
    ],
)
def test_a_mistake_is_one_line_that_says_what_to_do(
    words: list[str], says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, said = said_by(capsys, *words)
    assert (code, out) == (2, "")
    assert said.startswith(f"v3dcad: {says}")
    assert said.count("\n") == 1


def commands(group: TyperGroup) -> Iterator[tuple[str, TyperCommand]]:
    for name, one in group.commands.items():
        if isinstance(one, TyperGroup):
            yield from commands(one)
        elif isinstance(one, TyperCommand):
            yield name, one


def test_no_command_has_two_options_of_one_name() -> None:
    group = get_command(app)
    assert isinstance(group, TyperGroup)
    found = dict(commands(group))
    assert {"fill", "view", "slice"} <= found.keys()
    for command, one in found.items():
        names = [name for known in one.params for name in (*known.opts, *known.secondary_opts)]
        twice = {name for name in names if names.count(name) > 1}
        assert not twice, command


@pytest.mark.parametrize("words", [[], ["ont"], ["printer"]])
def test_a_group_alone_shows_its_commands(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    code, out, said = said_by(capsys, *words)
    assert (code, said) == (2, "")
    assert "Commands" in out


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert said_by(capsys, "--version") == (0, f"v3dcad {v3dcad.__version__}\n", "")


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("v3dcad sli", ["slice"]),
        ("v3dcad fill --first-layer-he", ["--first-layer-height"]),
        ("v3dcad fill a.step --flavour ", [*declared(PrintSettings, "flavour").choices]),
        ("v3dcad fill a.step --stretch col", ["columns"]),
    ],
)
def test_a_shell_completes(
    line: str,
    found: list[str],
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("_V3DCAD_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", line)
    monkeypatch.setenv("COMP_CWORD", str(line.count(" ")))
    code, out, said = said_by(capsys)
    assert (code, out.split(), said) == (0, found, "")


@pytest.mark.parametrize(
    ("text", "in_python"),
    [
        ("--layer-height 0: give more", "layer_height 0: give more"),
        ("one of --method thesis, or --no-verify", "one of method thesis, or verify=False"),
        (
            "run `apt-get install -y libgl1` -- or a--b",
            "run `apt-get install -y libgl1` -- or a--b",
        ),
    ],
)
def test_errors_name_options_or_arguments(text: str, in_python: str) -> None:
    assert with_arguments(text) == in_python
    error = GeometryError(text, layer=3)
    assert str(error) == f"layer 3: {in_python}"
    assert error.message == f"layer 3: {text}"


def test_each_door_has_its_own_names(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SettingError, match=r"^layer_height -1: give a number above 0 mm$"):
        v3dcad.FillSettings(layer_height=-1)
    with pytest.raises(SettingError, match="'layer_hight'; did you mean layer_height"):
        v3dcad.fill("a.step", layer_hight=1)
    _, _, said = said_by(capsys, "fill", "a.stl", "--out", "b", "--layer-height", "-1")
    assert said == "v3dcad: --layer-height -1.0: give a number above 0 mm\n"
