"""Sending to print servers: what is asked of them, and what becomes of their faults."""

from __future__ import annotations

import gc
import hashlib
import io
import json
import socket
import stat
import sys
import threading
import time
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from printer.fake_prusalink import FakePrusaLink, Serving

from v3dcad.cli import main
from v3dcad.printer import address_book, http_link, sending
from v3dcad.printer.ends import HostError, HostFault
from v3dcad.printer.hosts.kinds import KINDS
from v3dcad.printer.hosts.octoprint import OctoPrint
from v3dcad.printer.hosts.prusalink import PrusaLink
from v3dcad.printer.hosts.requests import Answer, Dialogue
from v3dcad.printer.http_link import Address, carry
from v3dcad.printer.sending import Sending
from v3dcad.printer.settings import HostSettings

pytestmark = pytest.mark.slow

GCODE = "G28\nM83\nG1 Z0.2 F600\nG1 X10 Y10 E1 F1200\nG1 X20 Y10 E1\n"


@pytest.fixture(autouse=True)
def _own_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    import keyring
    from keyring.backends.fail import Keyring

    monkeypatch.setattr(keyring.core, "_keyring_backend", Keyring())


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "part.gcode"
    path.write_text(GCODE)
    return path


@pytest.fixture
def prusalink() -> Iterator[tuple[type[FakePrusaLink], str]]:
    handler = type("Handler", (FakePrusaLink,), {"files": {}, "started": []})
    with Serving(handler) as serving:
        yield handler, serving.url


