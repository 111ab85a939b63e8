"""What is no material in a 3MF of PrusaSlicer, OrcaSlicer or Bambu Studio: modifiers, negatives.

The standard does not know them: slicers list them in files of their own beside the model.
"""

from __future__ import annotations

import zipfile
from typing import NamedTuple
from xml.etree import ElementTree

MATERIAL, NEGATIVE, MODIFIER = "material", "negative", "modifier"

ROLES = {
    "ModelPart": MATERIAL,
    "normal_part": MATERIAL,
    "NegativeVolume": NEGATIVE,
    "negative_part": NEGATIVE,
}
"""Any other kind (modifiers, support blockers and enforcers) is a `MODIFIER`."""

PRUSA = "Metadata/Slic3r_PE_model.config"
BAMBU = "Metadata/model_settings.config"


class Roles(NamedTuple):
    """Which parts of objects are what, where a slicer says so."""

    triangles: dict[str, list[tuple[int, int, str]]]
    """of an object: first and last triangle, and role"""
    components: dict[tuple[str, str], str]
    """the role of an object as a component of another, by both numbers"""


def read_roles(archive: zipfile.ZipFile) -> Roles:
    """The roles in a package; `ParseError`, `KeyError` or `ValueError` where they are damaged."""
    roles = Roles({}, {})
    names = set(archive.namelist())
    if PRUSA in names:
        for found in ElementTree.fromstring(archive.read(PRUSA)).iter("object"):
            for volume in found.iter("volume"):
                kinds = {row.get("key"): row.get("value") for row in volume.iter("metadata")}
                role = ROLES.get(kinds.get("volume_type") or "ModelPart", MODIFIER)
                first, last = int(volume.attrib["firstid"]), int(volume.attrib["lastid"])
                roles.triangles.setdefault(found.attrib["id"], []).append((first, last, role))
    if BAMBU in names:
        for found in ElementTree.fromstring(archive.read(BAMBU)).iter("object"):
            for part in found.iter("part"):
                role = ROLES.get(part.get("subtype", "normal_part"), MODIFIER)
                roles.components[found.attrib["id"], part.attrib["id"]] = role
    return roles
