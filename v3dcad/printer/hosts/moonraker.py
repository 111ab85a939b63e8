"""Moonraker. Follows `docs/external_api/` of its source: `server`, `printer`, `file_manager`."""

from __future__ import annotations

from v3dcad.printer.hosts.requests import (
    Dialogue,
    HostState,
    Request,
    escaped,
    introduced,
    refuse,
)

FREE = ("ready", "standby", "complete", "cancelled", "error")
"""States of `print_stats` in which nothing is printed; `error` is the last print's."""


class Moonraker:
    """Files lie in the root `gcodes`. A key is needed only where Moonraker trusts nobody."""

    title = "Moonraker"

    def state(self) -> Dialogue[HostState]:
        """Version and state, of Klipper and of what it prints."""
        version = ("result", "moonraker_version")
        answer = yield from introduced(self.title, "/server/info", *version)
        title = f"Moonraker {answer.words(*version)}"
        klipper = answer.words("result", "klippy_state")
        if klipper != "ready":
            return HostState(title, f"Klipper is {klipper}", ready=False)
        answer = yield Request("GET", "/printer/objects/query", query={"print_stats": "state"})
        refuse(answer, "state")
        state = answer.words("result", "status", "print_stats", "state")
        return HostState(title, state, ready=state in FREE)

    def exists(self, name: str) -> Dialogue[bool]:
        """Whether a file of this name is there; a HEAD of the file itself."""
        answer = yield Request("HEAD", f"/server/files/gcodes/{escaped(name)}")
        refuse(answer, "files", 200, 404)
        return answer.status == 200

    def upload(self, name: str, sha256: str, *, replace: bool) -> Dialogue[str]:
        """Send the file with its checksum: a file that arrives otherwise is thrown away there."""
        form = {"root": "gcodes", "print": "false", "checksum": sha256}
        answer = yield Request("POST", "/server/files/upload", upload=name, form=form)
        refuse(answer, "upload", 201)
        where = answer.words("item", "path") or answer.words("result", "item", "path")
        return f"gcodes/{where or name}"

    def start(self, name: str) -> Dialogue[None]:
        """Print a file."""
        answer = yield Request("POST", "/printer/print/start", query={"filename": name})
        refuse(answer, "start")

    def remove(self, name: str) -> Dialogue[None]:
        """Delete a file."""
        answer = yield Request("DELETE", f"/server/files/gcodes/{escaped(name)}")
        refuse(answer, "delete", 200, 404)
