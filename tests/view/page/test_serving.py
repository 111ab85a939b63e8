"""The page on this computer: who is answered, what is told, when it is made again."""

from __future__ import annotations

import http.client
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.view.page.shown import Shown
from v3dcad.commands.show_page import serve_file
from v3dcad.errors import V3dcadError
from v3dcad.view.page import serving
from v3dcad.view.page.serving import Live, Stamp, follow, served, stamp


class Making:
    """Pages made of a file's text; "bad" is no page."""

    def __init__(self, file: Path) -> None:
        self.file = file

    def __call__(self, number: int) -> str:
        text = self.file.read_text(encoding="utf-8")
        if text == "bad":
            raise V3dcadError("two\n--lines")
        return f"{number}: {text}"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    found = tmp_path / "part.ont"
    found.write_text("one", encoding="utf-8")
    return found


@pytest.fixture
def live(file: Path) -> Live:
    return Live(Making(file))


@pytest.fixture
def port(live: Live, file: Path) -> Iterator[int]:
    ended = threading.Event()
    following = threading.Thread(target=follow, args=(file, stamp(file), live, ended.is_set))
    following.start()
    with served(live) as address:
        assert address.startswith("http://127.0.0.1:")
        yield int(address.rstrip("/").rsplit(":", 1)[1])
    ended.set()
    following.join()


def answer(port: int, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
    connection.request("GET", path, headers=headers)
    return connection.getresponse()


def told(response: http.client.HTTPResponse) -> tuple[str, str]:
    """The next event: its name and its text."""
    while True:
        line = response.readline().decode().strip()
        if line.startswith("event: "):
            return line[7:], response.readline().decode().strip()[6:]


def test_a_file_that_was_written_makes_another_page(port: int, file: Path) -> None:
    assert answer(port, "/").read() == b"1: one"
    heard = answer(port, "/changes?1")
    file.write_text("another", encoding="utf-8")
    assert told(heard) == ("made", "2")
    assert answer(port, "/").read() == b"2: another"
    assert told(answer(port, "/changes?1")) == ("made", "2"), "who comes late hears of it too"


def test_what_cannot_be_shown_is_told_and_the_page_stays(port: int, file: Path) -> None:
    heard = answer(port, "/changes?1")
    file.write_text("bad", encoding="utf-8")
    assert told(heard) == ("failed", "two --lines")
    assert answer(port, "/").read() == b"1: one"


def test_what_is_written_while_the_first_page_is_made_counts(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known: list[Stamp] = []
    monkeypatch.setattr(serving, "follow", lambda file, made_of, live: known.append(made_of))

    def make(number: int) -> str:
        file.write_text("written meanwhile", encoding="utf-8")
        return ""

    before = stamp(file)
    serve_file(file, make, opens=False)
    assert known == [before]
    assert before != stamp(file)


def test_only_this_computer_by_its_own_name_is_answered(port: int) -> None:
    assert answer(port, "/", Host=f"localhost:{port}").status == 200
    for name in ("evil.example", f"evil.example:{port}", "127.0.0.1", ""):
        assert answer(port, "/", Host=name).status == 403, name


@pytest.mark.parametrize("path", ["/other", "/changes", "/changes?x", "/../etc/passwd"])
def test_there_is_nothing_else(port: int, path: str) -> None:
    assert answer(port, path).status == 404


def test_a_first_page_that_cannot_be_made_is_an_error(file: Path) -> None:
    file.write_text("bad", encoding="utf-8")
    with pytest.raises(V3dcadError):
        Live(Making(file))


def test_a_browser_loads_the_page_again_and_keeps_the_view(browser: Any, structure: Any) -> None:
    live = Live(lambda number: structure.page(live=number))
    with served(live) as address:
        shown = Shown(browser, address, offline=False)
        shown.set(layer=9, target="layer")
        live.renew()
        shown.tab.wait_for_function("() => globalThis.v3dcad?.told.live === 2", timeout=30_000)
        assert shown.state("layer") == 9
        assert shown.state("target") == "layer"
        shown.close()
