"""What is explained from a slice is explained as from all rules and facts."""

import random
import re
from dataclasses import replace
from pathlib import Path

import clingo
import pytest

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.trace.document import trace_json
from mars_asp.exchange.dora import import_dora
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import ANNOTATIONS, WIRING
from mars_asp.reasoning.facts.vocabulary import vocabulary
from mars_asp.reasoning.findings import kinds_of
from mars_asp.reasoning.project import (
    Project,
    described,
    load_project,
    project_facts,
    project_lookup,
)
from mars_asp.reasoning.questions.behind import for_resolution, names_read
from mars_asp.reasoning.questions.evidence import Slice, slice_for
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Evidence, Reasoner
from tests.support.campaigns import sample, seeds
from tests.support.documents import ROOT
from tests.support.random_configurations import random_configuration

CONFIGURATIONS = sorted((ROOT / "examples").glob("*/config.mars"))
RULEBOOK = load_rulebook()
VOCABULARY = vocabulary(RULEBOOK)
KEYS = VOCABULARY.keys


def sliced(project: Project, subject: str, rulebook: Rulebook) -> Slice | None:
    """Return what a question needs of a project."""
    return slice_for(
        subject,
        rulebook,
        lambda names: project_facts(project, wanted=names),
        lambda names: project_lookup(project, names, vocabulary(rulebook)),
    )


@pytest.mark.parametrize("path", sample(CONFIGURATIONS, 3), ids=lambda path: path.parent.name)
def test_a_slice_explains_as_the_whole_does(path: Path) -> None:
    project = load_project(str(path))
    whole = explain(Reasoner(project, RULEBOOK))
    for topic in whole.topics[: len(whole.analysis.consequences)]:
        part = explain(Reasoner(project, RULEBOOK), topic.title)
        assert part.synthesis is None
        traces = [trace_json(found.trace) for found in part.topics if found.title == topic.title]
        assert trace_json(topic.trace) in traces


def test_a_slice_is_smaller_and_what_is_chosen_has_none() -> None:
    project = load_project(str(ROOT / "examples" / "level0" / "config.mars"))

    part = sliced(project, "data_divergence(Runaway)", RULEBOOK)
    assert part is not None
    assert len(part.facts) < len(project_facts(project)) / 10
    assert len(part.rulebook.rules) < len(RULEBOOK.rules) / 4
    assert sliced(project, 'splitter("Runaway",origin)', RULEBOOK) is None
    assert sliced(project, "DataSplitter1", RULEBOOK) is None
    assert sliced(project, "nothing(", RULEBOOK) is None


def test_the_resolution_needs_no_more_consequences_than_it_names() -> None:
    project = load_project(str(ROOT / "examples" / "level0" / "config.mars"))
    part = for_resolution(RULEBOOK)
    kinds = {kind for rule in part.rules for kind in kinds_of(rule) or ()}
    assert kinds == {"simple_inheritance", "similar_inheritance", "emergent_functionality"}
    facts = project_facts(project, wanted=names_read(part))
    assert len(facts) < len(project_facts(project)) * 0.7
    # A rule that reads consequences of any kind needs all of them.
    reader = RULEBOOK.by_id["resolve/data/splitter-copies"]
    text = "splitter(S, origin) :- consequence(K, _, S, _), data_kind(K)."
    rules = (*RULEBOOK.rules, replace(reader, text=text))
    part = for_resolution(replace(RULEBOOK, rules=rules))
    assert any("data_divergence" in (kinds_of(rule) or ()) for rule in part.rules)


#: What the configurations of the project leave out.
RARE = """\
@configuration flat period 50
@modules Eye, Lens, Reader, Wheel, Turn, Part
Reader uses_data_from Eye
Wheel is_controlled_by Turn 2 hold 300
Part is_controlled_by Turn allocation root
@module_start
@module_name Eye
@Sense RequestWhenReady
a::Image grab();
@module_end
@module_start
@module_name Lens
@Sense RequestWhenReady
b::Image grab();
@module_end
@module_start
@module_name Reader
@DataIn
void read(Image image, auto other);
@module_end
@module_start
@module_name Turn
@Guard
@ControlOut
Command turn();
@module_end
"""


IMPORTED = """\
@configuration hierarchical
@modules A, B
// imported from ros2
// A: not all topics read
// B: commands pass a twist_mux
B is_controlled_by A 1
"""


