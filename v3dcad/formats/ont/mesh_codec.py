"""Triangles as few bytes, to the last bit: a walk over the mesh, and what it does not predict.

The walk grows one patch at a time. Each side of the patch that has no neighbour yet is a gate.
Gates are passed in the order in which they opened. One symbol for each says which third corner the
triangle behind it has: a new vertex, the next or the last one along the patch's rim, or another
old one. (Gumhold & Straßer, "Real time compression of triangle mesh connectivity",
SIGGRAPH 1998; here without its need for a manifold, since anything else begins a new patch.) A
new vertex is guessed by completing the parallelogram before its gate (Touma & Gotsman, "Triangle
mesh compression", GI 1998), and only the difference is kept.
"""

from __future__ import annotations

import struct
from array import array
from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from v3dcad.model import Floats, Ints, Mesh

NO_TRIANGLE, NEW, NEXT, LAST, OLD = range(5)
"""Symbols: which third corner the triangle behind a gate has; `NO_TRIANGLE` where there is none."""

MAX_TRIANGLES = 4_000_000

HEADER = struct.Struct("<BIII3d")
"""Coordinates' form, vertices, symbols, old corners; and the origin, mm."""

DECIMALS, SINGLE, DOUBLE = range(10), 10, 11
"""Forms of coordinates: whole 10⁻ᵈ mm; float32, float64 by their place in the order of floats."""

SIGN = np.uint64(1 << 63)
WRAP = (1 << 64) - 1


def mesh_bytes(mesh: Mesh, origin: Floats) -> bytes:
    """A mesh as bytes; `mesh_in` returns it with vertices and triangles in another order.

    `origin` (3,), mm, is what the vertices were moved by, if they were: they take fewer bytes
    where they had fewer digits before. Every vertex must be a triangle's corner.
    """
    walk = _Walk()
    _walk_over(mesh.triangles, walk)
    form, origin, codes = _coded(mesh.vertices[walk.vertices], origin)
    guesses = np.array(walk.guesses, np.int64).reshape(-1, 3)
    codes = np.concatenate([codes, np.zeros((1, 3), np.uint64)])
    a, b, opposite = codes[guesses.T]
    residuals = (codes[:-1] - (a + b - opposite)).view(np.int64)
    folded = ((residuals << 1) ^ (residuals >> 63)).view(np.uint64)
    header = HEADER.pack(
        form, len(guesses), len(walk.symbols), len(walk.old), *(float(x) for x in origin)
    )
    old = np.array(walk.old, np.uint32)
    return header + bytes(walk.symbols) + _to_planes(old) + _to_planes(folded)


def mesh_in(data: bytes) -> Mesh:
    """The mesh in what `mesh_bytes` made; `ValueError` says why it cannot be."""
    if len(data) < HEADER.size:
        raise ValueError("the mesh's header is cut off")
    form, vertices, symbols, old, *origin = HEADER.unpack_from(data)
    expected = HEADER.size + symbols + 4 * old + 24 * vertices
    if len(data) != expected:
        raise ValueError(f"the mesh states {expected} bytes and has {len(data)}")
    if form > DOUBLE or not np.isfinite(origin).all():
        raise ValueError("the mesh's coordinates have an unknown form")
    stop = HEADER.size + symbols
    walk = _Walk(
        symbols=bytearray(data[HEADER.size : stop]),
        old=array("I", _from_planes(data[stop : stop + 4 * old], np.dtype("<u4")).tobytes()),
    )
    triangles = _walk_along(walk)
    if len(walk.guesses) != 3 * vertices:
        raise ValueError(
            f"the mesh states {vertices} vertices, its walk has {len(walk.guesses) // 3}"
        )
    folded = _from_planes(data[stop + 4 * old :], np.dtype("<u8"))
    residuals = (folded >> np.uint64(1)) ^ (np.uint64(0) - (folded & np.uint64(1)))
    codes = _summed(residuals.reshape(-1, 3), walk.guesses)
    with np.errstate(all="ignore"):  # what is not finite is refused below
        places = _decoded(form, codes) + np.array(origin)
    if not np.isfinite(places).all():
        raise ValueError("a vertex of the mesh is not finite")
    return Mesh(places, triangles)


