"""Nothing that analysis does not derive is explained, and nothing that it derives is left out.

python -m tests.reasoning.questions.test_packs_explained HOW_MANY FIRST_SEED
"""

import random
import sys
import time
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import clingo
import pytest

from mars_asp.asp.messages import shown
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.trace import Derived
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.project import Project, load_project, project_facts
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Evidence, Reasoner
from tests.support.campaigns import seeds
from tests.support.documents import ROOT
from tests.support.random_configurations import random_configuration
from tests.support.random_packs import Pack, random_pack
from tests.support.trace_checker import faults

#: Of our own rules these are enough: the others take time and read no pack.
KEPT = ("rules/vocabulary.lp", "rules/data.lp")
#: Of the atoms of a pack so many are asked for one by one.
QUERIES = 4


@cache
def projects() -> tuple[Project, ...]:
    return tuple(load_project("random.mars", text=random_configuration(n)) for n in range(8))


def rulebook_with(pack: Path) -> Rulebook:
    """Return a pack with those of our rules that are kept."""
    whole = load_rulebook([pack], ())
    own = [ROOT / name for name in KEPT]
    rules = [rule for rule in whole.rules if rule.span.path in (*KEPT, str(pack))]
    texts = [("base", path.read_text(encoding="utf-8")) for path in own]
    documented = tuple(file for file in whole.documented if file.path in (*KEPT, str(pack)))
    texts.append(whole.texts[-1])
    return Rulebook(tuple(rules), tuple(texts), 1, whole.pack_rules, documented=documented)


def derived(rulebook: Rulebook, facts: str) -> frozenset[clingo.Symbol]:
    """Return the atoms that clingo derives from the unchanged texts."""
    control = clingo.Control(["--warn=none"])
    control.add("base", [], f"{rulebook.text('base')}\n{facts}")
    control.ground()
    return frozenset(atom.symbol for atom in control.symbolic_atoms if atom.is_fact)


def plain(text: str) -> str:
    """Return a rule as clingo writes it."""
    found: list[clingo.ast.AST] = []
    clingo.ast.parse_string(text, found.append)
    return next(str(each) for each in found if each.ast_type == clingo.ast.ASTType.Rule)


def misplaced(pack: Pack, rulebook: Rulebook, path: Path) -> list[str]:
    """Return the rules whose line or text differs from the pack."""
    read = [(r.span.line, plain(r.text)) for r in rulebook.rules if r.span.path == str(path)]
    return [
        f"{place}: {rule}"
        for place, rule in set(read) ^ {(line, plain(rule)) for line, rule in pack.rules}
    ]


def wrong_explanations(seed: int, folder: Path) -> list[str]:
    """Return the faults of the explanations of one pack."""
    rng = random.Random(seed)
    pack, path = random_pack(seed), folder / "p.lp"
    path.write_text(pack.text, encoding="utf-8", newline="")
    project = projects()[seed % len(projects())]
    rulebook = rulebook_with(path)
    wrong = misplaced(pack, rulebook, path)
    facts = tuple(project_facts(project))
    true = derived(rulebook, facts_text(facts))
    given = frozenset(symbol_of(fact.atom) for fact in facts)
    mine = {
        atom
        for atom in true - given
        if (f"{'' if atom.positive else '-'}{atom.name}", len(atom.arguments)) in pack.predicates
    }
    entries = {atom for atom in true if (atom.name, len(atom.arguments)) == ("consequence", 4)}
    analysis = analyse(facts, rulebook, project.configuration.span)
    found = {item.atom for item in analysis.consequences}
    wrong += [f"analysis: {atom}" for atom in found ^ entries]
    traces = Evidence(rulebook, facts, analysis).explainer.why(sorted(mine | entries))
    wrong += faults(traces.values(), given, true, pack.constants)
    wrong += [f"whole: {a}" for a, trace in traces.items() if not isinstance(trace, Derived)]
    context = (project, rulebook, given, true, pack.constants, wrong)
    for atom in rng.sample(sorted(mine), min(QUERIES, len(mine))):
        check_answer(str(atom), {str(atom)}, *context)
    by_name: dict[str, set[str]] = {}
    for item in entries:
        name = f"{item.arguments[0]}({shown(item.arguments[2])})"
        by_name.setdefault(name, set()).add(str(item))
    for name in rng.sample(sorted(by_name), min(QUERIES, len(by_name))):
        check_answer(name, by_name[name], *context)
    for atom in rng.sample(sorted(absent(pack, mine, project)), QUERIES):
        try:
            explain(Reasoner(project, rulebook), str(atom))
            wrong.append(f"explained: {atom}")
        except MarsError:
            pass
    return [f"{seed}: {each}" for each in wrong]


