"""Identifiers in facts: numbers of relationships and annotations, and terms of modes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from itertools import groupby
from operator import attrgetter

from clingo import Symbol, SymbolType

from mars_asp.asp.solve.atoms import Atom
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import (
    FOREVER,
    Configuration,
    Control,
    Data,
    Function,
    Gating,
    Hold,
    Limit,
    Lock,
    Mode,
    Module,
    Mount,
    Relationship,
    Reset,
    Service,
    Strategy,
    ends_of,
)
from mars_asp.model.modes import parse_mode
from mars_asp.model.remembered import remembered

ANY = Atom("any")
NONE = Atom("none")
PERIODIC = "NotifyAtFrequency"


def numbered_annotations(
    configuration: Configuration, described: Mapping[str, Module]
) -> Iterator[tuple[int, Module, Service | Function]]:
    """Yield the annotations of described modules with their identifiers."""
    number = len(configuration.relationships)
    for module in described.values():
        annotations: tuple[Service | Function, ...] = (*module.services, *module.functions)
        for annotation in annotations:
            number += 1
            yield number, module, annotation


def annotation_numbers(
    configuration: Configuration, described: Mapping[str, Module]
) -> Mapping[tuple[str, int], tuple[int, Span]]:
    """Return the identifier and location of each annotation, by its module and its `id`."""
    return {
        (module.name, id(annotation)): (number, annotation.span)
        for number, module, annotation in numbered_annotations(configuration, described)
    }


def mode_term(mode: Mode) -> Atom:
    """Return mode(Name, Arguments); equal modes give equal terms, however they are written."""
    inside = [plain(number) for number in mode.arguments]
    if mode.of is not None:
        inside.append(f"of={mode.of}")
    return Atom("mode", (mode.name, ", ".join(inside)))


def hold_term(hold: Hold) -> int | Atom:
    """Return a number of milliseconds, or the constant `forever`, which exceeds every number."""
    return Atom(FOREVER) if hold == FOREVER else hold


def hold_of(term: Symbol) -> Hold:
    """Return the hold time that a term of facts represents."""
    return term.number if term.type == SymbolType.Number else FOREVER


def mode_of(term: Symbol) -> Mode:
    """Return the mode that a term `mode(Name, Arguments)` represents."""
    name, inside = (argument.string for argument in term.arguments)
    mode = parse_mode(f"{name}({inside})" if inside else name)
    if not isinstance(mode, Mode):
        raise ValueError(f"no delivery mode: {term}")
    return mode


def plain(number: Decimal) -> str:
    """Return a number without exponent and without trailing zeros."""
    text = format(number, "f")
    return (text.rstrip("0").rstrip(".") or "0") if "." in text else text


@remembered
def numbered(
    relationships: Sequence[Relationship],
) -> tuple[tuple[int, Relationship], ...]:
    """Return relationships with their identifiers, integers from 1.

    The numbers depend on the content of relationships, so that the order of the lines of a file,
    which has no meaning, cannot decide anything.
    """
    found: list[Relationship] = []
    for kind, ends in _ENDS.items():
        alike = sorted((each for each in relationships if type(each) is kind), key=ends)
        # Few relationships have the same two modules, so little else is ever compared.
        for _, group in groupby(alike, ends):
            first, *others = group
            found += sorted((first, *others), key=_content) if others else (first,)
    return tuple(enumerate(found, 1))


#: The two modules of relationships of each kind, the kinds in the order of their identifiers.
_ENDS: Mapping[type[Relationship], Callable[[Relationship], tuple[str, str]]] = {
    Data: attrgetter("client", "source"),
    Control: attrgetter("controlled", "controller"),
    Mount: attrgetter("mounting", "mounted"),
    **dict.fromkeys((Gating, Reset, Lock, Limit, Strategy), ends_of),
}


def _content(relationship: Relationship) -> tuple[object, ...]:
    """Return the attributes of a relationship besides its two modules, with its span last."""
    match relationship:
        case Data(_, _, span, mode, hz, client_port, source_port):
            ports = (client_port or "", source_port or "")
            return (*ports, str(mode_term(mode)) if mode else "", hz or Fraction(0), span)
        case Control(_, _, span, priority, hold, allocation):
            return (priority or 0, str(hold or 0), allocation or "", span)
        case Mount(_, _, span, at, on):
            return (at or 0, on or 0, span)
        case Gating(_, _, span, sign, ms, port, trigger_port):
            return (sign, port or "", trigger_port or "", ms, span)
        case Reset(_, _, span, port):
            return (port or "", span)
        case Lock(_, _, span, priority, hold, port):
            return (port or "", -1 if priority is None else priority, hold or 0, span)
        case Limit(_, _, span, hold, port):
            return (port or "", hold or 0, span)
        case Strategy(_, span, strategy, period):
            return (strategy, period or 0, span)
