"""Checks of rule packs that clingo makes too late, without location, or not at all."""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple, TypeAlias

from mars_asp.asp import fragments
from mars_asp.asp.fragments import Fragment
from mars_asp.asp.rules.expansions import Expansions
from mars_asp.asp.rules.statements import (
    Piece,
    Place,
    Statement,
    calls,
    defined,
    head_pool,
    masked,
    refusals,
    replaced,
)
from mars_asp.asp.rules.statements import shown as shows
from mars_asp.asp.signature import SPACE, Signature
from mars_asp.diagnostic import Diagnostic, Span, point
from mars_asp.spelling import nearest

_NUMBER = re.compile(r"-?[0-9]+")

#: This error is found in all packs together.
_TWICE = "redefinition of constant"

#: Yields the errors of a pack's rule against the host's vocabulary: its statements, its text, and
#: its location.
Judge: TypeAlias = Callable[[Sequence[Statement], str, Span], Iterator[Diagnostic]]


@dataclass(frozen=True)
class Contract:
    """The permissions of packs beside the built-in rules of a program.

    Packs derive extensible predicates, and predicates of their own. `finding` is the predicate of
    their findings, and `findings` the plural noun in messages. `judge` checks heads that derive
    findings. `expansions` are rules that keys of metadata expand to. In the stages `choosing`,
    rules may choose, and minimise on levels below `free_below`; `trusted` packs may use any level.
    """

    finding: Signature
    findings: str
    judge: Judge
    expansions: Expansions = field(default_factory=dict)
    choosing: frozenset[str] = frozenset()
    free_below: int = 0
    #: The folders of a pack by stage, if they are not named after the stage.
    folders: Mapping[str, str] = field(default_factory=dict)
    trusted: bool = False


@dataclass(frozen=True)
class Seal:
    """The meaning of the predicates of the built-in rules in all stages, whichever are loaded.

    `derived` and `given` map each predicate to its stages, `sees` maps a stage to those that its
    rules can read. `extensible` maps predicates that packs may derive to the stages in which they
    may, `public` are those that a named pack may read.
    """

    derived: Mapping[Signature, frozenset[str]]
    given: Mapping[Signature, frozenset[str]]
    constants: frozenset[str]
    #: The locations of the rules that have names.
    ids: Mapping[str, Span]
    extensible: Mapping[Signature, frozenset[str]]
    sees: Mapping[str, frozenset[str]]
    public: frozenset[Signature]
    #: The stages for which packs have no rules, and whose predicates no pack can read.
    unseen: frozenset[str] = frozenset()

    def for_stages(self, stages: Iterable[str]) -> "Seal":
        """Return the seal for packs whose rules are only in some stages."""
        seen = frozenset().union(*(self.sees[stage] for stage in stages))
        return replace(self, unseen=frozenset(self.sees) - seen)

    def without(self, apart: Collection[Signature]) -> "Seal":
        """Return the seal without private predicates in `apart`, whose names packs may use."""
        freed = {each for each in apart if each not in self.reserved}
        return replace(
            self,
            derived={each: at for each, at in self.derived.items() if each not in freed},
            given={each: at for each, at in self.given.items() if each not in freed},
        )

    @cached_property
    def arities(self) -> Mapping[str, int]:
        """Return the arities of extensible predicates, by their names."""
        return {each.name: each.arity for each in self.extensible}

    @cached_property
    def named(self) -> Mapping[Signature, frozenset[str]]:
        """Return the stages in which each predicate is derived or given."""
        none: frozenset[str] = frozenset()
        both = {*self.derived, *self.given}
        return {each: self.derived.get(each, none) | self.given.get(each, none) for each in both}

    @cached_property
    def reserved(self) -> frozenset[Signature]:
        """Return the predicates that no pack can define: given and public ones."""
        given = (each for each, stages in self.given.items() if not stages <= self.unseen)
        return frozenset({*given, *self.extensible, *self.public})

    def known(self, stage: str) -> frozenset[Signature]:
        """Return the predicates that the rules of a stage can read."""
        seen = self.sees[stage]
        return frozenset(each for each, stages in self.named.items() if stages & seen)

    def elsewhere(self, signature: Signature, stage: str) -> str | None:
        """Return a stage with a predicate that rules of `stage` cannot read, else None."""
        stages = self.named.get(signature, frozenset())
        return None if not stages or stages & self.sees[stage] else min(stages)

    def extended_in(self, stage: str) -> frozenset[Signature]:
        """Return the predicates that packs may derive in a stage."""
        return frozenset(each for each, stages in self.extensible.items() if stage in stages)


def refused_rules(text: str, shown: str) -> Iterator[Diagnostic]:
    """Yield clingo's errors about the syntax and safety of rules; nothing is grounded."""
    for note in fragments.notes(refusals(text) or (), [Fragment(masked(text), shown)]):
        yield from fragments.unbound(note)
        if not note.unsafe and not note.message.startswith(_TWICE):
            yield Diagnostic("rule-syntax", "error", note.message, note.place)


