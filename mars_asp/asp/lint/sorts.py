"""Values in rules that can never be: of the wrong sort, misspelt, in another form or unit."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

from mars_asp.asp.lint.clauses import (
    Clause,
    ClauseAtom,
    Comparison,
    is_constant,
    joined,
    name_of,
    number_of,
    operation_of,
)
from mars_asp.asp.lint.found import Fix, LintFinding
from mars_asp.asp.lint.values import Environment, KnownValue, Use, Value, Values, differ_in_unit
from mars_asp.asp.rules.declarations import Declaration
from mars_asp.asp.rules.trees import Kind, SyntaxNode, below
from mars_asp.asp.signature import Signature
from mars_asp.asp.units import UNITS, measured
from mars_asp.spelling import nearest

SORT, UNIT, VALUE, FORM = "rule-sort", "rule-unit", "rule-value", "rule-form"
_WORDS = {"number": "a number", "string": "a string", "name": "a constant", "function": "a term"}
#: A sum or a difference, without the arrow of a rule.
_SUM = re.compile(r"\+|(?<!:)-")
#: Fine units: a number of less than one shown unit (hertz, millimetre, %) is a likely mistake.
_FINE = ("millihertz", "micrometres", "millionths")


def wrong_values(
    clause: Clause, known: KnownValue, names: Mapping[Signature, Declaration]
) -> Iterator[LintFinding]:
    """Yield variables with two incompatible sorts, and constants that never occur.

    `names` are the declarations of predicates.
    """
    for head, _ in clause.heads:
        yield from _wrong_constants(clause, head, True, known, names)
    for atom in clause.read:
        if len(atom.named) < len(atom.terms):
            yield from _wrong_constants(clause, atom, False, known, names)
    environments = []
    for scope in clause.scopes:
        environment = known.environment(clause, scope)
        environments.append(environment)
        yield from _contradictions(clause, scope.positive, environment, known)
        denied = (atom for atom in scope.atoms if atom.sign)
        yield from _never_given(clause, denied, environment, known)
        for comparison in scope.comparisons:
            yield from _comparison_of_sorts(clause, comparison, environment, known)
    for each in clause.conditionals:
        environment = known.environment(clause, joined(clause.body, each.condition))
        yield from _never_given(clause, each.literal.atoms, environment, known)
    yield from _aggregated(clause, environments[0], known)
    for head, condition in clause.heads:
        environment = known.environment(clause, condition) if condition.atoms else {}
        yield from _wrong_heads(clause, head, {**environments[0], **environment}, known)
    whole = {name: values for each in environments for name, values in each.items()}
    yield from _mixed_sums(clause, whole, known)


def _contradictions(
    clause: Clause, atoms: Sequence[ClauseAtom], environment: Environment, known: KnownValue
) -> Iterator[LintFinding]:
    for name, values in sorted(environment.items()):
        if values is None or values:
            continue
        first: Use | None = None
        for use in known.uses(name, atoms):
            if not use.values:
                continue
            both = known.meet(None if first is None else first.values, use.values)
            if first is not None and not both:
                yield _two_things(clause, name, first, use)
                break
            first = use if first is None else Use(first.atom, both or first.values)


def _two_things(clause: Clause, name: str, first: Use, use: Use) -> LintFinding:
    one, other = _in_words(first.values), _in_words(use.values)
    code, advice = SORT, "these are two things: use two variables, and state how they are related"
    if _units(first.values) and _units(use.values):
        code, advice = UNIT, "numbers of two units are two things: use two variables"
    message = f"`{name}` is {one} in `{first.atom.signature.unsigned}`"
    message += f" and {other} in `{use.atom.signature.unsigned}`"
    return clause.finding(code, message, use.atom.node, advice)


def _never_given(
    clause: Clause, atoms: Iterable[ClauseAtom], environment: Environment, known: KnownValue
) -> Iterator[LintFinding]:
    """Yield a finding for each argument that never has the value of the variable written there."""
    for atom in atoms:
        every = known.arguments(atom.signature)
        for at, name in atom.named if every else ():
            given, values = environment.get(name), every[at]
            if known.are_apart(given, values):
                code = UNIT if _units(given) and _units(values) else SORT
                message = f"`{name}` is {_in_words(given)}, and never {_in_words(values)}"
                message += f", as in `{atom.signature.unsigned}`"
                advice = "this never holds, and its negation always does: use another variable"
                yield clause.finding(code, message, atom.node, advice)


def _aggregated(
    clause: Clause, environment: Environment, known: KnownValue
) -> Iterator[LintFinding]:
    """Yield aggregates that are compared with numbers of another unit, or too small ones."""
    for aggregate in clause.aggregates:
        own = known.aggregated(aggregate, environment)
        inside = [_units(_numbers(each)) for each in known.of_elements(aggregate, environment)]
        is_measured = aggregate.function != "count" and len(inside) > 1 and all(inside)
        if is_measured and not set(inside[0]).intersection(*inside):
            measures = sorted({each[0] for each in inside})
            message = f"this aggregate is over numbers in {' and in '.join(measures)}"
            advice = "bring all of them to one unit, or use one aggregate for each"
            yield clause.finding(UNIT, message, aggregate.node, advice)
        for _, guard in aggregate.guards:
            values = known.of(guard, environment)
            units = _units(own), _units(values)
            if all(units) and not set(units[0]) & set(units[1]):
                message = f"`{guard!s}` is in {_in_words(values)}"
                message += f" and this aggregate in {_in_words(_numbers(own))}"
                advice = "bring both to one unit before they are compared"
                yield clause.finding(UNIT, message, aggregate.node, advice)
            else:
                yield from _too_small(clause, guard, own)


def _numbers(values: Values) -> Values:
    return values and frozenset(each for each in values if each.form != "name")


def _comparison_of_sorts(
    clause: Clause, comparison: Comparison, environment: Environment, known: KnownValue
) -> Iterator[LintFinding]:
    left, right = (known.of(each, environment) for each in (comparison.left, comparison.right))
    if not left or not right or (is_constant(comparison.left) and is_constant(comparison.right)):
        return
    one, other = str(comparison.left), str(comparison.right)
    units = _units(left), _units(right)
    if all(units) and not set(units[0]) & set(units[1]):
        message = f"`{one}` is in {_in_words(left)} and `{other}` in {_in_words(right)}"
        advice = "bring both to one unit before they are compared"
        yield clause.finding(UNIT, message, comparison.node, advice)
        return
    is_ordered = comparison.sign not in ("=", "!=")
    if known.meet(left, right) or (is_ordered and known.comparable(left, right)):
        for term, values in ((comparison.left, right), (comparison.right, left)):
            yield from _too_small(clause, term, values)
        return
    for (term, _, other_term), values in zip(comparison.sides, (right, left), strict=True):
        if is_constant(term):
            yield _never(clause, term, values, f"`{other_term!s}`", known)
            return
    always = "not comparable" if is_ordered else "never equal"
    message = (
        f"`{one}` is {_in_words(left)} and `{other}` is {_in_words(right)}, so they are {always}"
    )
    yield clause.finding(SORT, message, comparison.node, "compare values of one sort")


def _wrong_constants(
    clause: Clause,
    atom: ClauseAtom,
    is_head: bool,
    known: KnownValue,
    names: Mapping[Signature, Declaration],
) -> Iterator[LintFinding]:
    signature = atom.signature.unsigned
    declared = known.declared.get(signature)
    every = (declared or ()) if is_head else known.arguments(signature)
    for at, (term, values) in enumerate(zip(atom.terms, every, strict=False)):
        if not values or not is_constant(term):
            continue
        given = known.of(term, {})
        if given is None:
            continue
        if known.meet(given, values):
            yield from _too_small(clause, term, values)
            continue
        declaration = names.get(signature)
        name = f"`{declaration.arguments[at].name}`" if declaration else f"argument {at + 1}"
        yield _never(clause, term, values, f"{name} of `{signature}`", known)


def _never(
    clause: Clause, term: SyntaxNode, values: Values, what: str, known: KnownValue
) -> LintFinding:
    """Return the finding that a constant is never the value of an argument, which `what` names."""
    text, values = str(term), values or frozenset()
    (given,) = known.of(term, {}) or {Value(None)}
    bare = text.strip('"')
    for other in (bare, f'"{bare}"'):
        if other != text and any(each.text == other for each in values):
            message = f"{what} is never {_WORDS[given.form or 'name']}, such as `{text}`"
            fix = _replaced(clause, term, other)
            return clause.finding(FORM, message, term, f"write `{other}`", fix)
    forms = {each.form for each in values}
    if None not in forms and given.form not in forms:
        wanted = " or ".join(sorted(_WORDS[form] for form in forms if form))
        message = f"{what} is {wanted}, and `{text}` is {_WORDS[given.form or 'name']}"
        advice, fix = "write what it holds", ()
        if forms == {"string"} and given.form == "name":
            advice, fix = f'write `"{text}"`', _replaced(clause, term, f'"{text}"')
        return clause.finding(FORM, message, term, advice, fix)
    texts = sorted(each.text for each in values if each.text)
    near = nearest(text, texts)
    advice = f"did you mean `{near}`?" if near else f"one of {', '.join(texts[:12])}"
    alone = [each for each in texts if nearest(text, [each])]
    fix = _replaced(clause, term, near) if near and len(alone) == 1 else ()
    return clause.finding(VALUE, f"{what} is never `{text}`", term, advice, fix)


def _replaced(clause: Clause, term: SyntaxNode, text: str) -> tuple[Fix, ...]:
    span = clause.span(term)
    return () if span is None else (Fix(span, text),)


def _wrong_heads(
    clause: Clause, head: ClauseAtom, environment: Environment, known: KnownValue
) -> Iterator[LintFinding]:
    """Yield the variables of a head whose sort differs from the declared one."""
    declared = known.declared.get(head.signature.unsigned, ())
    for term, values in zip(head.terms, declared, strict=False):
        name = name_of(term)
        given = environment.get(name) if name is not None else None
        if values and given and not known.meet(values, given):
            units = _units(values) and _units(given)
            how = "in " if units else ""
            message = f"`{name}` is {how}{_in_words(given)}"
            message += f", and the head gives it {how or 'as '}{_in_words(values)}"
            advice = f"`rules show {head.signature.unsigned}` shows what its arguments are"
            yield clause.finding(UNIT if units else SORT, message, head.node, advice)


def mixed_units(
    clauses: Sequence[Clause], judged: Set[int], known: KnownValue
) -> Iterator[LintFinding]:
    """Yield the rules that give an argument numbers of another unit than an earlier rule.

    `judged` are the numbers of the clauses to report. Arguments with a declared sort are skipped.
    """
    first: dict[tuple[Signature, int], str] = {}
    for number, clause in enumerate(clauses):
        for head, _ in clause.heads:
            signature = head.signature.unsigned
            every = known.arguments(signature)
            mixed = [at for at in known.derived[signature] if len(_units(_numbers(every[at]))) > 1]
            environment = known.environment(clause, clause.body) if mixed else {}
            for at in mixed:
                given = _units(_numbers(known.of(head.terms[at], environment)))
                before = first.setdefault((signature, at), given[0]) if given else ""
                if number in judged and given and before not in given:
                    message = f"argument {at + 1} of `{signature}` is in {given[0]} here"
                    message += f", and in {before} elsewhere"
                    advice = "bring both to one unit, or declare what it holds: `%*! ... *%`"
                    yield clause.finding(UNIT, message, head.terms[at], advice)


def _mixed_sums(
    clause: Clause, environment: Environment, known: KnownValue
) -> Iterator[LintFinding]:
    """Yield the sums and differences of numbers of two units."""
    if _SUM.search(clause.rule.text) is None:
        return
    for node in below(clause.node):
        if node.ast_type is Kind.BinaryOperation and operation_of(node) in ("+", "-"):
            left, right = known.of(node.left, environment), known.of(node.right, environment)
            one, other = _units(left), _units(right)
            if one and other and all(differ_in_unit(a, b) for a in one for b in other):
                message = f"`{node!s}` adds {' or '.join(one)} and {' or '.join(other)}"
                if operation_of(node) == "-":
                    message = message.replace(" adds ", " subtracts ")
                advice = "bring both to one unit first"
                yield clause.finding(UNIT, message, node, advice)


def _too_small(clause: Clause, term: SyntaxNode, values: Values) -> Iterator[LintFinding]:
    """Yield a finding if a number is too small for the unit of the values it is compared with."""
    if term.ast_type is Kind.Interval:
        yield from _too_small(clause, term.left, values)
        yield from _too_small(clause, term.right, values)
        return
    number, units = number_of(term), _units(values)
    if number is None or len(units) != 1 or units[0] not in _FINE:
        return
    whole, unit = UNITS[units[0]]
    if 0 < abs(number) < whole:
        message = f"`{number}` {units[0]} are {measured(number, units[0])}"
        advice = f"for {number}{unit} write `{number * whole}`"
        yield clause.finding(UNIT, message, term, advice)


def _units(values: Values) -> list[str]:
    """Return the units of values, ignoring words such as `none`; empty unless all are measures."""
    numbers = [each for each in values or () if each.form != "name"]
    sorts = sorted(each.sort for each in numbers if each.sort in UNITS)
    return sorts if len(sorts) == len(numbers) else []


def _in_words(values: Values) -> str:
    texts = sorted(
        each.sort or (f"`{each.text}`" if each.text else _WORDS[each.form or "name"])
        for each in values or ()
    )
    more = f" or {len(texts) - 4} others" if len(texts) > 5 else ""
    shown = map(_with_article, texts[:4] if more else texts)
    return f"{' or '.join(shown) or 'nothing'}{more}"


def _with_article(text: str) -> str:
    """Return a sort with its article (`a module`); none for quoted text and measures."""
    if text.startswith(("`", "a ")) or text in UNITS:
        return text
    return f"{'an' if text[0] in 'aeiou' else 'a'} {text}"
