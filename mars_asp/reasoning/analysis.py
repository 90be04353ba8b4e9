"""The consequences that the rules derive from a configuration, with their messages and locations.

Nothing is decided here: a consequence is an atom `consequence(Kind, Severity, Subject, Case)` of
the answer set, its message the metadata of the rule that derives it.
"""

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import TypeAlias

import clingo

from mars_asp.asp.fragments import Fragment, fact_fragment
from mars_asp.asp.messages import (
    RenderedMessage,
    check_decided,
    labelling,
    labels,
    rendered_messages,
    saying,
    written,
)
from mars_asp.asp.rules.arithmetic import telling, wrapped
from mars_asp.asp.rules.consistency import check_packs
from mars_asp.asp.rules.expansions import Label
from mars_asp.asp.rules.expansions import labels as labels_above
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.asp.solve.grounding import Grounding, unsolved
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, as_term, atoms, text
from mars_asp.diagnostic import Diagnostic, MarsError, Severity, Span
from mars_asp.model.graph import OPEN_BRANCH, OPEN_CONDITION
from mars_asp.output import brief_repr
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.findings import (
    CONSEQUENCE,
    EXPANSIONS,
    SEVERITIES,
    check_severities,
)

#: Kind, subject and case of a consequence.
Key: TypeAlias = tuple[TermId, TermId, TermId]
#: The severity of consequences that are neither warnings nor errors.
_NOTE = as_term(clingo.Function("note"))
_STAGE = "base"
#: At most this many launch trees are named in a text; JSON has all.
_MOST_TREES = 3


@dataclass(frozen=True, slots=True)
class LaunchCondition:
    """A launch argument that must have a value; with `how` equal to `unless`, must not have it.

    `span` is the location in the launch file that states the condition.
    """

    variable: str
    value: str
    how: str
    span: Span | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Consequence:
    """One consequence; `spans` are the locations that it concerns, in the order of the file.

    `labels` are sentences about some of these locations, if the analysis has labels; `effect` is
    the effect on the robot; `trees` are the launch files in which the consequence holds.

    >>> found = load("examples/level0/config.mars").analyse().consequences[0]
    >>> found.kind, found.subject, found.spans[0].line
    ('data_divergence', 'SonarMap', 6)
    """

    __repr__ = brief_repr

    kind: str
    severity: Severity
    subject: str
    participants: tuple[str, ...]
    message: str
    help: str | None
    rule: Rule
    spans: tuple[Span, ...]
    atom: clingo.Symbol
    labels: tuple[tuple[Span, str], ...] = ()
    effect: str | None = None
    trees: tuple[str, ...] = ()
    conditions: tuple[LaunchCondition, ...] = ()
    #: Whether the conditions hold with the stated defaults of the launch arguments.
    is_usual: bool = False
    #: Whether it holds in one launch file of several.
    is_of_one_tree: bool = False


@dataclass(frozen=True, repr=False)
class Analysis:
    """The consequences and other atoms that the rules derive from facts.

    `speakers` are the rules that derive consequences; `grounding` contains all derived atoms.

    Consequences are read from the grounding on first use, as not every question needs them.

    >>> analysis = load("examples/level0/config.mars").analyse()
    >>> analysis.has_errors, len(analysis.consequences)
    (False, 3)
    """

    __repr__ = brief_repr

    grounding: Grounding
    facts: tuple[Fact, ...]
    speakers: tuple[Rule, ...]
    #: The location of a consequence that concerns no line.
    configuration: Span
    #: The labels of the rules for locations of findings; empty unless requested.
    labelled: tuple[tuple[Rule, Label], ...] = ()

    @cached_property
    def consequences(self) -> tuple[Consequence, ...]:
        """Return the consequences, sorted by location."""
        return read_consequences(self)

    @cached_property
    def unchecked(self) -> tuple[str, ...]:
        """Return the modules that nothing describes, which are therefore not checked."""
        symbols = self.grounding.symbols("unchecked", 1)
        return tuple(sorted(symbol.arguments[0].string for symbol in symbols))

    @cached_property
    def has_errors(self) -> bool:
        """Whether any consequence has the severity error."""
        severities = {arguments(a)[1] for a in atoms(self.grounding.control, *CONSEQUENCE)}
        return any(_severity(severity) == "error" for severity in severities)


@lru_cache(maxsize=64)
def _speakers(rulebook: Rulebook) -> tuple[Rule, ...]:
    """Return the rules that derive consequences."""
    return tuple(rule for rule in rulebook.rules if rule.derives(CONSEQUENCE))


