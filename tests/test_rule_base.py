"""`mars-asp rules` on the rules of every stage."""

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from mars_asp.asp.rules.metadata import file_name
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import defined
from mars_asp.cli import run_here
from mars_asp.cli.rules import shown, shown_json
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.launch_trees import launch_rules
from mars_asp.reasoning.packs import FOLDERS
from mars_asp.reasoning.questions.account import STAGE
from mars_asp.reasoning.rules import BASE, STAGES, load_rulebook, seal
from tests.support.campaigns import sample
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.refusals import refusals

#: The id after the sentence of a rule, in a trace or in the list of a repair; not a link.
CITED = re.compile(r"\[((?:[\w-]+/)+[\w-]+|(?:[\w-]+/)*[\w-]+:\d+(?::\d+)?)\](?!\()")


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return load_rulebook([ROOT / "examples" / "own-rules" / "rules"], STAGES)


def cited() -> Iterator[tuple[str, str]]:
    """Yield each id that a golden trace, an expected output or a document cites, with its file."""
    paths = [*ROOT.glob("tests/traces/**/*.txt"), *ROOT.glob("tests/**/expected.txt")]
    paths += [ROOT / "README.md", *ROOT.glob("docs/*/*.md"), *ROOT.glob("examples/**/README.md")]
    # Its pack is made on the way.
    paths.remove(ROOT / "docs/tutorial/packs.md")
    for path in paths:
        # The engine's programs have rules of their own.
        if path.parent.name != "engine":
            for found in CITED.finditer(path.read_text(encoding="utf-8")):
                yield found[1], str(path.relative_to(ROOT))


def test_whatever_a_trace_cites_can_be_shown(rulebook: Rulebook) -> None:
    found = dict(cited())
    # Sentences of accounts are printed without the id of their rule.
    speaking = (rule for rule in rulebook.built_in.rules if rule.stage != STAGE)
    # A constraint derives nothing that a trace could end in.
    assert {rule.id for rule in speaking if rule.because and rule.heads} <= found.keys()
    packs = sorted(path.parent for path in ROOT.glob("examples/packs/*/pack.toml"))
    pages = [ROOT / "examples" / "own-rules" / "rules", ROOT / "docs" / "how-to" / "attributes"]
    every = load_rulebook([*pages, *packs], STAGES)
    for name, path in found.items():
        assert shown_json(every, name)["id"] == name, path
    for name in sample(sorted(found), 12):
        assert shown(every, name).startswith(f"## {name}\n"), found[name]


@pytest.mark.parametrize("speaks", [True, False])
@pytest.mark.parametrize("stage", ["base", *STAGES])
def test_a_rule_of_any_stage_is_shown(
    stage: str, speaks: bool, rulebook: Rulebook, capsys: Captured
) -> None:
    rules = [r for r in rulebook.rules if r.stage == stage and (r.because is not None) == speaks]
    assert bool(rules) == ((stage, speaks) != ("cost", True))
    for rule in rules[:1]:
        assert run_here(["rules", "show", rule.id, "--source"]) == 0
        output = capsys.readouterr().out
        assert f"## {rule.id}\n" in output
        assert f"{rule.span.path}:{rule.span.line}\n" in output
        assert rule.text in output
        assert run_here(["rules", "show", rule.id, "--format", "json"]) == 0
        assert json.loads(capsys.readouterr().out)["stage"] == stage


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("data/edge", "resolve/data/edge"),
        ("repair/names/spell", "repair/names/spelt"),
        ("verify/delivry", "verify/delivery"),
        ("DATA/DIVERGENCE", "data/divergence"),
    ],
)
def test_a_misspelt_id_is_reported_with_a_suggestion(
    name: str, meant: str, rulebook: Rulebook
) -> None:
    assert refusals(shown, rulebook, name)[0].help == f"did you mean `{meant}`?"


