"""Sending to OctoPrint, Moonraker and PrusaLink themselves. Takes minutes: they are installed."""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import socket
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from printer.real_hosts import OCTOPRINT_KEY, PRUSALINK_KEY, moonraker, octoprint, prusalink

from v3dcad.formats.gcode.blocks import Totals, heading
from v3dcad.printer.ends import HostError, HostFault
from v3dcad.printer.hosts.moonraker import Moonraker
from v3dcad.printer.hosts.octoprint import OctoPrint
from v3dcad.printer.hosts.prusalink import PrusaLink
from v3dcad.printer.hosts.requests import Host
from v3dcad.printer.http_link import Address, carry
from v3dcad.printer.sending import Sending
from v3dcad.settings import PrintSettings

pytestmark = pytest.mark.long

GCODE = "G28\nM83\nG1 Z0.2 F600\n" + "".join(f"G1 X{i % 100} Y10 E0.1\n" for i in range(5000))


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return int(found.getsockname()[1])


@pytest.fixture(scope="module")
def octo(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Address]:
    with octoprint(tmp_path_factory.mktemp("octoprint"), free_port()) as url:
        yield Address(url, OCTOPRINT_KEY)


@pytest.fixture(scope="module")
def moon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Address]:
    with moonraker(tmp_path_factory.mktemp("moonraker"), free_port()) as url:
        yield Address(url)


@pytest.fixture(scope="module")
def prusa(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Address]:
    with prusalink(tmp_path_factory.mktemp("prusalink"), free_port()) as url:
        yield Address(url, PRUSALINK_KEY)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "a part with space.gcode"
    path.write_text(GCODE)
    return path


def sending(host: Host, address: Address, file: Path) -> Sending:
    sha256 = hashlib.sha256(file.read_bytes()).hexdigest()
    return Sending(host, address, file, sha256, lambda count: None)


def fetched(address: Address, path: str) -> bytes:
    request = urllib.request.Request(address.url + path, headers={"X-Api-Key": address.key})
    with urllib.request.urlopen(request, timeout=20) as answer:
        data: bytes = answer.read()
    return data


def test_octoprint(octo: Address, file: Path) -> None:
    state = carry(OctoPrint().state(), octo)
    assert state.version.startswith("OctoPrint 1.")
    one = sending(OctoPrint(), octo, file)
    one.check(start=False)
    assert not one.exists()
    where = one.send(start=False)
    assert one.exists()
    name = where.removeprefix("local/").replace(" ", "%20")
    assert fetched(octo, f"/downloads/files/local/{name}") == GCODE.encode()
    job = json.loads(fetched(octo, "/api/job"))
    assert job["state"] == "Operational", "it was started"
    with pytest.raises(HostError) as caught:
        carry(OctoPrint().upload(file.name, "", replace=False), octo, file=file)
    assert caught.value.fault == HostFault.BUSY


def test_octoprint_prints_and_refuses_a_second_start(octo: Address, file: Path) -> None:
    until = time.monotonic() + 60
    while not carry(OctoPrint().state(), octo).ready:
        assert time.monotonic() < until
        time.sleep(0.5)
    one = sending(OctoPrint(), octo, file)
    one.check(start=True)
    one.exists()
    one.send(start=True)
    until = time.monotonic() + 30
    while json.loads(fetched(octo, "/api/job"))["state"] != "Printing":
        assert time.monotonic() < until
        time.sleep(0.2)
    with pytest.raises(HostError, match="not ready"):
        one.check(start=True)


def test_octoprint_with_a_wrong_key(octo: Address) -> None:
    with pytest.raises(HostError) as caught:
        carry(OctoPrint().state(), Address(octo.url, "wrong"))
    assert caught.value.fault == HostFault.KEY


@pytest.mark.parametrize("host", [Moonraker(), PrusaLink()])
def test_octoprint_is_no_other_server(octo: Address, host: Host) -> None:
    with pytest.raises(HostError) as caught:
        carry(host.state(), octo)
    assert caught.value.fault == HostFault.KIND


