"""What is asked of a print server, and what it answers, as values.

Each thing that one wants of a server is a *dialogue*: a generator that yields requests, is sent
the answers, and returns what was wanted. `http_link` carries them.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar
from urllib.parse import quote

from v3dcad.printer.ends import HostError, HostFault

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Request:
    """One request. With `upload` the file is its body, as a form if `form` has fields."""

    method: str
    path: str
    query: dict[str, str] = field(default_factory=dict)
    headers: dict[str, str] = field(default_factory=dict)
    json: Any = None
    upload: str | None = None
    """the name that the file gets"""
    form: dict[str, str] | None = None
    """fields that go before the file; None sends the bare file"""


@dataclass(frozen=True, slots=True)
class Answer:
    """What came back. `data` is JSON read, or None where the body is no JSON."""

    status: int
    data: Any = None

    def at(self, *keys: str) -> Any:
        """A value inside the JSON, None where it is not there."""
        found = self.data
        for key in keys:
            found = found.get(key) if isinstance(found, dict) else None
        return found

    def words(self, *keys: str) -> str:
        """A text inside the JSON on one line of at most 200 characters; "" where there is none.

        What a terminal would obey is left out.
        """
        found = self.at(*keys)
        text = found if isinstance(found, str) else ""
        shown = "".join(letter if letter.isprintable() else " " for letter in text)
        return " ".join(shown.split())[:200]


Dialogue = Generator[Request, Answer, T]


@dataclass(frozen=True, slots=True)
class HostState:
    """How a print server and its printer are."""

    version: str
    state: str
    """in the server's words"""
    ready: bool
    """whether a print can be started now"""


class Host(Protocol):
    """One kind of print server."""

    title: str
    """its name"""

    def state(self) -> Dialogue[HostState]:
        """Version and state. Raises `HostError` for a wrong key or another kind of server."""

    def exists(self, name: str) -> Dialogue[bool]:
        """Whether a file of this name is there."""

    def upload(self, name: str, sha256: str, *, replace: bool) -> Dialogue[str]:
        """Send the file; where it lies. Never starts it."""

    def start(self, name: str) -> Dialogue[None]:
        """Start to print a file that is there."""

    def remove(self, name: str) -> Dialogue[None]:
        """Delete a file; it is no error if there is none."""


def introduced(title: str, path: str, *keys: str) -> Dialogue[Answer]:
    """Ask a server what it is; its answer has a text at `keys`.

    Raises `HostError` for a wrong key, or a server that does not answer as `title` does.
    """
    answer = yield Request("GET", path)
    if answer.status == 404:
        raise other_kind(title)
    refuse(answer, "version")
    if not answer.words(*keys):
        raise other_kind(title)
    return answer


def refuse(answer: Answer, doing: str, *fine: int) -> None:
    """Raise `HostError` for the statuses that mean the same with every server; `fine` do not."""
    status = answer.status
    if status in fine or (not fine and 200 <= status < 300):
        return
    if status in (401, 403):
        raise HostError(HostFault.KEY, f"{doing}: the server refuses the key; add the printer anew")
    if status in (413, 507):
        raise HostError(HostFault.FULL, f"{doing}: no room on the server; delete old files there")
    if status == 409:
        raise HostError(HostFault.BUSY, f"{doing}: {said(answer) or 'the printer is at work'}")
    message = f"{doing}: the server answers {status}"
    raise HostError(HostFault.OTHER, f"{message}, {said(answer)}" if said(answer) else message)


def said(answer: Answer) -> str:
    """The server's own words about an error, one line."""
    places = (("error", "message"), ("error",), ("message",), ("title",), ("text",))
    return next(filter(None, (answer.words(*keys) for keys in places)), "")


def other_kind(title: str) -> HostError:
    """The error for a server that does not answer as its kind does."""
    return HostError(
        HostFault.KIND, f"this is not {title}, or not its address; check --kind and --url"
    )


def escaped(name: str) -> str:
    """A file's name as a part of a path."""
    return quote(name, safe="")