def test_rules_are_listed_by_stage(rulebook: Rulebook, capsys: Captured) -> None:
    assert run_here(["rules", "list"]) == 0
    whole = capsys.readouterr().out
    sections = {part.partition(":")[0]: part.split("\n") for part in whole.split("\n\n")}
    assert list(sections) == ["base", *STAGES]
    speaking = [rule for rule in rulebook.built_in.rules if rule.because is not None]
    for stage, (heading, *lines) in sections.items():
        assert heading == f"{stage}: {STAGES.get(stage, BASE)}"
        listed = [line.split()[0] for line in lines if line]
        assert listed == [rule.id for rule in speaking if rule.stage == stage]
    assert run_here(["rules", "list", "--stage", "can", "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [each["id"] for each in found] == [r.id for r in speaking if r.stage == "can"]
    assert {each["stage"] for each in found} == {"can"}


def test_predicates_that_packs_may_read_are_listed_by_stage(
    rulebook: Rulebook, capsys: Captured
) -> None:
    packs = ["--rules", str(ROOT / "examples" / "own-rules" / "rules")]
    assert run_here(["rules", "list", "--predicates", *packs]) == 0
    lines = [line.split()[:2] for line in capsys.readouterr().out.split("\n") if "/" in line[:30]]
    sealed = seal()
    found = {name: use for name, use in lines}
    for signature in rulebook.declarations:
        use = "extend" if signature.unsigned in sealed.extensible else "read"
        stage, _ = rulebook.outlines[rulebook.declarations[signature].span.path]
        is_open = signature.unsigned in sealed.reserved and stage in FOLDERS.values()
        assert found.get(str(signature)) == (use if is_open else None), signature
    assert found["link/3"] == "read" and "sees/1" not in found
    assert (
        run_here(["rules", "list", "--predicates", "--stage", "resolve", "--format", "json"]) == 0
    )
    listed = json.loads(capsys.readouterr().out)
    assert {each["stage"] for each in listed} == {"resolve"}
    assert "inserted/2" in {each["predicate"] for each in listed}
    assert run_here(["rules", "lint", "--predicates"]) == 2


def test_rules_of_a_pack_are_listed_with_those_of_the_base(
    capsys: Captured,
) -> None:
    packs = ["--rules", str(ROOT / "examples" / "own-rules" / "rules")]
    assert run_here(["rules", "list", "--stage", "base", *packs]) == 0
    assert capsys.readouterr().out.split("\n")[-2].startswith("safety/blind-controller ")


@pytest.mark.parametrize("action", ["show", "lint"])
def test_a_stage_without_effect_is_refused(action: str, capsys: Captured) -> None:
    assert run_here(["rules", action, "data/link", "--stage", "can"]) == 2
    assert f"--stage has no effect on `{action}`" in capsys.readouterr().err


def _stage(path: Path) -> str:
    """Return the stage of a rule file: its folder, else `base`."""
    return path.parent.name or "base"


def test_the_document_has_each_file_and_each_rule_that_speaks(
    rulebook: Rulebook, capsys: Captured
) -> None:
    assert run_here(["rules", "doc"]) == 0
    output = capsys.readouterr().out
    rules = [line[4:] for line in output.split("\n") if line.startswith("### ")]
    assert sorted(rules) == sorted(r.id for r in rulebook.built_in.rules if r.because is not None)
    files = [line[3:] for line in output.split("\n") if line.startswith("## ")]
    written = [path.relative_to(ROOT / "rules") for path in ROOT.glob("rules/**/*.lp")]
    assert sorted(files) == sorted(file_name(str(path), _stage(path)) for path in written)


def test_the_gate_permits_the_documented_uses_of_predicates_by_packs(rulebook: Rulebook) -> None:
    sealed = seal()
    for signature, declaration in rulebook.declarations.items():
        found: Any = shown_json(rulebook, str(signature))["predicates"]
        (result,) = found
        extended = signature.unsigned in sealed.extensible
        is_open = signature.unsigned in sealed.reserved
        assert result["packs"] == ("extend" if extended else "read" if is_open else None), signature
        written = shown(rulebook, str(signature)).split("\n")
        assert [line for line in written if line.startswith("packs: ")] == (
            [f"packs: {result['packs']}"] if is_open else []
        ), declaration.name


@pytest.mark.parametrize("name", ["specify/rates", "rules/specify/rates.lp"])
def test_a_file_of_rules_is_shown(name: str, rulebook: Rulebook) -> None:
    """Read from the file by hand."""
    found = shown_json(rulebook, name)
    rules = found.pop("rules")
    assert isinstance(rules, list)
    assert {"specify/rates/lowers", "specify/rates/makes"} <= set(rules)
    assert (found["path"], found["stage"]) == ("rules/specify/rates.lp", "specify")
    assert found["shows"] == ["lowers/3", "makes_for/4", "states_need/3"]
    assert found["decides"] == []
    result = shown(rulebook, name)
    assert "Shows: `lowers/3`, `makes_for/4`, `states_need/3`" in result
    assert "Decides" not in result
    assert "- `specify/rates/lowers`: " in result


def test_each_file_has_a_purpose_and_no_list_of_predicates(
    rulebook: Rulebook,
) -> None:
    known = {head for rule in rulebook.rules for head in rule.heads}
    known |= {each for _, text in rulebook.texts for each in defined(text)}
    for path, (_, outline) in rulebook.outlines.items():
        assert outline.title, path
        assert outline.purpose.endswith("."), path
        assert known.issuperset(outline.given), path
        assert known.issuperset(outline.shows), path
    for file in ROOT.glob("rules/**/*.lp"):
        header = file.read_text(encoding="utf-8").partition("\n\n")[0]
        assert not re.search(r"^% (Given|Derives|Decides|Shows):", header, re.MULTILINE), file


def test_the_door_to_the_rules_names_each_stage() -> None:
    text = (ROOT / "rules" / "README.md").read_text(encoding="utf-8")
    unwrapped = text.replace("\n  ", " ")
    rows = dict(re.findall(r"^- `rules/(\w+)/`: (.*) \(for .*\)$", unwrapped, re.MULTILINE))
    assert rows == dict(STAGES)
    assert list(rows) == list(STAGES)
    folders = {path.name for path in Path(ROOT / "rules").iterdir() if path.is_dir()}
    assert folders == set(STAGES)


def test_few_stages_read_predicates_of_another_stage(rulebook: Rulebook) -> None:
    derived = {(each, rule.stage) for rule in rulebook.rules for each in rule.heads}
    given = {
        (each, stage) for stage, outline in rulebook.outlines.values() for each in outline.given
    }
    of_base = {each for each, stage in derived if stage == "base"}
    read = {
        (stage, other)
        for each, stage in given
        for found, other in derived
        if found == each and other not in ("base", stage) and each not in of_base
    }
    # The facts of a specification that is judged are what `specify` derives of a resolution.
    judging = {("verify", "specify"), ("cost", "specify")}
    telling = {("account", each) for each in ("resolve", "specify", "can")}
    assert read == {("specify", "resolve"), ("cost", "verify")} | judging | telling


@pytest.mark.parametrize("words", [["list"], ["show", "e/x", "--source"], ["show", "e"], ["doc"]])
def test_text_of_a_pack_is_escaped_on_a_terminal(
    words: list[str], tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "e.lp"
    pack.write_text(
        "%# T\x1b[31m\n% Purpose: x\x1b[31m.\n\n%! id: e/x\n%! because: \x1b[31m\nq(\t1).\n"
    )
    assert run_here(["rules", *words, "--rules", str(pack)]) == 0
    output = capsys.readouterr().out
    assert "\x1b" not in output
    # As Markdown has it, where the words are part of a document.
    assert "\\x1b[31m" in output.replace("\\[", "[")
    assert ("q(\t1)." in output) == (words in (["show", "e/x", "--source"], ["doc"]))


LINTED = sorted((ROOT / "tests/lint").glob("*.lp"))


@pytest.mark.parametrize("path", LINTED, ids=lambda path: path.stem)
def test_lint_findings_are_not_part_of_an_analysis(
    path: Path, update_golden: bool, capsys: Captured, monkeypatch: Patch
) -> None:
    """The expected lint output of each pack in `tests/lint` is beside it."""
    monkeypatch.chdir(ROOT)
    pack = str(path.relative_to(ROOT))
    assert run_here(["rules", "lint", pack]) == 0
    output = capsys.readouterr().err
    if update_golden:
        path.with_suffix(".txt").write_text(output, encoding="utf-8")
    assert output == path.with_suffix(".txt").read_text(encoding="utf-8")
    robot = "tests/packs/robot.mars"
    status = run_here(["analyse", robot])
    printed = capsys.readouterr()
    assert run_here(["analyse", robot, "--rules", pack]) == status
    assert capsys.readouterr() == printed


@pytest.mark.parametrize(
    ("file", "name", "rules"),
    [
        ("absence/everywhere.lp", "no_instance_reason", load_rulebook),
        (
            "launch/absences.lp",
            "nowhere_in_trees",
            lambda: launch_rules(load_rulebook(stages=("launch",))),
        ),
    ],
)
def test_each_kind_has_a_reason_for_its_absence(
    file: str, name: str, rules: Callable[[], Rulebook]
) -> None:
    text = (ROOT / "rules" / file).read_text(encoding="utf-8")
    assert consequence_kinds(rules()) <= set(re.findall(rf"(?m)^{name}\((\w+)", text))
