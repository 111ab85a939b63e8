"""A bracket whose inside becomes walls under a closed skin: `python lightened_bracket.py`."""

from pathlib import Path

from build123d import export_step, import_step

from v3dcad.adapters.build123d import VoronoiFill

bracket = import_step(Path(__file__).parent.parent / "bracket.step")
light = VoronoiFill(bracket, thickness=1.2, skin=1.5, cell_size=10, layer_height=0.4)
light.label = "lightened bracket"
export_step(light, "lightened_bracket.step")
print(f"{light.volume / bracket.volume:.0%} of the bracket's volume")
