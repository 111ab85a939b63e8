"""`Workplane.voronoiFill` on the stack, in assemblies, on solids from sketches."""

from __future__ import annotations

import pytest
from hosts import cadquery_or_skip

cadquery = cadquery_or_skip()

import v3dcad.adapters.cadquery  # noqa: E402

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore:.* cells are wide. they close up"),
]

SETTINGS = {"cell_size": 8.0, "layer_height": 1.0}


def test_every_solid_on_the_stack_is_filled_where_it_lies() -> None:
    two = cadquery.Workplane().rarray(40, 1, 2, 1).box(20, 20, 20, combine=False)
    filled = two.voronoiFill(thickness=1, **SETTINGS)
    assert [value.BoundingBox().center.x for value in filled.vals()] == pytest.approx([-20, 20])
    assert all(0 < value.Volume() < 8000 for value in filled.vals())


def test_cells_of_a_sketched_solid_in_an_assembly() -> None:
    sketch = cadquery.Sketch().rect(30, 20).vertices().fillet(3)
    solid = cadquery.Workplane().placeSketch(sketch).extrude(15)
    cells = solid.voronoiFill("cells", **SETTINGS)
    assert cells.size() == len(v3dcad.fill(solid, **SETTINGS).cells()) > 9
    whole = solid.val().Volume()
    assert sum(cell.Volume() for cell in cells.vals()) == pytest.approx(whole, rel=1e-8)
    assembly = cadquery.Assembly().add(cells, name="cells")
    assert assembly.toCompound().Volume() == pytest.approx(whole, rel=1e-8)
