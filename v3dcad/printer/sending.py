"""One file to one print server, so that nothing half-written stays there."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path

from v3dcad.errors import LocalPrinterError
from v3dcad.printer.ends import HostError, HostFault
from v3dcad.printer.hosts.requests import Host
from v3dcad.printer.http_link import Address, carry


class Sending:
    """The steps of `v3dcad send`, in their order."""

    def __init__(
        self,
        host: Host,
        address: Address,
        file: Path,
        sha256: str,
        progress: Callable[[int], None],
    ) -> None:
        if not file.name.isprintable():
            raise LocalPrinterError(f"{file.name!r}: no server takes such a name; rename the file")
        self.host = host
        self.address = address
        self.file = file
        self.sha256 = sha256
        self.progress = progress
        self._existed = False
        self._stamp = self._now()

    def check(self, *, start: bool) -> None:
        """Raise `HostError` if the server cannot be used, or with `start` the printer is not free.

        Asked before anything is sent, so that no file is sent in vain.
        """
        state = carry(self.host.state(), self.address)
        if start and not state.ready:
            raise HostError(
                HostFault.BUSY,
                f"--start: {self.host.title} says that the printer is not ready ({state.state}); "
                "nothing was sent",
            )

    def exists(self) -> bool:
        """Whether a file of this name is on the server."""
        self._existed = carry(self.host.exists(self.file.name), self.address)
        return self._existed

    def send(self, *, start: bool) -> str:
        """Send the file and, with `start`, print it; where it lies.

        An upload that breaks off, by Ctrl-C too, is deleted on the server, unless a file of this
        name was there before: then the server has kept that one.
        """
        name = self.file.name
        try:
            where = carry(
                self.host.upload(name, self.sha256, replace=self._existed),
                self.address,
                file=self.file,
                progress=self.progress,
            )
            if self._now() != self._stamp:
                raise HostError(
                    HostFault.OTHER, f"{self.file} was changed while it was sent; send it again"
                )
        except HostError as error:
            raise self._cleaned(error) from error
        except KeyboardInterrupt:
            self._cleaned(HostError(HostFault.CUT, "cancelled"))
            raise
        if start:
            carry(self.host.start(name), self.address)
        return where

    def _now(self) -> tuple[int, int] | None:
        try:
            found = self.file.stat()
        except OSError:
            return None
        return found.st_size, found.st_mtime_ns

    def _cleaned(self, error: HostError) -> HostError:
        """The error, after what may lie there of the upload was deleted."""
        if self._existed or error.fault not in (HostFault.CUT, HostFault.OTHER, HostFault.FULL):
            return error
        with contextlib.suppress(HostError):
            carry(self.host.remove(self.file.name), self.address)
            return HostError(error.fault, f"{error.message}; nothing of it is left on the server")
        message = f"{error.message}; a part of it may be left on the server as {self.file.name}"
        return HostError(error.fault, message)