def test_moonraker(moon: Address, file: Path) -> None:
    state = carry(Moonraker().state(), moon)
    assert state.version.startswith("Moonraker")
    assert not state.ready
    one = sending(Moonraker(), moon, file)
    one.check(start=False)
    assert not one.exists()
    assert one.send(start=False) == f"gcodes/{file.name}"
    assert one.exists()
    name = file.name.replace(" ", "%20")
    assert fetched(moon, f"/server/files/gcodes/{name}") == GCODE.encode()
    with pytest.raises(HostError, match="nothing was sent"):
        one.check(start=True)


def test_moonraker_finds_the_picture_and_what_the_print_takes(
    moon: Address, tmp_path: Path
) -> None:
    """What Mainsail and Fluidd show is what Moonraker finds in the file."""
    picture = io.BytesIO()
    Image.new("RGB", (300, 200), "orange").save(picture, "PNG")
    path = tmp_path / "picture.gcode"
    totals = Totals(600.0, 1234.0, 3.7, 50, np.array([[1.0, 1.0, 0.2], [9.0, 9.0, 10.0]]))
    path.write_text(heading(PrintSettings(), totals, picture.getvalue()) + GCODE)
    sending(Moonraker(), moon, path).send(start=False)
    found = json.loads(fetched(moon, "/server/files/metadata?filename=picture.gcode"))["result"]
    assert (300, 200) in [(one["width"], one["height"]) for one in found["thumbnails"]]
    assert found["slicer_version"] == "(v3dcad)"
    assert found["estimated_time"] == 600
    assert found["filament_total"] == pytest.approx(1234)
    assert found["layer_count"] == 50
    assert found["layer_height"] == pytest.approx(0.2)
    assert found["object_height"] == 10


def test_moonraker_throws_a_spoilt_upload_away(moon: Address, tmp_path: Path) -> None:
    path = tmp_path / "spoilt.gcode"
    path.write_text(GCODE)
    one = Sending(Moonraker(), moon, path, "0" * 64, lambda count: None)
    assert not one.exists()
    with pytest.raises(HostError):
        one.send(start=False)
    assert not one.exists()


@pytest.mark.parametrize(("kind", "address"), [(OctoPrint, "octo"), (Moonraker, "moon")])
def test_an_upload_that_is_cut_leaves_nothing(
    kind: type, address: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """The client promises a long file, sends half of it and hangs up."""
    server: Address = request.getfixturevalue(address)
    host, _, port = server.url.removeprefix("http://").partition(":")
    path = "/api/files/local" if kind is OctoPrint else "/server/files/upload"
    head = (
        f"POST {path} HTTP/1.1\r\nHost: {host}\r\nX-Api-Key: {server.key}\r\n"
        "Content-Type: multipart/form-data; boundary=b\r\nContent-Length: 1000000\r\n\r\n"
        '--b\r\nContent-Disposition: form-data; name="file"; filename="half.gcode"\r\n\r\n'
    )
    with contextlib.closing(socket.create_connection((host, int(port)))) as connection:
        connection.sendall(head.encode() + b"G1 X1\n" * 1000)
        time.sleep(0.5)
    time.sleep(1.0)
    assert carry(kind().exists("half.gcode"), server) is False


def test_prusalink_tells_version_and_state(prusa: Address) -> None:
    """Without a printer PrusaLink has no storage; `fake_prusalink` stands in for that part."""
    state = carry(PrusaLink().state(), prusa)
    assert state.version.startswith("PrusaLink")
    assert not state.ready
    with pytest.raises(HostError, match="no storage"):
        carry(PrusaLink().exists("part.gcode"), prusa)
    with pytest.raises(HostError) as caught:
        carry(PrusaLink().state(), Address(prusa.url, "wrong"))
    assert caught.value.fault == HostFault.KEY
