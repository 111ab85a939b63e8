"""How a run of the engine ended: one list for all of its loops."""

from __future__ import annotations

from enum import IntEnum


class Ending(IntEnum):
    """Why a compiled loop returned to Python: it is done, or it needs what only Python does."""

    DONE = 0
    NO_FLIP = 1
    """edges are due of which none can be flipped: the triangulation has to be built anew"""
    RING_OPEN = 2
    """a ring of the section does not close"""
    CROSSINGS_FULL = 3
    """no room for more crossings of rings and edges"""
    OUTPUT_FULL = 4
    """no room for the next layer in the arrays that the loop writes"""
