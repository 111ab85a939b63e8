"""Sets that are joined, by trees: two members are in one set if they have the same root."""

from __future__ import annotations

from v3dcad.geometry.compiled.arrays import IntArray
from v3dcad.geometry.compiled.options import INTERNAL, compiled


@compiled(INTERNAL)
def root(parent: IntArray, member: int) -> int:
    """The root of a member's tree, in which a root is its own `parent` (n,); ways get shorter."""
    while parent[member] != member:
        parent[member] = parent[parent[member]]
        member = parent[member]
    return member
