"""What one does with `.ont` files: check them, and write them in another form."""

from __future__ import annotations

from pathlib import Path

from v3dcad.pipeline import fill
from v3dcad.recipes import read_ont


def check(path: Path) -> dict[str, str]:
    """Make a file's structure again and compare check sums; what was compared, as lines to show.

    Raises `FormatError` where the file is damaged or its structure is another one.
    """
    recipe = read_ont(path)
    found = fill(recipe).checksum()
    if recipe.checksum is None:
        said = "the file has no check sum to compare with (the thesis's form has none)"
    else:
        said = "the structure is the one that was written"
    return {"result": said, **found.as_text()}


def convert(path: Path, to: Path, boundary: str, *, verify: bool = True) -> None:
    """Write a file again with its boundary in another form, "stl" or "exact".

    A B-rep "as stl" becomes its tessellation, and so another structure, with its own check sum.
    Raises as `check`, and `SettingError` for a form that is none.
    """
    fill(read_ont(path), verify=verify).write_ont(to, boundary)
