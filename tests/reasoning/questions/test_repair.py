"""The smallest edits that remove findings, each tried here in another way as well."""

import io
import json
import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings

from mars_asp.asp.signature import Signature
from mars_asp.cli import run_here
from mars_asp.language import print_configuration
from mars_asp.language.text_edits import LineEdit, apply_lines
from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.analysis import Analysis, analyse
from mars_asp.reasoning.project import Project, load_project, project_facts, revised
from mars_asp.reasoning.questions import repair
from mars_asp.reasoning.questions.repair import STAGES, Mend, Repair, repairs
from mars_asp.reasoning.rules import load_rulebook
from tests.support.applied_repairs import check_repairs
from tests.support.campaigns import examples, sample, seeds
from tests.support.documents import ROOT, run
from tests.support.fixtures import Captured, Patch
from tests.support.strategies import configurations, few

RULEBOOK = load_rulebook(stages=STAGES)
CASES = sorted((ROOT / "tests/repair").glob("*/"))


@pytest.mark.parametrize("folder", CASES, ids=lambda path: path.name)
def test_cases(folder: Path, update_golden: bool, monkeypatch: Patch) -> None:
    """The printed repairs; each of them, applied to the file, removes its finding."""
    calls: list[tuple[Project, tuple[Repair, ...]]] = []

    def noted(project: Project, *rest: Any, **options: Any) -> tuple[Repair, ...]:
        calls.append((project, repairs(project, *rest, **options)))
        return calls[-1][1]

    monkeypatch.chdir(ROOT)
    monkeypatch.setattr("mars_asp.cli.repair.repairs", noted)
    printed = run(f"mars-asp explain {folder.relative_to(ROOT)}/config.mars --repair")
    if update_golden:
        (folder / "expected.txt").write_text(printed)
    assert printed == (folder / "expected.txt").read_text()
    ((project, found),) = calls
    if folder in sample(CASES, 6):
        _remove_their_findings(project, found)


#: Repairs of one kind of finding, by the name of which the file is called.
OF_A_KIND = sorted(path for path in ROOT.glob("tests/repair/*/*.txt") if path.stem != "expected")


