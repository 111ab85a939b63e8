"""Sites of a foam whose cells are as large as a field says, for a part in a box.

Darts are thrown with a radius that follows the field, then sites are moved until no wall leans too
much, and the result is certified in whole numbers. Where that fails, it is done again from other
random numbers. The sites so made are explicit ones: whoever has them has the structure.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from v3dcad.errors import GeometryError, SettingError
from v3dcad.geometry.voronoi.reach import cell_reaches
from v3dcad.model import Floats, Progress, Value, unheard
from v3dcad.settings import FillSettings
from v3dcad.structure.foam.choice import graded_stretch
from v3dcad.structure.foam.darts import EXPECTED, graded_disk, radii_for, targets_of
from v3dcad.structure.foam.explicit import explicit_sites
from v3dcad.structure.foam.random import random_bits
from v3dcad.structure.foam.relaxing import STAGES, relax_inside
from v3dcad.structure.foam.size_grid import SLOPE, Field, Sampled, sampled
from v3dcad.structure.foam.space import steepest_in, tilt
from v3dcad.structure.foam.uniform import refuse_larger

PAD = 2.0
"""In radii: how far around the box sites are made."""

SLACK = 0.001
"""In squared radii: rounding to the structure's grid moves no bisector as far."""

MOST = 10_000_000
"""Sites of a graded foam."""

TRIES = 3
"""How often it is tried to find sites that are certified, none held where it is wanted"""

CLEAR = (1.1, 1.1, 2.5)
"""and before that, with those held that do not stand over others within so many radii: patterns
over each other, about two radii apart, leave the sites between them no room to move."""

HELD_EFFORT, EFFORT = 600, 20_000
"""How often sites are moved on average before a try is given up. Around patterns under roofs 25 to
500 times did; other random numbers are the quicker way out of a knot."""

SAME = 0.02
"""A made size that differs less from the asked one counts as it."""


@dataclass(frozen=True, eq=False, slots=True)
class Graded(Value):
    """The sites of a graded foam, and how its cells differ from what was asked."""

    sites: Floats
    """(n, 3) mm, bed coordinates"""
    stretch: float
    asked: tuple[float, float]
    """mm: the smallest and largest size that was asked for in the box"""
    made: tuple[float, float]
    """mm: those that were made"""
    finest: float
    """the least share of the asked size that was made"""
    finer: float
    """the share of the box where cells are smaller than asked, since the field is too steep"""


def graded_sites(
    field: Field,
    low: Floats,
    high: Floats,
    settings: FillSettings,
    progress: Progress = unheard,
    wanted: Callable[[], Floats] | None = None,
) -> Graded:
    """The sites for a part in the box low … high (3,), mm, with cells as large as a field says.

    `field` takes points (n, 3), mm, bed coordinates, and gives sizes (n,), mm, all above 0: there
    are 1 / size² cells a mm² of a horizontal section. Sites stand where they are `wanted` (m, 3),
    mm, if walls allow it. Raises `SettingError` for more than `MOST` sites, for cells larger than
    the box, for a field that is too steep if `settings.strict`, and where no sites can be found
    whose walls all lean at most `settings.max_overhang`.
    """
    stretch = graded_stretch(settings)
    squeezed = np.array([1, 1, 1 / stretch])
    inside = np.array([low, high]) * squeezed
    progress("sampling cell sizes", 0, 1)
    sizes = sampled(lambda places: field(places / squeezed), *inside)
    graded = _compared(sizes, stretch)
    refuse_larger(graded.made[0], np.ptp(inside, axis=0))
    if settings.strict and graded.finer > 0:
        raise SettingError(
            "strict",
            f"--strict: the cell size changes too steeply in {100 * graded.finer:.2g} % of the "
            f"part's box, where cells of {100 * graded.finest:.2g} % of the size would be made; "
            f"let it change by at most {SLOPE:g} mm a mm sideways and "
            f"{SLOPE / stretch:.2g} mm a mm upward, or leave --strict out",
        )
    grid = radii_for(sizes.grid)
    targets = targets_of(grid, inside, PAD)
    _refuse_many(EXPECTED * float(targets.shares[-1]))
    first = wanted() * squeezed if wanted else np.empty((0, 3))
    state = np.array([settings.random_seed], np.uint64)
    failure = ""
    for clear in [*(CLEAR if len(first) else ()), *(None,) * TRIES]:
        seed = int(random_bits(state)) >> 1
        progress("scattering cells", 0, 1)
        try:
            places, radii, held = graded_disk(grid, targets, seed, first, clear or CLEAR[-1])
            held = held if clear else 0
            if settings.max_overhang < 90:
                tau = stretch * float(np.tan(np.radians(settings.max_overhang)))
                places = _straightened(places, radii, held, inside, tau, seed, progress)
            _, reach = cell_reaches(places, *inside)
        except GeometryError as error:
            failure = error.message
            continue
        sites = places[reach > 0] / squeezed  # those that may have a cell in the box
        progress("certifying walls", 0, 1)
        foam = explicit_sites(sites, stretch, low, high)
        worst = steepest_in(foam, low, high)
        angle = tilt(worst, stretch)
        if settings.max_overhang >= 90 or angle <= settings.max_overhang:
            return replace(graded, sites=sites)
        x, y, z = sites[worst.sites[0]]
        failure = f"a wall near ({x:.4g}, {y:.4g}, {z:.4g}) mm leans {angle:.4g}°"
    raise SettingError(
        "stretch",
        f"no sites were found whose walls all lean at most {settings.max_overhang:g}° "
        f"({failure}); give a larger --stretch than {stretch:.4g}, or another --random-seed",
    )


def _straightened(
    places: Floats,
    radii: Floats,
    held: int,
    inside: Floats,
    tau: float,
    random_seed: int,
    progress: Progress,
) -> Floats:
    """Sites (n, 3) in the stretched space moved until no wall leans more than τ allows; the first
    `held` of them not if that can be.
    """
    stages = [stage for stage in STAGES if stage > tau] + [tau]
    first: dict[float, int] = {}

    def told(stage: float, bad: int) -> None:
        most = first.setdefault(stage, max(bad, 1))
        share = 1 - min(bad / most, 1.0)
        done = int(100 * (stages.index(stage) + share))
        progress("straightening walls", done, 100 * len(stages))

    return relax_inside(
        places,
        radii,
        inside,
        tau,
        held=held,
        effort=HELD_EFFORT if held else EFFORT,
        slack=SLACK,
        random_seed=random_seed,
        progress=told,
    )


def _compared(sizes: Sampled, stretch: float) -> Graded:
    """What is asked and what is made, without sites."""
    share = sizes.made / sizes.asked
    asked, made = ((float(some.min()), float(some.max())) for some in (sizes.asked, sizes.made))
    finer = float(np.mean(share < 1 - SAME))
    return Graded(np.empty((0, 3)), stretch, asked, made, float(share.min()), finer)


def _refuse_many(count: float) -> None:
    """Raise `SettingError` for more sites than `MOST`."""
    if count > MOST:
        larger = (count / MOST) ** (1 / 3)
        raise SettingError(
            "cell_size",
            f"about {count:,.0f} cells, more than {MOST:,}; sizes {larger:.3g} times as large "
            "would fit",
        )
