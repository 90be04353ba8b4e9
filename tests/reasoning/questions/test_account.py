"""Accounts of consequences and nodes, and whether the cited lines are causes.

Each `.mars` file of `tests/accounts` has the output of `explain` beside it; together they use every
rule of `rules/account`.
"""

import argparse
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout, suppress
from dataclasses import replace
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.term_ids import atoms
from mars_asp.asp.trace.tree import Unexplained
from mars_asp.cli import run_here
from mars_asp.cli.inputs import load
from mars_asp.diagnostic import MarsError, Span
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.account import ACCOUNT, STAGE, Account, Cited, true_atoms
from mars_asp.reasoning.questions.capability import capability
from mars_asp.reasoning.questions.explain import Explanation, Topic, explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support import counterfactual
from tests.support.campaigns import sample
from tests.support.counterfactual import (
    KINDS,
    STAGES,
    malformed,
    topics,
    uncaused,
    uncited,
    uncounted,
)
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

CASES = sorted((ROOT / "tests" / "accounts").glob("*.mars"))
#: Cases with a cause to which no answer leads are left out: this list may only shrink.
COMPLETE = [path for path in CASES if path.stem not in ("inherited", "wrong_ends")]
#: Robots in foreign files, and the expected outputs beside them.
FOREIGN = {
    "twist_mux/ros2_tied.yaml": "a_list",
    "twist_mux/cmd_vel_mux_ros2.yaml": "a_first_sender",
    "rosgraph/rosdiscover_warehouse.yml": "a_topic",
    "ros2/courier": "a_workspace",
}
EXAMPLES = sorted((ROOT / "examples").glob("*/*.mars"))
#: A node of ROS with a topic, in a configuration that was saved.
GRAPH = """@configuration
@modules /base
// imported from ros2
@module_start
@module_name /base
@Sense NotifyWhenReady
@Output Pose
@Input none
void pose();
@module_end
"""
#: What is asked of `tests/questions/able.mars`; `questions.txt` has the answers.
ABLE = (
    "Rotn_Z of Arm",
    "Rotn_X of Eye while Rotn_X of Plate",
    'Rotn_Y of Eye while Rotn_Y of "the other eye"',
    "Trans_Z of Eye",
    "Rotn_Z of Plate",
    'Trans_Z of "the other eye"',
    "Grasp of Eye",
    "Trans_X of Dark",
    "Trans_X of Probe",
    "Trans_X of Probe while Trans_X of Rail",
)
#: One answer of so many has more than twelve lines at most.
FEW = 20


def show_all_paragraphs(monkeypatch: Patch) -> None:
    """Give consequences paragraphs of their own, those that nodes resolve with the same lines."""
    monkeypatch.setattr("mars_asp.cli.explain._covered_by_nodes", lambda topics: ())


@cache
def explained(path: Path) -> tuple[str, Sequence[Topic]]:
    """Return the output of `explain` about a case, and the topics that it shows."""
    found: list[Topic] = []

    def noted(*arguments: Any) -> Explanation:
        found.extend((result := explain(*arguments)).topics)
        return result

    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as output:
        patch.chdir(path.parent)
        show_all_paragraphs(patch)
        patch.setattr("mars_asp.cli.explain.explain", noted)
        run_here(["explain", path.name])
    return output.getvalue(), found


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_the_explanation_of_each_case_is_as_expected(path: Path, update_golden: bool) -> None:
    output, expected = explained(path)[0], path.with_suffix(".txt")
    if update_golden:
        expected.write_text(output, encoding="utf-8")
    assert output == expected.read_text(encoding="utf-8")


@pytest.mark.parametrize(("path", "name"), FOREIGN.items(), ids=FOREIGN)
def test_the_explanation_of_each_foreign_file_is_as_expected(
    path: str, name: str, capsys: Captured, monkeypatch: Patch, update_golden: bool
) -> None:
    monkeypatch.chdir(ROOT / "tests")
    show_all_paragraphs(monkeypatch)
    run_here(["explain", path, "--quiet"])
    output, expected = capsys.readouterr().out, ROOT / f"tests/accounts/{name}.txt"
    if update_golden:
        expected.write_text(output, encoding="utf-8")
    assert output == expected.read_text(encoding="utf-8")


