"""The file that is written: one file, the same bytes, a policy that names all that may run."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import v3dcad
from tests.view.page.conftest import HOSTILE
from v3dcad.view.page.document import HERE, document, framed
from v3dcad.view.page.packing import pack


class Read(HTMLParser):
    """The texts of a page's elements, and what they point to."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.texts: dict[str, str] = {}
        self.policy = ""
        self.links: list[str] = []
        self._within = ""
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if values.get("http-equiv") == "Content-Security-Policy":
            self.policy = values["content"] or ""
        self.links += [values[name] or "" for name in ("src", "href", "action") if name in values]
        if tag in ("title", "style", "script"):
            self._within = values.get("id") or values.get("type") or tag

    def handle_endtag(self, tag: str) -> None:
        self._within = ""

    def handle_data(self, data: str) -> None:
        if self._within:
            self.texts[self._within] = self.texts.get(self._within, "") + data


@pytest.fixture(scope="module")
def small() -> str:
    return document(HOSTILE, {"note": HOSTILE}, pack({"numbers": np.arange(3)}))


def named(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def test_names_are_text(small: str) -> None:
    read = Read(small)
    assert read.texts["title"] == HOSTILE
    told = json.loads(read.texts["told"])
    assert told["title"] == told["note"] == HOSTILE
    assert set(read.texts) == {"title", "style", "told", "data", "importmap", "module"}


def test_the_policy_names_what_runs_and_nothing_from_outside(small: str) -> None:
    read = Read(small)
    policy = dict(rule.split(" ", 1) for rule in read.policy.split("; "))
    assert policy == {
        "default-src": "'none'",
        "script-src": f"data: {named(read.texts['importmap'])} {named(read.texts['module'])}",
        "style-src": named(read.texts["style"]),
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    assert read.links == []
    live = Read(document("a", {}, pack({}), live=1))
    assert "connect-src 'self'" in live.policy


def test_modules_are_in_the_file_and_find_each_other(small: str) -> None:
    imports = json.loads(Read(small).texts["importmap"])["imports"]
    assert {f"{name}.js" for name in ("main", "stage", "cells")} <= set(imports)
    for address in imports.values():
        head, text = address.split(",")
        assert head == "data:text/javascript;base64"
        source = base64.b64decode(text).decode()
        for name in re.findall(r"""\bfrom\s*["']([^"']+)["']""", source):
            assert (
                name in imports or name == "three/addons/controls/OrbitControls.js"
            )  # in a comment


def test_the_licence_of_three_goes_with_it(small: str) -> None:
    licence = (HERE / "three/LICENSE").read_text(encoding="utf-8")
    assert "Permission is hereby granted" in licence
    assert licence in small


def test_the_same_structure_makes_the_same_bytes(structure: v3dcad.Structure) -> None:
    assert structure.page() == structure.page()


def test_a_frame_holds_the_page(small: str) -> None:
    class Frame(HTMLParser):
        values: dict[str, str | None]

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            self.values = dict(attrs)

    frame = Frame()
    frame.feed(framed(small))
    assert frame.values["srcdoc"] == small
    assert frame.values["sandbox"] == "allow-scripts"
