"""Messages about rule packs before clingo reads them."""

import re
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.cases import run_case
from mars_asp.reasoning.project import load_project, project_facts
from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.mutate.rules import built_in
from tests.support.campaigns import seeds
from tests.support.fixtures import Captured, Patch
from tests.support.random_configurations import random_configuration
from tests.support.refusals import refusal, refusals


@pytest.fixture(autouse=True)
def wide(monkeypatch: Patch) -> None:
    """Print each message in one line."""
    monkeypatch.setenv("COLUMNS", "1000")


def located(folder: Path, text: str) -> list[tuple[str, int, int, str]]:
    path = folder / "mine.lp"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(MarsError) as caught:
        load_rulebook([path])
    assert {d.span.path for d in caught.value.diagnostics} == {str(path)}
    return [(d.code, d.span.line, d.span.column, d.message) for d in caught.value.diagnostics]


def test_a_variable_that_nothing_binds_is_named_at_its_own_place(tmp_path: Path) -> None:
    text = "seen(M) :- module(M).\n\nblind(X, Y) :- module(X), not seen(Y).\n"
    assert located(tmp_path, text) == [
        ("rule-unsafe", 3, 10, "nothing in the body binds `Y`"),
    ]


def test_a_predicate_without_facts_and_rules_is_named(tmp_path: Path) -> None:
    text = "seen(M) :- modul(M).\n{ odd(M) : seen(M, 1) } :- module(M), not -hidden(M).\n"
    assert located(tmp_path, text) == [
        ("rule-unknown", 1, 12, "nothing gives or derives `modul/1`"),
        ("rule-unknown", 2, 12, "nothing gives or derives `seen/2`"),
        ("rule-unknown", 2, 43, "nothing gives or derives `hidden/1`"),
    ]


def test_a_near_predicate_is_proposed(tmp_path: Path) -> None:
    path = tmp_path / "mine.lp"
    path.write_text("seen(M) :- modul(M).\n", encoding="utf-8")
    assert refusals(load_rulebook, [path])[0].help == "did you mean `module/1`?"


def test_packs_may_use_each_other_and_declare_facts_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "one.lp").write_text("#defined team/2.\nseen(M) :- module(M), team(M, 1).\n")
    (tmp_path / "two.lp").write_text("noticed(M) :- seen(M), not team(M, 2).\n")
    load_rulebook([tmp_path])


def test_a_consequence_has_a_severity_and_is_not_in_a_choice(tmp_path: Path) -> None:
    text = (
        "consequence(a, eror, M, 1) :- module(M). consequence(a, (note;1), M, 2) :- module(M).\n"
        "  { consequence(b, error, M, 1) } :-\n  module(M).\n"
        "concerns(c, M, X, M) : X = 1..2 :- module(M).\n"
        "consequence(d, error, M, 1); seen(M) :- module(M).\n"
        "consequence(e, S, M, 1) :- module(M), S = note.\n"
    )
    chosen = "occurs in a choice, disjunction or condition"
    assert located(tmp_path, text) == [
        ("rule-severity", 1, 16, "`eror` is not a severity"),
        ("rule-head", 1, 57, "`consequence/4` occurs in a pool, or contains one"),
        ("rule-head", 2, 3, f"`consequence/4` {chosen}"),
        ("rule-head", 4, 1, f"`concerns/4` {chosen}"),
        ("rule-head", 5, 1, f"`consequence/4` {chosen}"),
    ]


@pytest.mark.parametrize(
    "rules",
    [
        "{ lucky(M) } :- module(M).\n",
        "lucky(M) :- module(M), not other(M).\nother(M) :- module(M), not lucky(M).\n",
    ],
)
@pytest.mark.parametrize("words", [["check"], ["explain", "odd(Eye)"], ["explain", "plain(Eye)"]])
def test_consequences_follow_from_the_facts(
    rules: str, words: list[str], tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "mine.lp"
    pack.write_text(
        "consequence(odd, note, M, 1) :- lucky(M).\n"
        f"consequence(plain, note, M, 1) :- module(M).\n{rules}",
        encoding="utf-8",
    )
    robot = tmp_path / "robot.mars"
    robot.write_text("@configuration\n@modules Eye\n", encoding="utf-8")
    verb, *subject = words
    assert run_here([verb, str(robot), *subject, "--rules", str(pack)]) == 2
    output = "".join(capsys.readouterr())
    assert f"{pack}:1:1: error: whether this holds depends on a choice" in output


def test_refusing_does_not_ground(tmp_path: Path) -> None:
    path = tmp_path / "mine.lp"
    path.write_text("p((X,X)) :- p(X).\np(1).\n")
    load_rulebook([path])


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("p(1).\nq(X) :- not p(X).\n", "rule-unsafe", (2, 3)),
        ("p(1).\np(X :- q.\n", "rule-syntax", (2, 5)),
    ],
)
def test_a_case_that_clingo_refuses_is_reported_with_its_location(
    tmp_path: Path, text: str, code: str, place: tuple[int, int]
) -> None:
    path = tmp_path / "case.lp"
    path.write_text(text)
    found = refusal(run_case, path, load_rulebook(stages=()))
    assert (found.code, found.span.path) == (code, str(path))
    assert (found.span.line, found.span.column) == place


