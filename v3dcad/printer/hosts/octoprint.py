"""OctoPrint. Follows `docs/api/` of its source: `version`, `printer`, `files`, `job`."""

from __future__ import annotations

from v3dcad.printer.hosts.requests import (
    Dialogue,
    HostState,
    Request,
    escaped,
    introduced,
    other_kind,
    refuse,
)


class OctoPrint:
    """Files lie in `local`, OctoPrint's own storage. The key is an application key."""

    title = "OctoPrint"

    def state(self) -> Dialogue[HostState]:
        """Version and state."""
        text = (yield from introduced(self.title, "/api/version", "text")).words("text")
        if not text.startswith("OctoPrint"):
            raise other_kind(self.title)
        answer = yield Request("GET", "/api/printer", query={"exclude": "temperature,sd"})
        if answer.status == 409:
            return HostState(text, "the printer is not connected", ready=False)
        refuse(answer, "state")
        state = answer.words("state", "text")
        return HostState(text, state, ready=answer.at("state", "flags", "ready") is True)

    def exists(self, name: str) -> Dialogue[bool]:
        """Whether a file of this name is there."""
        answer = yield Request("GET", f"/api/files/local/{escaped(name)}")
        refuse(answer, "files", 200, 404)
        return answer.status == 200

    def upload(self, name: str, sha256: str, *, replace: bool) -> Dialogue[str]:
        """Send the file. OctoPrint takes a form, and writes the file when it is whole."""
        form = {"print": "false", "noOverwrite": "false" if replace else "true"}
        answer = yield Request("POST", "/api/files/local", upload=name, form=form)
        refuse(answer, "upload", 201)
        return f"local/{answer.words('files', 'local', 'path') or name}"

    def start(self, name: str) -> Dialogue[None]:
        """Select the file and print it."""
        body = {"command": "select", "print": True}
        answer = yield Request("POST", f"/api/files/local/{escaped(name)}", json=body)
        refuse(answer, "start")

    def remove(self, name: str) -> Dialogue[None]:
        """Delete a file."""
        answer = yield Request("DELETE", f"/api/files/local/{escaped(name)}")
        refuse(answer, "delete", 204, 404)
