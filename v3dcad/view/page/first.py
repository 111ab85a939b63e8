"""What a page shows when it is opened."""

from __future__ import annotations

from typing import NamedTuple


class First(NamedTuple):
    """A target, and what has to be chosen for it; by default the whole structure."""

    target: str = "full"
    layer: int | None = None
    """by its index; by default the middle one where the target shows one, else the uppermost"""
    cell: int | None = None
    neighbour: int | None = None

    def values(self, layers: int, step: int, one_layer: bool) -> dict[str, str | int]:
        """The page's values, where of a number of layers every `step`-th is shown."""
        layer = self.layer
        if layer is None:
            layer = layers // 2 if one_layer else layers - 1
        values: dict[str, str | int] = {"target": self.target, "layer": layer // step}
        if self.cell is not None:
            values["cell"] = self.cell
        if self.neighbour is not None:
            values["neighbour"] = self.neighbour
        return values


WHOLE = First()
"""The whole structure."""