def test_facts_of_some_predicates_are_those_of_all(tmp_path: Path) -> None:
    rare = tmp_path / "rare.mars"
    rare.write_text(RARE)
    seen = set()
    saved = tmp_path / "saved.mars"
    saved.write_text(IMPORTED)
    paths = [*CONFIGURATIONS, *(ROOT / "tests" / "specifications").rglob("*.mars"), rare, saved]
    paths += [ROOT / "tests" / "mixed.mars", ROOT / "tests" / "swapped.mars"]
    dataflow = tmp_path / "dataflow.yml"
    (tmp_path / "c").touch()
    nodes = (
        "nodes:\n- id: a\n  path: ./a\n- id: b\n  path: ./b\n  build: make\n- id: c\n  path: ./c\n"
    )
    dataflow.write_text(nodes)
    foreign = described(import_dora([(dataflow.read_text(), str(dataflow))]), "")
    for project in (*(load_project(str(path)) for path in paths), foreign):
        facts = project_facts(project)
        for name in {fact.atom.name for fact in facts}:
            seen.add(name)
            wanted = tuple(fact for fact in facts if fact.atom.name == name)
            assert project_facts(project, wanted={name}) == wanted
    assert seen >= WIRING | ANNOTATIONS | {"closed_walk", "entangled", "spelt"}


def test_facts_are_found_one_by_one(tmp_path: Path) -> None:
    rare = tmp_path / "rare.mars"
    rare.write_text(RARE)
    for path in [*CONFIGURATIONS, ROOT / "tests" / "mixed.mars", rare]:
        project = load_project(str(path))
        facts = project_facts(project)
        lookup = project_lookup(project, {each.name for each in KEYS}, VOCABULARY)
        for fact in facts:
            name, arguments = fact.atom.name, fact.atom.arguments
            keys = KEYS[Signature(name, len(arguments))]
            for place in keys:
                value = arguments[place]
                assert fact in lookup.find(name, (place,), (value,))
                assert lookup.find(name, (place,), ("nobody",)) == ()
            every = tuple(range(len(arguments)))
            if keys:
                assert fact in lookup.find(name, every, arguments)
        assert sorted(lookup.facts, key=str) == sorted(facts, key=str)


def test_every_given_predicate_can_be_found() -> None:
    text = (ROOT / "rules" / "vocabulary.lp").read_text(encoding="utf-8")
    defined = re.findall(r"^#defined (\w+)/(\d+)\.", text, re.MULTILINE)
    derived = {signature for rule in RULEBOOK.rules for signature in rule.heads}
    # Kinds of nodes are stated by packs, not by a configuration.
    stated = {Signature("node_kind", 4)}
    found = {Signature(name, int(arity)) for name, arity in defined} - derived - stated
    assert found == set(KEYS)


#: Rules of all sorts, of which `even` cannot be told apart by what it needs.
PACK = """\
gets(A, B) :- uses_data_from(_, A, B).
gets(A, C) :- gets(A, B), uses_data_from(_, B, C).
lonely(M) :- module(M), not gets(M, _), not gets(_, M).
fan(S, N) :- gets(_, S), N = #count { C : gets(C, S) }.
heaviest(S, N) :- fan(S, N), N >= N' : fan(_, N').
climbs(S, 0) :- fan(S, _).
climbs(S, I + 1) :- climbs(S, I), fan(S, N), I < N.
asks(f(C, S), R) :- uses_data_from(R, C, S), not required_mode(R, _).
amount(C, N) :- asks(f(C, _), _), N = #sum { R : asks(f(C, _), R) ; 1, x : lonely(C) }.
served_all(S) :- gets(_, S), amount(C, _) : gets(C, S).
hears_of(A ; B) :- gets(A, B), not amount(B, _).
beside(R, R') :- uses_data_from(R, _, _), R' = R - 1..R + 1, uses_data_from(R', _, _), R != R'.
-quiet(M) :- gets(M, _).
quiet(M) :- module(M), not -quiet(M).
akin(A, B) :- class(A, K), class(B, K), A != B, not gets(A, B).
flatly(M) :- architecture(flat), module(M), not is_controlled_by(_, M, _).
even(A) :- uses_data_from(_, A, B), not even(B).
%! id: sorts/alarm
%! because: {M} and {N}
consequence(sorts_alarm, warning, M, f(N)) :- fan(M, N), not served_all(M).
%! id: sorts/number
%! because: {R}
consequence(sorts_number, note, R, near) :- beside(R, R'), not asks(_, R).
%! id: sorts/term
%! because: {C}
consequence(sorts_term, note, f(C, S), x) :- asks(f(C, S), _), not gets(S, C).
"""


