"""Layers that tell how far one is when they are gone through."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

T = TypeVar("T")


class Watched(Sequence[T]):
    """The same layers or sections; each pass through them calls `passed` with how many are done.

    First with 0, last with as many as there are.
    """

    def __init__(self, layers: Sequence[T], passed: Callable[[int], None]) -> None:
        self.layers = layers
        self.passed = passed

    def __len__(self) -> int:
        return len(self.layers)

    def __getitem__(self, index: Any) -> Any:
        return self.layers[index]

    def __iter__(self) -> Iterator[T]:
        self.passed(0)
        for done, layer in enumerate(self.layers, start=1):
            yield layer
            self.passed(done)
