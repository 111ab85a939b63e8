"""What docs/printing.md lists is what there is."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

from v3dcad.commands import controls, print_port, print_view
from v3dcad.printer.ends import End
from v3dcad.printer.patience import Patience
from v3dcad.printer.progress import Phase
from v3dcad.printer.resume import AHEAD
from v3dcad.printer.sender import BYTES_UNDER_WAY, GOES_BACK

TEXT = (Path(__file__).parents[2] / "docs" / "printing.md").read_text(encoding="utf-8")


def column(title: str) -> set[str]:
    """The words in the first column of the table whose head begins so."""
    table = re.search(rf"^\| {title} \|.*\n\|[-|]+\|\n((?:\|.*\n)+)", TEXT, re.M)
    assert table is not None, title
    return set(re.findall(r"^\| `([^`]+)`", table[1], re.M))


def test_ends() -> None:
    assert column("end") == set(End)


def test_phases() -> None:
    for phase in Phase:
        assert f"`{phase}`" in TEXT


def test_events() -> None:
    source = inspect.getsource(print_port) + inspect.getsource(print_view)
    assert column("event") == set(re.findall(r'\bsay\(\s*"(\w+)"', source))


def test_keys_and_wishes() -> None:
    for key in set(controls.KEYS) - {"y", "n"} | set(controls.MORE_KEYS):
        assert f"`{key}`" in TEXT
    for wish in controls.DOES | controls.SETS:
        assert f'{{"do": "{wish}"' in TEXT


def test_numbers() -> None:
    patience = Patience()
    assert f"`no answer` after {patience.most(slow=False):.0f} s" in TEXT
    assert f"{patience.most(slow=True) / 60:.0f} min for commands" in TEXT
    assert f"asks {patience.probes} times, every {patience.answer:.0f} s" in TEXT
    assert f"refused more than {patience.resends} times" in TEXT
    assert f"quiet for {patience.settle} s" in TEXT
    assert f"more than {BYTES_UNDER_WAY} bytes" in TEXT
    assert f"within its first {GOES_BACK} lines" in TEXT
    assert f"up to {AHEAD} lines behind" in TEXT


def test_files_that_are_linked_are_there() -> None:
    for target in re.findall(r"\]\(([^)]+)\)", TEXT):
        assert (Path(__file__).parents[2] / "docs" / target).exists(), target
