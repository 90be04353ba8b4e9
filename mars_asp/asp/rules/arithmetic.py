"""Arithmetic in rules that exceeds the 32 bits of clingo's integers, which wrap silently."""

from collections.abc import Iterator, Mapping, Sequence, Set
from pathlib import Path
from typing import NamedTuple, TypeAlias

import clingo

from mars_asp.asp.cache import memoized
from mars_asp.asp.rules.checks import placed
from mars_asp.asp.rules.computed import Computed, Summed, leaves
from mars_asp.asp.rules.statements import (
    FILES,
    Number,
    Operand,
    Operation,
    Place,
    definitions,
    operands,
)
from mars_asp.asp.solve.term_ids import arguments, as_symbol, labelled
from mars_asp.diagnostic import Diagnostic, Span, point

LEAST, MOST = -(2**31), 2**31 - 1


class _Overflow(NamedTuple):
    place: Place
    text: str


def overflows(text: str, path: str) -> Iterator[Diagnostic]:
    """Yield the numbers of a rule file, and operations on constants alone, that do not fit."""
    files = (Path(__file__), *FILES)
    for place, written in memoized("overflows", files, [text], _overflows)[text]:
        yield Diagnostic(
            "rule-number",
            "error",
            f"`{written}` does not fit into 32 bits, so it would become a different number",
            point(path, *place),
            help=f"numbers in rules are {LEAST} to {MOST}",
        )


def _overflows(text: str) -> tuple[_Overflow, ...]:
    found: dict[_Overflow, None] = {}
    known = _constants(definitions(text))
    for operand in operands(text):
        _exact_value(operand, known, found)
    return tuple(sorted(found))


def _constants(defined: Mapping[str, Operand]) -> dict[str, int | None]:
    """Return the values of constants, None for circular definitions."""
    found: dict[str, int | None] = {}
    begun: set[str] = set()
    rest = list(defined)
    while rest:
        name = rest.pop()
        needed = [leaf for leaf in leaves(defined[name]) if leaf in defined and leaf not in found]
        if needed and name not in begun:
            begun.add(name)
            rest += (name, *needed)
        elif name not in found:
            found[name] = _exact_value(defined[name], found, {})
    return found


def _exact_value(
    operand: Operand, known: Mapping[str, int | None], found: dict[_Overflow, None]
) -> int | None:
    """Return the value of an operand, None if unknown or beyond 32 bits; add it to `found` then."""
    value: int | None
    match operand:
        case str():
            return known.get(operand)
        case Number(number, _):
            value, written = number, str(number)
        case Operation("-", (Number(whole, _),)) if whole == MOST + 1:
            return LEAST
        case Operation(sign, inside, written, _):
            value = _computed(sign, [_exact_value(each, known, found) for each in inside])
    if value is not None and not LEAST <= value <= MOST:
        found[_Overflow(operand.place, written)] = None
        return None
    return value


def _computed(sign: str, values: Sequence[int | None]) -> int | None:
    """Return the result of an operation with unlimited integers, None if a value is unknown."""
    match sign, values:
        case "-", [int(one)]:
            return -one
        case "|", [int(one)]:
            return abs(one)
        case "+", [int(one), int(other)]:
            return one + other
        case "-", [int(one), int(other)]:
            return one - other
        case "*", [int(one), int(other)]:
            return one * other
        case "**", [int(one), int(other)] if other >= 0:
            # With more digits the result does not fit in any case.
            return int(one ** (min(other, 64) if abs(one) > 1 else other % 2 + 2 * bool(other)))
        case "/", [int(one), int(other)] if other:
            return _quotient(one, other)
        case "\\", [int(one), int(other)] if other:
            # A quotient that does not fit ends the process, although the remainder would fit.
            whole = _quotient(one, other)
            return one - whole * other if whole <= MOST else whole
        case "**", [int(one), int()]:
            return 0 if one else None
        case "&", [int(one), int(other)]:
            return one & other
        case "?", [int(one), int(other)]:
            return one | other
        case "^", [int(one), int(other)]:
            return one ^ other
        case "~", [int(one)]:
            return ~one
    return None


