"""How the page comes before the user's eyes: opened in the browser, or served and kept up to date.

Where there is no browser, or no screen, its place is told and nothing else happens.
"""

from __future__ import annotations

import os
import sys
import tempfile
import webbrowser
from collections.abc import Callable
from pathlib import Path

from v3dcad.commands.rows import print_rows
from v3dcad.files import is_stream

SCREENS = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
"""Variables of which Linux sets one where a browser can be seen; without, it would start one made
of text, in this terminal."""


def open_in_browser(address: str) -> bool:
    """Open an address in the user's browser; false where there is none."""
    if sys.platform.startswith("linux") and not any(map(os.environ.get, SCREENS)):
        return False
    try:
        return webbrowser.open(address)
    except webbrowser.Error:
        return False


def page_place(part: Path) -> Path:
    """Where the page of a part is written that was not asked for as a file."""
    return Path(tempfile.mkdtemp(prefix="v3dcad-")) / f"{part.stem}.html"


def show_file(file: Path, opens: bool) -> None:
    """Open a page that was written, unless it shall not be; tell where it is if it is not open.

    What went to a device or a pipe is not there to be opened.
    """
    if is_stream(file):
        return
    address = file.resolve().as_uri()
    if opens and open_in_browser(address):
        print_rows([("page", "opened in the browser")])
    else:
        print_rows([("page", f"open {address} in a browser")])


def serve_file(file: Path, make: Callable[[int], str], opens: bool) -> None:
    """Serve the page of a file on this computer, made again when it is written, until Ctrl-C.

    `make` makes the page of a number; what it raises the first time ends the command.
    """
    from v3dcad.view.page.serving import Live, follow, served, stamp

    made_of = stamp(file)  # what is written while the first page is made counts, too
    live = Live(make)
    with served(live) as address:
        opened = opens and open_in_browser(address)
        print_rows(
            [
                ("page", f"{address} {'opened in' if opened else '- open it in'} the browser"),
                ("follows", f"{file}; Ctrl-C ends"),
            ]
        )
        sys.stdout.flush()
        try:
            follow(file, made_of, live)
        except KeyboardInterrupt:
            return
