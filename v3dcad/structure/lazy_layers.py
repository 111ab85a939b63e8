"""Layers that are made when they are asked for: one, some, or one after the other."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import overload

from v3dcad.arguments import place
from v3dcad.model import Layer
from v3dcad.words import counted


class LayerSequence(Sequence[Layer]):
    """A sequence of layers whose `layer` makes one; negative indices count from the top."""

    def __repr__(self) -> str:
        return f"<{counted(len(self), 'layer')}>"

    @abstractmethod
    def layer(self, index: int) -> Layer:
        """Layer `index`, 0 ≤ index < len(self), by itself."""

    @overload
    def __getitem__(self, index: int) -> Layer: ...
    @overload
    def __getitem__(self, index: slice) -> list[Layer]: ...
    def __getitem__(self, index: int | slice) -> Layer | list[Layer]:
        if isinstance(index, slice):
            return [*map(self.layer, range(len(self))[index])]
        return self.layer(place("layer", index, len(self), "layers", from_end=True))
