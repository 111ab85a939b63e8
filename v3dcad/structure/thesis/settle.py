"""The weights of inserted sites, brought down (Algorithm 7)."""

from __future__ import annotations

import math

import numpy as np

from v3dcad.model import Diagram, Section
from v3dcad.structure.sweep.one_layer import Engine
from v3dcad.structure.thesis.cells import corner_count, present
from v3dcad.structure.thesis.state import SHRINKS, State


def settle(
    state: State, section: Section, diagram_of: Engine, step: float
) -> tuple[State, Diagram]:
    """The state with settled weights, and its diagram.

    A cell that appears for the first time gets the smallest weight, in whole steps (mm²) down
    from its own, that keeps it; how many corners it then has is noted. One that is older and
    has more corners than that loses weight until it has not, and is tagged to shrink. With no
    step at all, nothing changes.
    """
    diagram = diagram_of(state.sites, state.weights, section)
    if step <= 0:
        return state, diagram
    for site in state.inserted().tolist():
        if not _has_cell(diagram, site, state):
            continue
        if not state.corners[site]:
            weight = least_weight(state, section, diagram_of, site, step)
            state = state.with_values(site, weights=weight)
            diagram = diagram_of(state.sites, state.weights, section)
            state = state.with_values(site, corners=corner_count(diagram, site))
        while corner_count(diagram, site) > state.corners[site]:
            weight = state.weights[site] - step
            state = state.with_values(site, weights=weight, tags=SHRINKS)
            diagram = diagram_of(state.sites, state.weights, section)
    return state, diagram


def _has_cell(diagram: Diagram, site: int, state: State) -> bool:
    return bool(present(diagram, len(state.sites))[site])


def least_weight(
    state: State, section: Section, diagram_of: Engine, site: int, step: float
) -> float:
    """The smallest of a site's weight − k · step, k = 0, 1, 2 …, that leaves it a cell.

    The thesis finds it by one diagram for each k. In a diagram without the site, how much
    nearer a point is to that diagram's cell than to the site is linear within each cell, so it
    is greatest at a vertex: the cell exists above one weight, which the vertices tell.
    """
    others = np.arange(len(state.sites)) != site
    sites, weights = state.sites[others], state.weights[others]
    diagram = diagram_of(sites, weights, section)
    owner = np.empty(len(diagram.vertices), dtype=np.int64)
    owner[diagram.edges] = diagram.edge_sites[:, 1:]
    power = ((diagram.vertices - sites[owner]) ** 2).sum(axis=1) - weights[owner]
    distance = ((diagram.vertices - state.sites[site]) ** 2).sum(axis=1)
    vanishing, start = float((distance - power).min()), float(state.weights[site])
    steps = max(math.ceil((start - vanishing) / step) - 1, 0)
    while steps and not _keeps(state, section, diagram_of, site, start - steps * step):
        steps -= 1  # a cell so small that rounding took its area
    return start - steps * step


def _keeps(state: State, section: Section, diagram_of: Engine, site: int, weight: float) -> bool:
    tried = state.with_values(site, weights=weight)
    return _has_cell(diagram_of(tried.sites, tried.weights, section), site, tried)
