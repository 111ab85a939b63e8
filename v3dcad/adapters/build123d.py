"""A structure as a build123d object, in algebra mode and inside `BuildPart`."""

from __future__ import annotations

from typing import Any

from v3dcad.adapters.form import shape_of
from v3dcad.errors import SettingError

try:
    from build123d import BasePartObject, Mode, Part, Shape
except ImportError as error:
    raise ImportError(
        f"build123d cannot be imported ({error}): run `pip install 'v3dcad[build123d]'`"
    ) from error


class VoronoiFill(BasePartObject):
    """A part filled with a Voronoi structure, as a compound that lies where the part lies.

    `form` says what becomes of it: "solid" (walls `thickness` mm thick, a closed `skin` if asked),
    "cells", "faces", "wires", "struts" (`diameter`, `cut`, `fuse`) or "beads" (`width`). All other
    settings are those of `v3dcad.fill`. Label and colour are the source's. Inside `BuildPart` it
    goes by `Locations` and `mode` as every object does; without a source it fills what is built
    so far, and replaces it. The structure itself is kept as `structure`. Raises `V3dcadError`s.
    """

    def __init__(
        self,
        source: Shape[Any] | None = None,
        form: str = "solid",
        *,
        mode: Mode | None = None,
        **settings: Any,
    ) -> None:
        if mode is None:
            mode = Mode.REPLACE if source is None else Mode.ADD
        source = self._built_so_far() if source is None else source
        shape, self.structure = shape_of(source, form, settings)
        part = Part(obj=shape, label=source.label)
        super().__init__(part, mode=mode)
        self.color = source.color

    def _built_so_far(self) -> Part:
        builder = self._get_builder_context()
        if builder is None or builder.part is None:
            raise SettingError(
                "source", "VoronoiFill needs a part: give one, or build one before it"
            )
        built: Part = builder.part
        return built
