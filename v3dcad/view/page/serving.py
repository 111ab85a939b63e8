"""The page on this computer, made again whenever a file changes.

The browser keeps a connection open on which it hears of changes (server-sent events). Only this
computer is listened to, and only requests that name it are answered, so that no other site's page
can read this one through a name of its own that leads here.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

from v3dcad.errors import V3dcadError

HOST = "127.0.0.1"
PAUSE = 0.4
"""Seconds between two looks at the file."""
HEARTBEAT = 10.0
"""Seconds after which a browser that went away is noticed."""

Stamp = tuple[int, int] | None
"""When a file was written, and its size; None while it is not there."""


class Live:
    """The page as it is now, and what has become of it; pages are numbered from 1."""

    def __init__(self, make: Callable[[int], str]) -> None:
        """Make the first page; `make` takes the page's number, and may raise `V3dcadError`."""
        self._make = make
        self._changed = threading.Condition()
        self._number = 1
        self._page = make(1).encode()
        self._news = b""
        self._failures = 0

    def page(self) -> bytes:
        """The latest page that could be made."""
        return self._page

    def renew(self) -> None:
        """Make the page again and tell everybody; where that fails it stays, and they hear why."""
        try:
            page = self._make(self._number + 1).encode()
        except V3dcadError as error:
            with self._changed:
                self._news = _event("failed", " ".join(error.message.split()))
                self._failures += 1
                self._changed.notify_all()
            return
        with self._changed:
            self._page, self._number = page, self._number + 1
            self._changed.notify_all()

    def news(self, number: int) -> Iterator[bytes]:
        """What somebody with the page of a number hears, as server-sent events; without end."""
        with self._changed:
            failures = self._failures
            while True:
                if self._number > number:
                    number = self._number
                    yield _event("made", str(number))
                elif self._failures > failures:
                    yield self._news
                else:
                    yield b":\n\n"
                failures = self._failures
                self._changed.wait(HEARTBEAT)


def _event(name: str, text: str) -> bytes:
    return f"event: {name}\ndata: {text}\n\n".encode()


@contextmanager
def served(live: Live) -> Iterator[str]:
    """Serve a page while the block runs; gives its address."""

    class Handler(_Handler):
        shown = live

    server = ThreadingHTTPServer((HOST, 0), Handler)
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://{HOST}:{server.server_port}/"
    finally:
        server.shutdown()
        server.server_close()


def follow(
    file: Path, made_of: Stamp, live: Live, ended: Callable[[], bool] = lambda: False
) -> None:
    """Make the page again each time the file was written, until `ended` says so.

    `made_of` is the file's stamp when the page that is shown was begun. A file that is still being
    written is waited for.
    """
    known = seen = made_of
    while not ended():
        time.sleep(PAUSE)
        now = stamp(file)
        still, seen = now == seen, now
        if still and now is not None and now != known:
            known = now
            live.renew()


def stamp(file: Path) -> Stamp:
    """What changes when a file is written; None while it is not there."""
    try:
        found = file.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


class _Handler(BaseHTTPRequestHandler):
    shown: Live

    def do_GET(self) -> None:
        """Answer with the page, or with what is told of it from now on."""
        assert isinstance(self.server, ThreadingHTTPServer)
        port, asked = self.server.server_port, urlsplit(self.path)
        if self.headers.get("Host") not in (f"{HOST}:{port}", f"localhost:{port}"):
            self.send_error(HTTPStatus.FORBIDDEN)
        elif asked.path == "/":
            page = self.shown.page()
            self._begin("text/html; charset=utf-8", length=len(page))
            self.wfile.write(page)
        elif asked.path == "/changes" and asked.query.isdecimal():
            self._begin("text/event-stream")
            try:
                for news in self.shown.news(int(asked.query)):
                    self.wfile.write(news)
                    self.wfile.flush()
            except OSError:
                pass  # the browser went away
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing: the terminal belongs to the command."""

    def _begin(self, kind: str, length: int | None = None) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        if length is not None:
            self.send_header("Content-Length", str(length))
        self.end_headers()