def analyse(
    facts: Iterable[Fact],
    rulebook: Rulebook,
    configuration: Span,
    with_labels: bool = False,
) -> Analysis:
    """Return the consequences that the rules derive from facts.

    `configuration` is the location of a consequence that concerns no line. `with_labels` adds the
    sentences of the rules about each location of a finding.

    Raises:
        MarsError: clingo refuses the rules, rule packs exclude every answer, or a severity is
            unknown.
    """
    facts = tuple(facts)
    speakers = _speakers(rulebook)
    queries = [
        Fragment(telling(at, each), "rules", each.span)
        for at, each in enumerate(rulebook.arithmetic)
    ]
    labelled = tuple(
        (rule, label)
        for rule in (speakers if with_labels else ())
        for label in labels_above(rule, EXPANSIONS)
    )
    text = facts_text(facts)
    program = [
        *rulebook.fragments("base"),
        *saying(_STAGE, speakers),
        *labelling(_STAGE, labelled),
        *queries,
        fact_fragment(text, {fact.atom.name for fact in facts}),
    ]
    try:
        grounding = Grounding(program)
    except MarsError as error:
        raise _all_wrong(error, program, rulebook) from None
    overflowing = tuple(wrapped(grounding.control, rulebook.arithmetic))
    if overflowing:
        raise MarsError(overflowing)
    check_packs(grounding.control, rulebook, text, "consequence/4")
    if rulebook.packs:
        check_decided(grounding.control, _STAGE, speakers)
    check_severities(rendered_messages(grounding.control, _STAGE, speakers))
    return Analysis(grounding, facts, speakers, configuration, labelled)


def _all_wrong(error: MarsError, program: Sequence[Fragment], rulebook: Rulebook) -> MarsError:
    """Return the error, with overflowing numbers in place of clingo's messages if any.

    For a sum over chosen atoms, clingo only reports that the sum is too large.
    """
    if not rulebook.arithmetic:
        return error
    overflowing = tuple(wrapped(unsolved(program), rulebook.arithmetic))
    placed = (each for each in error.diagnostics if each.code == "rule-undefined")
    return MarsError((*overflowing, *placed)) if overflowing else error


def read_consequences(
    analysis: Analysis, participants: bool = True, notes: bool = True
) -> tuple[Consequence, ...]:
    """Return the consequences, sorted by location, without caching them.

    `participants` also reads the participants of each consequence, and `notes` includes those with
    the severity `note`.
    """
    control = analysis.grounding.control
    first = _first_messages(analysis)
    if not notes:
        first = {head: item for head, item in first.items() if arguments(head)[1] != _NOTE}
    keys = {
        head: (kind, about, case)
        for head, (kind, _, about, case) in ((head, arguments(head)) for head in first)
    }
    wanted = set(keys.values())
    part_of = _collect(control, ("participant", 5), wanted) if participants else {}
    concerned = _collect(control, ("concerns", 4), wanted)
    trees = _collect(control, ("holds_in", 4), wanted)
    conditions = _conditions(analysis, wanted)
    usual = _collect(control, ("by_default", 3), wanted)
    launched = {f.atom.arguments[1] for f in analysis.facts if f.atom.name == "launched"}
    has_several = len(launched) > 1
    span_of = locations(analysis.facts)
    labels_of: dict[TermId, dict[Span, str]] = {}
    for label in labels(control, _STAGE, analysis.labelled) if analysis.labelled else ():
        if label.term in span_of:
            labels_of.setdefault(label.head, {}).setdefault(span_of[label.term], label.text)
    # A few terms occur in very many consequences.
    write = cache(text)
    consequences = []
    for head, key in keys.items():
        kind, severity, about, _ = arguments(head)
        item = first[head]
        label_at = labels_of.get(head, {})
        found = {span_of.get(row[0]) for row in concerned.get(key, ())}
        # Locations with a label come after the unlabelled ones.
        places = sorted((span in label_at, span) for span in found if span is not None)
        consequences.append(
            Consequence(
                write(kind),
                _severity(severity),
                written(about),
                _unique_texts(part_of.get(key, ())),
                item.message or str(as_symbol(head)),
                item.help,
                item.rule,
                tuple(span for _, span in places) or (analysis.configuration,),
                as_symbol(head),
                tuple(label_at.items()),
                item.effect,
                tuple(sorted(written(row[0]) for row in trees.get(key, ()))),
                tuple(conditions.get(key, ())),
                key in usual,
                len(trees.get(key, ())) == 1 and has_several,
            )
        )
    consequences.sort(key=lambda c: (c.spans[0], c.kind, c.subject, c.message))
    return tuple(consequences)


def findings(analysis: Analysis) -> tuple[Diagnostic, ...]:
    """Return the warnings and errors, sorted by location."""
    return tuple(map(diagnostic, read_consequences(analysis, participants=False, notes=False)))


