"""The page comes before the user's eyes where there is a browser, unless it shall not."""

from __future__ import annotations

import sys
import webbrowser
from pathlib import Path

import pytest

from v3dcad.cli import main
from v3dcad.commands import show_page


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


@pytest.mark.parametrize(("words", "count"), [((), 1), (("--no-browser",), 0)])
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
    part = ("view", str(samples / "pyramid.stl"), "--layer-height", "10", "--cell-size", "12")
    monkeypatch.setattr(sys, "argv", ["v3dcad", *part, "--html", str(page), *words])
    with pytest.raises(SystemExit) as stop:
        main()
    assert not stop.value.code
    assert page.read_text(encoding="utf-8").startswith("<!doctype html>")
    assert opened == [page.as_uri()] * count
    said = capsys.readouterr().out
    assert "opened in the browser" in said if count else f"open {page.as_uri()}" in said
