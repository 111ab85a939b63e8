"""A structure as a build123d object, in algebra mode and inside `BuildPart`."""

from __future__ import annotations

from typing import Any

from v3dcad.adapters.form import shape_of
from v3dcad.errors import SettingError

try:
    from build123d import BasePartObject, Mode, Part
except ImportError as error:
    raise ImportError(
        f"build123d cannot be imported ({error}): run `pip install 'v3dcad[build123d]'`"
    ) from error


class VoronoiFill(BasePartObject):
    """A part filled with a Voronoi structure, as a compound that lies where the part lies.

    `form` says what becomes of it: "solid" (walls `thickness` mm thick, a closed `skin` if asked),
    "cells", "faces", "wires", "struts" (`diameter`, `cut`, `fuse`) or "beads" (`width`). All other
    settings are those of `v3dcad.fill`. Label and colour are the source's. Inside `BuildPart` it
    goes by `Locations` and `mode` as every object does; without a source it is an operation, as
    `fillet` is: it fills what is built so far where it is, and replaces it. The structure itself is
    kept as `structure`. Raises `V3dcadError`s.
    """

    def __init__(
        self,
        source: Any = None,
        form: str = "solid",
        *,
        mode: Mode | None = None,
        **settings: Any,
    ) -> None:
        self.in_place = source is None
        """whether it takes the place of what was built, wherever `Locations` are"""
        if mode is None:
            mode = Mode.REPLACE if self.in_place else Mode.ADD
        if self.in_place:
            source = self._built_so_far()
            if mode != Mode.PRIVATE and form in ("faces", "wires"):
                raise SettingError(
                    "form",
                    f"form {form!r}: a builder's part is made of solids, which {form} cannot take "
                    "the place of; give mode=Mode.PRIVATE, or a part outside the builder",
                )
        shape, self.structure = shape_of(source, form, settings)
        super().__init__(Part(obj=shape, label=getattr(source, "label", "")), mode=mode)
        self.color = getattr(source, "color", None)

    def _built_so_far(self) -> Part:
        builder = self._get_builder_context()
        built: Part | None = getattr(builder, "part_local", None)
        if built is None:
            raise SettingError(
                "source", "VoronoiFill needs a part: give one, or build one before it"
            )
        return built

    def _publish_to_context(self, object_scope: Any) -> None:
        if not self.in_place:
            super()._publish_to_context(object_scope)
        elif self.mode != Mode.PRIVATE:
            object_scope.publication_target._add_to_context(self, mode=self.mode)