def diagnostic(consequence: Consequence) -> Diagnostic:
    """Return a consequence as a diagnostic at its first location, labelled at the others."""
    label_at = dict(consequence.labels)
    return Diagnostic(
        consequence.rule.id,
        consequence.severity,
        consequence.message,
        consequence.spans[0],
        tuple((span, label_at.get(span, "")) for span in consequence.spans[1:]),
        consequence.help,
        effect=" ".join(filter(None, (consequence.effect, *_where(consequence)))) or None,
        kind=consequence.kind,
        launch_files=consequence.trees,
    )


def _where(consequence: Consequence) -> Iterator[str]:
    """Yield the conditions of a finding as text and, if it holds in several launch trees, these."""
    if consequence.conditions:
        texts = " and ".join(map(_condition_text, consequence.conditions))
        usual = ", as it is by default" if consequence.is_usual else ""
        yield f"It is so when {texts}{usual}."
    if consequence.is_of_one_tree:
        yield f"It holds in the launch file `{consequence.trees[0]}`."
    if len(consequence.trees) > 1:
        named = [f"`{tree}`" for tree in consequence.trees[:_MOST_TREES]]
        more = len(consequence.trees) - _MOST_TREES
        last = f"{more} more" if more > 0 else named.pop()
        yield f"It holds in {len(consequence.trees)} launch files: {', '.join(named)} and {last}."


def _condition_text(condition: LaunchCondition) -> str:
    """Return a condition as ```use_composition` is `true` (robot.launch.py:206)``."""
    name = condition.variable
    if name.startswith(OPEN_CONDITION):
        verb = "holds" if condition.how == "if" else "does not hold"
        return f"{name.rpartition(':')[0]} {verb}"
    if name.startswith(OPEN_BRANCH):
        verb = "takes" if condition.how == "if" else "does not take"
        place = name.removeprefix(OPEN_BRANCH).rpartition(":")[0]
        return f"the code {verb} branch {condition.value} at {place}"
    called = f"`{name}`" if " (" not in name and " " not in name[4:] else name
    at = condition.span
    place = "" if at is None else f" ({at.path.rpartition('/')[2]}:{at.line})"
    value = f"`{condition.value}`" if condition.value else "empty"
    return f"{called} is {'' if condition.how == 'if' else 'not '}{value}{place}"


def _conditions(analysis: Analysis, wanted: Set[Key]) -> dict[Key, list[LaunchCondition]]:
    """Return the launch conditions of the findings in `wanted`, which are keys of atoms."""
    rows = _collect(analysis.grounding.control, ("condition_at", 7), wanted)
    if not rows:
        return {}
    spans = {
        fact.atom.arguments: fact.span for fact in analysis.facts if fact.atom.name == "starts_if"
    }
    found: dict[Key, list[LaunchCondition]] = {}
    for key, tests in rows.items():
        for test in tests:
            variable, value, how = map(written, test[:3])
            node = as_symbol(test[3]).number
            span = spans.get((node, variable, value, Atom(how)))
            found.setdefault(key, []).append(LaunchCondition(variable, value, how, span))
    return {
        key: sorted(each, key=lambda condition: (condition.variable, condition.value))
        for key, each in found.items()
    }


def _first_messages(analysis: Analysis) -> dict[TermId, RenderedMessage]:
    """Return one message for each consequence: that of the first rule that derives it."""
    first: dict[TermId, RenderedMessage] = {}
    for item in rendered_messages(analysis.grounding.control, _STAGE, analysis.speakers):
        rival = first.setdefault(item.head, item)
        if (item.number, as_symbol(item.values)) < (rival.number, as_symbol(rival.values)):
            first[item.head] = item
    return first


def _collect(
    control: clingo.Control, predicate: tuple[str, int], keys: Set[Key]
) -> dict[Key, list[Sequence[TermId]]]:
    """Return the further arguments of the atoms of a predicate, by the key of the consequence."""
    rows: dict[Key, list[Sequence[TermId]]] = {}
    for atom in atoms(control, *predicate, True):
        kind, about, case, *rest = arguments(atom)
        if (kind, about, case) in keys:
            rows.setdefault((kind, about, case), []).append(rest)
    return rows


def locations(facts: Iterable[Fact]) -> dict[TermId, Span]:
    """Return the locations of relationships, annotations, modules, attributes and guards."""
    located = {
        fact.atom if fact.atom.name == "guard" else fact.atom.arguments[0]: fact.span
        for fact in facts
        if fact.atom.name in ("place", "guard")
    }
    return {as_term(symbol_of(thing)): span for thing, span in located.items()}


def _unique_texts(rows: Sequence[Sequence[TermId]]) -> tuple[str, ...]:
    if len(rows) > 1:
        rows = sorted(rows, key=lambda row: (as_symbol(row[0]), str(as_symbol(row[1]))))
    return tuple(dict.fromkeys(written(row[1]) for row in rows))


@cache
def _severity(term: TermId) -> Severity:
    return next(severity for severity in SEVERITIES if severity == text(term))
