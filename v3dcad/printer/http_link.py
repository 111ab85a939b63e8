"""Dialogues with print servers carried over HTTP. The only file that imports an HTTP library.

What a server does cannot hurt: each request has a time that it must be over in, an answer of more
than `MOST_BYTES` is given up, lines of a head are bounded by aiohttp, certificates are checked, and
a redirect is never followed: the key goes to the address that was given and nowhere else.
"""

from __future__ import annotations

import asyncio
import contextlib
import io
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import aiohttp

from v3dcad.errors import LocalPrinterError
from v3dcad.printer.ends import HostError, HostFault
from v3dcad.printer.hosts.requests import Answer, Dialogue, Request

T = TypeVar("T")

MOST_BYTES = 4_000_000
"""Bytes of an answer; a list of many files stays below."""
TOTAL = 30.0
"""Seconds that a request may take, from name look-up to the answer's last byte."""
CONNECT = 10.0
STALLED = 60.0
"""Seconds in which no block of an upload is taken, or no answer comes to it; it is given up."""
SLOWEST = 10_000.0
"""Bytes a second below which an upload is given up as a whole."""
TRIES = 3
"""How often a question that changes nothing is asked when the connection fails."""
BETWEEN = 0.5
"""Seconds between two tries, doubled each time."""

Progress = Callable[[int], None]


@dataclass(frozen=True, slots=True)
class Address:
    """Where a print server is, and how one proves to be allowed."""

    url: str
    key: str = ""
    user: str = ""
    """with a user, `key` is the password and goes by HTTP digest"""


def carry(
    dialogue: Dialogue[T],
    address: Address,
    *,
    file: Path | None = None,
    progress: Progress = lambda count: None,
) -> T:
    """Carry a dialogue to its end and return what it returns.

    `file` is what a request with an upload sends; a block of it is in memory at a time, and
    `progress` is told of each. Raises `HostError` for all that goes wrong between here and there.
    """
    return asyncio.run(_carry(dialogue, address, file, progress))


async def _carry(
    dialogue: Dialogue[T], address: Address, file: Path | None, progress: Progress
) -> T:
    headers = {"Accept": "application/json"}
    middlewares: tuple[aiohttp.ClientMiddlewareType, ...] = ()
    if address.user:
        digest = aiohttp.DigestAuthMiddleware(address.user, address.key)
        middlewares = (digest, _let_refusals_go)
    elif address.key:
        headers["X-Api-Key"] = address.key
    session = aiohttp.ClientSession(
        headers=headers, middlewares=middlewares, cookie_jar=aiohttp.DummyCookieJar()
    )
    async with session:
        try:
            request = next(dialogue)
            while True:
                answer = await _answer(session, address.url, request, file, progress)
                request = dialogue.send(answer)
        except StopIteration as end:
            value: T = end.value
            return value


async def _let_refusals_go(
    request: aiohttp.ClientRequest, handler: aiohttp.ClientHandlerType
) -> aiohttp.ClientResponse:
    """Give the connection of a 401 back, which aiohttp's digest leaves open until it is collected.

    Nobody reads what such an answer says.
    """
    response = await handler(request)
    if response.status == 401:
        response.release()
    return response


async def _answer(
    session: aiohttp.ClientSession,
    url: str,
    request: Request,
    file: Path | None,
    progress: Progress,
) -> Answer:
    """One request, asked again where that changes nothing."""
    tries = TRIES if request.method in ("GET", "HEAD") else 1
    for number in range(1, tries + 1):
        try:
            return await _once(session, url, request, file, progress)
        except (aiohttp.ServerDisconnectedError, aiohttp.ClientConnectorError) as error:
            if number == tries:
                raise _unreachable(url, request, error) from error
            await asyncio.sleep(BETWEEN * 2 ** (number - 1))
        except TimeoutError as error:
            raise _unreachable(url, request, error) from error
        except aiohttp.ClientError as error:
            raise _broken(url, request, error) from error
    raise AssertionError("a try returns or raises")


