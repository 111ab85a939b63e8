"""Numbers with their nouns."""

from __future__ import annotations

import pytest

from v3dcad.words import counted


@pytest.mark.parametrize(
    ("number", "noun", "words"),
    [
        (0, "layer", "0 layers"),
        (1, "layer", "1 layer"),
        (2, "open edge", "2 open edges"),
        (1200, "cavity", "1,200 cavities"),
        (3, "boundary", "3 boundaries"),
        (3, "survey", "3 surveys"),
        (2, "vertex", "2 vertices"),
        (2, "mesh", "2 meshes"),
        (2, "stretch", "2 stretches"),
    ],
)
def test_a_number_tells_its_noun_as_english_has_it(number: int, noun: str, words: str) -> None:
    assert counted(number, noun) == words