def _quotient(one: int, other: int) -> int:
    return abs(one) // abs(other) * (1 if (one < 0) == (other < 0) else -1)


# ---- While grounding -----------------------------------------------------------------------------


#: A sum: its rule, its location there, and the values of its global variables.
_Group: TypeAlias = tuple[Span, Place, tuple[int, ...]]


class Arithmetic(NamedTuple):
    """An operation or sum of the rule at `span`."""

    span: Span
    computed: Computed | Summed


def telling(number: int, checked: Arithmetic) -> str:
    """Return a rule that records the operands of an operation or sum when grounded."""
    match checked.computed:
        case Computed(_, inside, body):
            return f"_computed({number},{_tuple(inside)}) :- {body}."
        case Summed(_, _, terms, shared, body):
            return f"_summed({number},{_tuple(shared)},{_tuple(terms)}) :- {body}."


def wrapped(control: clingo.Control, checked: Sequence[Arithmetic]) -> Iterator[Diagnostic]:
    """Yield the operations and sums whose values exceed 32 bits; `telling` records operands.

    One instance of each is reported: for an operation that with the smallest numbers.
    """
    least: dict[tuple[Span, _Overflow], tuple[int, str]] = {}
    for atom, _, _ in labelled(control, "_computed", 2, True):
        number, values = arguments(atom)
        span, computed = checked[as_symbol(number).number]
        if isinstance(computed, Computed):
            inside = [as_symbol(value) for value in arguments(values)[1:]]
            known = {
                leaf: value.number
                for leaf, value in zip(computed.leaves, inside, strict=True)
                if value.type == clingo.SymbolType.Number
            }
            found: dict[_Overflow, None] = {}
            _exact_value(computed.operation, known, found)
            for overflow in found:
                where = [f"`{leaf}` is {number}" for leaf, number in known.items()]
                message = f"`{overflow.text}` does not fit into 32 bits"
                message += f" where {' and '.join(where)}" if where else ""
                result = (max(map(abs, known.values()), default=0), message)
                least[span, overflow] = min(result, least.get((span, overflow), result))
    for (span, overflow), (_, message) in least.items():
        yield _too_large(span, overflow.place, message)
    yield from _oversized(control, checked, {span for span, _ in least})


def _oversized(
    control: clingo.Control, checked: Sequence[Arithmetic], wrong: Set[Span]
) -> Iterator[Diagnostic]:
    """Yield the sums that may exceed 32 bits, except in the rules at the locations `wrong`."""
    # Elements with equal tuples count once, whichever of them is true.
    elements: dict[_Group, dict[tuple[int, ...], tuple[int, bool]]] = {}
    for atom, _, is_fact in labelled(control, "_summed", 3, True):
        number, shared, terms = arguments(atom)
        span, summed = checked[as_symbol(number).number]
        if isinstance(summed, Summed) and span not in wrong:
            key = (span, summed.place, tuple(arguments(shared)))
            weight = as_symbol(arguments(terms)[1])
            if weight.type == clingo.SymbolType.Number and (weight.number > 0 or summed.negative):
                found = elements.setdefault(key, {})
                tuple_ = tuple(arguments(terms))
                found[tuple_] = (weight.number, is_fact or found.get(tuple_, (0, False))[1])
    entries = set()
    for (span, place, _), weights in elements.items():
        sure = sum(weight for weight, is_fact in weights.values() if is_fact)
        open_ = [weight for weight, is_fact in weights.values() if not is_fact]
        most = sure + sum(weight for weight in open_ if weight > 0)
        least = sure + sum(weight for weight in open_ if weight < 0)
        if not LEAST <= least <= most <= MOST and (span, place) not in entries:
            entries.add((span, place))
            message = f"this sum may be {most if most > MOST else least}, which does not fit into"
            yield _too_large(span, place, f"{message} 32 bits")


def _too_large(span: Span, place: Place, message: str) -> Diagnostic:
    help_text = f"numbers in rules are {LEAST} to {MOST}: compare them rather than computing"
    return Diagnostic("rule-number", "error", message, placed(span, place), help=help_text)


def _tuple(terms: Sequence[str]) -> str:
    # Without a term this would be a constant, which a pack may replace.
    return f"v({','.join(('0', *terms))})"
