"""What the thesis's loop carries from one layer to the next: its lists PL, WL, OL and POL."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from v3dcad.model import Floats, Ints, Value

SHRINKS, STAYS, GROWS = -1, 0, 1
"""The tags of OL: what a site's weight does on entering a layer."""

INITIAL = -1
"""`born_in` of the sites that were there from the start."""

UNTOUCHED = -1
"""`inset_steps` of a cell that Algorithm 8 has not met yet."""


@dataclass(frozen=True, eq=False, slots=True)
class State(Value):
    """The sites (PL), what they weigh (WL), how that changes (OL), and what their births fixed."""

    sites: Floats
    """(n, 2) mm"""
    weights: Floats
    """(n,) mm²"""
    tags: Ints
    """(n,) SHRINKS, STAYS or GROWS"""
    born_in: Ints
    """(n,) index of the layer that a site was inserted in, or `INITIAL`"""
    corners: Ints
    """(n,) corners of an inserted site's cell when it first appeared, 0 before"""
    inset_steps: Ints
    """(n,) by how many steps of 0.1 mm an inserted site's cell is drawn in (POL), or `UNTOUCHED`"""

    def inserted(self) -> Ints:
        """Ids of the inserted sites (IPL), in the order of their insertion."""
        return np.nonzero(self.born_in != INITIAL)[0]

    def grown(self, offset: float) -> State:
        """The state on entering a layer (Algorithm 1, lines 10 to 19)."""
        return replace(self, weights=self.weights + offset * self.tags)

    def with_site(self, place: Floats, weight: float, layer: int) -> State:
        """The state with one more site, growing, at a place (2,)."""
        return State(
            sites=np.vstack([self.sites, place]),
            weights=np.append(self.weights, weight),
            tags=np.append(self.tags, GROWS),
            born_in=np.append(self.born_in, layer),
            corners=np.append(self.corners, 0),
            inset_steps=np.append(self.inset_steps, UNTOUCHED),
        )

    def with_values(self, site: int, **values: float) -> State:
        """The state with one site's weight, tag, corners or inset steps replaced."""
        changed: dict[str, Any] = {}
        for name, value in values.items():
            changed[name] = np.array(getattr(self, name))
            changed[name][site] = value
        return replace(self, **changed)


def initial_state(sites: Floats) -> State:
    """Sites (n, 2), mm, without weight, none of them growing yet (Algorithm 1, lines 1 to 6)."""
    count = len(sites)
    return State(
        sites=sites,
        weights=np.zeros(count),
        tags=np.full(count, STAYS),
        born_in=np.full(count, INITIAL),
        corners=np.zeros(count, dtype=np.int64),
        inset_steps=np.full(count, UNTOUCHED),
    )
