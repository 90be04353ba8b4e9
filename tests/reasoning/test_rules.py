"""The rule cases of `tests/rules`: facts and expected answer sets in one file."""

from pathlib import Path

import pytest

from mars_asp.asp import cache
from mars_asp.asp.rules.expansions import labels
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import shown as shown_in
from mars_asp.asp.signature import Signature
from mars_asp.reasoning import rules as built_in_rules
from mars_asp.reasoning.cases import run_case, stages_of
from mars_asp.reasoning.findings import CONSEQUENCE, EXPANSIONS
from mars_asp.reasoning.questions.account import STAGE
from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.mutate.rules import built_in
from tests.support.campaigns import sample
from tests.support.cases_at_once import outcomes, together_or_apart
from tests.support.documents import ROOT
from tests.support.fixtures import Patch
from tests.support.rule_coverage import CASES, covered, fired_in, labelled, places, unnoticed


@pytest.fixture(scope="module")
def rulebook() -> Rulebook:
    return built_in()


GROUPS, ALONE = together_or_apart(CASES)


@pytest.mark.parametrize("cases", GROUPS, ids=lambda paths: "-".join(stages_of(paths[0])) or "base")
def test_cases(cases: list[Path], rulebook: Rulebook) -> None:
    wrong = [each for each in outcomes(cases, rulebook) if not each.passed]
    assert not wrong, "\n".join(
        line for each in wrong for line in (str(each.path), *each.difference())
    )


@pytest.mark.parametrize("case", ALONE, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_case(case: Path, rulebook: Rulebook) -> None:
    outcome = run_case(case, rulebook)
    assert outcome.passed, "\n".join(outcome.difference())


#: What makes a consequence visible: what it is, who takes part, and where it points.
SHOWN = (Signature("consequence", 4), Signature("participant", 5), Signature("concerns", 4))


@pytest.mark.parametrize(
    "case",
    [case for case in CASES if case.parent.name not in STAGES],
    ids=lambda path: f"{path.parent.name}/{path.stem}",
)
def test_a_case_of_the_base_pins_participants_and_places(case: Path) -> None:
    """What a case does not show may be wrong without anybody noticing it."""
    shown = [
        each
        for piece in read_case(case)[1]
        if piece.sort == "shown"
        for each in shown_in(piece.text)
    ]
    missing = [f"#show {each}." for each in SHOWN if each not in shown]
    assert not missing, f"{case} lacks {' '.join(missing)}"


def test_lines_continue_an_expected_answer_set(tmp_path: Path, rulebook: Rulebook) -> None:
    case = tmp_path / "case.lp"
    case.write_text('module("M"). q(1).\n#show module/1.\n#show q/1.\n%= module("M")\n%+ q(1)\n')
    assert run_case(case, rulebook).passed
    case.write_text('module("M"). q(1).\n#show module/1.\n#show q/1.\n%= module("M")\n%= q(1)\n')
    assert not run_case(case, rulebook).passed


def test_messages_are_compared_where_a_case_has_one(tmp_path: Path, rulebook: Rulebook) -> None:
    case = tmp_path / "case.lp"
    facts = 'module("S"). module("A"). module("B"). uses_data_from(1,"A","S").\n'
    facts += 'uses_data_from(2,"B","S").\n%= consequence(data_divergence,note,"S",receivers)\n'
    text = "%> data/divergence: `S` delivers data to 2 receivers, and a source feeds at most one\n"
    case.write_text(facts + text)
    assert run_case(case, rulebook).passed
    case.write_text(facts + text.replace("2", "3"))
    assert not run_case(case, rulebook).passed
    case.write_text(facts + text + "%> data/duplicate: `A` uses data from `S` twice\n")
    assert not run_case(case, rulebook).passed


def test_the_cost_of_an_answer_is_compared_if_a_case_expects_one(
    tmp_path: Path, rulebook: Rulebook
) -> None:
    case = tmp_path / "case.lp"
    facts = "1 { p(1..2) }. #minimize { 3@30, X : p(X) }. #minimize { 0@20 }. "
    facts += "#minimize { X@10, X : p(X) }.\n#show p/1.\n%= p(1)\n"
    case.write_text(facts + "%~ 3@30 1@10\n")
    assert run_case(case, rulebook).passed
    case.write_text(facts + "%~ 3@30 2@10\n")
    assert not run_case(case, rulebook).passed


def test_the_name_of_the_current_folder_gives_a_case_no_stage(
    tmp_path: Path, monkeypatch: Patch
) -> None:
    (tmp_path / "verify" / "can").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "verify")
    assert stages_of(Path("case.lp")) == ()
    assert stages_of(tmp_path / "verify" / "can" / "case.lp") == ("can",)
    assert stages_of(tmp_path / "resolve" / "case.lp") == ("resolve", "specify")
    monkeypatch.chdir(tmp_path)
    assert stages_of(Path("verify/case.lp")) == ("verify",)


