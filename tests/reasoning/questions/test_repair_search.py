"""The sets of edits tried for each finding, their order, and the fixes among them."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from clingo import Symbol, parse_term

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.atoms import Fact
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.reasoning.analysis import Analysis, Consequence, analyse
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project, load_project, project_facts
from mars_asp.reasoning.questions import repair
from mars_asp.reasoning.questions.edits import EditedTexts, apply_edits
from mars_asp.reasoning.questions.repair import (
    STAGES,
    FindingCounts,
    Repair,
    new_remarks,
    order_kept,
    repairs,
)
from mars_asp.reasoning.rules import load_rulebook
from tests.support.fixtures import Patch
from tests.support.refusals import refusals

RULEBOOK = load_rulebook(stages=STAGES)
ROBOT = "@configuration hierarchical\n@modules W, A\nW is_controlled_by A\n"
DOOMED = """
%! id: odd/doomed
%! because: `{M}` is doomed by {K}
consequence(doomed, warning, M, K) :- is_controlled_by(_, M, _), doom(K), not saved(K).
#defined saved/1.
%! id: odd/save
%! because: name `{N}`
edit(doomed, M, K, name(N), W) :- consequence(doomed, _, M, K), save(K, N, W).
"""


def _project(text: str = ROBOT) -> Project:
    return load_project("c.mars", text=text)


@pytest.fixture
def book(tmp_path: Path) -> Callable[[str], Rulebook]:
    """Return a rulebook with the finding `doomed` for each `doom(K)`, and more rules."""

    def load(rules: str) -> Rulebook:
        pack = tmp_path / "odd.lp"
        pack.write_text(f"{DOOMED}{rules}\n")
        return load_rulebook([pack], STAGES)

    return load


@pytest.fixture
def tries(monkeypatch: Patch) -> list[str]:
    """Return a list of the names that each try of edits `name(N)` adds."""
    made: list[str] = []

    def noted(texts: EditedTexts, terms: Sequence[Symbol]) -> object:
        made.append(" ".join(term.arguments[0].string for term in terms))
        return apply_edits(texts, terms)

    monkeypatch.setattr(repair, "apply_edits", noted)
    return made


def _saves(case: int, names: str, weight: int = 1) -> str:
    return " ".join(f'save({case}, "{name}", {weight}).' for name in names.split())


def _names(found: Repair) -> list[str]:
    return [" ".join(edit.term.arguments[0].string for edit in mend.edits) for mend in found.mends]


# ---- What is tried -------------------------------------------------------------------------------


def test_sets_are_tried_by_size_then_by_weight_and_heavy_edits_alone_and_last(
    book: Callable[[str], Rulebook], tries: list[str]
) -> None:
    rules = (
        f"doom(0). {_saves(0, 'D C')} {_saves(0, 'B', 2)} {_saves(0, 'Z', 3)} {_saves(0, 'Y', 4)}"
    )
    entries: list[tuple[int, int]] = []
    project = _project()
    (found,) = repairs(project, book(rules), progress=lambda *state: entries.append(state))
    singles, pairs = ["C", "D", "B", "Z"], ["C D", "C B", "D B", "C Z", "D Z", "B Z"]
    assert tries == [*singles, *pairs, "C D B", "C D Z", "C B Z", "D B Z", "Y"]
    assert (found.proposed, found.tried, found.mends) == (5, 15, ())
    assert (found.complete, found.late) == (True, False)
    most = 200_000 // (len(project_facts(project)) + 500)
    assert entries == [(done, most) for done in range(15)]


def test_sixty_sets_are_tried_for_a_finding_and_then_the_heavy_edits(
    book: Callable[[str], Rulebook], tries: list[str]
) -> None:
    light = [f"L{number:02}" for number in range(61)]
    rules = f"doom(0). {_saves(0, ' '.join(light))} {_saves(0, 'Heavy', 4)}"
    (found,) = repairs(_project(), book(f'{rules} saved(0) :- module("Heavy").'))
    assert tries == [*light[:60], "Heavy"]
    assert _names(found) == ["Heavy"]
    assert (found.proposed, found.tried, found.complete, found.late) == (62, 61, False, False)


def test_of_many_edits_the_first_twenty_are_combined(
    book: Callable[[str], Rulebook], tries: list[str], monkeypatch: Patch
) -> None:
    monkeypatch.setattr(repair, "MOST_TRIED", 44)
    names = [f"L{number:02}" for number in range(22)]
    (found,) = repairs(_project(), book(f"doom(0). {_saves(0, ' '.join(names))}"))
    assert tries == [
        *names,
        *(f"L00 {name}" for name in names[1:20]),
        *(f"L01 {name}" for name in names[2:5]),
    ]
    assert (found.tried, found.complete) == (44, False)


@pytest.mark.parametrize(
    ("offered", "complete"), [("A1 A2 A3 A4 A5", True), ("A1 A2 A3 A4 A5 A6", False)]
)
def test_at_most_five_repairs_are_listed(
    offered: str, complete: bool, book: Callable[[str], Rulebook]
) -> None:
    rules = f"doom(0). {_saves(0, offered)} saved(0) :- module(N), save(0, N, _)."
    (found,) = repairs(_project(), book(rules))
    assert _names(found) == ["A1", "A2", "A3", "A4", "A5"]
    assert (found.tried, found.complete, found.late) == (5, complete, False)


def test_ten_sets_are_tried_however_large_a_robot_is(
    book: Callable[[str], Rulebook], tries: list[str], monkeypatch: Patch
) -> None:
    monkeypatch.setattr(repair, "MOST_FACTS", 0)
    entries: list[tuple[int, int]] = []
    names = [f"L{number:02}" for number in range(12)]
    rules = book(f"doom(0). {_saves(0, ' '.join(names))}")
    (found,) = repairs(_project(), rules, progress=lambda *state: entries.append(state))
    assert tries == names[:10]
    assert entries == [(done, 10) for done in range(10)]
    assert (found.tried, found.complete, found.late) == (10, False, False)


def test_shared_edits_are_tried_first_then_by_position(
    book: Callable[[str], Rulebook], tries: list[str], monkeypatch: Patch
) -> None:
    monkeypatch.setattr(repair, "MOST_EDITS", 1)
    edits = ("B", "A", "A", "B", "C", "A1 A2 C", "D E", "D2 E")
    saves = " ".join(_saves(case, names) for case, names in enumerate(edits))
    found = repairs(_project(), book(f'doom(0..7). {saves} saved(0) :- module("B").'))
    assert [str(each.consequence.atom.arguments[3]) for each in found] == [*"01234567"]
    assert tries == ["B", "A", "C", "E", "A1", "D", "D2", "A2"]
    # `B` is tried for two findings, and removes one of them.
    assert [_names(each) for each in found] == [["B"], *([] for _ in range(7))]
    assert [each.tried for each in found] == [1, 1, 1, 1, 1, 3, 2, 2]


# ---- Time ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limit", "lasting", "tried"),
    [
        (10, [3, 3, 3, 3], 3),
        (9, [3, 3, 3, 3], 3),
        (8, [3, 3, 3, 3], 2),
        (10, [3, 1, 1, 1, 1, 1, 1, 1], 6),
    ],
)
def test_no_set_is_tried_that_may_outlast_the_limit(
    limit: int,
    lasting: Sequence[int],
    tried: int,
    book: Callable[[str], Rulebook],
    monkeypatch: Patch,
) -> None:
    clock = [100.0]
    monkeypatch.setattr(repair, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    durations = iter(lasting)

    def slowly(texts: EditedTexts, terms: Sequence[Symbol]) -> object:
        clock[0] += next(durations)
        return apply_edits(texts, terms)

    monkeypatch.setattr(repair, "apply_edits", slowly)
    rules = book(f"doom(0). {_saves(0, 'A1 A2 A3 A4 A5 A6 A7 A8')}")
    (found,) = repairs(_project(), rules, seconds=limit)
    assert (found.tried, found.complete, found.late) == (tried, False, True)


@pytest.mark.parametrize(("limit", "left"), [(None, None), (10, 7.0), (3, 0.1), (2, 0.1)])
def test_solving_takes_the_time_that_is_left(
    limit: int | None, left: float | None, book: Callable[[str], Rulebook], monkeypatch: Patch
) -> None:
    clock = [100.0]
    monkeypatch.setattr(repair, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    begun: list[float] = []
    budgets: list[float | None] = []

    def analysed(
        facts: Sequence[Fact], rulebook: Rulebook, span: Span, with_labels: bool = False
    ) -> Analysis:
        clock[0] += 3.0 * len(begun)
        begun.append(clock[0])
        return analyse(facts, rulebook, span, with_labels=with_labels)

    def solved(analysis: Analysis, rulebook: Rulebook, budget: Budget) -> dict[int, int]:
        budgets.append(budget.seconds)
        return {}

    monkeypatch.setattr(repair, "analyse", analysed)
    monkeypatch.setattr(repair, "least_cost", solved)
    rules = book(f'doom(0). {_saves(0, "Good")} saved(0) :- module("Good").')
    (found,) = repairs(_project(), rules, seconds=limit)
    assert (_names(found), budgets) == (["Good"], [left])


# ---- Fixes ---------------------------------------------------------------------------------------


def test_nothing_is_resolved_while_the_finding_is_there(
    book: Callable[[str], Rulebook], monkeypatch: Patch
) -> None:
    monkeypatch.setattr(repair, "least_cost", lambda *_: pytest.fail("resolved in vain"))
    (found,) = repairs(_project(), book(f"doom(0). {_saves(0, 'A1')}"))
    assert (found.tried, found.mends) == (1, ())


@pytest.mark.parametrize(
    "error",
    [TimeoutError(), MarsError((Diagnostic("cost", "error", "too large", point("c.mars", 1, 1)),))],
)
def test_an_edit_without_a_specification_is_not_a_fix(
    error: Exception, book: Callable[[str], Rulebook], monkeypatch: Patch
) -> None:
    def fails(*_: object) -> None:
        raise error

    monkeypatch.setattr(repair, "least_cost", fails)
    rules = book(f'doom(0). {_saves(0, "Good")} saved(0) :- module("Good").')
    (found,) = repairs(_project(), rules)
    assert (found.tried, found.mends) == (1, ())


def test_an_edit_that_adds_an_error_is_not_a_fix(book: Callable[[str], Rulebook]) -> None:
    rules = """
