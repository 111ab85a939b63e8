"""Stiffness of foam against columns at equal mass: `python -m benchmarks.stiffness [--quick]`.

Both are periodic, of walls of one thickness, so thick that the solid share is `SHARE`. The foam is
relaxed as the shipped tile is, in a box so small that its walls are some voxels thick; the columns
are scattered as `stretch="columns"` scatters them. Solid voxels are the finite elements: cubes of
eight nodes, fully integrated, of a material with E = 1 and ν = 0.3. The mean strain along an axis
is 1, the other five are free, and displacements are periodic but for it: the energy is then half of
Young's modulus along that axis. Conjugate gradients find it from above.
"""

from __future__ import annotations

import argparse
import time
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, cg
from scipy.spatial import KDTree

from v3dcad.geometry.voronoi.periodic import with_copies
from v3dcad.model import Floats
from v3dcad.structure.foam.darts import poisson_disk
from v3dcad.structure.foam.relaxing import relax
from v3dcad.structure.foam.tile import TAU_SQUARED, stretch_for

SHARE = 0.15
POISSON = 0.3
TOLERANCE = 1e-5
"""Of the residual. At 1e-6 columns are up to 0.6 % softer; at 1e-4 they seem up to 1.8 times as
stiff as they are, since a soft body converges late."""

FOAM_SIDE = 4.0
"""In radii: 45 cells. The relaxer takes no smaller box."""

COLUMNS, CANDIDATES = 40, 10

CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
SHEARS = [(1, 2), (0, 2), (0, 1)]
"""The axes of strains 3 to 5; 0 to 2 are along x, y, z."""


def foam(random_seed: int) -> tuple[Floats, Floats]:
    """Sites (n, 3) of a foam whose walls lean at most 45° where stretched, and their box (3,)."""
    box = np.full(3, FOAM_SIDE)
    places = poisson_disk(box, 1.0, random_seed)
    return relax(places, np.ones(len(places)), box, sqrt(TAU_SQUARED)), box


def columns(random_seed: int) -> tuple[Floats, Floats]:
    """Sites (n, 3) at one height, scattered evenly, and a box (3,) without another near above."""
    random, side = np.random.default_rng(random_seed), sqrt(COLUMNS)
    flat = random.random((1, 2)) * side
    while len(flat) < COLUMNS:
        candidates = random.random((CANDIDATES, 2)) * side
        distances, _ = KDTree(flat, boxsize=side).query(candidates)
        flat = np.vstack([flat, candidates[np.argmax(distances)]])
    return np.column_stack([flat, np.zeros(COLUMNS)]), np.array([side, side, 100 * side])


def wall_distances(
    places: Floats, box: Floats, stretch: float, voxel: float, shape: tuple[int, int, int]
) -> Floats:
    """How far the middles of voxels are from the nearest wall of stretched sites (n, 3)."""
    axes = [(np.arange(count) + 0.5) * voxel for count in shape]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    squeeze = np.array([1, 1, 1 / stretch])
    around = with_copies(places, box, 2.0)
    distances, near = KDTree(around).query(points * squeeze, 4)
    # A bisector's normal in the stretched space has the squeeze twice.
    normals = (around[near[:, 1:]] - around[near[:, :1]]) * squeeze
    gaps = (distances[:, 1:] ** 2 - distances[:, :1] ** 2) / 2
    return np.asarray((gaps / np.linalg.norm(normals, axis=2)).min(axis=1).reshape(shape))


def element() -> Floats:
    """The stiffness (30, 30) of a voxel of side 1: eight nodes' displacements, six mean strains."""
    lame, shear = POISSON / (1 + POISSON) / (1 - 2 * POISSON), 1 / (1 + POISSON) / 2
    elastic = np.diag([2 * shear] * 3 + [shear] * 3)
    elastic[:3, :3] += lame
    nodal = np.zeros((24, 24))
    for point in 0.5 + (CORNERS - 0.5) / sqrt(3):
        factors = np.where(CORNERS == 1, point, 1 - point)
        slopes = (2 * CORNERS - 1) * factors[:, [1, 2, 0]] * factors[:, [2, 0, 1]]
        strains = np.zeros((6, 8, 3))
        for axis in range(3):
            strains[axis, :, axis] = slopes[:, axis]
        for row, (a, b) in enumerate(SHEARS, 3):
            strains[row, :, a], strains[row, :, b] = slopes[:, b], slopes[:, a]
        flat = strains.reshape(6, 24)
        nodal += flat.T @ elastic @ flat / 8
    mean = np.zeros((8, 3, 6))
    for axis in range(3):
        mean[:, axis, axis] = CORNERS[:, axis]
    for row, (a, b) in enumerate(SHEARS, 3):
        mean[:, a, row], mean[:, b, row] = CORNERS[:, b] / 2, CORNERS[:, a] / 2
    both = np.hstack([np.eye(24), mean.reshape(24, 6)])
    return np.asarray(both.T @ nodal @ both)