def run(capsys: pytest.CaptureFixture[str], *words: object, stdin: str = "") -> tuple[int, str]:
    """Exit code and what was said on both outputs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["v3dcad", *map(str, words)])
        patch.setattr(sys, "stdin", io.StringIO(stdin))
        with pytest.raises(SystemExit) as stop:
            main()
    said = capsys.readouterr()
    code = stop.value.code
    if code == 2:
        assert said.err.count("\n") == 1, said.err
        assert said.err.startswith("v3dcad: ")
    return int(code or 0), said.out + said.err


def named(capsys: pytest.CaptureFixture[str], url: str, *words: object, key: str = "key") -> None:
    done = run(capsys, "printer", "add", "one", "--kind", "prusalink", "--url", url, *words,
               stdin=key + "\n")  # fmt: skip
    assert done[0] == 0, done


def test_a_file_is_sent_and_not_started(prusalink, file, capsys) -> None:
    handler, url = prusalink
    named(capsys, url)
    code, said = run(capsys, "send", file, "--to", "one")
    assert code == 0, said
    assert "usb/part.gcode" in said
    assert "not started" in said
    assert handler.files == {"part.gcode": GCODE.encode()}
    assert handler.started == []


def test_start_starts_only_a_ready_printer(prusalink, file, capsys) -> None:
    handler, url = prusalink
    named(capsys, url)
    handler.state = "PRINTING"
    code, said = run(capsys, "send", file, "--to", "one", "--start")
    assert code == 2
    assert "not ready (printing); nothing was sent" in said
    assert handler.files == {}
    handler.state = "IDLE"
    code, said = run(capsys, "send", file, "--to", "one", "--start", "--json")
    assert json.loads(said) == {"printer": "one", "file": "usb/part.gcode", "started": True}
    assert handler.started == ["part.gcode"]


def test_a_file_of_the_same_name_is_kept_unless_told(prusalink, file, capsys) -> None:
    handler, url = prusalink
    named(capsys, url)
    handler.files["part.gcode"] = b"old"
    code, said = run(capsys, "send", file, "--to", "one")
    assert code == 2
    assert "part.gcode is on one already; --replace replaces it" in said
    assert handler.files["part.gcode"] == b"old"
    assert run(capsys, "send", file, "--to", "one", "--replace")[0] == 0
    assert handler.files["part.gcode"] == GCODE.encode()


def test_digest(prusalink, file, capsys) -> None:
    handler, url = prusalink
    handler.user, handler.key = "maker", "secret"
    named(capsys, url, "--user", "maker", key="secret")
    assert run(capsys, "send", file, "--to", "one")[0] == 0
    assert handler.files == {"part.gcode": GCODE.encode()}
    named(capsys, url, "--user", "maker", key="other")
    code, said = run(capsys, "printer", "test", "one")
    assert code == 2
    assert "refuses the key" in said
    gc.collect()  # a connection left open would warn now, and warnings are errors


@pytest.mark.parametrize(
    ("options", "text", "message"),
    [
        (["--profile", "ender3v2"], "G1 X300 Y10 E1\n", "x runs from 10 to 300 mm, the bed from 0"),
        (["--profile", "ender3v2"], "G1 Z400\nG1 X30 Y10 E1\n", "it is 400 mm high"),
        (["--hottest-nozzle", "250"], "M109 S280\n", "heats the nozzle to 280 °C, at most 250"),
        (["--hottest-bed", "80"], "M190 S110\n", "heats the bed to 110 °C, at most 80"),
        (["--nozzle", "0.4"], "; nozzle_diameter = 0.6\n", "it is for a 0.6 mm nozzle, not 0.4"),
    ],
)
def test_what_does_not_fit_is_not_sent(prusalink, file, capsys, options, text, message) -> None:
    handler, url = prusalink
    named(capsys, url, *options)
    file.write_text(GCODE + text)
    code, said = run(capsys, "send", file, "--to", "one")
    assert code == 2
    assert message in said
    assert handler.files == {}


def test_a_profile_may_name_its_printer(prusalink, file, tmp_path, capsys) -> None:
    handler, url = prusalink
    named(capsys, url)
    profile = tmp_path / "p.toml"
    profile.write_text('printer = "one"\n')
    assert run(capsys, "send", file, "--profile", profile)[0] == 0
    assert "part.gcode" in handler.files
    profile.write_text('bed = "100x100"\n')
    assert "names no printer" in run(capsys, "send", file, "--profile", profile)[1]
    assert "give --to NAME" in run(capsys, "send", file)[1]


def test_keys_are_kept_for_their_owner_alone(prusalink, capsys, tmp_path) -> None:
    named(capsys, prusalink[1], key="hush")
    keys = tmp_path / "config" / "v3dcad" / "keys.json"
    assert json.loads(keys.read_text()) == {"one": "hush"}
    assert stat.S_IMODE(keys.stat().st_mode) == 0o600
    for words in (["printer", "list"], ["printer", "list", "--json"], ["printer", "test", "one"]):
        assert "hush" not in run(capsys, *words)[1]
    assert "hush" not in (keys.parent / "printers.toml").read_text()
    assert run(capsys, "printer", "remove", "one")[0] == 0
    assert json.loads(keys.read_text()) == {}
    assert address_book.printers() == {}


def test_the_systems_key_store_comes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    import keyring
    from keyring.backend import KeyringBackend

    class Store(KeyringBackend):
        priority = 1  # type: ignore[assignment]
        kept: dict[tuple[str, str], str] = {}  # noqa: RUF012

        def get_password(self, service: str, username: str) -> str | None:
            return self.kept.get((service, username))

        def set_password(self, service: str, username: str, password: str) -> None:
            self.kept[service, username] = password

        def delete_password(self, service: str, username: str) -> None:
            del self.kept[service, username]

    monkeypatch.setattr(keyring.core, "_keyring_backend", Store())
    assert address_book.set_key("one", "hush") == "the system's key store"
    assert address_book.key("one") == "hush"
    assert not (address_book.folder() / "keys.json").exists()
    address_book.set_key("one", "")
    assert Store.kept == {}
    assert address_book.key("one") == ""


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["printer", "add", "a/b", "--kind", "octoprint", "--url", "http://x"], "name a printer"),
        (["printer", "add", "a", "--url", "http://x"], "--kind is missing"),
        (["printer", "add", "a", "--kind", "bambu", "--url", "http://x"], "octoprint or moonraker"),
        (["printer", "add", "a", "--kind", "octoprint", "--url", "x"], "write http://HOST"),
        (["printer", "add", "a", "--kind", "octoprint", "--url", "http://me:pw@x"], "without user"),
        (["printer", "test", "nobody"], "no printer of this name (known: none yet"),
        (["printer", "remove", "nobody"], "no printer of this name"),
    ],
)
def test_mistakes(capsys, words, message) -> None:
    code, said = run(capsys, *words)
    assert code == 2
    assert message in said


def test_a_book_that_cannot_be_read(capsys) -> None:
    path = address_book.folder() / "printers.toml"
    path.parent.mkdir(parents=True)
    path.write_text("one = [")
    assert "no TOML" in run(capsys, "printer", "list")[1]
    path.write_text("[one]\ncolour = 1\n")
    assert "knows a key that no printer has" in run(capsys, "printer", "list")[1]
    (path.parent / "keys.json").write_text("{")
    path.unlink()
    with pytest.raises(Exception, match=r"keys\.json: cannot be read"):
        address_book.key("one")


def test_an_upload_that_is_cut_leaves_nothing(prusalink, file, capsys) -> None:
    handler, url = prusalink
    named(capsys, url)
    file.write_text(GCODE * 20_000)
    handler.breaks_after = 1000
    code, said = run(capsys, "send", file, "--to", "one")
    assert code == 2
    assert "the upload broke off" in said
    assert "nothing of it is left on the server" in said
    assert handler.files == {}


def test_a_full_server(prusalink, file, capsys) -> None:
    handler, url = prusalink
    named(capsys, url)
    handler.full = True
    code, said = run(capsys, "send", file, "--to", "one")
    assert code == 2
    assert "no room on the server" in said


def test_uploads_are_streamed(prusalink, tmp_path) -> None:
    handler, url = prusalink
    file = tmp_path / "big.gcode"
    file.write_bytes(b"G1 X1\n" * 4_000_000)
    received = hashlib.sha256()

    def handle(self: FakePrusaLink) -> None:
        left = int(self.headers.get("Content-Length") or 0)
        while left:
            block = self.rfile.read(min(left, 65536))
            received.update(block)
            left -= len(block)
        self.answer(201 if self.command == "PUT" else 200,
                    {"storage_list": [{"path": "/usb", "available": True}]})  # fmt: skip

    handler.do_PUT = handle
    sent: list[int] = []
    tracemalloc.start()
    try:
        host = PrusaLink()
        address = Address(url, "key")
        where = carry(host.upload("big.gcode", "", replace=False), address, file=file,
                      progress=sent.append)  # fmt: skip
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert where == "usb/big.gcode"
    assert received.digest() == hashlib.sha256(file.read_bytes()).digest()
    assert sum(sent) == file.stat().st_size
    assert peak < 8_000_000


class Hostile:
    """A server that says something to whoever connects, and then nothing more."""

    def __init__(self, say: Callable[[socket.socket], None]) -> None:
        self.say = say
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self.listener.getsockname()[1]}"

    def __enter__(self) -> Hostile:
        threading.Thread(target=self.serve, daemon=True).start()
        return self

    def __exit__(self, *_: object) -> None:
        self.listener.close()

    def serve(self) -> None:
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            threading.Thread(target=self.talk, args=(connection,), daemon=True).start()

    def talk(self, connection: socket.socket) -> None:
        try:
            connection.recv(65536)
            self.say(connection)
        except OSError:
            pass
        finally:
            connection.close()


def for_ever(first: bytes, then: bytes, pause: float = 0.0) -> Callable[[socket.socket], None]:
    def say(connection: socket.socket) -> None:
        connection.sendall(first)
        while True:
            connection.sendall(then)
            time.sleep(pause)

    return say


OK = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\n"


@pytest.mark.parametrize(
    ("say", "fault"),
    [
        pytest.param(for_ever(OK + b"\r\n", b"x" * 65536), HostFault.HOSTILE, id="endless-body"),
        pytest.param(for_ever(OK + b"X: ", b"x" * 65536), HostFault.HOSTILE, id="endless-header"),
        pytest.param(for_ever(OK, b"X: y\r\n" * 5000), HostFault.HOSTILE, id="endless-headers"),
        pytest.param(for_ever(b"", b"y" * 65536), HostFault.HOSTILE, id="no-http"),
        pytest.param(for_ever(OK + b"\r\n", b"x", 0.05), HostFault.UNREACHABLE, id="slow-body"),
        pytest.param(for_ever(OK, b"", 0.05), HostFault.UNREACHABLE, id="silent"),
        pytest.param(
            lambda connection: connection.sendall(
                b"HTTP/1.1 302 Found\r\nLocation: http://127.0.0.2/\r\nContent-Length: 0\r\n\r\n"
            ),
            HostFault.HOSTILE,
            id="redirect",
        ),
        pytest.param(lambda connection: None, HostFault.UNREACHABLE, id="hangs-up"),
        pytest.param(
            lambda connection: connection.sendall(OK + b"\r\n" + b"[" * 1_000_000),
            HostFault.KIND,
            id="deep-json",
        ),
        pytest.param(
            lambda connection: connection.sendall(OK + b"Content-Length: 4\r\n\r\nnull"),
            HostFault.KIND,
            id="json-of-another-kind",
        ),
    ],
)
@pytest.mark.parametrize("kind", sorted(KINDS))
def test_a_hostile_server(
    monkeypatch: pytest.MonkeyPatch, kind: str, say: Callable[[socket.socket], None],
    fault: HostFault,
) -> None:  # fmt: skip
    monkeypatch.setattr(http_link, "TOTAL", 1.0)
    monkeypatch.setattr(http_link, "BETWEEN", 0.01)
    tracemalloc.start()
    try:
        with Hostile(say) as server, pytest.raises(HostError) as caught:
            carry(KINDS[kind]().state(), Address(server.url, "key"))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert caught.value.fault == fault
    assert peak < 40_000_000


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_server_that_takes_no_more(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """It reads the beginning of an upload and stops."""
    monkeypatch.setattr(http_link, "STALLED", 1.0)
    file = tmp_path / "big.gcode"
    file.write_bytes(b"G1 X1\n" * 4_000_000)
    begun = time.monotonic()
    with Hostile(lambda connection: time.sleep(20)) as server, pytest.raises(HostError) as caught:
        carry(OctoPrint().upload("a.gcode", "", replace=False), Address(server.url), file=file)
    assert caught.value.fault == HostFault.CUT
    assert time.monotonic() - begun < 10
    gc.collect()  # asyncio complains of the bytes that nobody took


@pytest.mark.parametrize("error", [KeyboardInterrupt, HostError])
def test_ctrl_c_and_changes_leave_nothing(
    file: Path, monkeypatch: pytest.MonkeyPatch, error: type[BaseException]
) -> None:
    asked: list[str] = []

    def carried(dialogue: Dialogue, *_: object, **options: object) -> str:
        request = next(dialogue)
        asked.append(request.method)
        if request.upload and error is KeyboardInterrupt:
            raise KeyboardInterrupt
        if request.upload:
            file.write_text("G1 X2\n")
        return "where"

    monkeypatch.setattr(sending, "carry", carried)
    with pytest.raises(error):
        Sending(OctoPrint(), Address(""), file, "", lambda count: None).send(start=True)
    assert asked == ["POST", "DELETE"]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.text(st.characters(exclude_categories=["Cs"])))
def test_any_text_comes_back_from_the_book(text: str) -> None:
    address_book.add("one", HostSettings(url="http://x", user=text, profile=text))
    assert address_book.printer("one").user == text


def test_nobody_there(file: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        url = f"http://127.0.0.1:{free.getsockname()[1]}"
    with pytest.raises(HostError, match="cannot be reached") as caught:
        Sending(OctoPrint(), Address(url), file, "", lambda count: None).check(start=False)
    assert caught.value.fault == HostFault.UNREACHABLE


def test_the_key_is_in_no_error(file: Path) -> None:
    with Hostile(lambda connection: None) as server, pytest.raises(HostError) as caught:
        carry(OctoPrint().state(), Address(server.url, "hush-hush"))
    error: BaseException | None = caught.value
    while error is not None:
        assert "hush-hush" not in f"{error!r} {error}"
        error = error.__cause__


@pytest.mark.parametrize(
    ("status", "fault"),
    [(401, "KEY"), (403, "KEY"), (404, "KIND"), (409, "BUSY"), (413, "FULL"), (507, "FULL"),
     (500, "OTHER")],
)  # fmt: skip
@pytest.mark.parametrize("kind", sorted(KINDS))
def test_statuses(kind: str, status: int, fault: str) -> None:
    """Dialogues need no server: answers are sent to them by hand."""
    dialogue = KINDS[kind]().state()
    next(dialogue)
    with pytest.raises(HostError) as caught:
        dialogue.send(Answer(status, {"error": {"message": "said so"}}))
    assert caught.value.fault == HostFault[fault]


def test_settings_hold_no_key() -> None:
    assert not {"key", "password"} & set(HostSettings.__dataclass_fields__)
