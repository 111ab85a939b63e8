"""Real print servers in environments of their own: installed from the package index, started here.

V3DCAD_HOSTS names a folder that keeps the environments from run to run.
"""

from __future__ import annotations

import contextlib
import http.client
import os
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

OCTOPRINT_KEY = "0123456789ABCDEF0123456789ABCDEF"
PRUSALINK_KEY = "PRUSALINKKEY"
STARTS_WITHIN = 120.0


def environment(package: str, folder: Path) -> Path:
    """The folder of programs of an environment that has one package."""
    root = Path(os.environ.get("V3DCAD_HOSTS", folder)) / package
    if not (root / "ready").exists():
        subprocess.run([sys.executable, "-m", "venv", root], check=True)
        subprocess.run([root / "bin" / "pip", "install", "--quiet", package], check=True)
        (root / "ready").touch()
    return root / "bin"


@contextlib.contextmanager
def running(words: list[object], url: str, log: Path) -> Iterator[None]:
    """A server from when it answers to when it is not needed any more."""
    with log.open("wb") as stream:
        process = subprocess.Popen(
            [str(word) for word in words], stdout=stream, stderr=stream, stdin=subprocess.DEVNULL
        )
    try:
        until = time.monotonic() + STARTS_WITHIN
        while not _answers(f"{url}/api/version"):
            assert process.poll() is None, log.read_text(errors="replace")[-2000:]
            assert time.monotonic() < until, log.read_text(errors="replace")[-2000:]
            time.sleep(0.2)
        yield
    finally:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(20)
        process.kill()


def _answers(url: str) -> bool:
    try:
        urllib.request.urlopen(url, timeout=2).close()
    except urllib.error.HTTPError as error:
        return error.code != 503  # that is said while the server is starting
    except (OSError, http.client.HTTPException):
        return False
    return True


@contextlib.contextmanager
def octoprint(folder: Path, port: int) -> Iterator[str]:
    """OctoPrint with its virtual printer connected; its address."""
    (folder / "config.yaml").write_text(
        f"""
server: {{firstRun: false, onlineCheck: {{enabled: false}}, pluginBlacklist: {{enabled: false}}}}
accessControl: {{salt: salt}}
api: {{key: {OCTOPRINT_KEY}}}
plugins:
  virtual_printer: {{enabled: true}}
  _disabled: [softwareupdate, announcements, tracking, discovery, pi_support]
serial: {{port: VIRTUAL, baudrate: 250000, autoconnect: true}}
""",
        encoding="utf-8",
    )
    program = environment("octoprint", folder / "environments") / "octoprint"
    words = [program, "serve", "--iknowwhatimdoing", "--host", "127.0.0.1", "--port", port]
    url = f"http://127.0.0.1:{port}"
    with running([*words, "--basedir", folder], url, folder / "log"):
        yield url


@contextlib.contextmanager
def moonraker(folder: Path, port: int) -> Iterator[str]:
    """Moonraker without Klipper, trusting this computer; its address."""
    (folder / "gcodes").mkdir(exist_ok=True)
    settings = folder / "moonraker.conf"
    settings.write_text(
        f"""
[server]
host: 127.0.0.1
port: {port}
klippy_uds_address: {folder}/klippy.sock
[authorization]
trusted_clients:
  127.0.0.1
[machine]
provider: none
validate_service: false
""",
        encoding="utf-8",
    )
    program = environment("moonraker", folder / "environments") / "moonraker"
    url = f"http://127.0.0.1:{port}"
    with running([program, "-d", folder, "-c", settings, "-n"], url, folder / "log"):
        yield url


@contextlib.contextmanager
def prusalink(folder: Path, port: int) -> Iterator[str]:
    """PrusaLink without a printer; its address. It needs libcap-dev, libmagic1, libturbojpeg0."""
    (folder / "data").mkdir()
    settings = folder / "settings.ini"
    settings.write_text(
        f"""
[printer]
type = MK3S
name = test
location = here
prusalink_uuid = 0
[network]
hostname =
[service::connect]
hostname =
tls = 1
port = 0
token =
[service::local]
enable = 1
username = maker
digest =
api_key = {PRUSALINK_KEY}
""",
        encoding="utf-8",
    )
    daemon = folder / "prusalink.ini"
    daemon.write_text(
        f"""
[daemon]
data_dir = {folder}/data
pid_file = {folder}/pid
[http]
address = 127.0.0.1
port = {port}
[printer]
port = {folder}/no-printer
settings = {settings}
[cameras]
auto_detect = False
""",
        encoding="utf-8",
    )
    program = environment("prusalink", folder / "environments") / "prusalink"
    url = f"http://127.0.0.1:{port}"
    with running([program, "-f", "-c", daemon, "start"], url, folder / "log"):
        yield url
