"""The page as one file: markup, style, modules and data, put together."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from importlib.resources import files
from string import Template
from typing import Any

from v3dcad.view.page.packing import Packed

HERE = files("v3dcad.view.page")

LIBRARY = {
    "three": "three/three.module.min.js",
    "three.core.min.js": "three/three.core.min.js",
    "orbit": "three/OrbitControls.js",
}
"""Modules of three.js, by the name they are imported under."""

UNTRUSTED = "The structure is shown when this cell is run, or the notebook trusted."

RELATIVE = re.compile(r"""(\bfrom\s*|\bimport\s*)(["'])\./""")


def document(title: str, told: dict[str, Any], data: Packed, *, live: int = 0) -> str:
    """The HTML file. `told` is what the page says and how, as plain values for JSON.

    Modules lie in the file as they are, as `data:` addresses in an import map; where there is only
    one file there are no folders, so `./stage.js` becomes `stage.js`. The policy lets the page run
    these and its own style, and reach nothing: `live`, the number
    of a page that is served, lets it hear of later ones from where it came.
    """
    modules = {name: _source(path) for name, path in LIBRARY.items()}
    modules |= {name: _source(name) for name in _own_modules()}
    imports = _as_json({"imports": {name: _address(text) for name, text in modules.items()}})
    start = 'import "main.js";'
    style = _text("page.css")
    policy = {
        "default-src": "'none'",
        "script-src": f"data: {_hash(imports)} {_hash(start)}",
        "style-src": _hash(style),
        "base-uri": "'none'",
        "form-action": "'none'",
        **({"connect-src": "'self'"} if live else {}),
    }
    return Template(_text("page.html")).substitute(
        policy="; ".join(f"{name} {value}" for name, value in policy.items()),
        title=html.escape(title),
        licence=_text("three/LICENSE").replace("--", "- -"),
        style=style,
        imports=imports,
        told=_as_json({**told, "title": title, "table": data.table, "live": live}),
        data=data.text,
        start=start,
    )


def framed(page: str, height: int = 600) -> str:
    """A page as the HTML of a frame, for notebooks; it can reach nothing of what is around it.

    Where frames are taken out, as from a notebook that is not trusted, the words in it stay.
    """
    return (
        f'<iframe sandbox="allow-scripts" title="v3dcad" width="100%" height="{height}" '
        f'style="border: 0" srcdoc="{html.escape(page)}">{UNTRUSTED}</iframe>'
    )


def _own_modules() -> list[str]:
    return sorted(file.name for file in HERE.iterdir() if file.name.endswith(".js"))


def _text(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def _source(path: str) -> str:
    return RELATIVE.sub(r"\1\2", _text(path))


def _address(source: str) -> str:
    return f"data:text/javascript;base64,{base64.b64encode(source.encode()).decode()}"


def _hash(content: str) -> str:
    """How a policy names a script or style: the SHA-256 of its text."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()}'"


def _as_json(content: Any) -> str:
    """JSON that cannot end the element it lies in, whatever names it holds."""
    return json.dumps(content, separators=(",", ":")).replace("<", "\\u003c")
