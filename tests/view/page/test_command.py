"""Where there is no browser, nothing is opened."""

from __future__ import annotations

import webbrowser

import pytest

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
