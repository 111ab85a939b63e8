"""The layer loop (Algorithm 1 of the thesis): sections and sites to layers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from v3dcad.errors import GeometryError
from v3dcad.geometry.power_diagram import power_diagram
from v3dcad.model import Floats, Layer, Section, SiteState
from v3dcad.settings import FillSettings
from v3dcad.structure.growth import growing, spanning_tree


@dataclass(frozen=True, eq=False, slots=True)
class Layers(Sequence[Layer]):
    """The layers of a structure, computed as they are asked for."""

    sections: Sequence[Section]
    sites: Floats
    growth: Floats
    """(n,) mm² per mm of height"""

    def __len__(self) -> int:
        return len(self.sections)

    def __iter__(self) -> Iterator[Layer]:
        return (self[index] for index in range(len(self)))

    def __getitem__(self, index: int) -> Layer:  # type: ignore[override]
        """Layer `index`; negative ones count from the top."""
        index = range(len(self))[index]
        section = self.sections[index]
        state = SiteState(
            self.sites, self.growth * section.z, self.growth, np.zeros(len(self.sites))
        )
        diagram = power_diagram(self.sites, state.weights, section)
        areas = diagram.areas(len(self.sites))
        cells = int(np.count_nonzero(areas > 1e-12 * areas.max(initial=0.0)))
        return Layer(
            index=index,
            section=section,
            state=state,
            diagram=diagram,
            tree=spanning_tree(self.sites, diagram.neighbours),
            area_per_cell=float(areas.sum()) / max(cells, 1),
        )


def fill_sections(sections: Sequence[Section], sites: Floats, settings: FillSettings) -> Layers:
    """Fill sections (ascending in z) with the power diagrams of sites (n, 2), mm.

    On layer 0 all weights are 0; sites on odd levels of its spanning tree gain
    `settings.offset` mm² of weight a layer, linear in height. Raises `GeometryError` for
    a site that is not finite.
    """
    for site in np.nonzero(~np.isfinite(sites).all(axis=1))[0]:
        raise GeometryError("its coordinates are not finite numbers", site=int(site))
    still = Layers(sections, sites, np.zeros(len(sites)))
    grows = growing(len(sites), still[0].tree)
    return Layers(sections, sites, np.where(grows, settings.offset / settings.layer_height, 0.0))