@dataclass(slots=True)
class _Walk:
    """What a walk writes, and its state, which is the same when writing and when reading."""

    symbols: bytearray = field(default_factory=bytearray)
    old: array[int] = field(default_factory=lambda: array("I"))
    """How far back the vertex of each `OLD` is"""
    guesses: list[int] = field(default_factory=list)
    """For each new vertex three numbers: it is guessed as first + second − third; −1 is 0"""
    vertices: list[int] = field(default_factory=list)
    """The mesh's vertex for each of the walk's (when writing)"""
    gates: deque[tuple[int, int]] = field(default_factory=deque)
    open: dict[tuple[int, int], int] = field(default_factory=dict)
    """Gate → the corner on this side of it"""
    after: dict[int, int] = field(default_factory=dict)
    before: dict[int, int] = field(default_factory=dict)
    """A vertex on the rim → the one that follows and the one that precedes it"""

    @property
    def count(self) -> int:
        """How many vertices there are so far."""
        return len(self.guesses) // 3

    def add_vertex(self, first: int, second: int, third: int) -> int:
        """The number of a new vertex, guessed from three old ones."""
        self.guesses += (first, second, third)
        return self.count - 1

    def start_vertex(self) -> int:
        """The number of a new vertex that begins a patch: near the newest, if there is one."""
        return self.add_vertex(self.count - 1, -1, -1)

    def add_triangle(self, a: int, b: int, c: int) -> None:
        """Close the gates that a triangle fills and open those of its other sides."""
        for start, stop, opposite in ((a, b, c), (b, c, a), (c, a, b)):
            if self.open.pop((start, stop), None) is None:
                self.gates.append((stop, start))
                self.open[stop, start] = opposite
                self.after[stop], self.before[start] = start, stop

    def next_gate(self) -> tuple[int, int, int] | None:
        """The oldest open gate and the corner before it; None where the patch has none left."""
        while self.gates:
            gate = self.gates.popleft()
            if gate in self.open:
                return *gate, self.open[gate]
        return None


def _walk_over(triangles: Ints, walk: _Walk) -> None:
    """Write down a walk over triangles (t, 3)."""
    rows = triangles.tolist()
    beside: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for row in range(len(rows) - 1, -1, -1):
        a, b, c = rows[row]
        for side, corner in (((a, b), c), ((b, c), a), ((c, a), b)):
            beside.setdefault(side, []).append((row, corner))
    passed = bytearray(len(rows))
    number: dict[int, int] = {}

    def behind(start: int, stop: int) -> int | None:
        """Pass the first triangle behind a gate that has not been passed: its third corner."""
        waiting = beside.get((walk.vertices[start], walk.vertices[stop]), [])
        while waiting:
            row, corner = waiting.pop()
            if not passed[row]:
                passed[row] = 1
                return corner
        return None

    for row, corners in enumerate(rows):
        if passed[row]:
            continue
        passed[row] = 1
        for corner in corners:
            if corner in number:
                walk.symbols.append(OLD)
                walk.old.append(walk.count - 1 - number[corner])
            else:
                walk.symbols.append(NEW)
                number[corner] = walk.start_vertex()
                walk.vertices.append(corner)
        walk.add_triangle(*(number[corner] for corner in corners))
        while gate := walk.next_gate():
            start, stop, opposite = gate
            corner = behind(start, stop)
            if corner is None:
                walk.symbols.append(NO_TRIANGLE)
                del walk.open[start, stop]
                continue
            if corner not in number:
                walk.symbols.append(NEW)
                number[corner] = walk.add_vertex(start, stop, opposite)
                walk.vertices.append(corner)
            elif number[corner] == walk.after.get(stop):
                walk.symbols.append(NEXT)
            elif number[corner] == walk.before.get(start):
                walk.symbols.append(LAST)
            else:
                walk.symbols.append(OLD)
                walk.old.append(walk.count - 1 - number[corner])
            walk.add_triangle(start, stop, number[corner])


