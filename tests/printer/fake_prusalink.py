"""A server that follows PrusaLink's published API, `spec/openapi.yaml` of Prusa-Link-Web.

/api/version, /api/v1/status, /api/v1/storage; HEAD, PUT, POST and DELETE of
/api/v1/files/{storage}/{path}; 401 without the key, 409 for a file that exists, 404 for one that
does not. With a password it asks for HTTP digest (RFC 7616) as Prusa's firmware does.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import ClassVar


class FakePrusaLink(BaseHTTPRequestHandler):
    key: ClassVar[str] = "key"
    user: ClassVar[str] = ""
    state: ClassVar[str] = "IDLE"
    files: ClassVar[dict[str, bytes]]
    started: ClassVar[list[str]]
    breaks_after: ClassVar[int] = 0
    full: ClassVar[bool] = False
    protocol_version = "HTTP/1.1"

    def answer(self, status: int, value: object = None, **headers: str) -> None:
        body = b"" if value is None else json.dumps(value).encode()
        self.send_response(status)
        for name, text in {"Content-Length": str(len(body)), **headers}.items():
            self.send_header(name.replace("_", "-"), text)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(body)

    def allowed(self) -> bool:
        if not self.user:
            fine = self.headers.get("X-Api-Key") == self.key
            if not fine:
                self.answer(401, {"title": "Unauthorized"})
            return fine
        given = dict(re.findall(r'(\w+)="?([^",]+)', self.headers.get("Authorization", "")))
        secret = self.digest(f"{self.user}:Printer API:{self.key}")
        asked = self.digest(f"{self.command}:{self.path}")
        words = (secret, given.get("nonce"), given.get("nc"), given.get("cnonce"))
        right = self.digest(f"{':'.join(map(str, words))}:auth:{asked}")
        if given.get("response") != right:
            challenge = 'Digest realm="Printer API", nonce="abc", qop="auth", algorithm=MD5'
            self.answer(401, {"title": "Unauthorized"}, WWW_Authenticate=challenge)
            return False
        return True

    @staticmethod
    def digest(text: str) -> str:
        return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()

    def handle_any(self) -> None:
        body_size = int(self.headers.get("Content-Length") or 0)
        name = self.path.removeprefix("/api/v1/files/usb/")
        if self.command == "PUT" and self.breaks_after:
            self.rfile.read(self.breaks_after)
            self.files[name] = b"half"
            self.close_connection = True
            self.connection.close()
            return
        body = self.rfile.read(body_size)
        if not self.allowed():
            return
        if self.path == "/api/version":
            self.answer(200, {"api": "2.0.0", "server": "2.1.2", "text": "PrusaLink"})
        elif self.path == "/api/v1/status":
            self.answer(200, {"printer": {"state": self.state}})
        elif self.path == "/api/v1/storage":
            local = {"path": "/local", "available": False}
            usb = {"path": "/usb", "available": True, "read_only": False}
            self.answer(200, {"storage_list": [local, usb]})
        elif self.command == "PUT":
            if self.full:
                self.answer(507, {"title": "Insufficient Storage"})
            elif name in self.files and self.headers["Overwrite"] != "?1":
                self.answer(409, {"title": "File exists"})
            else:
                self.files[name] = body
                self.answer(201, {"name": name})
        elif name not in self.files:
            self.answer(404, {"title": "Not found"})
        elif self.command == "HEAD":
            self.answer(200)
        elif self.command == "POST":
            self.started.append(name)
            self.answer(204)
        else:
            del self.files[name]
            self.answer(204)

    do_GET = do_HEAD = do_PUT = do_POST = do_DELETE = handle_any  # noqa: N815

    def log_message(self, *_: object) -> None: ...


class Server(ThreadingHTTPServer):
    """Says nothing of a client that hangs up.

    v3dcad leaves what a 401 says unread, so that the kernel may reset the connection when it is
    closed. Python's server would print a traceback, into what a test reads as v3dcad's own words.
    """

    def handle_error(self, request: object, client_address: object) -> None:
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)  # type: ignore[arg-type]


class Serving:
    """A handler served on a port of its own."""

    def __init__(self, handler: type[BaseHTTPRequestHandler]) -> None:
        self.server = Server(("127.0.0.1", 0), handler)
        self.server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self.server.server_address[1]}"

    def __enter__(self) -> Serving:
        threading.Thread(target=self.server.serve_forever, args=(0.02,), daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self.server.shutdown()
        self.server.server_close()