#: The savings by sharing are stated for one arbiter only, because they need a separate search.
#: Robots whose packs bring nodes.
BROUGHT = {
    "two_effectors.mars": ["examples/packs/watchdog"],
    "after_controller.mars": ["tests/node_kinds/packs/filters"],
    "after_source.mars": ["tests/node_kinds/packs/filters"],
    "other_sources.mars": ["examples/packs/redundancy"],
    "listeners_alone.mars": ["tests/node_kinds/packs/ears"],
    "listeners_of_control.mars": ["tests/node_kinds/packs/ears"],
    "listeners_in_one_place.mars": ["tests/node_kinds/packs/ears"],
    "listeners_of_data.mars": ["tests/node_kinds/packs/ears"],
}
PRICES = {
    "shared.mars": "2 nodes; apart it would take 4 (2 arbiters; splitters for `Joy` and `Nav`).",
    "robots.mars": "These controllers take 5 nodes in all; apart it would take 6 (3 arbiters; "
    "splitters for `Nav`, `Joy` and `Stop`).",
    "even.mars": None,
}


def account_of(path: Path, name: str) -> Account:
    rulebook = load_rulebook(stages=STAGES)
    found = explain(Reasoner(load_project(str(path)), rulebook), name, traced=False).topics
    account = next(each.account for each in found if each.name == name)
    assert account is not None
    return account


@pytest.mark.parametrize(("name", "price"), PRICES.items(), ids=PRICES)
def test_savings_by_sharing_are_found_by_solving(name: str, price: str | None) -> None:
    notes = account_of(ROOT / "tests/questions" / name, "ArbitrationNode").notes
    assert [note for note in notes if "apart" in note] == ([price] if price else [])


#: Sentences about strategies and locks that no case speaks yet. The list may only shrink.
UNSPOKEN = {
    "account/findings/latest-wins-by-strategy",
    "account/capability/stopped",
    "account/capability/stopped-line",
}


def test_every_rule_speaks_in_a_case() -> None:
    rulebook = load_rulebook(stages=STAGES)
    telling = {rule.id for rule in rulebook.rules if rule.stage == STAGE and rule.derives(ACCOUNT)}
    spoken = {rule for account in _accounts() for rule in account.rules}
    for path in FOREIGN:
        reading = argparse.Namespace(
            from_format=None, sources=[], quiet=True, rules=[], isolated=True
        )
        project = load(reading, str(ROOT / "tests" / path))
        for topic in explain(Reasoner(project, rulebook), traced=False).topics:
            spoken |= set(topic.account.rules) if topic.account else set()
    for name, packs in BROUGHT.items():
        with_packs = load_rulebook([ROOT / each for each in packs], stages=STAGES)
        project = load_project(str(ROOT / "tests/node_kinds" / name))
        for topic in explain(Reasoner(project, with_packs), traced=False).topics:
            spoken |= set(topic.account.rules) if topic.account else set()
    for name in PRICES:
        spoken |= set(account_of(ROOT / "tests/questions" / name, "ArbitrationNode").rules)
    able = load_rulebook(stages=("can", STAGE))
    questions = [(load_project(str(ROOT / "tests/questions/able.mars")), query) for query in ABLE]
    graph = load_project("graph.mars", text=GRAPH)
    questions.append((graph, "Trans_X of /base"))
    for project, query in questions:
        answer = capability(project, able, query)
        spoken |= {rule for verdict in answer.verdicts for rule in verdict.account.rules}
    assert telling - spoken == UNSPOKEN


def test_whatever_a_sentence_counts_is_listed(monkeypatch: Patch) -> None:
    monkeypatch.chdir(CASES[0].parent)
    assert [missing for account in _accounts() for missing in uncounted(account)] == []


def test_counts_without_a_list_are_found() -> None:
    cited = Cited(Span(str(CASES[0]), 1, 1, 1, 1), "", "of `A`")
    text = "`A` feeds 2 modules on 1 lines."
    assert [each.partition(" are")[0] for each in uncounted(Account(text, (cited,), ()))] == [
        "0 modules|controllers"
    ]


def _accounts() -> list[Account]:
    """Return the accounts of all cases."""
    each_topic = (topic for path in CASES for topic in explained(path)[1])
    return [topic.account for topic in each_topic if topic.account is not None]


@pytest.mark.parametrize(
    "path",
    [*sample(CASES, 26, 13), *sample(EXAMPLES, 26)],
    ids=lambda path: str(path.relative_to(ROOT)),
)
def test_whatever_is_cited_is_a_cause(path: Path) -> None:
    assert list(uncaused(path.read_text(encoding="utf-8"), str(path))) == []


