"""Dialogues with print servers, played by hand: what is asked, and what answers mean."""

from __future__ import annotations

import pytest

from v3dcad.printer.ends import HostError, HostFault
from v3dcad.printer.hosts.moonraker import Moonraker
from v3dcad.printer.hosts.octoprint import OctoPrint
from v3dcad.printer.hosts.prusalink import PrusaLink
from v3dcad.printer.hosts.requests import Answer, Dialogue, HostState, Request, said

VERSION = Answer(200, {"text": "OctoPrint 1.11.8"})
INFO = Answer(200, {"result": {"moonraker_version": "0.11", "klippy_state": "ready"}})
LINK = Answer(200, {"text": "PrusaLink", "server": "2.1"})
STORAGE = Answer(200, {"storage_list": [{"path": "/usb", "available": True}]})


def play(dialogue: Dialogue, *answers: Answer) -> tuple[list[Request], object]:
    """What is asked when a server answers so, and what comes out."""
    asked: list[Request] = []
    try:
        asked = [next(dialogue)]
        for answer in answers:
            asked = [*asked, dialogue.send(answer)]
    except StopIteration as end:
        assert len(asked) == len(answers), "not all answers were wanted"
        return asked, end.value
    raise AssertionError("the dialogue wants more answers")


def printing(state: str) -> Answer:
    return Answer(200, {"result": {"status": {"print_stats": {"state": state}}}})


@pytest.mark.parametrize(
    ("host", "answers", "state"),
    [
        (OctoPrint, [VERSION, Answer(200, {"state": {"text": "Operational",
            "flags": {"ready": True}}})], HostState("OctoPrint 1.11.8", "Operational", True)),
        (OctoPrint, [VERSION, Answer(200, {"state": {"text": "Printing",
            "flags": {"ready": False}}})], HostState("OctoPrint 1.11.8", "Printing", False)),
        (OctoPrint, [VERSION, Answer(409)],
            HostState("OctoPrint 1.11.8", "the printer is not connected", False)),
        (Moonraker, [INFO, printing("standby")], HostState("Moonraker 0.11", "standby", True)),
        (Moonraker, [INFO, printing("printing")], HostState("Moonraker 0.11", "printing", False)),
        (Moonraker, [INFO, printing("paused")], HostState("Moonraker 0.11", "paused", False)),
        (PrusaLink, [LINK, Answer(200, {"printer": {"state": "FINISHED"}})],
            HostState("PrusaLink 2.1", "finished", True)),
        (PrusaLink, [LINK, Answer(200, {"printer": {"state": "ATTENTION"}})],
            HostState("PrusaLink 2.1", "attention", False)),
    ],
)  # fmt: skip
def test_states(host: type, answers: list[Answer], state: HostState) -> None:
    assert play(host().state(), *answers)[1] == state


@pytest.mark.parametrize(
    ("host", "before", "answer", "method", "where"),
    [
        (OctoPrint, [], {"files": {"local": {"path": "a_b.gcode"}}}, "POST", "local/a_b.gcode"),
        (OctoPrint, [], None, "POST", "local/a b.gcode"),
        (Moonraker, [], {"item": {"path": "a b.gcode"}}, "POST", "gcodes/a b.gcode"),
        (PrusaLink, [STORAGE], None, "PUT", "usb/a%20b.gcode"),
    ],
)
@pytest.mark.parametrize("replace", [True, False])
def test_uploads(host, before, answer, method, where, replace: bool) -> None:
    asked, found = play(host().upload("a b.gcode", "5ha", replace=replace), *before,
                        Answer(201, answer))  # fmt: skip
    upload = asked[-1]
    assert found == where
    assert (upload.method, upload.upload) == (method, "a b.gcode")
    told = {**(upload.form or {}), **upload.headers}
    assert {told.get("print", "false"), told.get("Print-After-Upload", "?0")} == {"false", "?0"}
    if host is OctoPrint:
        assert told["noOverwrite"] == str(not replace).lower()
    if host is Moonraker:
        assert told["checksum"] == "5ha"
    if host is PrusaLink:
        assert told["Overwrite"] == f"?{int(replace)}"


@pytest.mark.parametrize("host", [OctoPrint, Moonraker, PrusaLink])
def test_files(host: type) -> None:
    before = [STORAGE] if host is PrusaLink else []
    assert play(host().exists("a"), *before, Answer(200))[1] is True
    assert play(host().exists("a"), *before, Answer(404))[1] is False
    play(host().start("a"), *before, Answer(204))
    for status in (404, 200 if host is Moonraker else 204):
        play(host().remove("a"), *before, Answer(status))
    with pytest.raises(HostError, match="being printed") as caught:
        play(host().remove("a"), *before, Answer(409, {"error": "it is being printed"}))
    assert caught.value.fault == HostFault.BUSY


def test_klipper_that_is_not_ready() -> None:
    info = {"moonraker_version": "0.11", "klippy_state": "shutdown"}
    (_, state) = play(Moonraker().state(), Answer(200, {"result": info}))
    assert state == HostState("Moonraker 0.11", "Klipper is shutdown", ready=False)


@pytest.mark.parametrize("host", [OctoPrint, Moonraker, PrusaLink])
@pytest.mark.parametrize("answer", [Answer(404), Answer(200), Answer(200, {"text": "Router"}),
                                    Answer(200, [1])])  # fmt: skip
def test_another_kind(host: type, answer: Answer) -> None:
    with pytest.raises(HostError) as caught:
        play(host().state(), answer)
    assert caught.value.fault == HostFault.KIND


def test_what_a_terminal_would_obey_is_not_shown() -> None:
    nasty = {"text": "OctoPrint\x1b[2J\x07 1\n2", "error": "x" * 999}
    answer = Answer(200, nasty)
    assert answer.words("text") == "OctoPrint [2J 1 2"
    assert len(said(answer)) == 200
    _, state = play(OctoPrint().state(), answer, Answer(409))
    assert state.version.isprintable()


def test_prusalink_without_a_storage() -> None:
    full = {"storage_list": [{"path": "/usb", "available": True, "read_only": True}]}
    odd = ({"storage_list": found} for found in (5, [5], [{"available": True}], {"a": 1}))
    for answer in (Answer(200, full), Answer(200, {}), *(Answer(200, one) for one in odd)):
        with pytest.raises(HostError, match="put in a USB stick"):
            play(PrusaLink().exists("a"), answer)


def test_the_storage_is_asked_for_once() -> None:
    host = PrusaLink()
    assert len(play(host.exists("a"), STORAGE, Answer(404))[0]) == 2
    assert len(play(host.upload("a", "", replace=False), Answer(201))[0]) == 1
