"""`v3dcad view` as a user calls it: the page, what it shows first, where it is opened."""

from __future__ import annotations

import json
import re
import sys
import webbrowser
from pathlib import Path
from typing import Any

import pytest

from v3dcad.cli import main
from v3dcad.commands import estimate, show_page

COARSE = ("--layer-height", "10", "--cell-size", "12")


def view(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    """The exit code of the command."""
    monkeypatch.setattr(sys, "argv", ["v3dcad", "view", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        main()
    return int(stop.value.code or 0)


def told(page: Path) -> dict[str, Any]:
    """What a page says and how, as its scripts read it."""
    (found,) = re.findall(r'id="told">(.*?)</script>', page.read_text(encoding="utf-8"), re.S)
    values: dict[str, Any] = json.loads(found)
    return values


def test_without_a_browser_nothing_is_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in show_page.SCREENS:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(show_page.sys, "platform", "linux")
    assert not show_page.open_in_browser("file:///a.html")
    monkeypatch.setenv("DISPLAY", ":0")
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    assert show_page.open_in_browser("file:///a.html")
    assert opened == ["file:///a.html"]


@pytest.mark.parametrize(("words", "count"), [((), 1), (("--no-open",), 0)])
def test_the_page_is_opened_unless_it_shall_not_be(
    words: tuple[str, ...],
    count: int,
    samples: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    monkeypatch.setenv("DISPLAY", ":0")
    page = tmp_path / "a.html"
    assert view(monkeypatch, samples / "pyramid.stl", *COARSE, "--html", page, *words) == 0
    assert page.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert opened == [page.as_uri()] * count
    said = capsys.readouterr().out
    assert "opened in the browser" in said if count else f"open {page.as_uri()}" in said


def test_the_page_begins_with_what_is_asked_for(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, how = tmp_path / "a.html", (samples / "pyramid.stl", *COARSE, "--no-open")
    sites = tmp_path / "sites.csv"
    sites.write_text("x,y\n-10,0\n10,-8\n10,8\n", encoding="utf-8")
    where = ("--target", "neighbour", "--layer", 1, "--cell", 0, "--neighbour", 2)
    plain = (how[0], "--layer-height", 10, "--no-open", "--sites-file", sites)
    assert view(monkeypatch, *plain, "--html", page, *where) == 0
    first = {"target": "neighbour", "layer": 1, "cell": 0, "neighbour": 2}
    assert told(page)["first"] == first
    assert ["cells", "3"] in told(page)["facts"]
    assert view(monkeypatch, *how, "--html", page) == 0
    assert told(page)["first"] == {"target": "full", "layer": 4}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--serve", "--html", "a.html"), "--serve keeps the page in memory; leave out --html"),
        (("--html", "a.html", "--target", "layer", "--layer", "5"), "the layers are 0 to 4"),
        (("--html", "a.html", "--cell-size", "1"), "of memory, of which there are 1 MB"),
    ],
)
def test_a_page_that_cannot_be_is_told_in_one_line(
    words: tuple[str, ...],
    said: str,
    samples: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    if "--cell-size" in words:
        monkeypatch.setattr(estimate, "_memory", lambda: 1_000_000)
    assert view(monkeypatch, samples / "pyramid.stl", *COARSE, "--no-open", *words) == 2
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
