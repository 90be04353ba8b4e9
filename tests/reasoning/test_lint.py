"""Lint finds each planted fault in `tests/lint/faults`, and nothing in `tests/lint/correct`.

A comment `%~ CODE ...` names the faults of its line; each `^` after `%~` moves them one line up.
"""

import re
from collections import Counter
from pathlib import Path

import pytest

from mars_asp.asp.lint.catalogue import CODES, PAGES
from mars_asp.asp.lint.found import fixed
from mars_asp.reasoning.lint import lint
from tests.support.documents import ROOT

FAULTS = sorted((ROOT / "tests" / "lint" / "faults").glob("*.lp"))
CORRECT = sorted((ROOT / "tests" / "lint" / "correct").glob("*.lp"))
#: A pack with attributes, a kind of node and rules of several stages.
PACK = ROOT / "tests" / "lint" / "pack"
EXPECTED = re.compile(r"%~(\^*) (.*)$")


def expected(path: Path) -> Counter[tuple[int, str]]:
    found: Counter[tuple[int, str]] = Counter()
    for number, line in enumerate(path.read_text().split("\n"), 1):
        match = EXPECTED.search(line)
        for code in match[2].split() if match else ():
            found[number - len(match[1] if match else ""), code] += 1
    return found


@pytest.mark.parametrize("path", sorted(PACK.rglob("*.lp")), ids=lambda path: path.stem)
def test_exactly_the_planted_faults_of_a_pack_are_reported(path: Path) -> None:
    found = (each for each in lint([PACK], grounded=False).diagnostics)
    here = (each for each in found if Path(each.span.path) == path)
    assert Counter((each.span.line, each.code) for each in here) == expected(path)


def reported(path: Path) -> Counter[tuple[int, str]]:
    return Counter((each.span.line, each.code) for each in lint([path], grounded=False).diagnostics)


@pytest.mark.parametrize("path", [*FAULTS, *CORRECT], ids=lambda path: path.stem)
def test_exactly_the_planted_faults_are_reported(path: Path) -> None:
    assert reported(path) == expected(path)


def test_each_lint_has_three_faults_and_there_are_as_many_near_misses() -> None:
    planted = sum(map(expected, FAULTS), Counter())
    codes = Counter(code for _, code in planted.elements())
    # Names have a case of their own; only packs with a manifest introduce nodes.
    assert {
        code: codes[code]
        for code in CODES.keys() - {"rule-name", "rule-unplaced"}
        if codes[code] < 3
    } == {}
    assert len(list(planted.elements())) >= 40
    rules = [line for path in CORRECT for line in path.read_text().split("\n") if ":-" in line]
    assert len(rules) >= 40
    assert len({page.code for page in PAGES}) == len(PAGES)


def test_fixes_leave_nothing_to_fix(tmp_path: Path) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text(
        "% größer\n"
        'flat :- architecture(flatt), architecture("flat"). #show flat/0.\n'
        "sees(M) :- class(M, senser); module(camera), guard(M), described(M), guard(M). "
        "#show sees/1.\n"
        "late(R) :- hold(R, T), T > 2000,\n    T > 1000. #show late/1.\n"
    )
    found = lint([pack], grounded=False)
    text, count = fixed(pack.read_text(), str(pack), found.lints)
    assert text == (
        "% größer\n"
        "flat :- architecture(flat), architecture(flat). #show flat/0.\n"
        'sees(M) :- class(M, sensor); module("camera"), guard(M), described(M). '
        "#show sees/1.\n"
        "late(R) :- hold(R, T), T > 2000. #show late/1.\n"
    )
    assert count == 6
    pack.write_text(text)
    assert [each.code for each in lint([pack], grounded=False).diagnostics] == ["rule-redundant"]


def test_errors_and_lints_are_found_together(tmp_path: Path) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text(
        "stray_here(M) :- guard(M), missing_here(M).\n#show stray_here/1.\n"
        "guarded_here(M) :- guard(M), guard(M).\n"
    )
    found = lint([pack])
    assert [each.code for each in found.errors] == ["rule-unknown"]
    assert {each.diagnostic.code for each in found.lints} == {"rule-redundant", "rule-unused"}


def test_an_unknown_severity_is_one_error(tmp_path: Path) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text(
        "%! id: heavy\n%! because: `{M}` is heavy\n%! who: M\n"
        "consequence(heavy, warnin, M, 1) :- module(M).\n"
    )
    found = [each for each in reported(pack) if each[1] != "rule-metadata"]
    assert found == [(4, "rule-severity")]


def test_endless_rules_are_not_grounded(tmp_path: Path) -> None:
    pack = tmp_path / "pack.lp"
    pack.write_text("tower(1).\ntower(N + 1) :- tower(N).\n#show tower/1.\n")
    assert [each.code for each in lint([pack]).diagnostics] == ["rule-recursion"]