class Reader(NamedTuple):
    """The predicates that are `known` to the rules of a stage.

    `hidden` maps predicates of other packs to the names of these packs.
    """

    stage: str
    known: Set[Signature]
    hidden: Mapping[Signature, str]


def unknown_predicates(
    rule: Iterable[Statement], reader: Reader, seal: Seal, contract: Contract, span: Span
) -> Iterator[Diagnostic]:
    """Yield the predicates that a rule reads and no fact or earlier rule provides.

    A rule with a misspelt predicate, or one that is decided later, never fires. `span` is the
    location of the rule; locations in statements are relative to it.
    """
    stage, known, hidden = reader
    literals = {(each.place, each.signature.unsigned) for one in rule for each in one.read}
    for place, signature in sorted(literals):
        if signature in known:
            continue
        if seal.elsewhere(signature, stage) is not None:
            yield _too_early(signature, stage, seal, contract, placed(span, place))
        elif signature in seal.named:
            yield _private(signature, placed(span, place))
        elif signature in hidden:
            message = f"`{signature}` belongs to the pack `{hidden[signature]}` alone"
            advice = (
                "it can be read where its pack documents it with `packs: read`, and yours needs it"
            )
            yield Diagnostic("rule-private", "error", message, placed(span, place), help=advice)
        else:
            near = nearest(signature.name, sorted({other.name for other in known}))
            others = sorted(f"`{other}`" for other in known if other.name == near)
            yield Diagnostic(
                "rule-unknown",
                "error",
                f"nothing gives or derives `{signature}`",
                placed(span, place),
                help=f"did you mean {' or '.join(others)}?"
                if others
                else f"`rules/vocabulary.lp` lists the given facts; write `#defined {signature}.` "
                "where only some facts hold it",
            )


def _private(signature: Signature, place: Span) -> Diagnostic:
    return Diagnostic(
        "rule-private",
        "error",
        f"`{signature}` belongs to the built-in rules alone",
        place,
        help="a pack reads what is given, and what is documented with `packs: read`: "
        "`mars-asp rules show` tells for each",
    )


def misused_heads(
    rule: Sequence[Statement], text: str, stage: str, seal: Seal, contract: Contract, span: Span
) -> Iterator[Diagnostic]:
    """Yield errors in heads that derive findings, such as a choice or a pool.

    `text` is that of the rule, and `span` its location; locations in statements are relative to it.
    """
    extended = seal.extended_in(stage)
    if stage in contract.choosing:
        yield from contract.judge(rule, text, span)
        return
    pool = head_pool(text) if len(rule) > 1 else None
    for statement in rule:
        entries = sorted({each.unsigned for each in statement.derives} & extended)
        place = statement.place
        if not entries:
            continue
        if not statement.forces:
            negated = len(statement.heads) == 1 and not statement.head.binds
            where = "after `not`" if negated else "in a choice, disjunction or condition"
            message = f"`{entries[0]}` occurs {where}"
            advice = "findings must follow from the facts: write a rule with this head alone"
        elif pool is not None:
            place = pool
            message = f"`{entries[0]}` occurs in a pool, or contains one"
            advice = "write a rule for each, or bind a variable in the body: `X = (a; b)`"
        elif not statement.head.signature.positive:
            message = f"`-{entries[0]}` denies a finding"
            advice = "only findings are reported: leave out the rule"
        else:
            continue
        yield Diagnostic("rule-head", "error", message, placed(span, place), help=advice)
        if not statement.forces or pool is not None:
            return
    if any(each.derives & extended for each in rule):
        yield from contract.judge(rule, text, span)


def misplaced_statements(
    written: Iterable[Piece], stage: str, seal: Seal, contract: Contract, shown: str
) -> Iterator[Diagnostic]:
    """Yield errors for a pack's statements, except rules, that would affect other files."""
    for piece in written:
        place = point(shown, *piece.begin)
        match piece.sort:
            case "cost" if stage not in contract.choosing:
                message = (
                    f"a minimisation chooses between answers, and {contract.findings} have only one"
                )
                advice = f"derive `{contract.finding}` for whatever costs too much"
                yield Diagnostic("rule-statement", "error", message, place, help=advice)
            case "term":
                message = "`#show` of a term shows a term that no rule derives"
                advice = "derive a predicate, and show that: `#show name/1.`"
                yield Diagnostic("rule-statement", "error", message, place, help=advice)
            case "other" | "external":
                message = f"`{piece.text.split()[0]}` is not a statement of a rule pack"
                advice = "a pack contains rules, `#const`, `#defined` and `#show`"
                yield Diagnostic("rule-statement", "error", message, place, help=advice)
            case "constant":
                for name in sorted(replaced(piece.text) & seal.constants):
                    message = f"`{name}` is a word of the built-in rules or of their facts"
                    advice = "choose another name: `#const` would replace it everywhere"
                    yield Diagnostic("rule-constant", "error", message, place, help=advice)
            case "shown" | "declaration":
                for signature in sorted(
                    {*(each.unsigned for each in shows(piece.text)), *defined(piece.text)}
                ):
                    if seal.elsewhere(signature, stage) is not None:
                        yield _too_early(signature, stage, seal, contract, place)
                    elif signature.name.startswith("_"):
                        yield from _reserved(signature, stage, seal, contract, place)


