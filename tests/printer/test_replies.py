"""What printers say, in the forms of their sources."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from v3dcad.printer.lines import checksum, command_of, is_slow, name_of, numbered
from v3dcad.printer.replies import (
    LONGEST,
    Action,
    Busy,
    Failure,
    Garbage,
    LineSplitter,
    Ok,
    Resend,
    Skipped,
    Started,
    Temperatures,
    Text,
    Waiting,
    parse,
)

HOT = {"T": (201.3, 200.0), "B": (60.1, 60.0)}


@pytest.mark.parametrize(
    ("line", "replies"),
    [
        ("ok", [Ok()]),
        ("ok N5 P15 B3", [Ok(5, 3)]),
        ("ok P15 B3", [Ok(None, 3)]),
        ("ok T:201.3 /200.0 B:60.1 /60.0 @:63 B@:0", [Ok(None, None, HOT)]),
        ("ok B:60.1 /60.0 T0:201.3 /200.0", [Ok(None, None, {"B": HOT["B"], "T0": HOT["T"]})]),
        ("ok T:0", [Ok(None, None, {"T": (0.0, None)})]),
        (" T:201.3 /200.0 B:60.1 /60.0 @:63 B@:0 W:?", [Temperatures(HOT)]),
        ("Resend: 7", [Resend(7)]),
        ("Resend:7", [Resend(7)]),
        ("rs 7", [Resend(7)]),
        ("rs N7", [Resend(7)]),
        ("skip 7", [Skipped(7)]),
        ("echo:busy: processing", [Busy("processing")]),
        ("busy:heating", [Busy("heating")]),
        ("echo:busy: paused for user", [Busy("paused for user")]),
        ("wait", [Waiting()]),
        ("start", [Started()]),
        ("Error:checksum mismatch, Last Line: 6", [Failure("checksum mismatch, Last Line: 6",
                                                           fatal=False, about_line=True)]),
        ("Error:expected line 7 got 9", [Failure("expected line 7 got 9", fatal=False,
                                                 about_line=True)]),
        ("Error:SD init fail", [Failure("SD init fail", fatal=False)]),
        ("Error:Printer halted. kill() called!", [Failure("Printer halted. kill() called!",
                                                          fatal=True)]),
        ("Error:MINTEMP triggered", [Failure("MINTEMP triggered", fatal=True)]),
        ("!! Must home axis first", [Failure("Must home axis first", fatal=True)]),
        ("//action:pause", [Action("pause")]),
        ("// action:resume", [Action("resume")]),
        ("//action:prompt_begin Filament runout", [Action("prompt_begin", "Filament runout")]),
        ("fatal:Heater error", [Failure("Heater error", fatal=True)]),
        ("RS485 module found", [Text("RS485 module found")]),
        ("T:" + "9" * 400, [Text("T:" + "9" * 400)]),
        ("T:nan /200.0 B:60.1 /60.0", [Temperatures({"B": HOT["B"]})]),
        ("// Klipper state: Ready", [Text("// Klipper state: Ready")]),
        ("echo:Unknown command: \"M999\"", [Text("echo:Unknown command: \"M999\"")]),
        ("okay then", [Text("okay then")]),
        ("o\x8ek", [Garbage()]),
        ("okok", [Ok(), Ok()]),
        ("ok N5 P15 B3ok N6 P15 B3", [Ok(5, 3), Ok(6, 3)]),
        ("okResend: 7", [Ok(), Resend(7)]),
        ("Resend: 7ok", [Resend(7), Ok()]),
        ("okstart", [Ok(), Started()]),
        ("okecho:busy: processing", [Ok(), Busy("processing")]),
    ],
)  # fmt: skip
def test_a_line_means(line: str, replies: list[object]) -> None:
    assert parse(line) == replies


@given(st.binary(max_size=300), st.lists(st.integers(0, 300), max_size=8))
def test_how_bytes_arrive_does_not_matter(data: bytes, cuts: list[int]) -> None:
    whole = LineSplitter()
    lines = whole.feed(data) + whole.flush()
    pieces = LineSplitter()
    found, at = [], 0
    for cut in [*sorted(cuts), len(data)]:
        found += pieces.feed(data[at:cut])
        at = max(at, cut)
    assert found + pieces.flush() == lines
    for line in lines:
        assert parse(line)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", "\n\n"])
def test_line_ends(end: str) -> None:
    assert LineSplitter().feed(f"ok{end}wait{end}".encode()) == ["ok", "wait"]


def test_an_endless_line_takes_no_room() -> None:
    splitter = LineSplitter()
    for _ in range(100):
        assert splitter.feed(b"x" * 1000) == []
        assert len(splitter._rest) <= LONGEST + 1000
    (line,) = splitter.feed(b"\n")
    assert parse(line) == [Garbage()] or len(line) <= LONGEST


def test_numbered_lines() -> None:
    # The example of RepRap's G-code documentation: N3 T0*57.
    assert numbered(3, "T0") == b"N3 T0*57\n"
    assert numbered(2, "M117 a\\b\x08c") == numbered(2, "M117 a?b?c"), "Marlin reads both otherwise"
    assert numbered(1, "M117 schön") == b"N1 M117 sch?n*" + b"%d\n" % checksum(b"N1 M117 sch?n")


@pytest.mark.parametrize(
    ("line", "command", "name", "slow"),
    [
        ("G1 X5 ; go", "G1 X5", "G1", False),
        ("  g01X5\r\n", "g01X5", "G1", False),
        ("N12 G28 X0*71\n", "G28 X0", "G28", True),
        ("; comment", "", "", True),
        ("M117 at 5*3", "M117 at 5*3", "M117", False),
        ("G92.1", "G92.1", "G92.1", False),
        ("PRINT_START BED=60", "PRINT_START BED=60", "PRINT_START", True),
        ("T0", "T0", "T0", False),
    ],
)
def test_commands_of_files(line: str, command: str, name: str, slow: bool) -> None:
    assert command_of(line) == command
    assert name_of(command) == name
    if command:
        assert is_slow(command) is slow
