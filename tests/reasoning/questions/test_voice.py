"""Explanations contain nothing of the internal encoding."""

from pathlib import Path

import pytest

from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.support.campaigns import sample
from tests.support.documents import ROOT, run
from tests.support.every_output import helps, of_whole_files, printed, questions, wrong_in
from tests.support.fixtures import Patch
from tests.support.forbidden import FORBIDDEN, forbidden_in, wider_than

INPUTS = (*sorted(ROOT.glob("examples/*/config.mars")), *sorted((ROOT / "tests/voice").iterdir()))
#: Inputs by their names in the repository, and the options of `explain`.
EXPLAINED = sample(
    [
        (path.relative_to(ROOT), options)
        for path in INPUTS
        for options in ("--depth all", "--depth all --all")
    ],
    3,
)
#: Of this every verb is tried; `python -m tests.support.every_output` tries more files.
TRIED = ROOT / "examples" / "figure15-control-divergence" / "config.mars"
#: One of so many questions about what is not there is asked.
EACH = 200
#: An output that a pattern finds, and nothing but a pattern could.
SHOWN = (
    ("  tree_place(1,0)", "an atom or term of the encoding"),
    ("  `A` accepts _", "an open value"),
    ("  derivation 1 of 2 for X = 1", "a variable"),
    ("  no repeats(1,_)", "an absence by an atom"),
    ("  `{M}` has several controllers", "an open place"),
    ("  1 paths lead there", "a number that does not agree"),
    ("  cost: 2 node", "a number that does not agree"),
    ("  at least #inf", "a bound of the encoding"),
    ("  Verb(summary='report')", "a value of Python"),
    ("  `up` is no axis", "a word to be rid of"),
    ("  its mode number 0", "a number of a relationship or mode"),
    ("  at 25000 mHz", "a unit of the encoding"),
    ("  c.mars:8  // @module_start", "a heading as a reason"),
    ("  in mars_asp.cli", "a module of ours"),
    ("  /tmp/x/config.mars:3  A uses_data_from B", "a path of this machine"),
    ("      [data/divergence]", "a line that is only a reference"),
)


@pytest.mark.parametrize(("path", "options"), EXPLAINED, ids=str)
def test_traces_show_nothing_of_the_encoding(path: Path, options: str) -> None:
    output = run(f"mars-asp explain {path.name} {options}", ROOT / path.parent)
    assert "[" in output
    assert list(forbidden_in(output)) == []


def test_no_verb_shows_anything_of_the_encoding(monkeypatch: Patch) -> None:
    monkeypatch.chdir(TRIED.parent)
    for words, given in (*of_whole_files(TRIED.name), *questions(TRIED.name, EACH)):
        assert list(wrong_in(words, printed(words, given).text)) == [], words


def test_no_help_shows_anything_of_the_encoding() -> None:
    for words, given in helps():
        assert list(wrong_in(words, printed(words, given).text)) == [], words


def test_only_lines_that_could_be_broken_are_too_wide() -> None:
    line = "aa bb " * 5
    assert list(wider_than(20, f"{line}\n  c.mars:8  {line}\n{'a' * 30}\n")) == [
        f"30 columns: {line.strip()}"
    ]


@pytest.mark.parametrize(("text", "what"), SHOWN)
def test_each_pattern_finds_something(text: str, what: str) -> None:
    assert f"{what}: {text.strip()}" in list(forbidden_in(text))


def test_the_subject_of_an_answer_may_begin_with_a_small_letter() -> None:
    assert list(forbidden_in("No ignored_priority(n1): no line of `n1` states one")) == []
    assert list(forbidden_in("No ignored_priority(n1): no last(n1)"))


def test_every_pattern_is_tried() -> None:
    assert {what for _, what in SHOWN} == FORBIDDEN.keys()


def test_each_given_predicate_that_is_cited_has_words() -> None:
    declared = load_rulebook(stages=tuple(STAGES)).declarations.values()
    given = [each for each in declared if each.origin is not None and each.cited]
    assert len(given) > 60
    assert [each.written for each in given if not (each.says and each.unless)] == []
