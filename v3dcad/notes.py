"""Warnings of Python as sentences that a command or the worker tells."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def noted() -> Iterator[list[str]]:
    """Fills a list, at the end, with what was warned of meanwhile: each sentence once, in order."""
    notes: list[str] = []
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UserWarning)
        try:
            yield notes
        finally:
            notes += dict.fromkeys(str(one.message) for one in told if one.category is UserWarning)
