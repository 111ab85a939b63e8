"""One bar over all steps on a terminal, one line in a pipe."""

from __future__ import annotations

import sys

import pytest

from v3dcad.commands.progress import Progress


def test_in_a_pipe_one_line_as_soon_as_work_begins(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress("filling a.step", 2) as progress:
        assert capsys.readouterr().err == ""
        progress.start("reading")
        assert capsys.readouterr().err == "filling a.step\n"
        assert list(progress.watch([1, 2, 3])) == [1, 2, 3]
        progress.start("writing")
        progress.step("writing", 1, 2)
    assert capsys.readouterr().err == ""


def test_on_a_terminal_the_bar_never_goes_back_and_ends_full(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    reached = [0.0]
    with Progress("filling a.step", 3) as progress:
        assert progress.bar is not None
        (task,) = progress.bar.tasks
        progress.start("reading")
        progress.step("cutting", 2, 4)
        reached.append(task.completed)
        for what in ("writing a.step", "writing a.png"):
            progress.start(what)
            assert task.description == what
            reached.extend(task.completed for _ in progress.watch([1, 2, 3, 4]))
        assert task.completed == task.total == 3
    assert reached == sorted(reached)
    assert reached[1] == 0.5
    assert "a.step" in capsys.readouterr().err
