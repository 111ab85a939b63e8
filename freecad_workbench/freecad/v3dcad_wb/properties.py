# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""Properties made from v3dcad's declared settings, so that new settings appear by themselves.

A setting that takes a number or a word ("auto") has two properties: `CellSize`, a length, and
`CellSizeFrom`, which says where it comes from. Changing the number says "given".
"""

from __future__ import annotations

from typing import Any

from .qt import tr

GROUP = "Voronoi fill"
RESULT = "Result"
GIVEN = "given"
WAYS = ("expression", "faces", "stress")
"""How a size may differ from place to place, see `grading.py`."""
LARGEST = 2**31 - 1
"""FreeCAD's integers have 32 bits."""

Declared = dict[str, Any]

RESULTS = (
    ("String", "Status", "Whether the result belongs to the settings; if not, why."),
    ("Integer", "Layers", "Number of layers."),
    (
        "Integer",
        "Edges",
        "Number of edges of the shape, or of lines where they are too many for a shape.",
    ),
    ("Integer", "Cells", "Number of cells."),
    ("Length", "CellSizeMade", "Size of the cells as made."),
    ("Angle", "SteepestWall", "Tilt of the steepest wall from the vertical."),
    ("Length", "WallLength", "Length of the walls in all layers."),
    ("Float", "MassMade", "Mass as printed, in grams."),
    ("String", "Certificate", "How every layer rests on the one below."),
    ("StringList", "Findings", "What should be known of how the part was read."),
    ("String", "Checksum", "The check sum by which the structure is known; .ont files carry it."),
)
"""Read-only properties: type, name, help."""


def property_name(setting: str) -> str:
    """`cell_size` → `CellSize`."""
    return "".join(word.capitalize() for word in setting.split("_"))


def from_name(declared: Declared) -> str | None:
    """The property that says where a setting comes from, where words may take its place."""
    return property_name(declared["name"]) + "From" if declared["words"] else None


def words_of(declared: Declared) -> tuple[str, ...]:
    """What may be said in place of a setting's number."""
    return (*declared["words"], *(WAYS if declared["fields"] else ()))


def of_fill(settings: list[Declared]) -> list[Declared]:
    """The settings of a fill, without those of printing."""
    return [one for one in settings if one["group"] == "fill"]


def add_settings(obj: Any, settings: list[Declared]) -> None:
    """Give an object the properties that it lacks, with their defaults."""
    for one in of_fill(settings):
        name = property_name(one["name"])
        if name not in obj.PropertiesList:
            obj.addProperty(_type_of(one), name, GROUP, help_of(one))
            _set_default(obj, name, one)
        extra = from_name(one)
        if extra and extra not in obj.PropertiesList:
            text = tr("Where {name} comes from.").format(name=name)
            obj.addProperty("App::PropertyEnumeration", extra, GROUP, text)
            setattr(obj, extra, [*words_of(one), GIVEN])
            setattr(obj, extra, one["default"] if one["default"] in one["words"] else GIVEN)
        elif extra and obj.getEnumerationsOfProperty(extra) != [*words_of(one), GIVEN]:
            chosen = getattr(obj, extra)
            setattr(obj, extra, [*words_of(one), GIVEN])
            setattr(obj, extra, chosen)
    show_settings(obj, settings)


def add_results(obj: Any) -> None:
    """Give an object the read-only properties that it lacks."""
    for kind, name, text in RESULTS:
        if name not in obj.PropertiesList:
            obj.addProperty(f"App::Property{kind}", name, RESULT, tr(text))
        obj.setEditorMode(name, 1)


def show_settings(obj: Any, settings: list[Declared]) -> None:
    """Show the settings of the chosen method alone."""
    for one in of_fill(settings):
        mode = 0 if one["method"] in (None, obj.Method) else 2
        for name in filter(None, (property_name(one["name"]), from_name(one))):
            obj.setEditorMode(name, mode)


def values_of(obj: Any, settings: list[Declared]) -> dict[str, Any]:
    """The settings that an object has, by v3dcad's names; those of other methods left out."""
    values: dict[str, Any] = {}
    for one in of_fill(settings):
        if one["method"] not in (None, obj.Method):
            continue
        extra = from_name(one)
        if extra and getattr(obj, extra) != GIVEN:
            values[one["name"]] = str(getattr(obj, extra))
            continue
        value = getattr(obj, property_name(one["name"]))
        values[one["name"]] = getattr(value, "Value", value)
    return values


def set_values(obj: Any, values: dict[str, Any], settings: list[Declared]) -> None:
    """Set properties from settings by v3dcad's names."""
    for one in of_fill(settings):
        if one["name"] not in values:
            continue
        value, name, extra = values[one["name"]], property_name(one["name"]), from_name(one)
        if extra and value in words_of(one):
            setattr(obj, extra, value)
            continue
        if one["fields"] and isinstance(value, str):
            setattr(obj, f"{name}Expression", value)
            setattr(obj, extra, WAYS[0])
            continue
        setattr(obj, name, value)
        if extra:
            setattr(obj, extra, GIVEN)


def show_resolved(obj: Any, resolved: dict[str, Any], settings: list[Declared]) -> None:
    """Show the numbers that "auto" stood for beside it."""
    for one in of_fill(settings):
        value = resolved.get(one["name"])
        extra = from_name(one)
        if extra and getattr(obj, extra) != GIVEN and isinstance(value, (int, float)):
            setattr(obj, property_name(one["name"]), value)


def help_of(declared: Declared) -> str:
    """What a setting is, in the user's language where it is translated, and its unit."""
    unit = f" [{declared['unit']}]" if declared["unit"] else ""
    return tr(declared["help"]) + unit


def label_of(setting: str) -> str:
    """`cell_size` → "Cell size", in the user's language where it is translated."""
    return tr(setting.replace("_", " ").capitalize())


def limits_of(declared: Declared) -> tuple[float, float]:
    """The least and the largest value that a field may take; v3dcad itself checks exactly."""
    least = max(
        (float(declared[key]) for key in ("least", "above") if declared[key] is not None),
        default=-LARGEST,
    )
    most = LARGEST if declared["most"] is None else min(float(declared["most"]), LARGEST)
    if declared.get("also"):
        least, most = min(least, *declared["also"]), max(most, *declared["also"])
    return least, most


def _type_of(declared: Declared) -> str:
    if declared["choices"]:
        return "App::PropertyEnumeration"
    if declared["type"] == "float":
        units = {"mm": "App::PropertyLength", "°": "App::PropertyAngle"}
        return units.get(declared["unit"], "App::PropertyFloat")
    kinds = {"int": "IntegerConstraint", "bool": "Bool", "str": "String"}
    return f"App::Property{kinds[declared['type']]}"


def _set_default(obj: Any, name: str, declared: Declared) -> None:
    default = declared["default"]
    if declared["choices"]:
        setattr(obj, name, list(declared["choices"]))
    elif declared["type"] == "int":
        least, most = limits_of(declared)
        default = (default, int(least), int(most), 1)
    if default not in declared["words"]:
        setattr(obj, name, default)