def costs_too_high(
    found: Iterable[Statement], contract: Contract, shown: str
) -> Iterator[Diagnostic]:
    """Yield errors for costs on levels above those that `contract` allows packs."""
    for cost in found:
        level = cost.level or ""
        if contract.trusted or (_NUMBER.fullmatch(level) and int(level) < contract.free_below):
            continue
        place = point(shown, *cost.place)
        message = f"the cost on level {level} outranks the cost of nodes, conversions and lines"
        if not _NUMBER.fullmatch(level):
            message = f"the level of this cost, `{level}`, is not a number"
        advice = f"use a level below {contract.free_below}, or trust the pack: `--trust`"
        yield Diagnostic("rule-cost", "error", message, place, help=advice)


def repeated_constants(written: Iterable[tuple[str, Piece]]) -> Iterator[Diagnostic]:
    """Yield the constants that packs define twice; `written` pairs files with statements."""
    first: dict[str, Span] = {}
    for shown, piece in written:
        for name in replaced(piece.text) if piece.sort == "constant" else ():
            place = point(shown, *piece.begin)
            earlier = first.setdefault(name, place)
            if earlier != place:
                message = f"constant `{name}` is defined twice"
                labels = ((earlier, "first defined here"),)
                yield Diagnostic("rule-constant", "error", message, place, labels)


def called_functions(text: str, span: Span) -> Iterator[Diagnostic]:
    """Yield the functions that a rule calls; there are none, because rules run no code."""
    for place, name in calls(text):
        message = f"there is no function `@{name}`"
        advice = "rules run no code: state it with facts and rules"
        yield Diagnostic("rule-undefined", "error", message, placed(span, place), help=advice)


def reserved_heads(
    rule: Iterable[Statement], stage: str, seal: Seal, contract: Contract, span: Span
) -> Iterator[Diagnostic]:
    """Yield the predicates that a pack's rule must not derive, because they are defined elsewhere.

    `span` is the location of the rule; locations in statements are relative to it.
    """
    heads = {(head.literal.place, head.literal.signature) for one in rule for head in one.heads}
    for place, signature in sorted(heads):
        yield from _reserved(signature.unsigned, stage, seal, contract, placed(span, place))


def _reserved(
    signature: Signature, stage: str, seal: Seal, contract: Contract, place: Span
) -> Iterator[Diagnostic]:
    name = signature.name
    advice = f"derive a predicate of your own, or `{contract.finding}`"
    stages = seal.extensible.get(signature, frozenset())
    if stage in stages:
        return
    if stages:
        message = f"`{signature}` is not derived in `{contract.folders.get(stage, stage)}`"
        names = sorted(contract.folders.get(each, each) for each in stages)
        advice = f"derive it in {' or '.join(f'`{each}`' for each in names)}"
    elif name.startswith("_"):
        message = f"`{signature}` begins with `_`, which is reserved"
    elif SPACE in name:
        message = f"`{signature}` has two primes in its name, which are reserved"
    elif signature not in seal.reserved and name not in seal.arities:
        return
    elif signature in seal.derived:
        message = f"`{signature}` is derived only by the built-in rules"
    elif signature in seal.given:
        message = f"`{signature}` is given, and nothing derives it"
    else:
        message = f"`{name}` has {seal.arities[name]} arguments, not {signature.arity}"
        advice = "`mars-asp rules list --predicates` lists those that may be derived"
    elsewhere = seal.elsewhere(signature, stage)
    if elsewhere is not None and not stages:
        advice += f"; this one belongs to `{_folder(elsewhere)}`"
    yield Diagnostic("rule-reserved", "error", message, place, help=advice)


def _folder(stage: str) -> str:
    return "rules" if stage == "base" else f"rules/{stage}"


def _too_early(
    signature: Signature, stage: str, seal: Seal, contract: Contract, place: Span
) -> Diagnostic:
    where = seal.elsewhere(signature, stage) or ""
    how = "derived by" if signature in seal.derived else "given to"
    if stage == "base":
        after = f", after the {contract.findings}"
        advice = "a rule pack may use what is given or derived in `rules/*.lp`"
    else:
        after = ""
        seen = sorted(map(_folder, seal.sees[stage]))
        advice = f"rules in `{stage}` use what is given or derived in {' and '.join(seen)}"
    message = f"`{signature}` is {how} `{_folder(where)}`{after}"
    return Diagnostic("rule-later", "error", message, place, help=advice)


def placed(span: Span, place: Place) -> Span:
    """Return the location in a file of a place in the rule at `span`."""
    line, column = place
    return point(span.path, span.line + line - 1, column + (span.column - 1) * (line == 1))
