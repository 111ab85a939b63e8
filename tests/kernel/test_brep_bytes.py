from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from parts import part_file

from v3dcad.errors import KernelError
from v3dcad.model import Brep, Placement
from v3dcad.parts import part_from
from v3dcad.structure.placement import on_bed

MADE = ["bracket.step", "cone.step", "islands.step", "pyramid.step"]
SHARED = ["nist_ctc_01_asme1_rd.stp", "nist_ftc_11_asme1_rb.stp"]


@pytest.mark.parametrize("name", MADE + SHARED)
def test_solids_come_back_and_stay_in_place(name: str, samples: Path) -> None:
    """The same bytes, bounds and volume; placed once, they are never moved again."""
    from v3dcad.kernel.brep_bytes import brep_of, part_in

    part = part_from(part_file(name) if name in SHARED else samples / name)
    part = part.placed(Placement(np.eye(3), np.array([3.7, -1e3 / 3, 0.1])))
    placed = part.placed(on_bed(part.bounds))
    assert placed.bounds.tobytes() == on_bed(part.bounds).to_bed(part.bounds).tobytes()
    assert not on_bed(placed.bounds).translation.any()
    brep = brep_of(placed)
    again = part_in(brep, "again")
    assert again.bounds.tobytes() == placed.bounds.tobytes()
    assert brep_of(again).data == brep.data
    assert again.placed(on_bed(again.bounds)) is again
    assert again.contents() == placed.contents()


def test_the_bytes_do_not_tell_what_was_done_with_the_part(samples: Path) -> None:
    from v3dcad.kernel.brep_bytes import brep_of

    part, other = part_from(samples / "bracket.step"), part_from(samples / "bracket.step")
    other.mesh()
    other.sections(np.array([0.0, 5.0]))
    assert brep_of(part).data == brep_of(other).data


def test_bytes_that_are_no_solid_are_refused(samples: Path) -> None:
    from v3dcad.kernel.brep_bytes import brep_of, part_in

    part = part_from(samples / "cone.step")
    good = brep_of(part)
    for bad in (b"", b"\nOpen CASCADE Topology V4", good.data[:300], good.data[:-40]):
        with pytest.raises(KernelError, match=r"broken: (OCCT cannot read|contains no solid)"):
            part_in(Brep(bad, good.bounds), "broken")
    with pytest.raises(KernelError, match="does not lie within the bounds"):
        part_in(replace(good, bounds=good.bounds * 2), "broken")
    with pytest.raises(KernelError, match="mesh: is not a B-rep"):
        brep_of(part_from(part.mesh()))
