"""The sender step by step: what goes out, and when."""

from __future__ import annotations

import contextlib

import pytest
from printer.firmware import Faults, Firmware
from printer.world import job_for

from v3dcad.printer.drive import HEATERS_OFF
from v3dcad.printer.ends import End, PrintError
from v3dcad.printer.handshake import QUIET, Handshake
from v3dcad.printer.lines import numbered
from v3dcad.printer.patience import Patience
from v3dcad.printer.sender import BYTES_UNDER_WAY, HURRY, Sender

PATIENCE = Patience()


def sender_with(*commands: str, **options: bool) -> Sender:
    """A sender that has sent the commands, all but the last acknowledged."""
    sender = Sender(checks_numbers=options.get("checks_numbers", True))
    for command in commands:
        if sender.newest:
            sender.receive(b"ok\n", 0.0)
        sender.send(command, 0.0)
    sender.data_to_send()
    return sender


def windowed() -> Sender:
    """A sender with three lines under way."""
    sender = sender_with("G1 X1", "G1 X2")
    sender.receive(b"ok N2 P15 B3\n", 0.0)
    for number in (3, 4, 5):
        sender.send(f"G1 X{number}", 0.0)
    sender.data_to_send()
    return sender


def test_after_a_request_it_is_quiet_until_all_answers_are_here() -> None:
    sender = sender_with("G1 X1", "G1 X2", "G1 X3")
    sender.receive(b"Error:checksum mismatch, Last Line: 2\nResend: 3\nok\n", 1.0)
    assert (sender.acknowledged, sender.proven) == (2, 2), "the ok is the request's own"
    assert sender.data_to_send() == b""
    sender.receive(b"Resend: 3\nok\n", 1.05)
    sender.due(1.0 + PATIENCE.settle)
    assert sender.data_to_send() == b"", "the second request starts the quiet anew"
    assert not sender.ready()
    sender.due(1.05 + PATIENCE.settle)
    assert sender.data_to_send() == numbered(3, "G1 X3")
    sender.receive(b"ok\n", 1.2)
    assert sender.acknowledged == 3
    assert sender.resent == 1


def test_after_a_request_lines_go_one_by_one_until_the_loss_is_made_good() -> None:
    sender = windowed()
    sender.receive(b"Resend: 3\nok N2 P15 B3\n", 1.0)
    assert sender.window == 1
    sender.due(2.0)
    for number in (3, 4, 5):
        assert sender.data_to_send() == numbered(number, f"G1 X{number}")
        assert sender.window == 1
        sender.receive(f"ok N{number} P15 B3\n".encode(), 2.0)
    assert sender.window == 4


def test_advanced_ok_counts_for_all_lines_before() -> None:
    sender = windowed()
    sender.receive(b"ok N5 P15 B3\n", 1.0)
    assert sender.acknowledged == 5
    sender.receive(b"ok N4 P15 B3\nok N9 P15 B3\nok\n", 1.0)
    assert sender.acknowledged == 5


def test_wait_makes_it_ask_at_once() -> None:
    sender = sender_with("G1 X1")
    sender.receive(b"wait\n", HURRY / 2)
    assert sender.wake_at() == PATIENCE.answer, "the line may still be on its way"
    sender.receive(b"wait\n", HURRY)
    assert sender.wake_at() == HURRY
    sender.due(HURRY)
    assert sender.data_to_send() == b"\n" + numbered(1001, "M105")


def test_skip_proves_nothing() -> None:
    """Repetier says it of lines that it has, and of all it does not want after a Resend."""
    sender = sender_with("G1 X1", "G1 X2")
    for now in (1.0, 2.0, 3.0):
        sender.receive(b"skip 2\nok\n", now)
        assert sender.acknowledged == 1, "the ok is that of the skip"
        assert sender.data_to_send() == b"\n" + numbered(1002, "M105")
    sender.receive(b"Resend: 3\nskip 2\nok\n", 4.0)
    assert sender.acknowledged == 2
    sender.due(5.0)
    assert sender.data_to_send() == b""
    assert sender.idle


def test_skipping_without_end_is_bounded() -> None:
    sender = sender_with("G1 X1")
    with pytest.raises(PrintError, match="no answer: the printer skips line 1"):
        sender.receive(b"skip 1\nok\n" * 50, 1.0)


def test_the_words_that_turn_heaters_off_find_room() -> None:
    words = "\n" + "".join(f"{line}\n" for line in HEATERS_OFF)
    assert BYTES_UNDER_WAY + len(words) < 128


@pytest.mark.parametrize(
    "words", [b"ok\n", b"ok T:20 /0\n", b"start\n", b"hello\n", b"Resend: 1\n"]
)
def test_hands_are_shaken_or_not_but_soon(words: bytes) -> None:
    """A printer, or something else, that never stops talking."""
    talk = Handshake(0.0)
    now = 0.0
    with contextlib.suppress(PrintError):
        while talk.greeting is None:
            now += 0.05
            talk.receive(words, now)
            talk.due(now)
            assert now < 30, "this hangs"


def test_start_is_a_reset() -> None:
    with pytest.raises(PrintError, match="was reset after line 1") as caught:
        sender_with("G1 X1", "G1 X2").receive(b"start\n", 1.0)
    assert caught.value.end == End.HALTED


def test_silence_is_asked_about_and_bounded() -> None:
    sender = sender_with("G1 X1")
    for time in (10.0, 20.0, 30.0, 40.0, 50.0):
        assert sender.wake_at() == time
        sender.due(time)
        assert b"M105" in sender.data_to_send()
    assert sender.wake_at() == PATIENCE.most(slow=False)
    with pytest.raises(PrintError, match="said nothing to line 1 for 60 s"):
        sender.due(60.0)


def test_reports_of_temperature_are_no_sign_of_life() -> None:
    """They come by themselves, whether a line was lost or not."""
    sender = sender_with("G1 X1")
    sender.receive(b"T:20 /0 B:20 /0\necho:hello\n", 9.0)
    assert sender.wake_at() == PATIENCE.answer
    sender.receive(b"echo:busy: processing\n", 9.0)
    assert sender.wake_at() == 9.0 + PATIENCE.answer


def test_an_interrupt_goes_before_all_others() -> None:
    sender = Sender(checks_numbers=True)
    sender.send("G1 X1", 0.0)
    sender.interrupt(b"M112\n")
    assert sender.data_to_send() == b"\nM112\n" + numbered(1, "G1 X1")


def test_finished_is_proven() -> None:
    """The very last line is lost, and an ok too many hides it."""
    firmware = Firmware()
    world, job = job_for(firmware, ["G28", "G1 X1"])

    def spoil(line: bytes, count: int) -> bytes:
        if line.startswith(b"N3 M400") and not firmware.overruns:
            firmware.overruns = 1
            firmware.say("ok", world.now)
            return b""
        return line

    firmware.faults = Faults(to_printer=spoil)
    assert world.run(job) == End.FINISHED
    assert firmware.obeyed.count("M400") == 1


def test_only_the_probe_tells_whether_numbers_are_checked() -> None:
    """A request before it may be about a line of some host before us."""
    talk = Handshake(0.0)
    talk.receive(b"Resend: 77\nok\n", 0.1)
    talk.due(0.1 + QUIET)
    talk.receive(b"ok\n", 0.4)
    talk.due(0.4 + QUIET)
    talk.receive(b"ok T:0\n", 0.7)
    talk.due(0.7 + QUIET)
    assert talk.greeting is not None
    assert not talk.greeting.checks_numbers
