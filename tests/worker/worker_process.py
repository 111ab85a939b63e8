"""The worker as a child process, as another program runs it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent.parent


class Worker:
    """A running worker; every line that it writes has to be JSON."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        with (folder / "stderr.txt").open("wb") as errors:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "v3dcad.worker", str(folder)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                cwd=ROOT,
            )
        self.asked = 0
        self.stages: list[dict[str, Any]] = []

    def send(self, line: bytes) -> dict[str, Any]:
        """Write a line, and read up to the result or the error."""
        assert self.process.stdin is not None
        self.process.stdin.write(line + b"\n")
        self.process.stdin.flush()
        return self.answer()

    def answer(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        self.stages = []
        while True:
            line = self.process.stdout.readline()
            assert line, self.stderr()
            said: dict[str, Any] = json.loads(line)
            if "stage" not in said:
                return said
            self.stages.append(said)

    def ask(self, do: str, **what: Any) -> dict[str, Any]:
        """The whole answer to a request."""
        self.asked += 1
        said = self.send(json.dumps({"id": self.asked, "do": do, **what}).encode())
        assert said["id"] == self.asked
        return said

    def get(self, do: str, **what: Any) -> dict[str, Any]:
        """The result of a request."""
        said = self.ask(do, **what)
        assert "result" in said, said
        return dict(said["result"])

    def refused(self, do: str, **what: Any) -> tuple[str, str | None]:
        """The error of a request, and the setting that it names."""
        said = self.ask(do, **what)
        assert "error" in said, said
        assert "\n" not in said["error"]
        return said["error"], said["setting"]

    def stderr(self) -> str:
        return (self.folder / "stderr.txt").read_text(encoding="utf-8")

    def close(self) -> int:
        """End its input, and wait for its end."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        code = self.process.wait(60)
        assert self.process.stdout.read() == b""
        self.process.stdout.close()
        return code
