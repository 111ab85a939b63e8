"""How a run of the engine ended: one list for all of its loops."""

from __future__ import annotations

from enum import IntEnum


class Ending(IntEnum):
    """Why a compiled loop returned to Python: it is done, or it needs what only Python does."""

    DONE = 0
    LOG_FULL = 1
    """no room for more struts in the log"""
    NO_FLIP = 2
    """edges are due of which none can be flipped: moments differ by less than floats resolve"""
    POINTS_FULL = 3
    """no room for more points"""
    EPOCH_OVER = 4
    """the next layer belongs to the next epoch"""
    RING_OPEN = 5
    """a ring of the section does not close"""
    CROSSINGS_FULL = 6
    """no room for more crossings of rings and edges"""
    OUTPUT_FULL = 7
    """no room for the next layer in the arrays that the loop writes"""