@pytest.mark.parametrize("kind", sample(KINDS, 2))
def test_whatever_is_cited_of_random_configurations_is_a_cause(kind: type) -> None:
    assert list(uncaused(kind(0))) == []


@pytest.mark.parametrize("kind", sample(KINDS, 2, 1))
def test_an_answer_leads_to_each_cause(kind: Callable[[int], str]) -> None:
    assert list(uncited(kind(2))) == []


@pytest.mark.parametrize(
    "path",
    [*sample(COMPLETE, 24, 1), *sample(EXAMPLES, 36, 1)],
    ids=lambda path: str(path.relative_to(ROOT)),
)
def test_an_answer_leads_to_each_cause_in_a_case(path: Path) -> None:
    assert list(uncited(path.read_text(encoding="utf-8"), str(path))) == []


def test_a_cause_that_no_answer_cites_is_found(monkeypatch: Patch) -> None:
    text = "@configuration\n@modules A, B, C\nB uses_data_from A\nC uses_data_from A\n"
    assert list(uncited(text)) == []
    monkeypatch.setattr(counterfactual, "_lines_of", lambda topic, path: frozenset())
    missing = [f"{line} uses_data_from A is missing for" for line in "BC"]
    found = list(uncited(text, "other.mars"))
    for node_or_finding in ("data_divergence(A)", "DataSplitter"):
        lines = [each for each in found if node_or_finding in each]
        assert [each.partition(f" {node_or_finding}")[0] for each in lines] == missing


@pytest.mark.parametrize("kind", KINDS)
def test_each_account_of_a_random_configuration_has_a_sentence_and_each_line_once(
    kind: type,
) -> None:
    for seed in (17, 20):
        # Some of the texts cannot be read.
        with suppress(MarsError):
            assert [fault for each in topics(kind(seed)) for fault in malformed(each)] == []


def test_an_account_without_a_sentence_or_with_a_line_twice_is_malformed() -> None:
    cited = Cited(Span("a.mars", 1, 1, 1, 2), "a.mars:1", "")
    named = Topic("N", "N", "node", None, None, (), Account("", (), ()), Unexplained("N", ""))
    assert list(malformed(named)) == ["no sentence for N"]
    twice = replace(named, account=Account("`N` is here.", (cited, cited), ()))
    assert list(malformed(twice)) == ["('a.mars', 1, '') twice for N"]


def test_most_answers_are_short() -> None:
    found = [
        block for path in CASES for block in path.with_suffix(".txt").read_text().split("\n\n")
    ]
    long = [block for block in found if len(block.strip().splitlines()) > 12]
    assert len(long) * FEW <= len(found), long


def test_a_part_has_the_same_explanation_as_the_whole() -> None:
    rulebook = load_rulebook(stages=STAGES)
    for path in sample(CASES, 64, 18):
        project = load_project(str(path))
        for topic in explain(Reasoner(project, rulebook), traced=False).topics:
            part = explain(Reasoner(project, rulebook), topic.name, traced=False).topics
            entries = [each.account for each in part if each.name == topic.name]
            assert topic.account in map(without_price, entries), (path, topic.name)


def without_price(account: Account | None) -> Account | None:
    if account is None:
        return None
    notes = tuple(note for note in account.notes if "apart" not in note)
    rules = tuple(rule for rule in account.rules if "price-of-sharing" not in rule)
    return replace(account, notes=notes, rules=rules)


#: The data of `Eye` goes through one of two converters, and a splitter could follow either.
TWO_WAYS = """@configuration
@modules Eye, Screen
Screen uses_data_from Eye
@module_start
@module_name Eye
@Sense RequestWhenReady
Photo look();
@module_end
@module_start
@module_name Screen
@DataIn
void show(Picture shown);
@module_end
@module_start
@module_name Painter
@Converts
Picture paint(Photo photo);
@module_end
@module_start
@module_name Slow
@Converts 2
Picture paint(Photo photo);
@module_end
"""


def test_an_unchosen_atom_is_not_true(tmp_path: Path) -> None:
    path = tmp_path / "config.mars"
    path.write_text(TWO_WAYS, encoding="utf-8")
    evidence = Reasoner(load_project(str(path)), load_rulebook()).evidence(resolved=True)
    splitter, transformer = Signature("splitter", 2), Signature("transformer", 2)
    assert atoms(evidence.analysis.grounding.control, *splitter)
    found = true_atoms(evidence, [splitter, transformer])
    assert (len(found[splitter]), len(found[transformer])) == (0, 1)
