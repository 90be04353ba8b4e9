"""Places in UTF-16 units, and answers about texts that are edited at random."""

import random
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp.diagnostic import Span
from mars_asp.lsp.completion import completion, rule_completion
from mars_asp.lsp.hover import hover, hover_rules
from mars_asp.lsp.lenses import lenses
from mars_asp.lsp.places import Position, Range, Text, changed_lines
from mars_asp.lsp.references import definition, references
from mars_asp.lsp.rename import RefusedError, rename
from mars_asp.lsp.rules import Rules, predicate_definition
from mars_asp.lsp.symbols import module_symbols, predicate_symbols
from mars_asp.lsp.workspace import EditorWorkspace
from mars_asp.reading import overlay, overlay_bytes
from tests.support.documents import ROOT
from tests.support.processes import takes_at_most
from tests.support.wire import edited

EDITS = 400


@given(st.text(alphabet="aé😀\n\r\t\x0c\u2028\ufeff", max_size=30))
def test_a_place_is_found_again(written: str) -> None:
    text = Text("/t", written)
    for number, line in enumerate(text.lines, 1):
        for column in range(1, len(line) + 2):
            position = text.position(number, column)
            assert text.column(position) == (number, column)
            units = sum(1 + (ord(each) > 0xFFFF) for each in line[: column - 1])
            mark = number == 1 and written.startswith("\ufeff")
            assert position == Position(number - 1, units + mark)
            span = Span("/t", number, column, number, len(line) + 1)
            assert text.range(span) == (position, text.position(number, len(line) + 1))


@pytest.mark.parametrize(
    ("now", "places"),
    [
        ("a\nb\nc\nd\n", {0: 0, 1: 1, 2: 2, 3: 3}),
        ("new\na\nb\nc\nd\n", {0: 1, 1: 2, 2: 3, 3: 4}),
        ("a\r\nb\r\nnew\r\nnew\r\nc\r\nd\r\n", {0: 0, 1: 1, 2: 4, 3: 5}),
        ("a\nd\n", {0: 0, 3: 1}),
        ("a\nB\nc\nd\n", {0: 0, 2: 2, 3: 3}),
        ("A\nb\nc\nD\nnew", {}),
        ("", {}),
    ],
)
def test_lines_outside_of_an_edit_are_found_again(now: str, places: dict[int, int]) -> None:
    edit = changed_lines("a\nb\nc\nd\n", now)
    ranges = {line: Range(Position(line, 0), Position(line, 1)) for line in range(4)}
    found = {line: edit.moved(place) for line, place in ranges.items()}
    assert {line: place.start.line for line, place in found.items() if place} == places
    several = edit.moved(Range(Position(1, 0), Position(2, 1)))
    assert (several is None) == (places.get(2, 9) - places.get(1, 0) != 1)


def test_half_a_character_is_the_place_before_it() -> None:
    assert Text("/t", "a😀b").column(Position(0, 2)) == (1, 2)
    assert Text("/t", "a😀b").column(Position(0, 3)) == (1, 3)
    assert Text("/t", "a\nb").column(Position(9, 9)) == (2, 2)
    assert Text("/t", "a\nb").column(Position(0, 9)) == (1, 2)


def test_an_unsaved_text_is_read_by_every_path_to_its_file(tmp_path: Path) -> None:
    path = tmp_path / "a.mars"
    path.write_text("old")
    (tmp_path / "link.mars").symlink_to(path)
    with overlay({str(path): "new \ud800"}):
        assert overlay_bytes(tmp_path / "." / "link.mars") == b"new ?"
        assert overlay_bytes(tmp_path / "b.mars") is None
    assert overlay_bytes(path) is None


def test_answers_survive_edits_at_random() -> None:
    rng = random.Random(1)
    desk = EditorWorkspace()
    paths = [
        *sorted((ROOT / "tests/lsp/robot").iterdir()),
        ROOT / "examples/own-rules/rules/safety.lp",
    ]
    originals = {str(path): path.read_text(encoding="utf-8") for path in paths}
    desk.texts = dict(originals)
    for _ in range(EDITS):
        path = rng.choice(list(originals))
        text = desk.texts[path] = edited(desk.texts[path], rng)
        position = Position(rng.randrange(text.count("\n") + 3), rng.randrange(60))
        scene, rules = desk.context(path), desk.rule_text(path)
        if rules is not None:
            predicate_definition(rules, Rules(), desk.texts, position)
            hover_rules(rules, Rules(), position, [])
            rule_completion(rules, Rules(), position)
            assert all(
                each.place in [m.range for m in rules.mentions] for each in predicate_symbols(rules)
            )
        else:
            assert scene is not None
            hover(scene, position, {})
            completion(scene, position)
            definition(scene, position)
            references(scene, position)
            tuple(lenses(scene))
            try:
                rename(scene, position, "Other")
            except RefusedError as refused:
                assert str(refused)
            for each in module_symbols(scene.here):
                assert each.whole.start <= each.place.start <= each.place.end <= each.whole.end
        if rng.random() < 0.05:
            desk.texts[path] = originals[path]


#: Texts that a pattern which tries each beginning would read for minutes.
LONG = 20_000
ENDLESS = {
    "a.mars": (
        "x" * LONG + " ",
        '"' * LONG,
        "# " * LONG,
        "a," * LONG,
        "A.b" * LONG,
        "@modules " * LONG,
    ),
    "a.cpp": ("// @Sense " * LONG, "/" * LONG, "@" * LONG + " ", "// @module_name " + "x" * LONG),
    "a.lp": ("a( :- " * LONG, "%*" * LONG, "a(" * LONG, '"' * LONG, "-" * LONG, "a/" * LONG),
}


def test_no_text_takes_long_to_read() -> None:
    with takes_at_most(6):
        for name, texts in ENDLESS.items():
            for text in texts:
                desk = EditorWorkspace()
                desk.texts[name] = text
                position = Position(0, len(text))
                scene, rules = desk.context(name), desk.rule_text(name)
                if scene is not None:
                    completion(scene, position)
                    hover(scene, position, {})
                    definition(scene, position)
                if rules is not None:
                    rule_completion(rules, Rules(), position)
                    hover_rules(rules, Rules(), position, [])