async def _once(
    session: aiohttp.ClientSession,
    url: str,
    request: Request,
    file: Path | None,
    progress: Progress,
) -> Answer:
    size = file.stat().st_size if request.upload and file else 0
    timeout = aiohttp.ClientTimeout(
        total=TOTAL + size / SLOWEST, connect=CONNECT, sock_read=STALLED if size else TOTAL
    )
    loop = asyncio.get_running_loop()
    stalled = asyncio.timeout(None)

    def moved(count: int) -> None:
        """A block was taken, in whatever thread: the time without progress begins anew."""
        progress(count)
        limit = loop.time() + STALLED if count else None
        loop.call_soon_threadsafe(_restart, stalled, limit)

    body = _Watched(file, moved) if request.upload and file else None
    try:
        async with (
            stalled,
            session.request(
                request.method,
                url.rstrip("/") + request.path,
                params=request.query or None,
                headers=request.headers,
                json=request.json,
                data=_form(request, body),
                timeout=timeout,
                allow_redirects=False,
            ) as response,
        ):
            if 300 <= response.status < 400:
                where = Answer(0, {"to": response.headers.get("Location", "elsewhere")}).words("to")
                raise HostError(
                    HostFault.HOSTILE,
                    f"{url} sends on to {where}, where the key does not go; if that is the "
                    "server, add the printer with this --url",
                )
            if response.status == 401:
                return Answer(401)
            return Answer(response.status, _json(await _bounded(response, url)))
    finally:
        if body is not None:
            body.close()


def _restart(timeout: asyncio.Timeout, limit: float | None) -> None:
    with contextlib.suppress(RuntimeError):  # the request is over
        timeout.reschedule(limit)


def _form(request: Request, body: _Watched | None) -> aiohttp.FormData | _Watched | None:
    if body is None or request.form is None:
        return body
    form = aiohttp.FormData(quote_fields=False)  # servers take a name as it stands
    for name, value in request.form.items():
        form.add_field(name, value)
    form.add_field("file", body, filename=request.upload, content_type="application/octet-stream")
    return form


async def _bounded(response: aiohttp.ClientResponse, url: str) -> bytes:
    data = bytearray()
    async for block in response.content.iter_chunked(65536):
        data += block
        if len(data) > MOST_BYTES:
            raise HostError(HostFault.HOSTILE, f"{url} answers without end; is it a print server?")
    return bytes(data)


def _json(data: bytes) -> object:
    try:
        found: object = json.loads(data)
    except (ValueError, RecursionError):
        return None
    return found


def _unreachable(url: str, request: Request, error: Exception) -> HostError:
    if request.upload:
        return HostError(HostFault.CUT, f"{url}: the upload broke off ({_reason(error)})")
    return HostError(
        HostFault.UNREACHABLE,
        f"{url} cannot be reached ({_reason(error)}); is it on, and the address right?",
    )


def _broken(url: str, request: Request, error: aiohttp.ClientError) -> Exception:
    if isinstance(error, aiohttp.InvalidURL):
        return LocalPrinterError(f"{url} is no address; write it as http://HOST or https://HOST")
    if isinstance(error, (aiohttp.ClientOSError, aiohttp.ClientPayloadError)):
        return _unreachable(url, request, error)
    return HostError(
        HostFault.HOSTILE,
        f"{url} does not answer as a web server does ({type(error).__name__})",
    )


def _reason(error: Exception) -> str:
    if isinstance(error, TimeoutError):
        return "no answer in time"
    if isinstance(error, aiohttp.ClientConnectorCertificateError):
        return "its certificate is not trusted"
    cause = getattr(error, "os_error", error)
    return str(getattr(cause, "strerror", None) or type(error).__name__)


class _Watched(io.BufferedReader):
    """A file that tells how much of it was read."""

    def __init__(self, path: Path, progress: Progress) -> None:
        super().__init__(io.FileIO(path))
        self._progress = progress

    def read(self, size: int | None = -1, /) -> bytes:
        """The next bytes."""
        data = super().read(size)
        self._progress(len(data))
        return data