#: Heads of rules whose premises hold together or not at all, so that none can fail alone.
TOGETHER = (
    "carried(M, N + 1, B', R)",
    "consequence(data_cycle, warning, M, cycle)",
    "consequence(control_cycle, error, M, cycle)",
    "consequence(module_conflict, error, M, cycle)",
    "placed(R, X, P, I, C)",
    "lifted(X, M, P, C)",
    "element(M, I, L, R)",
    "leaf(M, R - R', K)",
    "leaf(divided(X), R - R', K)",
    "run_includes(W, M, 0, K)",
    "consequence(type_mismatch, warning, X, types(K, K'))",
    "control_input(R, B, inherited(M))",
    "heard_as(M, I, L, V)",
    "offers(S, I, mode(N, X), none)",
    "says(X, S, D, F, R)",
    "edit(Kind, M, cycle, drop(R), 3) :- about(mount, W, Kind, M)",
)


#: Beginnings of rules that no case in `tests/rules` fires or lets fail by one premise alone.
#: Tests of whole configurations use them: `test_bindings.py`, `test_joint_services.py`,
#: `test_descriptions.py`. The list may only shrink.
WITHOUT_A_CASE = (
    "slips_between(",
    "eliminated(R, X) :- unmatched(R, C), several_left(C)",
    "serves_three(",
    "brought_to(L, X) :- named_end(",
    "edit(ambiguous_input, C, inputs, redirect(R, first, X), 1)",
    "brought_to(L, C) :- named_end(",
    "brought_to(L, C) :- takes_turn_of(",
    "takes_turn_of(",
    "compared_by_source(",
    "absent(loose_end, X, fed_somehow)",
    "cites(loose_end,X,fed_somehow,R)",
)
LISTS_WITHOUT_A_CASE = {
    "absence/checks/may-be-meant:lines",
    "absence/ports/fed-somehow:lines2",
}


def test_every_rule_fires_in_one_case_and_narrowly_fails_in_another(rulebook: Rulebook) -> None:
    """A new rule needs two cases in `tests/rules`: see `mars_asp/asp/cases/coverage.py`."""
    # Accounts need whole configurations: `tests/accounts` uses each of their rules.
    found = covered(rulebook, [rule for rule in rulebook.rules if rule.stage != STAGE])
    silent = [rule for rule in found.silent if not rule.text.startswith(WITHOUT_A_CASE)]
    never_near = [
        rule for rule in found.never_near if not rule.text.startswith((*TOGETHER, *WITHOUT_A_CASE))
    ]
    assert any(rule.text.startswith(WITHOUT_A_CASE) for rule in found.silent)
    assert not silent, f"no case in tests/rules fires:\n{places(silent)}"
    assert not never_near, f"no case lets one premise alone fail:\n{places(never_near)}"


