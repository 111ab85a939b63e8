"""Random numbers by hashing integers: the same on every machine and in every version.

splitmix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import Word, WordArray
from v3dcad.geometry.compiled.options import ENTRY, compiled


@compiled(ENTRY)
def random_bits(state: WordArray) -> Word:
    """64 random bits; moves the state (1,) uint64 on."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    bits: np.uint64 = state[0]
    bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return int(bits ^ (bits >> np.uint64(31)))


@compiled(ENTRY)
def random_share(state: WordArray) -> float:
    """A random number from 0 to below 1; moves the state (1,) uint64 on."""
    return np.float64(random_bits(state) >> np.uint64(11)) * (1.0 / 9007199254740992.0)
