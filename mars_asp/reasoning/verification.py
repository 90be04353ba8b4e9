"""Does a specification realise a configuration: facts of both, judged by `rules/verify`."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import clingo

from mars_asp.annotations.representations import RepresentationNames, canonical_names
from mars_asp.asp.fragments import Fragment
from mars_asp.asp.messages import rendered_messages, saying
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, plain
from mars_asp.asp.solve.atoms import Atom, Fact, fact_at
from mars_asp.asp.solve.grounding import Grounding, Resolution
from mars_asp.asp.solve.term_ids import arguments, as_symbol
from mars_asp.asp.trace import Derived, Explainer, Given
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.asp.trace.text import steps_of
from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.language.print import print_transformation
from mars_asp.model.declarations import Configuration, Data, Module, Mount, Transformation
from mars_asp.model.described import described_modules
from mars_asp.model.ports import free_positions, input_position
from mars_asp.model.transformation import normalized
from mars_asp.reasoning.facts.compile import (
    FactNaming,
    configuration_facts,
    given,
    representation_names,
    representations,
)
from mars_asp.reasoning.facts.descriptions import description_facts, instance_facts
from mars_asp.reasoning.facts.ends import ends_of_specification
from mars_asp.reasoning.facts.identifiers import numbered
from mars_asp.reasoning.facts.vocabulary import given_in
from mars_asp.reasoning.findings import FIRST_CLAUSE, MEANINGS, VIOLATION
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.synthesis.line_inputs import state_inputs
from mars_asp.reasoning.synthesis.synthesise import costs_of

_CAUTION = Signature("caution", 1)
_STAGE = "verify"
#: A violation of a clause, and a location that shows it.
_DIFFERS_AT = "differs_at"
_CONVERTERS = frozenset({"converts"})
#: The prefix of the predicates of facts about a specification.
_OF_SPECIFICATION = "spec_"
#: The rule is about the side line that its first argument identifies, and cites no location.
_COMMANDS_ASIDE = Signature("aside_commands", 2)


@dataclass(frozen=True, slots=True)
class Violation:
    """A violated clause of the definition of `realises`; `head` is the atom that a rule derives.

    `locations` are those of the difference, or of the lines that the violation rests on: in the
    specification, then in the configuration.
    """

    clause: int
    message: str
    help: str | None
    rule: Rule
    head: clingo.Symbol
    locations: tuple[Span, ...] = ()


@dataclass(frozen=True, slots=True)
class Caution:
    """A difference from the configuration that does not violate a clause."""

    message: str
    help: str | None
    rule: Rule


@dataclass(frozen=True)
class Verification:
    """Violations, sorted by clause, cautions, and the grounding that contains both."""

    violations: tuple[Violation, ...]
    cautions: tuple[Caution, ...]
    grounding: Grounding


def verify(
    specification: Configuration,
    project: Project,
    rulebook: Rulebook,
    grounding: Grounding | None = None,
) -> tuple[Violation, ...]:
    """Return the violations that keep a specification from realising a configuration.

    `rulebook` contains the stage `verify`; `grounding` is that of the project's analysis, if there
    is one.

    Raises:
        MarsError: rules that clingo refuses.
    """
    return judge_specification(specification, project, rulebook, grounding).violations


def judge_specification(
    specification: Configuration,
    project: Project,
    rulebook: Rulebook,
    grounding: Grounding | None = None,
    modules: Mapping[str, Module] | None = None,
    cited: bool = False,
) -> Verification:
    """Return the violations and cautions of a specification, with their grounding.

    `modules` are the ones that the specification's own sources describe. The result rests on facts
    and built-in rules alone. The findings of packs are added; the grounding is then that of the
    built-in rules. With `cited`, each violation has the locations of the lines that it rests on.

    Raises:
        MarsError: rules that clingo refuses.
    """
    own = [rule for rule in rulebook.of_packs if rule.stage == _STAGE and _is_judge(rule)]
    with_packs = bool(rulebook.packs)
    described = project.configuration.with_declared(project.modules)
    specification = state_inputs(specification, described, rulebook)
    facts = tuple(specification_facts(specification, project, rulebook, modules or {}))
    fragment = given(facts)
    every = rulebook.built_in
    found = _judged_by(fragment, project, every, None if with_packs else grounding, None)
    if cited:
        found = _with_lines(found, specification, facts, project, every)
    if not own:
        return found
    # Packs add findings, and remove none.
    more = _judged_by(fragment, project, rulebook, None, own)
    if cited:
        more = _with_lines(more, specification, facts, project, rulebook)
    return Verification(
        tuple(sorted({*found.violations, *more.violations}, key=lambda v: (v.clause, v.message))),
        (*found.cautions, *more.cautions),
        found.grounding,
    )


def _clause(head: clingo.Symbol, rule: Rule) -> int:
    """Return the number of the violated clause.

    Raises:
        MarsError: the first argument of a rule pack's violation is not a number.
    """
    if head.arguments[0].type == clingo.SymbolType.Number:
        return head.arguments[0].number
    message = f"`{head.arguments[0]}` is not the number of a clause"
    advice = f"number the clauses of a pack from {FIRST_CLAUSE} on"
    raise MarsError((Diagnostic("rule-clause", "error", message, rule.span, help=advice),))


def _is_judge(rule: Rule) -> bool:
    return rule.derives(VIOLATION) or rule.derives(_CAUTION)


def _judged_by(
    facts: Fragment,
    project: Project,
    rulebook: Rulebook,
    grounding: Grounding | None,
    judges: Sequence[Rule] | None,
) -> Verification:
    """Return the violations and cautions that rules find; `judges` restricts the rules."""
    if judges is None:
        judges = [rule for rule in rulebook.rules if _is_judge(rule)]
    judging = [*rulebook.fragments(_STAGE), *saying(_STAGE, judges), facts]
    if grounding is None:
        base = rulebook.fragments("base")
        grounding = Grounding([*base, *judging, given(project_facts(project))])
    else:
        grounding.derive(judging)
    locations = {
        clingo.Function("violation", [clingo.Number(0), what]): tuple(
            point(path.string, line.number, column.number)
            for path, line, column in (place.arguments for place in places)
        )
        for what, *places in (s.arguments for s in grounding.symbols(_DIFFERS_AT, 3))
    }
    violations: dict[tuple[int, str], Violation] = {}
    cautions: dict[str, Caution] = {}
    for item in rendered_messages(grounding.control, _STAGE, judges):
        head = as_symbol(item.head)
        message = item.message or plain(str(head))
        if item.rule.derives(_CAUTION):
            cautions[message] = Caution(message, item.help, item.rule)
        else:
            clause = _clause(head, item.rule)
            shown = locations.get(head, ())
            violations[clause, message] = Violation(
                clause, message, item.help, item.rule, head, shown
            )
    return Verification(
        tuple(violations[key] for key in sorted(violations)),
        tuple(cautions[key] for key in sorted(cautions)),
        grounding,
    )


def _with_lines(
    found: Verification,
    specification: Configuration,
    facts: Sequence[Fact],
    project: Project,
    rulebook: Rulebook,
) -> Verification:
    """Return a verification whose violations have locations: lines of relationships, if any."""
    if all(each.locations for each in found.violations):
        return found
    known = GivenFacts((*project_facts(project), *facts), rulebook.declarations)
    explainer = Explainer(rulebook, found.grounding.control, known)
    traces = explainer.why(each.head for each in found.violations if not each.locations)
    lines = dict(numbered(specification.relationships))
    both = (*specification.relationships, *project.configuration.relationships)
    order = {line.span: number for number, line in enumerate(both)}

    def located(violation: Violation) -> Violation:
        places: dict[Span, None] = dict.fromkeys(violation.locations)
        for step in steps_of(traces[violation.head], MEANINGS) if not places else ():
            if isinstance(step, Given) and step.span is not None:
                places[step.span] = None
            elif isinstance(step, Derived) and step.rule.derives(_COMMANDS_ASIDE):
                places[lines[as_symbol(arguments(step.head)[0]).number].span] = None
        lines_of_both = sorted((place for place in places if place in order), key=order.__getitem__)
        return replace(violation, locations=tuple(lines_of_both or places))

    return replace(found, violations=tuple(map(located, found.violations)))


def written_cost(
    verification: Verification,
    project: Project,
    rulebook: Rulebook,
    deadline: float | None = None,
) -> Resolution:
    """Return the cost of a specification without violations, by the levels of the minimisation.

    `rulebook` contains the stage `cost`; `deadline` is a time of `time.monotonic`.

    Raises:
        TimeoutError: the deadline passed before a converter was found for each transformer.
        MarsError: the sum of the costs of converters is too large.
    """
    with costs_of(project_facts(project, wanted=_CONVERTERS)):
        return verification.grounding.resolve(rulebook.fragments("cost"), deadline)


def specification_facts(
    specification: Configuration,
    project: Project,
    rulebook: Rulebook,
    modules: Mapping[str, Module] | None = None,
) -> Iterator[Fact]:
    """Yield the facts of a specification, each predicate under a name that begins with `spec_`.

    Of the predicates of configurations, these are the ones that `verify` declares with the prefix.
    Further facts are the tuples and descriptions of the project's configuration, which no other
    stage reads. `modules` are the ones that the specification's own sources describe.
    """
    described = project.described
    every = specification.with_declared(modules or {})
    own = described_modules(specification, every)
    # A converter without conversions in the specification still belongs to the configuration.
    own = {**own, **{name: every[name] for name in described if name in every}}
    naming = FactNaming(
        ends_of_specification(project.configuration, described, specification),
        project.rates,
        _shared_names(specification, own, project),
    )
    # The names of facts that configurations and specifications both have.
    base, judged = set(given_in(rulebook, "base")), given_in(rulebook, "verify")
    given = (each._replace(name=each.name.removeprefix(_OF_SPECIFICATION)) for each in judged)
    wanted = frozenset(each.name for each in given if each in base)
    for fact in configuration_facts(specification, own, wanted, naming):
        name = f"{_OF_SPECIFICATION}{fact.atom.name}"
        yield Fact(Atom(name, fact.atom.arguments), fact.span)
    yield from _positions(specification, project)
    yield from mount_tuples("mount_tuple", project.configuration)
    yield from mount_tuples(f"{_OF_SPECIFICATION}mount_tuple", specification)
    canonical = naming.names.canonical
    for each in specification.conversions:
        ends = (canonical[name] for name in (each.source, each.target))
        yield fact_at(each.span, "spec_converts", each.transformer, *ends)
        if each.converter is not None:
            yield fact_at(each.span, "spec_converter", each.transformer, each.converter)
    for stand_in in specification.stand_ins:
        yield fact_at(stand_in.span, "spec_stands_for", stand_in.node, stand_in.module)
    yield from instance_facts(_OF_SPECIFICATION, specification, {})
    yield from instance_facts("", project.configuration, described)
    yield from description_facts(_OF_SPECIFICATION, own, canonical)
    # Descriptions are compared only if both files have them.
    if own:
        yield from description_facts("", described, canonical)


def _positions(specification: Configuration, project: Project) -> Iterator[Fact]:
    """Yield the positions of the inputs of undescribed clients, in lines of both files.

    Only clients with an input that a line of the specification names by its position are included.
    """
    described = project.described
    clients = set()
    for number, line in numbered(specification.relationships):
        if isinstance(line, Data) and line.client_port and line.client not in described:
            if at := input_position(line.client_port):
                clients.add(line.client)
                yield Fact(Atom("spec_position", (number, at)), line.span)
    lines: dict[str, list[Data]] = {client: [] for client in clients}
    numbers = {id(line): number for number, line in numbered(project.configuration.relationships)}
    for line in project.configuration.relationships:
        if isinstance(line, Data) and line.client in clients:
            lines[line.client].append(line)
    for each in lines.values():
        free = free_positions(line.client_port for line in each)
        known: dict[Hashable, int] = {}
        for line in each:
            if line.client_port is None:
                # A line that is stated again shares its input.
                key = line.source, line.source_port, line.mode, line.hz
                at = known[key] if key in known else known.setdefault(key, next(free))
                yield Fact(Atom("position_of", (numbers[id(line)], at)), line.span)


def mount_tuples(predicate: str, configuration: Configuration) -> Iterator[Fact]:
    """Yield the pose at which each mount places its module; equal poses have equal texts."""
    for number, line in numbered(configuration.relationships):
        if isinstance(line, Mount):
            pose = normalized(line.transformation or Transformation())
            yield Fact(Atom(predicate, (number, print_transformation(pose))), line.span)


def _shared_names(
    specification: Configuration, own: Mapping[str, Module], project: Project
) -> RepresentationNames:
    """Return the representations of both files, with the names that the project's rules use."""
    declared = representation_names(project.configuration, project.modules).canonical
    comments = [name for c in specification.conversions for name in (c.source, c.target)]
    together = canonical_names([*declared, *comments, *representations(own.values())])
    known = {together.canonical[name]: canonical for name, canonical in declared.items()}
    full = together.canonical.items()
    return RepresentationNames(
        {name: known.get(longest, longest) for name, longest in full}, together.ambiguous
    )
