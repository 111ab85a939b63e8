"""A bracket whose cells are fine around its screw holes: `python graded_bracket.py`."""

from pathlib import Path

from build123d import GeomType, export_step, import_step

import v3dcad
from v3dcad.adapters.build123d import VoronoiFill

bracket = import_step(Path(__file__).parent.parent / "bracket.step")
holes = [face for face in bracket.faces().filter_by(GeomType.CYLINDER) if face.radius < 4]
size = v3dcad.near_faces(holes, size=5, far=12, within=20)
light = VoronoiFill(bracket, "faces", cell_size=size, layer_height=0.4)
export_step(light, "graded_bracket.step")
low, high = light.structure.graded.made
print(f"cells of {low:.1f} mm at the holes, {high:.1f} mm far from them")