doom(0). saved(0) :- not module("A"). save(none, none, 1).
%! id: odd/without
%! because: do without the name
edit(doomed, M, K, unname("A"), 1) :- consequence(doomed, _, M, K).
"""
    (found,) = repairs(_project(), book(rules))
    assert (found.tried, found.mends) == (1, ())


def test_an_edit_that_reverses_the_order_of_controllers_is_not_a_fix(
    book: Callable[[str], Rulebook],
) -> None:
    rules = """
doom(0). saved(0) :- not priority(_, 2). save(none, none, 1).
%! id: odd/rank
%! because: rank it {P}
edit(doomed, M, K, rank(R, P), 1) :- consequence(doomed, _, M, K), priority(R, 2), P = (0; 1; 3).
"""
    text = "@configuration hierarchical\n@modules W, A, B\n"
    text += "W is_controlled_by A 1\nW is_controlled_by B 2\n"
    (found,) = repairs(_project(text), book(rules))
    assert [line.new for mend in found.mends for line in mend.lines] == ["W is_controlled_by B 3"]
    assert found.tried == 3


def test_an_edit_without_a_message_is_printed_as_its_term(book: Callable[[str], Rulebook]) -> None:
    rules = """
doom(0). saved(0) :- module("Good"). save(none, none, 1).
edit(doomed, M, K, name("Good"), 1) :- consequence(doomed, _, M, K).
"""
    (found,) = repairs(_project(), book(rules))
    assert [edit.message for edit in found.mends[0].edits] == ['name("Good")']


# ---- What is asked -------------------------------------------------------------------------------

TIES = "@configuration hierarchical\n@modules Wheel, Wander, Turn, Stop, Idle\n"
TIES += "Wheel is_controlled_by Wander, Turn\nWheel is_controlled_by Stop 1\n"


@pytest.mark.parametrize(
    ("subject", "kinds"),
    [
        (None, ["unused_module", "ambiguous_priority"]),
        ("Wheel", ["ambiguous_priority"]),
        ("Stop", ["ambiguous_priority"]),
        ("Idle", ["unused_module"]),
        ("unused_module", ["unused_module"]),
        ("unused_module(Idle)", ["unused_module"]),
        ("unused_module(Wheel)", []),
        ("control_convergence", []),
        ("control_convergence(Wheel)", []),
        ("Wander", []),
        ("data_divergence", []),
    ],
)
def test_a_subject_selects_its_findings_except_notes(subject: str | None, kinds: list[str]) -> None:
    found = repairs(_project(TIES), RULEBOOK, subject)
    assert [each.consequence.kind for each in found] == kinds


@pytest.mark.parametrize(
    ("subject", "help_text"),
    [
        ("Wheell", "did you mean `Wheel`?"),
        ("unused_modul", "did you mean `unused_module`?"),
        ("unused_module(Idel)", "did you mean `unused_module(Idle)`?"),
        ("unused_module(Wheel(", "did you mean `unused_module(Wheel)`?"),
        ("unused_module(Xylophone)", "write a module, a KIND or `KIND(NAME)`"),
        ("unused_module()", "write a module, a KIND or `KIND(NAME)`"),
        ("Xylophone(Wheel)", "write a module, a KIND or `KIND(NAME)`"),
        ("Xylophone", "write a module, a KIND or `KIND(NAME)`"),
    ],
)
def test_a_subject_that_nothing_is_called_is_an_error(subject: str, help_text: str) -> None:
    assert [d.help for d in refusals(repairs, _project(TIES), RULEBOOK, subject)] == [help_text]


def test_no_edits_are_proposed_without_findings(monkeypatch: Patch) -> None:
    monkeypatch.setattr(repair, "_proposals", lambda *_: pytest.fail("asked in vain"))
    assert repairs(_project(), RULEBOOK) == ()
    assert repairs(_project(), RULEBOOK, "W") == ()


# ---- What was there before -----------------------------------------------------------------------


def _finding(kind: str, subject: str, message: str, participants: str = "") -> Consequence:
    atom = parse_term(f'consequence({kind},error,"{subject}",x)')
    named = tuple(participants.split())
    return Consequence(kind, "error", subject, named, message, None, RULEBOOK.rules[0], (), atom)


def test_a_finding_is_gone_where_fewer_are_about_it_and_none_reads_like_it() -> None:
    one, two = _finding("tie", "W", "at 1"), _finding("tie", "W", "at 2")
    other = _finding("tie", "V", "at 1")
    before = FindingCounts([one, two, other])
    assert FindingCounts([two, other]).lacks(one, before)
    assert not FindingCounts([two, other]).lacks(two, before)
    # Another finding of its kind with another message replaces it.
    assert not FindingCounts([two, other, _finding("tie", "W", "at 3")]).lacks(one, before)
    assert not before.lacks(one, before)
    assert not FindingCounts([one, two]).lacks(one, before)
    assert FindingCounts([one, two]).fewer([one, two, other], before) == 1
    assert FindingCounts([]).fewer([one, two], before) == 2
    assert FindingCounts([one, one, one]).fewer([one, other], before) == 1


def test_a_new_finding_differs_in_participants_or_kind() -> None:
    one = _finding("tie", "W", "at 1", "A B")
    before = FindingCounts([one])
    for new in (
        _finding("tie", "V", "at 1", "A B"),
        _finding("tie", "W", "at 1", "A C"),
        _finding("loop", "W", "at 1", "A B"),
    ):
        assert FindingCounts([one, new]).beyond(before) == [new]
        assert FindingCounts([new]).beyond(before) == [new]
    assert FindingCounts([one, one]).beyond(before) == [one, one]
    assert FindingCounts([]).beyond(before) == []
    assert before.beyond(before) == []
    # An error may read otherwise; a warning that does is another one.
    error = replace(one, message="at 2")
    warning = replace(error, severity="warning")
    assert FindingCounts([error]).beyond(before) == []
    assert FindingCounts([warning]).beyond(before) == [warning]
    quiet = replace(one, severity="warning")
    assert FindingCounts([quiet]).beyond(FindingCounts([quiet])) == []


def test_new_remarks_are_warnings_that_were_not_there_as_often() -> None:
    one = Diagnostic("odd", "warning", "one", point("c.mars", 1, 1))
    two, note = replace(one, message="two"), replace(one, message="three", severity="note")
    other = replace(one, code="other")
    assert list(new_remarks([], [one, note, two])) == [one, two]
    assert list(new_remarks([one], [two, one])) == [two]
    assert list(new_remarks([one], [one, one])) == [one]
    assert list(new_remarks([one, one], [one, one, one])) == [one]
    assert list(new_remarks([one], [other])) == [other]
    assert list(new_remarks([one, two], [])) == []


@pytest.mark.parametrize(
    ("before", "after", "edits", "kept"),
    [
        ("W:A 0; W:B 1", "W:A 0; W:B 1", "", True),
        ("W:A 0; W:B 1", "W:A 5; W:B 9", "", True),
        ("W:A 0; W:B 1", "W:A 1; W:B 1", "", False),
        ("W:A 0; W:B 1", "W:A 1; W:B 0", "", False),
        ("W:A; W:B 1", "W:A 1; W:B 1", "", False),
        ("W:A 1; W:B 1", "W:A 0; W:B 2", "", True),
        ("W:A 0; W:B 0; W:C 1", "W:A 0; W:B 1; W:C 2", "", True),
        ("W:A 0; W:B 0; W:C 1", "W:A 0; W:B 3; W:C 2", "", False),
        ("W:A 0; W:B 1; W:C 1", "W:A 2; W:B 3; W:C 1", "", False),
        ("W:A 0; W:B 1; W:C 2", "W:A 3; W:B 4; W:C 3", "", False),
        ("W:A 0; W:B 1", "W:A 1", "", True),
        ("W:A 0; W:B 1", "V:A 1; V:B 0", "", True),
        ("V:A 0; V:B 1; W:A 0; W:B 1", "V:A 0; V:B 1; W:A 1; W:B 0", "", False),
        # Of several priorities of a controller the highest counts.
        ("W:A 3; W:A 0; W:B 2", "W:A 0; W:B 2", "", False),
        ("W:A 3; W:A 0; W:B 2", "W:A 3; W:B 2", "", True),
        ("W:A, B, C", "W:A; W:C 5", "", True),
        ("W:A, B, C", "W:A 3; W:C 2", "", False),
        # Who is renamed keeps a rank.
        ("W:A 2; W:C 1", "W:B 0; W:C 1", "", True),
        ("W:A 2; W:C 1", "W:B 0; W:C 1", 'rename("A","B")', False),
        ("W:A 2; W:C 1", "W:B 2; W:C 1", 'rename("A","B")', True),
        ("W:A 0; W:B 1", "V:A 1; V:B 0", 'rename("W","V")', False),
        ("W:Tur 3; W:Turn 1; W:Slow 2", "W:Turn 3; W:Slow 2", 'rename("Tur","Turn")', False),
        # Whose priority is left out frees the order of its module, and of no other.
        ("W:A 0; W:B 1", "W:A; W:B", "", False),
        ("W:A 0; W:B 1", "W:A; W:B", "unrank(1)", True),
        ("V:A 0; V:B 1; W:A 0; W:B 1", "V:A 0; V:B 1; W:A; W:B", "unrank(1)", False),
        ("V:A 0; V:B 1; W:A 0; W:B 1", "V:A; V:B; W:A 0; W:B 1", "unrank(1)", True),
    ],
)
def test_edits_keep_the_strict_order_of_priorities(
    before: str, after: str, edits: str, kept: bool
) -> None:
    terms = [parse_term(edit) for edit in edits.split(";") if edit]
    old, new = (_project(_controls(lines)) for lines in (before, after))
    assert order_kept(EditedTexts(old), new.configuration, terms) is kept


def _controls(lines: str) -> str:
    declared = (line.strip().replace(":", " is_controlled_by ") for line in lines.split(";"))
    return "\n".join(["@configuration", "@modules W, X", *declared, "W is_mounted_on X", ""])
