"""What explanations show people holds nothing of the encoding."""

from pathlib import Path

import pytest

from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.support.documents import ROOT, run
from tests.support.forbidden import FORBIDDEN, forbidden_in

INPUTS = (*sorted(ROOT.glob("examples/*/config.mars")), *sorted((ROOT / "tests/voice").iterdir()))
#: An output that a pattern finds, and nothing but a pattern could.
SHOWN = (
    ("  tree_place(1,0)", "an atom or term of the encoding"),
    ("  `A` accepts _", "an open value"),
    ("  derivation 1 of 2 for X = 1", "a variable"),
    ("  no repeats(1,_)", "an absence by an atom"),
    ("  its mode number 0", "a number of a relationship or mode"),
    ("  at 25000 mHz", "a unit of the encoding"),
    ("  c.mars:8  // @module_start", "a heading as a reason"),
    ("  in mars_asp.cli", "a module of ours"),
    ("  /tmp/x/config.mars:3  A uses_data_from B", "a path of this machine"),
    ("      [data/divergence]", "a line that is only a reference"),
)


@pytest.mark.parametrize("path", INPUTS, ids=lambda path: path.parent.name + "/" + path.stem)
@pytest.mark.parametrize("options", ["--depth all", "--depth all --all"])
def test_traces_show_nothing_of_the_encoding(path: Path, options: str) -> None:
    told = run(f"mars-asp explain {path.name} {options}", path.parent)
    assert "[" in told
    assert list(forbidden_in(told)) == []


@pytest.mark.parametrize(("text", "what"), SHOWN)
def test_each_pattern_finds_something(text: str, what: str) -> None:
    assert f"{what}: {text.strip()}" in list(forbidden_in(text))


def test_every_pattern_is_tried() -> None:
    assert {what for _, what in SHOWN} == FORBIDDEN.keys()


def test_each_given_predicate_that_is_cited_has_words() -> None:
    declared = load_rulebook(stages=tuple(STAGES)).declarations.values()
    given = [each for each in declared if each.origin is not None and each.cited]
    assert len(given) > 60
    assert [each.written for each in given if not (each.says and each.unless)] == []
