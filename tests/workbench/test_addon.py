"""The add-on as files: what the index asks for, translations, pins; needs no FreeCAD."""

from __future__ import annotations

import ast
import importlib.util
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from workbench.conftest import ADDON, ROOT

TOOLS = ROOT / "freecad_workbench" / "tools"
AWAY = ("https://example.org/voronoi-3d", "main")


def tool(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, TOOLS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", sorted(ADDON.rglob("*.py")), ids=lambda path: path.name)
def test_v3dcad_is_never_imported_in_freecads_process(path: Path) -> None:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom) and not node.level:
            names = [node.module or ""]
        assert not [name for name in names if name.split(".")[0] == "v3dcad"]


def test_the_zip_keeps_the_rules_and_is_the_same_each_time(tmp_path: Path) -> None:
    package = tool("package")
    found = package.files(*AWAY)
    assert package.broken_rules(found) == []
    for name in ("a.zip", "b.zip"):
        package.write(found, tmp_path / name)
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("<version>0.1.0", "<version>one", "<version>"),
        ('file="LICENSE"', 'file="COPYING"', "licence"),
        ("VoronoiWorkbench", "Other", "no class Other"),
        ("<icon>freecad_workbench/", "<icon>", "icon"),
        ('type="repository"', 'type="website"', "repository"),
        ("</package>", "", "package.xml"),
    ],
)
def test_a_broken_rule_is_found(old: str, new: str, said: str) -> None:
    package = tool("package")
    found = package.files(*AWAY)
    text = found["package.xml"].decode()
    assert old in text
    wrong = package.broken_rules({**found, "package.xml": text.replace(old, new).encode()})
    assert any(said in line for line in wrong), wrong


def test_code_that_reviewers_refuse_is_found() -> None:
    package = tool("package")
    bad = {"freecad_workbench/a.py": b"import v3dcad\nfrom PySide2 import QtCore\n", "x.pyc": b""}
    wrong = "\n".join(package.broken_rules({**package.files(*AWAY), **bad}))
    for words in ("imports v3dcad", "imports Qt", "no SPDX head", "is compiled", "at the top"):
        assert words in wrong


def test_every_text_is_translated() -> None:
    checked = subprocess.run(
        [sys.executable, str(TOOLS / "translations.py"), "--check"],
        cwd=ROOT,
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert checked.returncode == 0, checked.stderr


def test_translations_keep_placeholders() -> None:
    translations = tool("translations")
    for language in translations.LANGUAGES:
        path = translations.FOLDER / f"v3dcad_{language}.ts"
        assert path.with_suffix(".qm").stat().st_size > 10_000
        for source, translation in translations.known(path).items():
            places = [set(text.split("{")[1:]) for text in (source, translation)]
            names = [{place.split("}")[0] for place in one} for one in places]
            assert names[0] == names[1], source


def test_pins_fit_what_v3dcad_needs() -> None:
    lines = (ADDON / "resources" / "pins.txt").read_text(encoding="utf-8").splitlines()
    pins = {name: version for name, _, version in (line.partition("==") for line in lines)}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = project["dependencies"] + project["optional-dependencies"]["occt"]
    for one in map(Requirement, needed):
        assert one.specifier.contains(pins[canonicalize_name(one.name)]), one


def test_the_add_on_says_v3dcads_version() -> None:
    from v3dcad.version import VERSION

    assert f"<version>{VERSION}</version>" in (ROOT / "package.xml").read_text(encoding="utf-8")
