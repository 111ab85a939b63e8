"""Memory that one layer's arrays leave behind, kept for those of the next."""

from __future__ import annotations

import numpy as np

KEPT = 31 << 20
"""Bytes; 32 MiB is the most that glibc's threshold rises to."""


def keep_freed_memory() -> None:
    """Have the C library of Linux keep freed arrays for the next, not hand them to the system.

    It maps arrays from a threshold on page by page, and unmaps them when they are freed. The
    threshold, and twice that for the top of the heap, follow the largest array that was freed so
    far (mallopt(3), M_MMAP_THRESHOLD): one of `KEPT` bytes, which nobody writes to and which so
    costs nothing, raises them for good. Without it the pages of each layer's arrays would be handed
    back, and be zeroed and mapped anew for the next layer. Other C libraries do not mind.
    """
    np.empty(KEPT, np.uint8)
