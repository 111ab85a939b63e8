# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The add-on's texts and their translations.

python freecad_workbench/tools/translations.py           collect the texts, make .qm
python freecad_workbench/tools/translations.py --check   exit 1 where a text has no translation

Qt's `lrelease` makes the .qm files (Debian: qttools5-dev-tools). Translations are written into the
.ts files, by hand or with Qt Linguist; what is there is kept.
"""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

from v3dcad.settings import ExportSettings, FillSettings, PrintSettings, declared

ADDON = Path(__file__).resolve().parents[1] / "freecad" / "v3dcad_wb"
FOLDER = ADDON / "resources" / "translations"
LANGUAGES = ("tr",)
CONTEXT = "v3dcad"
CALLS = {"tr": (0,), "Command": (0, 1), "Group": (0,)}
"""Calls whose arguments at these places are shown to users."""
TABLES = {"TARGETS", "RESULTS", "hidden", "BREP_FORMS", "PROPERTIES", "WAYS"}
"""Tables whose texts are shown."""
PHASES = (
    "printing", "pausing", "paused", "resuming", "cancelling", "finishing", "ended", "finished",
    "cancelled", "printer halted", "connection lost", "no answer", "file changed", "given",
)  # fmt: skip
"""Words of v3dcad that are shown."""


def texts() -> list[str]:
    """Every text that is shown, each once, in order."""
    found: dict[str, None] = {}
    for path in sorted(ADDON.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            found |= dict.fromkeys(_in_call(node) + _in_table(node))
    for name in (*_names(FillSettings), "thickness", "skin", "diameter"):
        found[name.replace("_", " ").capitalize()] = None
    for name in _names(FillSettings):
        known = declared(FillSettings, name)
        found |= dict.fromkeys((known.help, *known.words, *known.choices))
    for name in ("step_as", "threemf_as", "stl_as"):
        found |= dict.fromkeys(declared(ExportSettings, name).choices)
    for name in _names(PrintSettings):
        found[name.replace("_", " ").capitalize()] = None
    return [text for text in [*found, *PHASES] if text]


def _names(cls: type) -> tuple[str, ...]:
    return tuple(cls.__dataclass_fields__)  # type: ignore[attr-defined]


def _in_call(node: ast.AST) -> list[str]:
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Name):
        return []
    places = CALLS.get(node.func.id, ())
    return [
        constant
        for place in places
        if place < len(node.args)
        for constant in _constants(node.args[place])
        if _is_text(constant)
    ]


def _constants(node: ast.AST) -> list[object]:
    """The constants of an expression, but for keys of what is looked up and pieces of f-strings."""
    if isinstance(node, (ast.Subscript, ast.JoinedStr)):
        return []
    if isinstance(node, ast.Constant):
        return [node.value]
    return [one for child in ast.iter_child_nodes(node) for one in _constants(child)]


def _in_table(node: ast.AST) -> list[str]:
    if not isinstance(node, ast.Assign) or not isinstance(node.targets[0], ast.Name):
        return []
    if node.targets[0].id not in TABLES:
        return []
    words = [one for one in ast.walk(node.value) if isinstance(one, ast.Constant)]
    return [
        one.value
        for one in words
        if _is_text(one.value) and (one.value.islower() or one.value.endswith("."))
    ]


def _is_text(value: object) -> bool:
    return isinstance(value, str) and any(letter.isalpha() for letter in value)


def known(path: Path) -> dict[str, str]:
    """The translations of a .ts file."""
    if not path.exists():
        return {}
    messages = ElementTree.parse(path).getroot().iter("message")
    return {one.findtext("source", ""): one.findtext("translation", "") for one in messages}


def write(path: Path, language: str, translated: dict[str, str]) -> None:
    """Write a .ts file."""
    root = ElementTree.Element("TS", version="2.1", language=language, sourcelanguage="en")
    context = ElementTree.SubElement(root, "context")
    ElementTree.SubElement(context, "name").text = CONTEXT
    for source, translation in translated.items():
        message = ElementTree.SubElement(context, "message")
        ElementTree.SubElement(message, "source").text = source
        element = ElementTree.SubElement(message, "translation")
        if translation:
            element.text = translation
        else:
            element.set("type", "unfinished")
    ElementTree.indent(root)
    head = '<?xml version="1.0" encoding="utf-8"?>\n<!DOCTYPE TS>\n'
    body = ElementTree.tostring(root, encoding="unicode")
    path.write_text(head + body + "\n", encoding="utf-8")


def main() -> None:
    """Collect, or check."""
    missing = []
    for language in LANGUAGES:
        path = FOLDER / f"v3dcad_{language}.ts"
        before = known(path)
        now = {text: before.get(text, "") for text in dict.fromkeys(texts())}
        missing += [f"{path.name}: {text}" for text, words in now.items() if not words]
        if "--check" in sys.argv:
            continue
        write(path, language, now)
        release = shutil.which("lrelease") or "/usr/lib/qt5/bin/lrelease"
        subprocess.run([release, "-silent", str(path)], check=True)
    if missing:
        sys.exit("without a translation:\n" + "\n".join(missing))


if __name__ == "__main__":
    main()
