"""Manifests of rule packs and where their rules lie: each fault is reported at its place.

Packs are folders in `tests/manifests`, each with the output of an analysis in `expected.txt`.
"""

from pathlib import Path

import pytest

from mars_asp.asp.cases.coverage import covered
from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.language import parse_text
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.cases.run import run_case, tried
from mars_asp.reasoning.facts.compile import configuration_facts
from mars_asp.reasoning.packs import MANIFEST, find_packs
from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.refusals import refusals

CASES = sorted(each.parent for each in (ROOT / "tests/manifests").glob("*/expected.txt"))
ROBOT = "tests/packs/robot.mars"
NODE = """
[[node]]
kind = "{kind}"
name = "{name}"
carries = "data"
inputs = "one"
outputs = "one"
"""


@pytest.mark.parametrize("folder", CASES, ids=lambda folder: folder.name)
def test_each_mistake_has_its_message(
    folder: Path, update_golden: bool, capsys: Captured, monkeypatch: Patch
) -> None:
    monkeypatch.chdir(ROOT)
    packs = sorted(folder.glob("with-*")) or [folder]
    given = [word for pack in packs for word in ("--rules", str(pack.relative_to(ROOT)))]
    assert run_here(["analyse", ROBOT, *given]) == 2
    printed, output = capsys.readouterr()
    assert not printed
    expected = folder / "expected.txt"
    if update_golden:
        expected.write_text(output, encoding="utf-8")
    assert output == expected.read_text(encoding="utf-8")


def test_every_stage_reports_the_same_errors() -> None:
    for folder in CASES:
        packs = sorted(folder.glob("with-*")) or [folder]
        entries = []
        for stages in ((), ("resolve", "verify"), STAGES):
            entries.append(refusals(load_rulebook, packs, stages))
        assert entries[0] == entries[1] == entries[2]


@pytest.mark.parametrize(
    ("there", "bound", "is_right"),
    [
        ("1.2", ">= 1.2", True),
        ("1.2", ">= 1.2.0", True),
        ("1.2", ">= 1.10", False),
        ("1.10", ">= 1.2", True),
        ("1.2", "== 1.2.0", True),
        ("1.2", "== 1.3", False),
        ("1.2", "< 2", True),
        ("2", "< 2", False),
        ("0.3", "", True),
    ],
)
def test_versions_are_compared_as_numbers(
    there: str, bound: str, is_right: bool, tmp_path: Path
) -> None:
    for name, more in (("base", ""), ("user", f'needs = ["base {bound}"]')):
        (tmp_path / name).mkdir()
        version = there if name == "base" else "1"
        text = f'name = "{name}"\nversion = "{version}"\n{more}\n'
        (tmp_path / name / MANIFEST).write_text(text)
    problems: list[object] = []
    find_packs([tmp_path / "user", tmp_path / "base"], problems)  # type: ignore[arg-type]
    assert bool(problems) != is_right


def test_a_pack_is_read_once(tmp_path: Path) -> None:
    (tmp_path / MANIFEST).write_text('name = "one"\nversion = "1"\n')
    (tmp_path / "vocabulary.lp").write_text("one(1).")
    found = find_packs([tmp_path, tmp_path / ".", tmp_path], [])
    assert [len(pack.files) for pack in found] == [1]


def test_folders_of_one_name_are_apart(tmp_path: Path) -> None:
    packs = [tmp_path / each / "rules" for each in "abc"]
    for number, pack in enumerate(packs):
        pack.mkdir(parents=True)
        # Ours derives a predicate of this name for itself.
        (pack / f"f{number}.lp").write_text(f"contested(M, {number}) :- module(M).\n")
        (pack / "same.lp").write_text("%! id: same/one\n%! because: same\nsame(M) :- module(M).\n")
    rules = load_rulebook(packs).of_packs
    ids = [rule.id for rule in rules if rule.id.endswith("same/one")]
    assert ids == ["same/one", "rules/same/one", "rules2/same/one"]
    names = {head.name for rule in rules for head in rule.heads}
    assert len(names) == 6
    assert "contested" not in names


def test_places_after_names_of_a_space_are_those_of_the_file(tmp_path: Path) -> None:
    # Ours derives a predicate of this name for itself; the string is not one.
    line = (
        """a(X) :- M != "it''s", contested(M, N), X = M + 1. """
        "b(X) :- contested(M, N), X = 1 / N. c(X) :- a(X). c(X) :- b(X)."
    )
    rules = tmp_path / "sums.lp"
    rules.write_text(f"contested(M, 0) :- module(M).\n{line}\n")
    configuration = parse_text("@configuration\n@modules A, B\n", "a.mars").configuration
    with pytest.raises(MarsError) as caught:
        analyse(configuration_facts(configuration), load_rulebook([rules]), configuration.span)
    expected = [(2, 1 + line.index("M + 1")), (2, 1 + line.index("1 / N"))]
    assert [each.span[1:3] for each in caught.value.diagnostics] == expected


def test_cases_give_facts_of_a_predicate_that_ours_is_called_like(tmp_path: Path) -> None:
    (tmp_path / "rules.lp").write_text(
        "consequence(high, note, M, N) :- contested(M, N).\ncontested(M, 1) :- guard(M).\n"
    )
    case = tmp_path / "cases" / "one.lp"
    case.parent.mkdir()
    case.write_text(
        'guard("A"). contested("B",2).\n#show contested/2.\n#show consequence/4.\n'
        '%= contested("A",1) contested("B",2)\n'
        '%+ consequence(high,note,"A",1) consequence(high,note,"B",2)\n'
    )
    rulebook = load_rulebook([tmp_path / "rules.lp"])
    assert run_case(case, rulebook).passed
    measured = covered(rulebook.of_packs, rulebook, [tried(case, rulebook)])
    assert not measured.silent
