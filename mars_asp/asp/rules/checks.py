"""What clingo would say of a rule pack too late, or without the place, or not at all."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import clingo

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
    replaced,
)
from mars_asp.asp.rules.statements import shown as shows
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic, Span, point
from mars_asp.spelling import nearest

_UNSAFE = re.compile(r"note: '(\w+'*)' is unsafe")

#: What is found in all packs together.
_TWICE = "redefinition of constant"

#: Yields what a host's own vocabulary has against a rule of a pack: its statements, its text, and
#: where it stands.
Judge: TypeAlias = Callable[[Sequence[Statement], str, Span], Iterator[Diagnostic]]


@dataclass(frozen=True)
class Contract:
    """What packs may do beside the built-in rules of a program.

    They derive what is declared extensible, and predicates of their own. What they find they tell
    by `finding`, of which `findings` is the word for several. `judge` says what is wrong with a
    head that tells of one. `expansions` are what keys of metadata stand for.
    """

    finding: Signature
    findings: str
    judge: Judge
    expansions: Expansions = field(default_factory=dict)


@dataclass(frozen=True)
class Seal:
    """What the built-in rules of all stages derive, are given and mean, whichever are loaded.

    `derived` and `given` have the stage of each predicate, `base` where it has several.
    """

    derived: Mapping[Signature, str]
    given: Mapping[Signature, str]
    constants: frozenset[str]
    #: Where the rules stand that have names.
    ids: Mapping[str, Span]
    #: What packs may derive, too.
    extensible: frozenset[Signature]

    @cached_property
    def arities(self) -> Mapping[str, int]:
        """Return how many arguments what is extensible has, by its names."""
        return {each.name: each.arity for each in self.extensible}

    @cached_property
    def early(self) -> frozenset[Signature]:
        """Return the predicates that rules of the base can rest on."""
        found = (*self.given.items(), *self.derived.items())
        return frozenset(signature for signature, stage in found if stage == "base")

    @cached_property
    def later(self) -> Mapping[Signature, str]:
        """Return the predicates that only later stages derive or are given, with their stages."""
        every = {**self.given, **self.derived}
        return {each: stage for each, stage in every.items() if each not in self.early}


def refused_rules(text: str, shown: str) -> Iterator[Diagnostic]:
    """Yield what clingo says against the rules of a text; none of them is grounded here."""
    notes: list[str] = []
    control = clingo.Control(["--warn=none"], lambda _, note: notes.append(note))
    try:
        # Clingo's columns count bytes, and it cuts what it says of a text between them.
        control.add("base", [], masked(text))
        control.ground([("nothing", [])])
    except RuntimeError:
        for place, said, _ in fragments.notes(notes, [Fragment(masked(text), shown)]):
            unsafe = [f"`{name}`" for name in _UNSAFE.findall(said)]
            if unsafe:
                message = f"nothing in the body binds {' and '.join(dict.fromkeys(unsafe))}"
                advice = "name it in a literal of the body that is not negated"
                yield Diagnostic("rule-unsafe", "error", message, place, help=advice)
            elif not said.startswith(_TWICE):
                yield Diagnostic("rule-syntax", "error", said, place)


def unknown_predicates(
    rule: Iterable[Statement],
    known: Set[Signature],
    seal: Seal,
    contract: Contract,
    span: Span,
) -> Iterator[Diagnostic]:
    """Yield the predicates that a rule reads and nobody gives or derives, or none who comes before.

    A rule that is misspelt, or reads what is decided later, never fires. `span` is where it
    stands, for the places of what it says count from its beginning.
    """
    literals = {(each.place, each.signature.unsigned) for one in rule for each in one.read}
    for place, signature in sorted(literals):
        if signature in seal.later:
            # Of what packs derive, too, the head has been told.
            if signature not in known or signature in seal.extensible:
                yield _too_early(signature, seal, contract, placed(span, place))
        elif signature not in known:
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


def misused_heads(
    rule: Sequence[Statement], text: str, seal: Seal, contract: Contract, span: Span
) -> Iterator[Diagnostic]:
    """Yield what is wrong with a head that tells of a finding, such as a choice or a pool.

    `text` is that of the rule, `span` where it stands, for the places of what it says count from
    its beginning.
    """
    pool = head_pool(text) if len(rule) > 1 else None
    for statement in rule:
        told = sorted({each.unsigned for each in statement.derives} & seal.extensible)
        if told and not statement.forces:
            negated = len(statement.heads) == 1 and not statement.head.binds
            where = "after `not`" if negated else "in a choice, disjunction or condition"
            yield Diagnostic(
                "rule-head",
                "error",
                f"`{told[0]}` occurs {where}",
                placed(span, statement.place),
                help="findings must follow from the facts: write a rule with this head alone",
            )
            return
        if told and pool is not None:
            yield Diagnostic(
                "rule-head",
                "error",
                f"`{told[0]}` occurs in a pool, or contains one",
                placed(span, pool),
                help="write a rule for each, or bind a variable in the body: `X = (a; b)`",
            )
            return
        if told and statement.head.is_negated:
            yield Diagnostic(
                "rule-head",
                "error",
                f"`-{told[0]}` denies a finding",
                placed(span, statement.place),
                help="only findings are reported: leave out the rule",
            )
    yield from contract.judge(rule, text, span)


def misplaced_statements(
    written: Iterable[Piece], seal: Seal, contract: Contract, shown: str
) -> Iterator[Diagnostic]:
    """Yield the statements of a pack, rules apart, that would change what others mean."""
    for piece in written:
        place = point(shown, *piece.begin)
        match piece.sort:
            case "cost":
                message = (
                    f"a minimisation chooses between answers, and {contract.findings} have only one"
                )
                advice = f"derive `{contract.finding}` for whatever costs too much"
                yield Diagnostic("rule-statement", "error", message, place, help=advice)
            case "term":
                message = "`#show` of a term shows a term that no rule derives"
                advice = "derive a predicate, and show that: `#show name/1.`"
                yield Diagnostic("rule-statement", "error", message, place, help=advice)
            case "other":
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
                    if signature in seal.later:
                        yield _too_early(signature, seal, contract, place)
                    elif signature.name.startswith("_"):
                        yield from _reserved(signature, seal, contract, place)


def repeated_constants(written: Iterable[tuple[str, Piece]]) -> Iterator[Diagnostic]:
    """Yield the constants that packs define twice; pieces stand beside the names of their files."""
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
    """Yield the functions that a rule calls: rules run no code, so there are none."""
    for place, name in calls(text):
        message = f"there is no function `@{name}`"
        advice = "rules run no code: state it with facts and rules"
        yield Diagnostic("rule-undefined", "error", message, placed(span, place), help=advice)


def reserved_heads(
    rule: Iterable[Statement], seal: Seal, contract: Contract, span: Span
) -> Iterator[Diagnostic]:
    """Yield the predicates that a rule of a pack may not derive, for others mean something by them.

    `span` is where the rule stands, for the places of what it says count from its beginning.
    """
    heads = {(head.literal.place, head.literal.signature) for one in rule for head in one.heads}
    for place, signature in sorted(heads):
        yield from _reserved(signature.unsigned, seal, contract, placed(span, place))


def _reserved(
    signature: Signature, seal: Seal, contract: Contract, place: Span
) -> Iterator[Diagnostic]:
    name = signature.name
    advice = f"derive a predicate of your own, or `{contract.finding}`"
    if signature in seal.extensible:
        return
    if signature in seal.derived:
        message = f"`{signature}` is derived only by the built-in rules"
    elif signature in seal.given:
        message = f"`{signature}` is given, and nothing derives it"
    elif name.startswith("_"):
        message = f"`{signature}` begins with `_`, which is reserved"
    elif name in seal.arities:
        message = f"`{name}` has {seal.arities[name]} arguments, not {signature.arity}"
        advice = "`docs/writing-rules.md` explains each of them"
    else:
        return
    if signature in seal.later:
        advice += f"; this one belongs to `rules/{seal.later[signature]}`"
    yield Diagnostic("rule-reserved", "error", message, place, help=advice)


def _too_early(signature: Signature, seal: Seal, contract: Contract, place: Span) -> Diagnostic:
    stage = seal.later[signature]
    how = "derived by" if signature in seal.derived else "given to"
    return Diagnostic(
        "rule-later",
        "error",
        f"`{signature}` is {how} `rules/{stage}`, after the {contract.findings}",
        place,
        help="a rule pack may use what is given or derived in `rules/*.lp`",
    )


def placed(span: Span, place: Place) -> Span:
    """Return where something stands in a file that has a place in the rule at `span`."""
    line, column = place
    return point(span.path, span.line + line - 1, column + (span.column - 1) * (line == 1))
