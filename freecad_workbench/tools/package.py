# SPDX-License-Identifier: MIT
# SPDX-FileNotice: Part of the Voronoi 3D addon.
"""The add-on alone as a zip, as FreeCAD's add-on index takes it, checked against the index's rules.

python freecad_workbench/tools/package.py OUT.zip --repository URL [--branch NAME]

The rules are those of the Addon Academy (pages "Addon Manifest" and "Qualities" at
https://freecad.github.io/Addon-Academy/) and what reviewers of the index object to. The same files
give the same bytes. Exits with 1 and a line for each rule that is broken.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
import zipfile
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[2]
ADDON = PurePosixPath("freecad_workbench")
NAMESPACE = "https://wiki.freecad.org/Package_Metadata"
LEFT_OUT = {"tests", "tools", "__pycache__"}
REQUIRED = ("name", "version", "date", "description", "maintainer", "license", "icon", "content")
FORBIDDEN = {
    r"\bsys\.path\b": "changes sys.path",
    r"^\s*(from|import) PySide[26]": "imports Qt past FreeCAD's own wrapper",
    r"^\s*(from|import) v3dcad\b": "imports v3dcad, which runs in a process of its own",
    r"\bos\.system\b": "runs a shell",
}

Files = dict[str, bytes]


def files(repository: str, branch: str) -> Files:
    """What the zip holds, by path."""
    found: Files = {"package.xml": manifest(repository, branch)}
    found["LICENSE"] = (ROOT / "LICENSE").read_bytes()
    found["README.md"] = (ROOT / ADDON / "README.md").read_bytes()
    for path in sorted((ROOT / ADDON).rglob("*")):
        inside = PurePosixPath(path.relative_to(ROOT).as_posix())
        if path.is_file() and not LEFT_OUT & set(inside.parts) and path.name != "README.md":
            found[str(inside)] = path.read_bytes()
    return found


def manifest(repository: str, branch: str) -> bytes:
    """`package.xml` with the addresses of where it is published."""
    addresses = (
        f'  <url type="repository" branch="{branch}">{repository}</url>\n'
        f'  <url type="readme">{repository}/blob/{branch}/README.md</url>\n'
        f'  <url type="bugtracker">{repository}/issues</url>\n'
    )
    text = (ROOT / "package.xml").read_text(encoding="utf-8")
    return text.replace("  <icon>", addresses + "  <icon>", 1).encode()


def broken_rules(package: Files) -> list[str]:
    """A line for each rule that the package breaks."""
    try:
        root = ElementTree.fromstring(package["package.xml"])
    except ElementTree.ParseError as error:
        return [f"package.xml: {error}"]
    return [*_manifest_rules(root, package), *_content_rules(root, package), *_code_rules(package)]


def _text(node: ElementTree.Element, name: str) -> str:
    return (node.findtext(f"{{{NAMESPACE}}}{name}") or "").strip()


def _manifest_rules(root: ElementTree.Element, package: Files) -> list[str]:
    def tags(name: str) -> list[ElementTree.Element]:
        return root.findall(f"{{{NAMESPACE}}}{name}")

    wrong = [f"package.xml has no <{name}>" for name in REQUIRED if not tags(name)]
    if root.tag != f"{{{NAMESPACE}}}package" or root.get("format") != "1":
        wrong.append("package.xml is not <package> of format 1")
    if re.search(r'[/\\?%*:|"<>]', _text(root, "name")):
        wrong.append("<name> has a character that file names cannot have")
    if not re.fullmatch(r"\d+\.\d+\.\d+(-[\w.]+)?", _text(root, "version")):
        wrong.append("<version> is not three numbers")
    if not re.fullmatch(r"\d{4}-\d\d-\d\d", _text(root, "date")):
        wrong.append("<date> is not YYYY-MM-DD")
    wrong += ["<maintainer> has no email" for one in tags("maintainer") if not one.get("email")]
    for one in tags("license"):
        if one.get("file") not in package:
            wrong.append(f"the licence's text {one.get('file')} is not there")
    homes = [one for one in tags("url") if one.get("type") == "repository"]
    if len(homes) != 1 or not homes[0].get("branch"):
        wrong.append("no <url> of type repository with its branch")
    if not all((one.text or "").startswith("https://") for one in tags("url")):
        wrong.append("a <url> is not https")
    if len(tags("tag")) > 4:
        wrong.append("more than 4 <tag>")
    if _text(root, "icon") not in package:
        wrong.append(f"the icon {_text(root, 'icon')} is not there")
    return wrong


def _content_rules(root: ElementTree.Element, package: Files) -> list[str]:
    wrong = []
    for workbench in root.iter(f"{{{NAMESPACE}}}workbench"):
        folder = PurePosixPath(_text(workbench, "subdirectory"))
        if str(folder / _text(workbench, "icon")) not in package:
            wrong.append("the workbench's icon is not there")
        start = str(folder / "freecad" / "v3dcad_wb" / "init_gui.py")
        names = [one.name for one in ast.walk(ast.parse(package[start])) if _is_class(one)]
        if _text(workbench, "classname") not in names:
            wrong.append(f"{start} has no class {_text(workbench, 'classname')}")
    top = {path.split("/")[0] for path in package}
    if extra := top - {"package.xml", "LICENSE", "README.md", str(ADDON)}:
        wrong.append(f"at the top there is more than metadata: {', '.join(sorted(extra))}")
    return wrong


def _is_class(node: ast.AST) -> bool:
    return isinstance(node, ast.ClassDef)


def _code_rules(package: Files) -> list[str]:
    wrong = []
    for path, data in package.items():
        if path.endswith((".pyc", "_rc.py")):
            wrong.append(f"{path} is compiled")
        if path.endswith((".py", ".svg")) and b"SPDX-License-Identifier: MIT" not in data[:300]:
            wrong.append(f"{path} has no SPDX head")
        if path.endswith(".py"):
            for pattern, what in FORBIDDEN.items():
                if re.search(pattern, data.decode(), re.MULTILINE):
                    wrong.append(f"{path} {what}")
    return wrong


def write(package: Files, out: Path) -> None:
    """Write the zip; no time of day goes in."""
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in sorted(package.items()):
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data)


def main() -> None:
    """Check and write."""
    parser = argparse.ArgumentParser(description="The add-on alone as a zip.")
    parser.add_argument("out", type=Path)
    parser.add_argument("--repository", required=True, help="https address of its repository")
    parser.add_argument("--branch", default="main")
    asked = parser.parse_args()
    package = files(asked.repository, asked.branch)
    if wrong := broken_rules(package):
        sys.exit("\n".join(wrong))
    write(package, asked.out)
    print(f"{asked.out}: {len(package)} files, {asked.out.stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
