"""The possible values of arguments: sorts that predicates declare, and constants of rules.

Both are propagated from rule to rule. A name, or an identifier of a thing, has one sort alone, so a
variable of two sorts never has a value.
"""

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from fractions import Fraction
from typing import Literal, NamedTuple, TypeAlias

from clingo import SymbolType

from mars_asp.asp.lint.clauses import (
    Aggregate,
    Clause,
    ClauseAtom,
    ClauseScope,
    is_constant,
    joined,
    name_of,
    number_of,
    operation_of,
)
from mars_asp.asp.rules.declarations import Declaration, PredicateArgument
from mars_asp.asp.rules.trees import Kind, SyntaxNode
from mars_asp.asp.signature import Signature
from mars_asp.asp.units import UNITS, times_as_many

#: The forms of values.
Form: TypeAlias = Literal["number", "string", "name", "function"]


class Value(NamedTuple):
    """Some values: all of a `sort`, those of a `form`, or the single one with this `text`."""

    form: Form | None
    sort: str = ""
    text: str = ""


#: All possible values, or None if any value is possible.
Values: TypeAlias = frozenset[Value] | None
Environment: TypeAlias = Mapping[str, Values]

NUMBERS: Values = frozenset({Value("number")})
_NOTHING: frozenset[Value] = frozenset()
_NUMBER: Form = "number"
#: Larger sets of values are treated as unknown.
_MOST = 200


class Use(NamedTuple):
    """An atom that restricts a variable, and the values that it allows."""

    atom: ClauseAtom
    values: frozenset[Value]


