"""Two steps of a job at the same time: what comes is what one after the other would give."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest

from v3dcad.toolpath.overlapped import overlapped


def test_results_come_in_order_and_none_is_lost() -> None:
    for count in (0, 1, 2, 50):
        assert list(overlapped(lambda item: item**2, range(count))) == [i**2 for i in range(count)]


def test_an_item_is_made_while_the_last_one_is_worked_on() -> None:
    """Each waits for the other, so this ends only if they run at the same time."""
    made = threading.Barrier(2, timeout=60)

    def items() -> Iterator[int]:
        yield 0
        made.wait()
        yield 1

    def work(item: int) -> int:
        if item == 0:
            made.wait()
        return item

    assert list(overlapped(work, items())) == [0, 1]


def test_one_item_is_made_ahead_and_no_more() -> None:
    made: list[int] = []

    def items() -> Iterator[int]:
        for item in range(5):
            made.append(item)
            yield item

    results = overlapped(str, items())
    assert not made
    assert next(results) == "0"
    assert made == [0, 1]


def test_the_function_runs_in_one_thread() -> None:
    threads = set(overlapped(lambda _: threading.get_ident(), range(9)))
    assert len(threads) == 1
    assert threading.get_ident() not in threads


def test_errors_of_either_step_come_as_they_are() -> None:
    def items() -> Iterator[int]:
        yield 1
        raise KeyError("items")

    with pytest.raises(ZeroDivisionError):
        list(overlapped(lambda item: 1 // item, [0]))
    with pytest.raises(KeyError, match="items"):
        list(overlapped(str, items()))


def test_the_thread_ends_where_nobody_takes_the_rest() -> None:
    before = threading.active_count()
    results = overlapped(str, range(9))
    next(results)
    assert threading.active_count() == before + 1
    results.close()  # type: ignore[attr-defined]
    assert threading.active_count() == before