def _walk_along(walk: _Walk) -> Ints:
    """The triangles (t, 3) of a walk's symbols; fills in its guesses."""
    symbols, old = iter(walk.symbols), iter(walk.old)
    triangles = array("q")

    def corner(symbol: int, gate: tuple[int, int, int] | None) -> int:
        if symbol == NEW:
            return walk.add_vertex(*gate) if gate else walk.start_vertex()
        if symbol == OLD:
            found = walk.count - 1 - next(old, walk.count)
        elif gate and symbol == NEXT:
            found = walk.after.get(gate[1], -1)
        elif gate and symbol == LAST:
            found = walk.before.get(gate[0], -1)
        else:
            found = -1
        if found < 0:
            raise ValueError("the mesh's walk refers to a vertex that does not exist")
        return found

    def add(a: int, b: int, c: int) -> None:
        if len(triangles) >= 3 * MAX_TRIANGLES:
            raise ValueError(f"the mesh has more than {MAX_TRIANGLES} triangles")
        triangles.extend((a, b, c))
        walk.add_triangle(a, b, c)

    for symbol in symbols:
        first = corner(symbol, None)
        second = corner(next(symbols, NO_TRIANGLE), None)
        add(first, second, corner(next(symbols, NO_TRIANGLE), None))
        while gate := walk.next_gate():
            symbol = next(symbols, NO_TRIANGLE)
            if symbol == NO_TRIANGLE:
                del walk.open[gate[:2]]
            else:
                add(*gate[:2], corner(symbol, gate))
    if next(old, None) is not None:
        raise ValueError("the mesh has more old corners than its walk uses")
    return np.frombuffer(triangles, np.int64).reshape(-1, 3)


def _summed(residuals: NDArray[np.uint64], guesses: list[int]) -> NDArray[np.uint64]:
    """Codes (v, 3): each residual on top of the guess made of earlier codes, modulo 2⁶⁴."""
    columns = []
    for column in residuals.T.tolist():
        codes = [*column, 0]  # the last one is the vertex −1's
        for vertex in range(len(column)):
            a, b, opposite = guesses[3 * vertex : 3 * vertex + 3]
            codes[vertex] = (codes[vertex] + codes[a] + codes[b] - codes[opposite]) & WRAP
        columns.append(codes[:-1])
    return np.array(columns, np.uint64).T


def _coded(places: Floats, origin: Floats) -> tuple[int, Floats, NDArray[np.uint64]]:
    """The form that takes the fewest bits of those that keep every bit; origin; codes (v, 3)."""
    for shift in (origin, np.zeros(3)):
        base = places - shift
        with np.errstate(over="ignore"):  # numbers so large are no form's but the last
            tries = [np.rint(base * 10.0**digits) for digits in DECIMALS]
            single = base.astype(np.float32)
        for digits, whole in zip(DECIMALS, tries, strict=True):
            exact = np.array_equal(whole / 10.0**digits + shift, places)
            if exact and np.abs(whole).max(initial=0) < 2**53:
                return digits, shift, whole.astype(np.int64).view(np.uint64)
        if np.array_equal(single.astype(np.float64) + shift, places):
            bits = single.view(np.uint32).astype(np.uint64)
            return SINGLE, shift, np.where(bits >> 31, 0xFFFFFFFF - bits, bits + (1 << 31))
    bits = places.view(np.uint64)
    return DOUBLE, np.zeros(3), np.where(bits >= SIGN, ~bits, bits + SIGN)


def _decoded(form: int, codes: NDArray[np.uint64]) -> Floats:
    """What `_coded` made codes (v, 3) of, but for the origin."""
    if form in DECIMALS:
        return np.asarray(codes.view(np.int64) / 10.0**form, np.float64)
    if form == SINGLE:
        low = codes.astype(np.uint32)
        bits = np.where(low >> 31, low - np.uint32(1 << 31), ~low)
        return bits.view(np.float32).astype(np.float64)
    return np.where(codes >= SIGN, codes - SIGN, ~codes).view(np.float64)


def _to_planes(words: NDArray[np.uint32] | NDArray[np.uint64]) -> bytes:
    """All words' first bytes, then all their second ones, and so on: alike next to alike."""
    rows = words.reshape(-1, 1).astype(words.dtype.newbyteorder("<")).view(np.uint8)
    return rows.T.tobytes()


def _from_planes(
    data: bytes, word: np.dtype[np.uint64] | np.dtype[np.uint32]
) -> NDArray[np.uint64]:
    rows = np.frombuffer(data, np.uint8).reshape(word.itemsize, -1)
    return np.ascontiguousarray(rows.T).view(word).ravel()