def test_a_case_notices_each_list_that_is_left_out(rulebook: Rulebook) -> None:
    """Mutants change rules written in files, not the rules that `who` and `at` expand to."""
    listed = [each for each in rulebook.rules if each.listed is not None]
    lists = sample(listed, 24)
    folders = {r.stage if r.stage != "base" else Path(r.span.path).stem for r in lists}
    own = [path for path in CASES if path.parent.name in folders]
    assert len(listed) > 100
    expected = LISTS_WITHOUT_A_CASE.intersection(rule.id for rule in lists)
    assert {rule.id for rule in unnoticed(lists, rulebook, own)} == expected


def test_each_consequence_has_a_reason_and_fires_in_its_example(rulebook: Rulebook) -> None:
    finding = [r for r in rulebook.rules if r.stage == "base" and r.derives(CONSEQUENCE)]
    examples = []
    for rule in finding:
        assert rule.why and rule.why.endswith("."), rule.id
        assert rule.example is not None and ROOT / rule.example in CASES, rule.id
        examples.append(ROOT / rule.example)
    fired = fired_in(finding, rulebook, sorted(set(examples)))
    result = zip(finding, examples, fired, strict=True)
    silent = [rule.id for rule, example, paths in result if example not in paths]
    assert len(finding) > 40
    assert silent == []


def test_each_finding_has_an_effect_and_each_label_a_location(rulebook: Rulebook) -> None:
    """Each label of a rule appears at a place in at least one case."""
    finding = [r for r in rulebook.rules if r.stage == "base" and r.derives(CONSEQUENCE)]
    grave = [r for r in finding if "consequence(" in r.text and ", note," not in r.text]
    assert [r.id for r in grave if not (r.effect or "").endswith(".")] == []
    listed = [(r, label) for r in finding for label in labels(r, EXPANSIONS)]
    assert len(listed) > 25
    files = {rule.id.split("/")[0] for rule, _ in listed}
    result = labelled(listed, rulebook, [case for case in CASES if case.parent.name in files])
    silent = [pair for number, pair in enumerate(listed) if number not in result]
    assert [(rule.id, label.text) for rule, label in silent] == []


#: What several files add to: consequences and their places, verdicts, nodes, costs, edits, accounts
#: and why something is absent.
COMMON = {
    "consequence",
    "participant",
    "concerns",
    "violation",
    "resolves",
    "line",
    "edit",
    "sub_edit",
}
COMMON |= {"caution", "account", "absent", "cites", "change", "related_edge", "need", "holds_in"}
#: Nodes of packs have lines as ours have.
COMMON |= {"spec_node", "spec_uses_data_from", "spec_is_controlled_by", "written_at"}
#: Gates and bounds add to what these mean elsewhere.
COMMON |= {"takes_aside", "derives_from", "leaf", "lacks"}
COMMON |= {"spec_required_mode", "spec_required_rate"}


def test_a_predicate_is_derived_in_one_file_alone(rulebook: Rulebook) -> None:
    """Two files that mean different things by one name would mix them up unnoticed."""
    files: dict[Signature, set[str]] = {}
    for rule in rulebook.rules:
        for head in rule.heads:
            if head.name not in COMMON:
                files.setdefault(head, set()).add(rule.span.path)
    assert {name: paths for name, paths in files.items() if len(paths) > 1} == {}


def test_rules_of_a_table_are_those_that_were_read(tables: Path) -> None:
    built_in_rules._unchanged.cache_clear()
    read = load_rulebook()
    made = dict(cache.tables())
    for name, content in made.items():
        (tables / name).write_bytes(content)
    cache.forget(tables)
    built_in_rules._unchanged.cache_clear()
    held = load_rulebook()
    assert (held.rules, held.texts) == (read.rules, read.texts)
    assert held.rules[0] is not read.rules[0]
    assert [rule.heads for rule in held.rules] == [rule.heads for rule in read.rules]
    assert [rule.firsts for rule in held.rules] == [rule.firsts for rule in read.rules]
    assert str(held.rules[-1].node) == str(read.rules[-1].node)
    assert dict(cache.tables()).keys() == made.keys()