#: A finding that lists its participants and places; the expected lists are written by hand.
FOUND = "consequence(busy, note, C, work) :- is_controlled_by(_, _, C), uses_data_from(R, C, S)."
LISTED = """%! id:  mine/busy
%! who: C, S; M@(1, X) : is_controlled_by(X, M, C)
%! at:  R; X : is_controlled_by(X, _, C)
"""
BY_HAND = """
participant(busy, C, work, 0, C) :- is_controlled_by(_, _, C), uses_data_from(_, C, _).
participant(busy, C, work, 1, S) :- is_controlled_by(_, _, C), uses_data_from(_, C, S).
participant(busy, C, work, (1, X), M) :- is_controlled_by(X, M, C), uses_data_from(_, C, _).
concerns(busy, C, work, R) :- is_controlled_by(_, _, C), uses_data_from(R, C, _).
concerns(busy, C, work, X) :- is_controlled_by(X, _, C), uses_data_from(_, C, _).
"""


@pytest.mark.parametrize("subject", ["", "busy", "busy(D0)", "busy(D1)"])
def test_listed_participants_and_locations_equal_heads_by_hand(
    subject: str, tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "mine.lp"
    robot = tmp_path / "robot.mars"
    busy = 0
    for seed in seeds(2, 60):
        lines = "D0 uses_data_from W0\nD1 uses_data_from W1\n"
        robot.write_text(f"{random_configuration(seed)}\n{lines}")
        entries = []
        for text in (LISTED + FOUND, "%! id: mine/busy\n" + FOUND + BY_HAND):
            pack.write_text(text)
            verb = ["explain", str(robot), subject] if subject else ["analyse", str(robot)]
            assert run_here([*verb, "--rules", str(pack), "--format", "json"]) in (0, 1, 2)
            output = capsys.readouterr().out
            entries.append(re.sub(rf'"path": "{pack}", "line": \d+', "", output))
            busy += "busy" in output
        assert entries[0] == entries[1]
    assert busy


def test_a_constraint_over_participants_is_named(tmp_path: Path) -> None:
    pack = tmp_path / "mine.lp"
    others = ':- module("Nobody").\nseen(M) :- module(M).\n'
    pack.write_text(f":- participant(data_divergence, _, _, _, M), module(M).\n{others}")
    robot = tmp_path / "robot.mars"
    robot.write_text("@configuration\n@modules A, B, C\nA uses_data_from C\nB uses_data_from C\n")
    project = load_project(str(robot))
    found = refusal(
        analyse, project_facts(project), load_rulebook([pack]), project.configuration.span
    )
    assert found.message == "this rule excludes every answer"
    assert (found.span.path, found.span.line, found.labels) == (str(pack), 1, ())


def test_each_participant_of_a_built_in_rule_is_traced_to_its_list() -> None:
    book = built_in()
    above = {rule.id: rule for rule in book.rules if rule.lists}
    listed = [rule for rule in book.rules if rule.listed is not None]
    assert len(above) > 30 and len(listed) > len(above)
    for rule in listed:
        owner = above[re.sub(r":(who|at|in|lines)\d*$", "", rule.id)]
        assert rule.span == owner.span
        assert {str(head) for head in rule.heads} <= {
            "participant/5",
            "concerns/4",
            "holds_in/4",
            "cites/4",
        }
        assert rule.written[1].startswith(owner.written[1])
        assert book.by_id[rule.id] is rule


DEADLINES = """\
%*! deadline(M: module, T: milliseconds)
Module M has to answer within T.
from: property
*%
#defined deadline/2.
called(M, N) :- is_controlled_by(_, N, M).
%! because: `{M}` has to answer within {T:milliseconds}
consequence(late, warning, M, N) :- called(M, N), deadline(M, T), T > 100.
"""


def test_facts_of_runs_are_optional_for_packs_without_rules_on_runs(
    tmp_path: Path, capsys: Captured
) -> None:
    pack = tmp_path / "pace"
    (pack / "consequences").mkdir(parents=True)
    (pack / "pack.toml").write_text('name = "pace"\nversion = "1.0"\nsummary = "In time"\n')
    (pack / "consequences" / "pace.lp").write_text(DEADLINES)
    robot = tmp_path / "robot.mars"
    robot.write_text(
        "@configuration\n@modules A, B\nB is_controlled_by A\nA @Property deadline 0.5 s\n"
    )
    assert run_here(["rules", "lint", str(pack)]) == 0
    assert run_here(["check", str(robot), "--rules", str(pack)]) == 0
    assert "`A` has to answer within 0.5 s" in capsys.readouterr().out
    (pack / "run").mkdir()
    rule = "%! because: `{C}` is silent\nconsequence(quiet, note, C, E) :- commanded_by(E, C).\n"
    (pack / "run" / "pace.lp").write_text(rule)
    assert {each.message for each in refusals(load_rulebook, [pack], STAGES)} >= {
        "`deadline` means something else already, so it cannot be the property `deadline`",
        "`called/2` is given, and nothing derives it",
    }


def test_a_list_that_cannot_be_read_is_refused_where_a_predicate_is_called_as_one_of_ours(
    tmp_path: Path,
) -> None:
    text = "%! who:     O' : untaken(A', M), seen(A', O'Coverage that\nuseful(899, 900).\n"
    assert located(tmp_path, text) == [
        (
            "rule-metadata",
            1,
            1,
            "`who` is above a rule that does not derive `consequence/4` alone",
        )
    ]