class KnownValue:
    """The possible values of the arguments of predicates.

    `forms` are those of sorts, `replaced` the constants that `#const` replaces. `kinds` maps a sort
    to an argument, with its position from 0, that has all derived values of the sort.
    """

    def __init__(
        self,
        clauses: Sequence[Clause],
        declared: Mapping[Signature, Declaration],
        forms: Mapping[str, Form],
        replaced: Set[str],
        kinds: Mapping[str, tuple[Signature, int]] | None = None,
    ) -> None:
        self.forms: dict[str, Form] = {**dict.fromkeys(UNITS, _NUMBER), **forms}
        self._replaced = replaced
        self.declared = {
            signature: tuple(map(self._argument_values, each.arguments))
            for signature, each in declared.items()
        }
        self._arguments: dict[Signature, list[Values]] = {
            signature: list(values) for signature, values in self.declared.items()
        }
        #: The undeclared positions of derived predicates.
        self.derived: dict[Signature, tuple[int, ...]] = {}
        self._infer(clauses)
        for sort, (signature, at) in (kinds or {}).items():
            given = self.arguments(signature)[at] if self.arguments(signature) else None
            self._close(sort, given)

    def _close(self, sort: str, given: Values) -> None:
        """Replace a declared sort by its constants if these are known."""
        names = given and all(each.text and each.form == "name" for each in given)
        of = frozenset({Value(self.forms.get(sort), sort)})
        for signature, values in self.declared.items() if names else ():
            closed = tuple(given if each == of else each for each in values)
            self.declared[signature] = closed
            for at, each in enumerate(self._arguments[signature]):
                if each == of:
                    self._arguments[signature][at] = given

    def arguments(self, signature: Signature) -> Sequence[Values]:
        """Return the possible values of the arguments of a predicate; empty if unknown."""
        return self._arguments.get(signature.unsigned, ())

    def alike(self, one: Value, other: Value) -> Value | None:
        """Return the intersection of two values, or None if it is empty."""
        if one == other:
            return one
        if other.text:
            one, other = other, one
        if (one.text and other.text) or (one.sort and other.sort):
            return None
        if one.form and other.form and one.form != other.form:
            return None
        return one if one.text or one.sort else other

    def meet(self, one: Values, other: Values) -> Values:
        """Return the values that are in both sets; None (any value) restricts nothing."""
        if one is None:
            return other
        if other is None or one == other:
            return one
        found = (self.alike(each, rest) for each in one for rest in other)
        return frozenset(each for each in found if each is not None)

    def are_apart(self, one: Values, other: Values) -> bool:
        """Whether all values of two sets differ in sort or form.

        Terms may represent anything, so they are never apart.
        """
        if not one or not other or any(each.form == "function" for each in one | other):
            return False
        return not self.meet(_of_any_text(one), _of_any_text(other))

    def comparable(self, one: Values, other: Values) -> bool:
        """Whether `<` between two sets of values is meaningful, as between numbers."""
        forms = [{each.form for each in values or ()} for values in (one, other)]
        return bool(
            self.meet(_of_any_text(one), _of_any_text(other))
            or forms[0] & forms[1] & {"number"}
            or {"function", None} & (forms[0] | forms[1])
        )

    def uses(self, variable: str, atoms: Iterable[ClauseAtom]) -> Iterator[Use]:
        """Yield the atoms that restrict the values of a variable."""
        for atom in atoms:
            for term, values in zip(atom.terms, self.arguments(atom.signature), strict=False):
                if values is not None and name_of(term) == variable:
                    yield Use(atom, values)

    def environment(self, clause: Clause, scope: ClauseScope) -> dict[str, Values]:
        """Return the possible values of each variable in a scope of a clause."""
        found: dict[str, Values] = {}
        for name, values in self._variable_values(scope):
            found[name] = self.meet(found.get(name), values)
        for comparison in scope.comparisons:
            for one, other in comparison.equal:
                equal = name_of(one)
                # Sides that are never equal have a finding at their comparison.
                if equal is not None and equal not in found:
                    found[equal] = self.of(other, found)
        for aggregate in clause.aggregates:
            for sign, guard in aggregate.guards:
                value = name_of(guard)
                if sign == "=" and value is not None and value not in found:
                    found[value] = self.aggregated(aggregate, found)
        return found

    def aggregated(self, aggregate: Aggregate, environment: Environment) -> Values:
        """Return the possible values of an aggregate, by the terms that it adds or compares."""
        if aggregate.function in ("count", "set"):
            return NUMBERS
        found: frozenset[Value] = _NOTHING
        for given in self.of_elements(aggregate, environment):
            if given is None:
                return NUMBERS if aggregate.function.startswith("sum") else None
            found |= given
        if aggregate.function.startswith("sum"):
            return frozenset(Value("number", each.sort) for each in found if each.form == "number")
        return found | {Value("name", text="#inf"), Value("name", text="#sup")}

    def of_elements(self, aggregate: Aggregate, environment: Environment) -> Iterator[Values]:
        """Yield the term that each element of an aggregate adds or compares."""
        for element in aggregate.elements:
            inside = dict(environment)
            for name, values in self._variable_values(element.scope):
                inside[name] = self.meet(inside.get(name), values)
            yield self.of(element.terms[0], inside) if element.terms else None

    def _variable_values(self, scope: ClauseScope) -> Iterator[tuple[str, Values]]:
        """Yield the variables of positive atoms in a scope, with the values that they allow."""
        for atom in scope.atoms:
            known = self.arguments(atom.signature) if atom.sign == 0 else ()
            for at, name in atom.named if known else ():
                values = known[at]
                if values is not None:
                    yield name, values

    def of(self, term: SyntaxNode, environment: Environment) -> Values:
        """Return the possible values of a term, None if any; `environment` has its variables."""
        kind = term.ast_type
        if kind is Kind.Variable:
            return environment.get(term.name)
        if kind in (Kind.SymbolicTerm, Kind.Function):
            return self._constant(term)
        if kind is Kind.UnaryOperation:
            return self.of(term.argument, environment) or NUMBERS
        if kind is Kind.BinaryOperation:
            return self._computed(term, environment)
        return NUMBERS if kind is Kind.Interval else None

    def _computed(self, term: SyntaxNode, environment: Environment) -> Values:
        """Return the values of a sum or multiple, which has the sort of its operands."""
        inside = [self.of(each, environment) for each in (term.left, term.right)]
        sorts = [
            {each.sort for each in values or () if each.sort and each.form == "number"}
            for values in inside
        ]
        sign, plain = operation_of(term), [is_constant(term.left), is_constant(term.right)]
        if sign in ("+", "-", "*") or (sign in ("/", "\\") and plain[1]):
            named = [one for one in sorts if one]
            rest = [is_plain for one, is_plain in zip(sorts, plain, strict=True) if not one]
            if named and all(one == named[0] for one in named) and all(rest):
                if len(named) == 1 or sign in ("+", "-"):
                    factors = number_of(term.left), number_of(term.right)
                    converted = _converted(named[0], sign, *factors)
                    return frozenset(Value("number", sort) for sort in named[0] | converted)
        return NUMBERS

    def _constant(self, term: SyntaxNode) -> Values:
        if term.ast_type is Kind.Function and (term.arguments or not term.name):
            return frozenset({Value("function", text=f"{term.name}/{len(term.arguments)}")})
        text = str(term)
        if text in self._replaced:
            return None
        if term.ast_type is Kind.Function or term.symbol.type == SymbolType.Function:
            return frozenset({Value("name", text=text)})
        if term.symbol.type == SymbolType.Number:
            return frozenset({Value("number", text=text)})
        if term.symbol.type == SymbolType.String:
            return frozenset({Value("string", text=text)})
        # `#inf` and `#sup`.
        return frozenset({Value("name", text=text)})

    def _argument_values(self, argument: PredicateArgument) -> Values:
        if not argument.sorts and not argument.constants:
            return None
        constants = (Value("name", text=text) for text in argument.constants)
        return frozenset({*(Value(self.forms.get(s), s) for s in argument.sorts), *constants})

    # ---- From rule to rule -----------------------------------------------------------------------

    def _infer(self, clauses: Sequence[Clause]) -> None:
        """Propagate the values of derived arguments through the rules to a fixpoint."""
        for clause in clauses:
            for head, _ in clause.heads:
                signature = head.signature.unsigned
                if signature not in self.derived:
                    values = self._arguments.setdefault(signature, [None] * signature.arity)
                    places = tuple(at for at, each in enumerate(values) if each is None)
                    self.derived[signature] = places
                    for at in places:
                        values[at] = _NOTHING
        reading: dict[Signature, list[int]] = {}
        for number, clause in enumerate(clauses):
            for signature in {atom.signature.unsigned for atom in clause.read}:
                reading.setdefault(signature, []).append(number)
        # A queue without duplicates, so that long chains take no longer.
        waiting = deque(range(len(clauses)))
        queued = set(waiting)
        while waiting:
            number = waiting.popleft()
            queued.remove(number)
            for signature in self._handed_on(clauses[number]):
                more = [each for each in reading.get(signature, ()) if each not in queued]
                waiting += more
                queued.update(more)

    def _handed_on(self, clause: Clause) -> Iterator[Signature]:
        """Add the values that a rule derives; yield the predicates that got new values."""
        shared: dict[str, Values] | None = None
        for head, condition in clause.heads:
            signature = head.signature.unsigned
            places = self.derived[signature]
            if not places:
                continue
            if condition.atoms or shared is None:
                shared = self.environment(clause, joined(clause.body, condition))
            known = self._arguments[signature]
            changed = False
            for at in places:
                before = known[at]
                if before is None:
                    continue
                given = self.of(head.terms[at], shared)
                if given is None or not given <= before:
                    more = None if given is None else before | given
                    known[at] = None if more is None or len(more) > _MOST else more
                    changed = True
            if changed:
                yield signature


def _of_any_text(values: Values) -> Values:
    return values and frozenset(each._replace(text="") for each in values)


def _converted(
    sorts: Set[str], sign: str | None, left: int | None, right: int | None
) -> frozenset[str]:
    """Return the units of numbers in `sorts` times or by (`sign`) a constant; set() if none.

    For example, `S * 1000` with S in seconds is in milliseconds.
    """
    factor = right if sign in ("*", "/") and right else left if sign == "*" else None
    if not factor:
        return frozenset()
    return frozenset(
        other
        for other in UNITS
        for sort in sorts & UNITS.keys()
        if (times := times_as_many(sort, other)) is not None
        and times == (factor if sign == "*" else Fraction(1, factor))
    )


def differ_in_unit(one: str, other: str) -> bool:
    """Whether two sorts are measured in different units."""
    return one in UNITS and other in UNITS and UNITS[one] != UNITS[other]
