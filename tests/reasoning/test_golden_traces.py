"""Every built-in rule that speaks is explained in a golden trace.

`tests/traces` has a file for each rule file: every rule with a message, and a trace that ends in
it, over the facts of the first case in `tests/rules` that has one. Rules without a message are
folded into those that they support.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from functools import cache
from pathlib import Path

import clingo
import pytest
from clingo import ast

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.term_ids import TermId, as_term
from mars_asp.asp.trace import Derived, Explainer, Trace
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.asp.trace.text import traces_text
from mars_asp.diagnostic import MarsError, Span
from mars_asp.reasoning.cases import stages_of
from mars_asp.reasoning.questions.account import STAGE as TELLING
from mars_asp.reasoning.rules import FOLLOWING, STAGES, load_rulebook
from mars_asp.reasoning.synthesis import derived
from tests.support.campaigns import sample
from tests.support.documents import ROOT
from tests.support.programs import atom_of
from tests.support.rule_coverage import CASES

#: Stages that choose; what others derive follows.
CHOOSING = ("resolve", "can", "cost")


def cases_of(stage: str) -> list[Path]:
    """Return the cases of a stage and of the one that it follows."""
    first = {path: next(iter(stages_of(path)), "base") for path in CASES}
    return [path for path in CASES if stage in (first[path], FOLLOWING.get(first[path]))]


@cache
def rulebook_of(stage: str) -> Rulebook:
    """Return the rules of the base and of a stage, with all that is found out about them once."""
    return load_rulebook(stages=() if stage == "base" else (stage,))


def symbols_of(head: ast.AST) -> Sequence[clingo.Symbol]:
    """Return the atoms of a fact, of which an interval has several."""
    try:
        return [clingo.parse_term(str(head))]
    except RuntimeError:
        control = clingo.Control()
        control.add("base", [], f"{head}.")
        control.ground()
        return [atom.symbol for atom in control.symbolic_atoms]


def explainer_of(case: Path, stage: str) -> tuple[Explainer, frozenset[clingo.Symbol]] | None:
    """Return an explainer of a case and its true atoms; `None` where nothing answers it."""
    stage = next(iter(stages_of(case)), stage)
    rulebook = rulebook_of(stage)
    text = read_case(case)[0]
    given: list[Fact] = []

    def note(statement: ast.AST) -> None:
        if statement.ast_type == ast.ASTType.Rule and not statement.body:
            begin, end = statement.location.begin, statement.location.end
            path = str(case.relative_to(ROOT))
            place = Span(path, begin.line, begin.column, end.line, end.column)
            given.extend(Fact(atom_of(each), place) for each in symbols_of(statement.head))

    ast.parse_string(text, note)
    stages = ("base",) if stage in CHOOSING else dict.fromkeys(("base", stage))
    rules = [fragment for each in stages for fragment in rulebook.fragments(each)]
    grounding = Grounding([*rules, Fragment(text, "rules")])
    opened: Mapping[Signature, Sequence[TermId]] = {}
    if stage in CHOOSING:
        try:
            answer = grounding.resolve(rulebook.fragments(stage)).answer
            opened = answer.true
        except MarsError:  # a case may ask for what has no answer
            return None
        if stage in FOLLOWING:
            derived.SpecifiedAtoms(rulebook, answer).hand_to(grounding)
    atoms = grounding.control.symbolic_atoms
    taken = {term for terms in opened.values() for term in terms}
    true = frozenset(atom.symbol for atom in atoms if atom.is_fact or as_term(atom.symbol) in taken)
    return Explainer(
        rulebook, grounding.control, GivenFacts(given, rulebook.declarations), opened
    ), true


def speaking(stage: str) -> list[Rule]:
    """Return the rules of a stage that have a trace."""
    # A constraint derives nothing: its sentence appears only if no answer set is left.
    return [r for r in rulebook_of(stage).rules if r.stage == stage and r.because and r.heads]


def goldens(
    stage: str, rules: Iterable[Rule], named: Mapping[Path, Set[str]]
) -> Iterator[tuple[Rule, str]]:
    """Yield each of some rules of a stage with the text of the first trace that ends in it.

    `named` has the atoms to explain, by their cases; without any, all cases are searched.
    """
    wanted = {r.span: r for r in rules}
    for case in cases_of(stage):
        heads = {head for rule in wanted.values() for head in rule.heads}
        explained = explainer_of(case, stage) if heads and case in (named or (case,)) else None
        if explained is None:
            continue
        explainer, true = explained
        atoms = sorted(a for a in true if signature_of(a).unsigned in heads)
        atoms = [a for a in atoms if without_blanks(a) in named[case]] if named else atoms
        for atom, trace in explainer.why(atoms).items():
            if isinstance(trace, Derived) and trace.rule.span in wanted:
                yield wanted.pop(trace.rule.span), shown(case, atom, trace)
    assert not wanted, f"no case has a trace that ends in {[str(r.span) for r in wanted.values()]}"


def named_in(goldens: Iterable[Path]) -> Mapping[Path, Set[str]]:
    """Return the atoms that golden traces explain, without blanks, by their cases."""
    found: dict[Path, set[str]] = {}
    for path in goldens:
        # A long title goes on in lines that are indented, by less than its trace is.
        for title in re.findall(r"(?m)^\S.*(?:\n  \S.*)*", path.read_text(encoding="utf-8")):
            atom, _, case = without_blanks(title).rpartition(",in")
            found.setdefault(ROOT / case, set()).add(atom)
    return found


def without_blanks(text: object) -> str:
    return "".join(str(text).split())


def golden_of(rule: Rule) -> Path:
    return ROOT / "tests" / "traces" / Path(rule.span.path).relative_to("rules").with_suffix(".txt")


def shown(case: Path, atom: clingo.Symbol, trace: Trace) -> str:
    lines = case.read_text(encoding="utf-8").splitlines()
    title = f"{atom}, in {case.relative_to(ROOT)}"
    result = traces_text([(title, trace)], lambda span: lines[span.line - 1], 2)
    return "\n".join(result)


@pytest.mark.parametrize("stage", ["base", *(each for each in STAGES if each != TELLING)])
def test_every_rule_has_a_golden_trace(stage: str, update_golden: bool) -> None:
    by_file: dict[Path, list[tuple[int, str]]] = {}
    rules = speaking(stage)
    files = sorted({golden_of(rule) for rule in rules})
    some = files if update_golden else sample(files, 6)
    explained = {} if update_golden else named_in(some)
    chosen = [rule for rule in rules if golden_of(rule) in some]
    for rule, text in goldens(stage, chosen, explained):
        by_file.setdefault(golden_of(rule), []).append((rule.span.line, text))
    for golden, found in by_file.items():
        text = "\n\n".join(item for _, item in sorted(found)) + "\n"
        if update_golden:
            golden.parent.mkdir(parents=True, exist_ok=True)
            golden.write_text(text, encoding="utf-8")
        assert text == golden.read_text(encoding="utf-8"), golden


def test_every_rule_is_named_by_a_golden_trace() -> None:
    """Of a rule file that the suite leaves out, traces are made in campaigns alone."""
    stages = ["base", *(each for each in STAGES if each != TELLING)]
    texts = {rule: golden_of(rule) for stage in stages for rule in speaking(stage) if rule.id}
    missing = [r.id for r, path in texts.items() if f"[{r.id}]" not in path.read_text("utf-8")]
    assert not missing