def test_every_atom_is_explained_from_what_it_needs(tmp_path: Path) -> None:
    pack = tmp_path / "sorts.lp"
    pack.write_text(PACK)
    # Taken as rules of our own: with a pack that negates itself nothing is sliced.
    rulebook = replace(load_rulebook([pack]), packs=0)
    names = {signature for rule in rulebook.rules for signature in rule.heads}
    projects = [load_project(str(path)) for path in sample(CONFIGURATIONS, 2)]
    projects += [load_project("random.mars", text=random_configuration(s)) for s in seeds(1, 6)]
    fewer = 0
    for number, project in enumerate(projects):
        facts = project_facts(project)
        analysis = analyse(facts, rulebook, project.configuration.span)
        atoms = [
            atom.symbol
            for atom in analysis.grounding.control.symbolic_atoms
            if atom.is_fact and signature_of(atom.symbol) in names
        ]
        whole = Evidence(rulebook, facts, analysis).explainer
        rng = random.Random(number)
        asked = [(str(atom), {atom}) for atom in rng.sample(atoms, min(4, len(atoms)))]
        of_kinds: dict[str, set[clingo.Symbol]] = {}
        for told in analysis.consequences:
            of_kinds.setdefault(f"{told.kind}({told.subject})", set()).add(told.atom)
        asked += rng.sample(sorted(of_kinds.items()), min(2, len(of_kinds)))
        for subject, wanted in asked:
            part = sliced(project, subject, rulebook)
            assert part is not None
            found = analyse(part.facts, part.rulebook, project.configuration.span, subject)
            if subject in of_kinds:
                assert {told.atom for told in found.consequences} == wanted
            explainer = Evidence(part.rulebook, part.facts, found).explainer
            traces, expected = explainer.why(wanted, True), whole.why(wanted, True)
            for atom in wanted:
                assert trace_json(traces[atom]) == trace_json(expected[atom]), subject
            fewer += len(part.facts) < len(facts) / 2
    assert fewer > 40


#: What leaves just one answer, whatever it is about.
STRATIFIED = """\
#show gets/2.
#defined far/1.
gets(A, B) :- uses_data_from(_, A, B).
gets(A, C) :- gets(A, B), uses_data_from(_, B, C).
lonely(M) :- module(M), not gets(M, _), not gets(_, M), not far(M).
%! id: stratified/many
%! because: `{S}` serves {N}
consequence(many, note, S, 0) :- module(S), N = #count { C : gets(C, S) }, N > 1.
consequence(K, note, M, odd) :- lonely(M), kind_of_oddity(K).
kind_of_oddity(data_divergence).
"""


def test_packs_that_have_one_answer_are_sliced(tmp_path: Path) -> None:
    pack = tmp_path / "stratified.lp"
    pack.write_text(STRATIFIED)
    rulebook = load_rulebook([pack])
    fewer = 0
    for path in sample(CONFIGURATIONS, 3):
        project = load_project(str(path))
        count = len(project_facts(project))
        whole = explain(Reasoner(project, rulebook))
        told = whole.topics[: len(whole.analysis.consequences)]
        # The pack adds to these; of the others, which it says nothing of, one in six.
        own = [topic for topic in told if topic.title.startswith(("many(", "data_divergence("))]
        for topic in dict.fromkeys([*own, *told[::6]]):
            part = sliced(project, topic.title, rulebook)
            assert part is not None
            fewer += len(part.facts) < count / 2
            found = explain(Reasoner(project, rulebook), topic.title)
            assert found.synthesis is None
            traces = [trace_json(t.trace) for t in found.topics if t.title == topic.title]
            assert trace_json(topic.trace) in traces
    assert fewer > 3


@pytest.mark.parametrize(
    "rules",
    [
        ":- module(_).",
        "{ odd(M) } :- module(M).",
        "odd(M) ; even(M) :- module(M).",
        "odd(M) :- module(M), not even(M). even(M) :- module(M), not odd(M).",
        "odd(N) :- N = #count { M : odd(M) }.",
        "odd(M) :- module(M). -odd(M) :- module(M).",
        "#const most = 1. odd(M) :- module(M).",
        "odd(M) :- module(M). odd(2 * N) :- odd(N).",
    ],
)
def test_other_packs_are_not(tmp_path: Path, rules: str) -> None:
    pack = tmp_path / "other.lp"
    pack.write_text(rules + "\n")
    project = load_project(str(ROOT / "examples" / "level0" / "config.mars"))
    assert sliced(project, "data_divergence(Runaway)", RULEBOOK) is not None
    assert sliced(project, "data_divergence(Runaway)", load_rulebook([pack])) is None


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