def absent(pack: Pack, mine: set[clingo.Symbol], project: Project) -> set[clingo.Symbol]:
    """Return atoms that are not derived: of a pack's predicates, and of their contraries."""
    names = [clingo.String(name.text) for name in project.configuration.modules]
    found = {clingo.Function("never", [name]) for name in names}
    found |= {clingo.Function(a.name, a.arguments, not a.positive) for a in mine}
    for name, arity in pack.predicates:
        for first in names:
            arguments = [first, *names[-1:]][:arity]
            found.add(clingo.Function(name.removeprefix("-"), arguments, name[0] != "-"))
    found |= {clingo.Function("never", [clingo.Number(n)]) for n in range(QUERIES)}
    return found - mine


def check_answer(
    subject: str,
    wanted: set[str],
    project: Project,
    rulebook: Rulebook,
    given: frozenset[clingo.Symbol],
    true: frozenset[clingo.Symbol],
    constants: tuple[str, ...],
    wrong: list[str],
) -> None:
    """Explain one subject as the command does, and note the faults of the answer."""
    try:
        topics = explain(Reasoner(project, rulebook), subject).topics
    except MarsError as error:
        wrong.append(f"refused: {subject}: {error.diagnostics[0].message}")
        return
    wrong += faults([topic.trace for topic in topics], given, true, constants)
    tops = {str(t.trace.atom) for t in topics if isinstance(t.trace, Derived)}
    if tops != wanted:
        wrong.append(f"asked for {subject}: {sorted(tops)} instead of {sorted(wanted)}")


@pytest.mark.parametrize("first", [2 * seed for seed in seeds(1, 100)])
def test_exactly_the_derived_atoms_are_explained(first: int, tmp_path: Path) -> None:
    results = [wrong_explanations(seed, tmp_path) for seed in range(first, first + 2)]
    assert [fault for faults_of_pack in results for fault in faults_of_pack] == []


HIDING = """\
% "An open string in a comment :- and more
ranked(M, C) :- %* priority(_, _) counts, not this: *% is_controlled_by(R, M, C), %* and
   more, *% priority(R, P), P > 1.
unranked(M, C) :- is_controlled_by(R, M, C), %* x :- *% not priority(R, _).
unstated(M, C) :- %* a *% is_controlled_by(R, M, C), not priority(R, _).
phrase("%* no comment :- ").
odd(M) :- module(M), phrase("%* no comment :- "), not ranked(M, _). % form \x0c feed, größer
consequence(%* c *% oddity, note, M, "%") :- odd(M).
marked(M, first; M, second) :- ranked(M, _).
"""
RANKED = """\
@configuration hierarchical
@modules Base, A, B
Base is_controlled_by A 1
Base is_controlled_by B 2
"""


@pytest.mark.parametrize(
    ("subject", "line"),
    [
        ('ranked("Base","B")', 2),
        ('ranked("Base","A")', None),
        # The line that states a priority was shown beside the denial of it.
        ('unranked("Base","A")', None),
        ('unstated("Base","A")', None),
        ('odd("A")', 7),
        ('odd("Base")', None),
        ("oddity(A)", 8),
        # The second element of a pool once had no proof.
        ('marked("Base",second)', 9),
    ],
)
def test_comments_and_strings_hide_nothing(subject: str, line: int | None, tmp_path: Path) -> None:
    pack = tmp_path / "hiding.lp"
    pack.write_text(HIDING, encoding="utf-8")
    project = load_project("ranked.mars", text=RANKED)
    if line is None:
        with pytest.raises(MarsError):
            explain(Reasoner(project, load_rulebook([pack])), subject)
    else:
        (topic,) = explain(Reasoner(project, load_rulebook([pack])), subject).topics
        assert isinstance(topic.trace, Derived)
        assert topic.trace.rule.span.line == line


def test_constants_of_packs_are_read_with_all_rules(tmp_path: Path) -> None:
    pack = tmp_path / "limits.lp"
    pack.write_text(
        "#const most = 1.\n%! id: limits/busy\n%! because: {S} feeds {N}\n"
        "consequence(busy, note, S, receivers) :- uses_data_from(_, _, S),"
        " N = #count { C : uses_data_from(_, C, S) }, N > most.\n"
    )
    project = load_project(str(ROOT / "examples" / "level0" / "config.mars"))
    topics = explain(Reasoner(project, load_rulebook([pack])), "busy(Runaway)").topics
    assert [topic.title for topic in topics] == ["busy(Runaway)"]


if __name__ == "__main__":
    how_many, first_seed = map(int, sys.argv[1:])
    began, faulty = time.monotonic(), 0
    with TemporaryDirectory() as temporary:
        for each in range(first_seed, first_seed + how_many):
            faults_of_pack = wrong_explanations(each, Path(temporary))
            faulty += bool(faults_of_pack)
            for one in faults_of_pack[:5]:
                print(one, flush=True)
    seconds = time.monotonic() - began
    print(f"{how_many} packs, {faulty} with faults, {seconds:.0f} s")
