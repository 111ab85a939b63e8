"""Numbers with their nouns."""

from __future__ import annotations

import pytest

from v3dcad.words import counted, point_words


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


def test_a_point_tells_no_rounding_about_zero() -> None:
    assert point_words((-1.35e-15, 4.0, -103.87654321)) == "(0, 4, -103.877)"
    assert point_words((-4e-7, 4e-6, 0.0)) == "(0, 4e-06, 0)"
