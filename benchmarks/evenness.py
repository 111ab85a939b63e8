"""How even cells stay on the way up a pole: `python -m benchmarks.evenness`.

A square pole with the default settings, its sites scattered as `v3dcad fill` does, with layers of a
hundredth of its width. For each height: how many cells there are, the largest one, and the one that
a random point lies in, in shares of the mean cell; the worst of three seeds.
"""

from __future__ import annotations

import numpy as np

from v3dcad import FillSettings, Section, fill_sections
from v3dcad.structure.sites import scatter_sites

SITES = (20, 50, 200, 1000)
HEIGHTS = (0, 1, 2, 3, 5, 8, 12)
"""in widths"""
WIDTH, LAYER = 20.0, 0.2


def rows(count: int, seed: int) -> list[tuple[int, float, float]]:
    """For each height the number of cells, and two shares of the mean one."""
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]) * WIDTH
    sites = scatter_sites(square[[0, 2]], count, seed)
    heights = np.arange(0, HEIGHTS[-1] * WIDTH + LAYER, LAYER)
    sections = [Section(z, (square,)) for z in heights]
    layers = fill_sections(sections, sites, FillSettings(layer_height=LAYER)).layers
    wanted = {round(height * WIDTH / LAYER) for height in HEIGHTS}
    found = []
    for layer in layers:
        if layer.index in wanted:
            areas = layer.diagram.areas(len(layer.state.sites))
            areas = areas[areas > 0]
            around = (areas**2).sum() / areas.sum()
            found.append((len(areas), areas.max() / areas.mean(), around / areas.mean()))
    return found


def main() -> None:
    print("sites |" + "".join(f"{height:>12} w" for height in HEIGHTS))
    for count in SITES:
        seeds = np.array([rows(count, seed) for seed in range(3)])
        cells, largest, around = seeds[:, :, 0].min(0), seeds[:, :, 1].max(0), seeds[:, :, 2].max(0)
        cols = zip(cells, largest, around, strict=True)
        print(f"{count:5} |" + "".join(f"{n:5.0f} {a:4.1f} {b:3.1f}" for n, a, b in cols))


if __name__ == "__main__":
    main()