@pytest.mark.parametrize("path", OF_A_KIND, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_cases_of_a_kind(path: Path, update_golden: bool, monkeypatch: Patch) -> None:
    monkeypatch.chdir(ROOT)
    folder = path.parent.relative_to(ROOT)
    printed = run(f"mars-asp explain {folder}/config.mars --repair {path.stem}")
    if update_golden:
        path.write_text(printed)
    assert printed == path.read_text()


def test_every_rule_proposes_an_edit_that_a_case_shows() -> None:
    shown = "".join(path.read_text() for path in ROOT.glob("tests/repair/*/*.txt"))
    ids = [rule.id for rule in RULEBOOK.rules if Signature("edit", 5) in rule.heads]
    assert ids
    # Cases in `tests/rules/repair` show those of gates.
    missing = [name for name in ids if name not in shown and "repair/gates/" not in name]
    assert missing == []


def _analyse(project: Project) -> Analysis:
    return analyse(project_facts(project), RULEBOOK, project.configuration.span)


def _errors(analysis: Analysis) -> list[tuple[str, str]]:
    return sorted((c.kind, c.subject) for c in analysis.consequences if c.severity == "error")


def _remove_their_findings(project: Project, found: Iterable[Repair]) -> None:
    before = Counter((c.kind, c.subject) for c in _analyse(project).consequences)
    edited: dict[tuple[LineEdit, ...], Analysis] = {}
    for each in found:
        finding = (each.consequence.kind, each.consequence.subject)
        for mend in each.mends:
            if mend.lines not in edited:
                edited[mend.lines] = _analyse(_edited(project, mend))
            after = edited[mend.lines]
            assert [(c.kind, c.subject) for c in after.consequences].count(finding) < before[
                finding
            ]
            assert len(_errors(after)) == mend.errors


def _edited(project: Project, mend: Mend) -> Project:
    """Return a project after the edits of a fix."""
    texts = {project.configuration.path: project.text}
    for path in {line.path for line in mend.lines}:
        before = texts.get(path) or Path(path).read_text()
        texts[path] = apply_lines(before, [line for line in mend.lines if line.path == path])
    return revised(project, texts)


@pytest.mark.parametrize("seed", [2 + each for each in seeds(1, 12)])
def test_repairs_of_random_robots_hold_when_a_program_applies_them(
    seed: int, tmp_path: Path
) -> None:
    """More by hand: `python -m tests.support.applied_repairs --seeds 1-300`.

    Nine of these robots detect repairs with unannounced warnings, six those that lose lines.
    """
    assert check_repairs(seed, tmp_path)[2] == []


@pytest.mark.parametrize("seed", sample((1, 5, 8), 3))
def test_repairs_of_random_included_files_hold_for_all_instances(seed: int, tmp_path: Path) -> None:
    """More by hand: `python -m tests.support.applied_repairs --seeds 1-300 --instances 2`."""
    _, tried, wrong = check_repairs(seed, tmp_path, instances=2)
    assert tried
    assert wrong == []


@settings(few, max_examples=examples(3, 12))
@given(configurations)
def test_every_repair_holds_and_is_minimal(configuration: Configuration) -> None:
    project = load_project("robot.mars", text=print_configuration(configuration))
    before = _errors(_analyse(project))
    for found in repairs(project, RULEBOOK):
        finding = (found.consequence.kind, found.consequence.subject)
        assert len({len(mend.edits) for mend in found.mends}) <= 1
        for mend in found.mends:
            after = _analyse(_edited(project, mend))
            count = [(c.kind, c.subject) for c in after.consequences].count(finding)
            was = [(c.kind, c.subject) for c in _analyse(project).consequences].count(finding)
            assert count < was
            assert not set(_errors(after)) - set(before)
            assert (mend.spent is None) == bool(mend.errors)
            assert mend.others == _gone(project, after) - 1


def _gone(project: Project, after: Analysis) -> int:
    """Return the number of removed errors, or of removed warnings if there were no errors."""
    was, now = (
        [(c.severity, c.kind, c.subject) for c in analysis.consequences]
        for analysis in (_analyse(project), after)
    )
    worst = "error" if any(name[0] == "error" for name in was) else "warning"
    had = Counter(name[1:] for name in was if name[0] == worst)
    return sum((had - Counter(name[1:] for name in now)).values())


def _hub(clients: int) -> Project:
    """Return clients of one source, none of which accepts its representation."""
    names = [f"C{number}" for number in range(clients)]
    lines = ["@configuration", "@modules S, " + ", ".join(names)]
    lines += [f"{name} uses_data_from S" for name in names]
    lines += ["@module_start", "@module_name S", "@Sense NotifyWhenReady", "Raw grab();"]
    for name in names:
        lines += ["@module_end", "@module_start", f"@module_name {name}", "@DataIn"]
        lines += ["void show(Other x);"]
    text = "\n".join([*lines, "@module_end", ""])
    return load_project("hub.mars", text=text)


def test_an_edit_that_many_findings_share_is_tried_once_and_first(
    monkeypatch: Patch,
) -> None:
    monkeypatch.setattr(repair, "MOST_FACTS", 0)
    monkeypatch.setattr(repair, "LEAST_TRIED", 5)
    entries: list[tuple[int, int]] = []
    found = repairs(_hub(20), RULEBOOK, progress=lambda *state: entries.append(state))
    assert entries == [(done, 5) for done in range(5)]
    assert len(found) == 20
    for number, each in enumerate(found):
        assert str(each.mends[0].edits[0].term) == 'declare("Raw","Other")'
        assert each.mends[0].others == 19
        # Of the other edit of each finding, four more are tried.
        assert (each.tried, len(each.mends), each.complete) == (
            (2, 2, True) if number < 4 else (1, 1, False)
        )


def _undeclared(count: int) -> str:
    """Return a configuration of which as many modules are used and not named, a third misspelt."""
    known = [f"Client{number:03}" for number in range(0, count, 3)]
    lines = ["@configuration", "@modules S, " + ", ".join(known), *_uses("S", known)]
    names = [f"{'Cliemt' if not n % 3 else 'Other'}{n:03}" for n in range(count)]
    return "\n".join([*lines, *_uses("S", names), ""])


def _uses(source: str, clients: Iterable[str]) -> list[str]:
    return [f"{client} uses_data_from {source}" for client in clients]


def test_many_undeclared_names_are_all_mended_by_one_edit_and_a_bounded_number_of_tries() -> None:
    project = load_project("robot.mars", text=_undeclared(120))
    entries: list[tuple[int, int]] = []
    found = repairs(project, RULEBOOK, progress=lambda *state: entries.append(state))
    most = repair.MOST_FACTS // (len(project_facts(project)) + repair.FACTS_OF_A_TRY)
    assert len(entries) <= max(repair.LEAST_TRIED, most // repair.ONE_IN_FOR_FURTHER) < 120
    assert len(found) == 120
    whole = {mend.lines: mend for each in found for mend in each.mends if mend.others == 119}
    (all_named,) = whole.values()
    for each in found:
        assert all_named.lines in [mend.lines for mend in each.mends]
        assert each.mends[-1].lines == all_named.lines, "what changes less comes first"
    assert _errors(_analyse(_edited(project, all_named))) == []
    # Edits of single names have the same effects as with few names.
    alone = [mend for each in found for mend in each.mends if mend.lines != all_named.lines]
    assert alone
    for mend in alone:
        assert len(_errors(_analyse(_edited(project, mend)))) == mend.errors == 119


def test_where_each_edit_can_be_tried_all_names_are_not_named_at_once() -> None:
    project = load_project("robot.mars", text=_undeclared(9))
    for each in repairs(project, RULEBOOK):
        assert each.complete
        assert "name_all" not in [str(edit.term) for mend in each.mends for edit in mend.edits]


def test_findings_without_a_remaining_try_are_marked(monkeypatch: Patch, capsys: Captured) -> None:
    monkeypatch.setattr(repair, "MOST_FACTS", 0)
    monkeypatch.setattr(repair, "LEAST_TRIED", 1)
    path = str(ROOT / "tests/repair/roles/config.mars")
    assert run_here(["explain", path, "--repair"]) == 1
    assert "not tried beside so many others: ask for `class_mismatch(" in capsys.readouterr().out


def test_a_time_limit_ends_the_search_with_a_note(capsys: Captured) -> None:
    path = str(ROOT / "tests/repair/roles/config.mars")
    assert run_here(["explain", path, "--repair", "--time-limit", "0.001"]) == 3
    output = capsys.readouterr()
    assert output.out.count("no time was left: ask for `class_mismatch(") == 3
    assert "the time limit ended the search" in output.err
    assert run_here(["explain", path, "--repair", "--time-limit", "600"]) == 1
    assert all(not found.late for found in repairs(load_project(path), RULEBOOK, seconds=600))


def test_json(capsys: Captured) -> None:
    path = str(ROOT / "tests/repair/mode/config.mars")
    assert run_here(["explain", path, "--repair", "--format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)["repairs"]
    assert [repair["consequence"]["kind"] for repair in found] == ["service_infeasible"]
    first = found[0]["repairs"][0]
    assert [edit["rule"]["id"] for edit in first["edits"]] == ["repair/require/offered"]
    assert first["lines"][0]["new"] == "Screen uses_data_from Camera RequestWhenReady"
    assert first["cost"] == {"nodes": 0, "conversion": 0, "relationships": 1}


def test_a_subject_chooses_the_findings(capsys: Captured) -> None:
    path = str(ROOT / "tests/repair/roles/config.mars")
    for subject, count in (("Lamp", 1), ("class_mismatch", 3), ("class_mismatch(Notes)", 1)):
        run_here(["explain", path, subject, "--repair", "--format", "json"])
        assert len(json.loads(capsys.readouterr().out)["repairs"]) == count


def test_a_pack_may_propose_edits_for_its_own_findings(tmp_path: Path) -> None:
    pack = tmp_path / "lonely.lp"
    pack.write_text(
        "%! id: lonely/finding\n%! because: `{M}` stands on nothing\n"
        "consequence(lonely, error, M, ground) :- module(M), not is_mounted_on(_, M, _, _, _).\n"
        "%! id: lonely/edit\n%! because: do without `{M}`\n"
        "edit(lonely, M, ground, unname(M), 1) :- consequence(lonely, _, M, ground).\n"
        "%! id: lonely/nonsense\n%! because: polish `{M}`\n"
        "edit(lonely, M, ground, polish(M), 1) :- consequence(lonely, _, M, ground).\n"
    )
    project = load_project("c.mars", text="@configuration\n@modules Rock, Sand\n")
    book = load_rulebook([pack], STAGES)
    found = repairs(project, book, "lonely(Rock)")
    assert [str(edit.term) for mend in found[0].mends for edit in mend.edits] == ['unname("Rock")']


def test_a_finding_without_proposed_edits_is_reported_as_such(
    tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "lonely.lp"
    pack.write_text(
        "%! id: lonely/finding\n%! because: `{M}` stands on nothing\n"
        "consequence(lonely, error, M, ground) :- module(M), not is_mounted_on(_, M, _, _, _).\n"
    )
    path = str(ROOT / "tests/repair/clean/config.mars")
    assert run_here(["explain", path, "--repair", "--rules", str(pack)]) == 1
    assert "no rule proposes an edit for `lonely`; one of yours" in capsys.readouterr().out


def test_edits_of_standard_input_name_its_lines(monkeypatch: Patch, capsys: Captured) -> None:
    text = b"@configuration\r\n@modules Camera, Log // all\r\nLog uses_data_from Camra\r\n"
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text)))
    assert run_here(["explain", "-", "--repair", "--format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)["repairs"][0]["repairs"]
    assert found[0]["lines"] == [
        {
            "path": "<stdin>",
            "line": 3,
            "column": 20,
            "old": "Log uses_data_from Camra",
            "new": "Log uses_data_from Camera",
            "where": None,
        }
    ]


def test_conflicting_rules_of_packs_are_named(tmp_path: Path, capsys: Captured) -> None:
    pack = tmp_path / "three.lp"
    pack.write_text(
        "noisy(S) :- uses_data_from(_, _, S).\n"
        "quiet(S) :- module(S), not loud(S).\n"
        "other(X) :- module(X).\n"
        "#show other/1.\n"
        ":- noisy(S), quiet(S).\n"
        "#defined loud/1.\n"
    )
    path = str(ROOT / "examples/figure04-divergence/config.mars")
    for verb in ("analyse", "synthesise", "explain", "check"):
        form = ["--format", "full"] if verb == "check" else []
        assert run_here([verb, path, "--rules", str(pack), *form]) == 2
        output = "".join(capsys.readouterr())
        quoted = [re.search(rf"^ +{line} \|", output, re.MULTILINE) for line in (1, 2, 3, 4, 5)]
        assert list(map(bool, quoted)) == [True, True, False, False, True]
    pack.write_text("odd :- not odd.\n")
    assert run_here(["analyse", path, "--rules", str(pack)]) == 2
    assert "error: this rule excludes every answer" in " ".join(capsys.readouterr().err.split())
