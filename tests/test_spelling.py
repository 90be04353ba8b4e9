"""Suggestions for misspelt words."""

import pytest

from mars_asp import spelling
from mars_asp.spelling import nearest, resemblances
from tests.support.fixtures import Patch


@pytest.mark.parametrize(
    ("word", "known", "expected"),
    [
        ("Camra", ["Camera", "Screen"], "Camera"),
        ("camera", ["Camera", "Camera1"], "Camera"),
        ("Mpa", ["Map", "Mapper"], "Map"),
        ("BA", ["AB"], None),
        ("Sonar", ["Camera"], None),
        ("Sonar", [], None),
    ],
)
def test_the_nearest_word(word: str, known: list[str], expected: str | None) -> None:
    assert nearest(word, known) == expected


def test_two_letters_in_the_wrong_order_are_a_misspelling_of_a_short_word() -> None:
    assert nearest("Mpa", ["Map"], 0.75) == "Map"
    assert nearest("pMa", ["Map"], 0.75) is None


def test_of_very_many_names_only_the_first_are_compared(monkeypatch: Patch) -> None:
    names, known = ["Camra", "Sonr", "Odometri"], ["Camera", "Sonar", "Odometry"]
    assert dict(resemblances(names, known, 0.75)) == dict(zip(names, known, strict=True))
    monkeypatch.setattr(spelling, "_MOST_COMPARED", 6)
    assert dict(resemblances(names, known, 0.75)) == {"Camra": "Camera", "Sonr": "Sonar"}
    assert list(resemblances(names, [], 0.75)) == []
