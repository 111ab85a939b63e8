"""PrusaLink. Follows `spec/openapi.yaml` of Prusa-Link-Web: `/api/version`, `/api/v1/…`."""

from __future__ import annotations

from v3dcad.printer.ends import HostError, HostFault
from v3dcad.printer.hosts.requests import (
    Dialogue,
    HostState,
    Request,
    escaped,
    introduced,
    other_kind,
    refuse,
)

FREE = ("IDLE", "READY", "FINISHED", "STOPPED")


class PrusaLink:
    """Files lie in the first storage that can be written to: `local` or `usb`.

    With a user the password goes by HTTP digest; without, the key goes in `X-Api-Key`.
    """

    title = "PrusaLink"

    def __init__(self) -> None:
        self._storage: str | None = None

    def state(self) -> Dialogue[HostState]:
        """Version and state."""
        answer = yield from introduced(self.title, "/api/version", "text")
        if "PrusaLink" not in answer.words("text"):
            raise other_kind(self.title)
        title = f"{answer.words('text')} {answer.words('server')}".strip()
        answer = yield Request("GET", "/api/v1/status")
        refuse(answer, "state")
        state = answer.words("printer", "state")
        return HostState(title, state.lower(), ready=state in FREE)

    def exists(self, name: str) -> Dialogue[bool]:
        """Whether a file of this name is there."""
        answer = yield Request("HEAD", (yield from self._file(name)))
        refuse(answer, "files", 200, 404)
        return answer.status == 200

    def upload(self, name: str, sha256: str, *, replace: bool) -> Dialogue[str]:
        """Send the bare file."""
        path = yield from self._file(name)
        headers = {
            "Content-Type": "text/x.gcode",
            "Print-After-Upload": "?0",
            "Overwrite": "?1" if replace else "?0",
        }
        answer = yield Request("PUT", path, headers=headers, upload=name)
        refuse(answer, "upload", 201)
        return path.removeprefix("/api/v1/files/")

    def start(self, name: str) -> Dialogue[None]:
        """Print a file."""
        answer = yield Request("POST", (yield from self._file(name)))
        refuse(answer, "start")

    def remove(self, name: str) -> Dialogue[None]:
        """Delete a file."""
        answer = yield Request("DELETE", (yield from self._file(name)))
        refuse(answer, "delete", 204, 404)

    def _file(self, name: str) -> Dialogue[str]:
        """Where a file lies, or is to lie."""
        if self._storage is None:
            answer = yield Request("GET", "/api/v1/storage")
            refuse(answer, "storage")
            storages = answer.at("storage_list")
            for storage in storages if isinstance(storages, list) else []:
                match storage:
                    case {"path": str(path), "available": True} if not storage.get("read_only"):
                        self._storage = path.strip("/")
                        break
            else:
                raise HostError(
                    HostFault.FULL, "no storage that can be written to; put in a USB stick"
                )
        return f"/api/v1/files/{escaped(self._storage)}/{escaped(name)}"
