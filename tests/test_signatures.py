"""What Python shows of functions that take settings, and of what they give back."""

from __future__ import annotations

import inspect
import pydoc
from pathlib import Path

import v3dcad
from v3dcad.settings import FillSettings, SectionSettings, declared
from v3dcad.signatures import takes_settings


def test_fill_shows_every_setting_with_its_default() -> None:
    parameters = inspect.signature(v3dcad.fill).parameters
    for name, field in FillSettings.__dataclass_fields__.items():
        assert parameters[name].kind is inspect.Parameter.KEYWORD_ONLY
        assert parameters[name].default == (None if name == "sites" else field.default)
    assert all(one.kind is not inspect.Parameter.VAR_KEYWORD for one in parameters.values())


def test_help_says_what_each_setting_is_for() -> None:
    told = pydoc.render_doc(v3dcad.fill, renderer=pydoc.plaintext)
    assert "layer_height (mm): Distance between two layers." in told
    assert "the least that max_overhang allows" in told
    for name in FillSettings.__dataclass_fields__:
        assert f"    {name}" in told
        assert declared(FillSettings, name).help.split(",")[0].split("--")[0] in told
    assert "--" not in told


def test_a_function_is_called_as_before() -> None:
    @takes_settings(SectionSettings)
    def named(part: str, **settings: object) -> tuple[str, object]:
        """Name a part."""
        return part, settings

    assert named("a", layer_height=2) == ("a", {"layer_height": 2})
    assert (named.__doc__ or "").startswith("Name a part.\n\nSettings (SectionSettings):\n")


def test_values_show_what_they_are_in_a_line(samples: Path) -> None:
    structure = v3dcad.fill(samples / "pyramid.stl", layer_height=5.0, cell_size=20.0)
    layer = structure.layers[2]
    cells, points = len(layer.diagram.sites()), sum(map(len, layer.section.rings))
    part = "'pyramid', 67 × 67 × 50 mm"
    for value, words in (
        (structure, f"<Structure of {part}: 10 layers, foam>"),
        (structure.layers, "<10 layers>"),
        (layer, f"<Layer 2 at z 12.5 mm: {cells} cells>"),
        (layer.section, f"<Section at z 12.5 mm: 1 ring, {points} points>"),
        (layer.diagram, f"<Diagram of {cells} cells: {len(layer.diagram.edges)} edges>"),
        (structure.part, f"<MeshPart {part}: 12 triangles>"),
        (structure.recipe(), "<Recipe of 'pyramid': foam, 10 layers>"),
        (v3dcad.section(samples / "pyramid.stl", layer_height=5.0), f"<10 sections of {part}>"),
        (v3dcad.part_from(samples / "cone.step"), "<SolidPart 'cone', 40 × 40 × 30 mm>"),
    ):
        assert repr(value) == words
