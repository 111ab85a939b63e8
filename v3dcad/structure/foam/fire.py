"""Descending an energy: sites with speeds, which turn downhill and halt where they would go up.

FIRE (Bitzek et al., "Structural relaxation made simple", Phys. Rev. Lett. 2006).
"""

from __future__ import annotations

import numpy as np

from v3dcad.geometry.compiled.arrays import FloatArray, IntArray
from v3dcad.geometry.compiled.options import INTERNAL, compiled
from v3dcad.geometry.voronoi.bins import bin_of, insert, remove
from v3dcad.structure.foam.energy import TOUCHED, Foam

FIRST_STEP, LEAST_STEP, LARGEST_STEP = 0.05, 0.01, 0.3
"""The time steps of FIRE."""

FIRST_MIX, MIX_DECAY, CALM, FASTER, SLOWER = 0.1, 0.99, 5, 1.1, 0.5
"""FIRE's own constants: how much of the speed turns downhill, and how the time step changes."""

STRONGEST, LONGEST = 2.0, 0.08
"""The largest force, and the largest step in radii."""


@compiled(INTERNAL)
def descend(foam: Foam, pace: FloatArray) -> None:
    """One step of FIRE for all touched sites; pace (3,) holds time step, mix and calm steps."""
    gradients, speeds = foam.gradients, foam.speeds
    power, forces, motion = 0.0, 0.0, 0.0
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        force = 0.0
        for axis in range(3):
            gradients[site, axis] *= -foam.radii[site]
            force += gradients[site, axis] ** 2
        if force > STRONGEST**2:
            for axis in range(3):
                gradients[site, axis] *= STRONGEST / np.sqrt(force)
        for axis in range(3):
            power += gradients[site, axis] * speeds[site, axis]
            forces += gradients[site, axis] ** 2
            motion += speeds[site, axis] ** 2
    keep, turn = 0.0, 0.0
    if power > 0:
        keep, turn = 1 - pace[1], pace[1] * np.sqrt(motion / forces)
        pace[2] += 1
        if pace[2] > CALM:
            pace[0] = min(pace[0] * FASTER, LARGEST_STEP)
            pace[1] *= MIX_DECAY
    else:
        pace[0], pace[1], pace[2] = max(pace[0] * SLOWER, LEAST_STEP), FIRST_MIX, 0
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        length = 0.0
        for axis in range(3):
            force = gradients[site, axis]
            speeds[site, axis] = keep * speeds[site, axis] + (turn + pace[0]) * force
            length += speeds[site, axis] ** 2
            gradients[site, axis] = 0.0
        length = pace[0] * np.sqrt(length)
        step = pace[0] * foam.radii[site] * min(1.0, LONGEST / max(length, 1e-300))
        if site < foam.held:
            continue
        for axis in range(3):
            foam.places[site, axis] += step * speeds[site, axis]


@compiled(INTERNAL)
def settle_in_bins(foam: Foam, homes: IntArray) -> None:
    """Bring touched sites back into the periods and into their bins; homes (n,) are these."""
    periods, low = foam.bins.periods, foam.bins.low
    for index in range(foam.counts[TOUCHED]):
        site = foam.touched_rows[index]
        for axis in range(3):
            if periods[axis] > 0:
                place = foam.places[site, axis] - low[axis]
                place -= periods[axis] * np.floor(place / periods[axis])
                foam.places[site, axis] = low[axis] + (place if place < periods[axis] else 0.0)
        x, y, z = foam.places[site, 0], foam.places[site, 1], foam.places[site, 2]
        home = bin_of(foam.bins, x, y, z)
        if home != homes[site]:
            remove(foam.bins, site, homes[site])
            insert(foam.bins, site, home)
            homes[site] = home