def youngs_modulus(solid: NDArray[np.bool_], axis: int) -> float:
    """Young's modulus along an axis of a periodic body of voxels, in shares of its material's."""
    voxels = np.argwhere(solid)
    corners = (voxels[:, None] + CORNERS) % solid.shape
    _, nodes = np.unique(
        np.ravel_multi_index(tuple(corners.reshape(-1, 3).T), solid.shape), return_inverse=True
    )
    freedoms = (3 * nodes.reshape(-1, 8, 1) + np.arange(3)).reshape(-1, 24)
    count, stiffness = 3 * (nodes.max() + 1), element()
    given = count + axis
    moved = np.empty((len(voxels), 30))

    def forces(state: Floats) -> Floats:
        moved[:, :24], moved[:, 24:] = state[freedoms], state[count:]
        on_voxels = moved @ stiffness
        on_nodes = np.bincount(freedoms.ravel(), on_voxels[:, :24].ravel(), count)
        return np.append(on_nodes, on_voxels[:, 24:].sum(axis=0))

    def free_forces(state: Floats) -> Floats:
        found = forces(np.where(np.arange(len(state)) == given, 0.0, state))
        found[given] = 0.0
        return found

    start = np.zeros(count + 6)
    start[given] = 1.0
    load = -forces(start)
    load[given] = 0.0
    own = np.tile(np.diag(stiffness)[:24], len(voxels))
    diagonal = np.append(
        np.bincount(freedoms.ravel(), own, count), np.diag(stiffness)[24:] * len(voxels)
    )
    size = (count + 6, count + 6)
    answer, failed = cg(
        LinearOperator(size, free_forces, dtype=np.float64),
        load,
        rtol=TOLERANCE,
        maxiter=5000,
        M=LinearOperator(size, lambda state: state / diagonal, dtype=np.float64),
    )
    assert not failed, "conjugate gradients did not end"
    answer += start
    return float(answer @ forces(answer)) / solid.size


def row(name: str, distances: Floats, voxel: float) -> float:
    """Print the moduli of walls of the share; returns the mean one sideways."""
    began = time.process_time()
    half = float(np.quantile(distances, SHARE))
    solid = distances <= half
    x, y, z = (youngs_modulus(solid, axis) for axis in range(3))
    print(
        f"{name:>16} {2 * half / voxel:13.2f} {solid.mean():6.3f} {x:8.4f} {y:8.4f} {z:8.4f} "
        f"{time.process_time() - began:5.0f} s",
        flush=True,
    )
    return (x + y) / 2


def compare(quick: bool) -> tuple[list[float], list[float]]:
    """Print all rows; returns the moduli sideways of foams and of columns."""
    stretch = stretch_for(45.0)
    print(f"{'walls':>16} {'voxels thick':>13} {'share':>6} {'E x':>8} {'E y':>8} {'E z':>8}")
    stiff, soft = [], []
    for seed, across in [(1, 64), (1, 96)] + ([] if quick else [(2, 96), (1, 128)]):
        voxel, (places, box) = FOAM_SIDE / across, foam(seed)
        shape = (across, across, round(across * stretch))
        stiff.append(
            row(f"foam, seed {seed}", wall_distances(places, box, stretch, voxel, shape), voxel)
        )
    for seed, across in [(1, 128), (1, 256), (2, 256)] + ([] if quick else [(3, 256), (1, 384)]):
        places, box = columns(seed)
        voxel = box[0] / across
        shape = (across, across, 1)
        soft.append(
            row(f"columns, seed {seed}", wall_distances(places, box, 1.0, voxel, shape), voxel)
        )
    return stiff, soft


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="leave the finest voxels out")
    stiff, soft = compare(parser.parse_args().quick)
    print(f"foam ÷ columns, sideways: {np.mean(stiff) / np.mean(soft):.1f} on average,")
    print(f"  {min(stiff) / max(soft):.1f} … {max(stiff) / min(soft):.1f} between all rows")


if __name__ == "__main__":
    main()
