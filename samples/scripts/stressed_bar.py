"""A bar whose cells are fine where bending loads it: `python stressed_bar.py`.

../cantilever.frd is CalculiX's result of the same bar, held at one end and pressed down at the
other; ../cantilever.py computed it. The result of FreeCAD's FEM workbench is such a file.
"""

from pathlib import Path

from build123d import Align, Box

import v3dcad

result = Path(__file__).parent.parent / "cantilever.frd"
bar = Box(80, 16, 16, align=(Align.MIN, Align.CENTER, Align.MIN))
size = f"ramp(stress({str(result)!r}), 1, 8, 8, 4)"  # MPa, mm
structure = v3dcad.fill(bar, cell_size=size, layer_height=0.4)
structure.write_step("stressed_bar.step", "faces")
low, high = structure.graded.made
print(f"cells of {low:.1f} to {high:.1f} mm")
