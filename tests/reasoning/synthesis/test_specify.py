"""Atoms of `rules/specify` equal the facts of the printed text, also for `rules/verify`."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import clingo
import pytest

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules.read import read_rules
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.term_ids import as_symbol, atoms
from mars_asp.asp.trace import Derived
from mars_asp.diagnostic import Diagnostic
from mars_asp.language import parse_text, print_configuration
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis import derived as of_rules
from mars_asp.reasoning.synthesis.synthesise import Synthesis
from mars_asp.reasoning.verification import specification_facts
from tests.support.campaigns import seeds
from tests.support.random_configurations import (
    random_configuration,
    random_control,
    random_mounts,
    random_twins,
)

RULEBOOK = load_rulebook(stages=("resolve", "verify"))
MAKERS = (random_configuration, random_control, random_mounts, random_twins)
#: Predicates of the properties of a relationship, after its two ends.
DATA = ("spec_uses_data_from", "spec_required_mode", "spec_required_rate")
CONTROL = ("spec_is_controlled_by", "spec_priority", "spec_hold", "spec_allocation")
NODES = ("spec_node", "spec_converts", "spec_converter", "spec_stands_for")


def resolved(text: str, rulebook: Rulebook = RULEBOOK) -> tuple[Reasoner, Synthesis | None]:
    reasoner = Reasoner(Project(parse_text(text, "c.mars").configuration, {}, ()), rulebook)
    return reasoner, reasoner.synthesis


def derived_atoms(derived: of_rules.SpecifiedAtoms) -> Iterator[clingo.Symbol]:
    grounding = Grounding(())
    derived.hand_to(grounding)
    for signature in derived.predicates:
        yield from map(as_symbol, atoms(grounding.control, *signature))


def named(synthesis: Synthesis) -> Iterator[clingo.Symbol]:
    """Yield the derived atoms with names of nodes in place of their terms."""
    nodes = {clingo.parse_term(n.term): n.name for n in synthesis.specification.nodes}

    def name_of(term: clingo.Symbol) -> clingo.Symbol:
        return clingo.String(nodes[term]) if term in nodes else term

    for atom in derived_atoms(synthesis.derived):
        # The id of a relationship may equal the term of a node, but is not its name.
        line = atom.name in (*DATA, *CONTROL)
        kept, rest = atom.arguments[:line], atom.arguments[line:]
        yield clingo.Function(atom.name, [*kept, *map(name_of, rest)])


def lines(atoms: Iterable[clingo.Symbol], predicates: tuple[str, ...]) -> Counter[str]:
    """Return lines by their ends and all that they state."""
    found: dict[clingo.Symbol, list[str]] = {}
    for atom in atoms:
        if atom.name in predicates:
            line, *rest = atom.arguments
            found.setdefault(line, []).append(f"{atom.name}{[str(each) for each in rest]}")
    return Counter(" ".join(sorted(parts)) for parts in found.values())


@pytest.mark.parametrize("make", MAKERS)
@pytest.mark.parametrize("seed", seeds(2, 40))
def test_a_printed_specification_has_the_derived_facts(
    make: Callable[[int], str], seed: int
) -> None:
    reasoner, synthesis = resolved(make(seed))
    if synthesis is None:
        return
    text = print_configuration(synthesis.specification.configuration)
    printed = parse_text(text, "s.mars").configuration
    # The module of an InheritanceNode is printed only if it cannot be inferred.
    printed = replace(printed, stand_ins=synthesis.specification.configuration.stand_ins)
    facts = [symbol(fact) for fact in specification_facts(printed, reasoner.project, RULEBOOK)]
    derived = list(named(synthesis))
    assert lines(derived, DATA) == lines(facts, DATA)
    assert lines(derived, CONTROL) == lines(facts, CONTROL)
    assert {str(a) for a in derived if a.name in NODES} == {
        str(a) for a in facts if a.name in NODES
    }


def symbol(fact: Fact) -> clingo.Symbol:
    return clingo.parse_term(str(fact.atom))


def violations(reasoner: Reasoner, atoms: Iterable[clingo.Symbol]) -> set[str]:
    """Return the faults of a specification that atoms describe."""
    configuration = reasoner.project.configuration
    kept = replace(configuration, kind="specification", relationships=())
    facts = facts_text(specification_facts(kept, reasoner.project, RULEBOOK))
    mounts = "spec_is_mounted_on(R, M, V, B, W) :- is_mounted_on(R, M, V, B, W)."
    program = [RULEBOOK.text("verify"), facts, mounts, *(f"{atom}." for atom in atoms)]
    grounding = reasoner._analyse().grounding
    grounding.derive([Fragment("\n".join(program), "rules")])
    return set(map(str, grounding.symbols("violation", 2)))


@pytest.mark.parametrize("make", MAKERS)
@pytest.mark.parametrize("seed", seeds(1, 20))
def test_derived_atoms_pass_verification(make: Callable[[int], str], seed: int) -> None:
    reasoner, synthesis = resolved(make(seed))
    if synthesis is None:
        return
    derived = list(derived_atoms(synthesis.derived))
    assert violations(reasoner, derived) == set()
    # Without any of its lines it realises the configuration no longer.
    for name in ("spec_uses_data_from", "spec_is_controlled_by"):
        for line in [atom for atom in derived if atom.name == name][:2]:
            assert violations(reasoner, [atom for atom in derived if atom != line])


#: A rule pack that adds a recorder for the data that a DataSplitter copies.
RECORDER = """
%! id:      specify/recorder/node
%! because: a recorder keeps what `{S}` delivers
spec_node(recorder(S), flight_recorder) :- splitter(S, origin).
spec_uses_data_from(recorder(S), recorder(S), splitter(S, origin)) :- splitter(S, origin).
spec_required_mode(recorder(S), mode("NotifyWhenReady", "")) :- splitter(S, origin).
written_at(recorder(S), R) :- splitter(S, origin), link(R, _, S).
"""


def test_rules_can_bring_a_kind_of_node_that_python_does_not_know() -> None:
    problems: list[Diagnostic] = []
    file = read_rules(RECORDER, "recorder.lp", "specify", problems)
    assert file is not None
    assert not problems
    more = Rulebook(
        (*RULEBOOK.rules, *file.rules),
        (*RULEBOOK.texts, ("specify", RECORDER)),
        paths=(*RULEBOOK.paths, "recorder.lp"),
    )
    names = "@modules S, A, B, FlightRecorder1"
    text = f"@configuration flat\n{names}\nA uses_data_from S\nB uses_data_from S\n"
    reasoner, synthesis = resolved(text, more)
    assert synthesis is not None
    printed = print_configuration(synthesis.specification.configuration)
    assert "FlightRecorder2 uses_data_from DataSplitter1 NotifyWhenReady\n" in printed
    topics = {topic.title: topic.trace for topic in explain(reasoner, only="nodes").topics}
    assert set(topics) == {"DataSplitter1 resolves data_divergence(S)", "FlightRecorder2"}
    trace = topics["FlightRecorder2"]
    assert isinstance(trace, Derived)
    assert trace.message == "a recorder keeps what `S` delivers"
