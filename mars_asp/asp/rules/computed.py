"""Additional rules that record the operands of a rule's operations, so that Python can check them.

clingo's integers wrap at 32 bits silently. Operands are recorded for all instances of the other
literals, without those that depend on the result.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import memoized
from mars_asp.asp.rules.statements import (
    FILES,
    ArithmeticReader,
    Operand,
    Operation,
    Place,
    refusals,
    rule_operands,
    variants,
)
from mars_asp.asp.rules.trees import (
    FUNCTIONS,
    WITH_ELEMENTS,
    Kind,
    SyntaxNode,
    atom_of,
    elements_of,
    global_names,
    guards_of,
    names_in,
)

#: Operations that never leave 32 bits if their operands do not.
_FITS = frozenset({"&", "?", "^", "~", "/", "\\", ""})
_SUMS = ("sum", "sumplus")
#: A string or a word, such as the name of a variable.
_WORD = re.compile(r""""(?:[^"\\]|\\.)*"|(?<![\w'])[\w']+""")
_UNSAFE = re.compile(r"note: '(\w+'*)' is unsafe")
_NONE: frozenset[str] = frozenset()


class Computed(NamedTuple):
    """An operation of a rule, and a body that binds its `leaves`."""

    operation: Operation
    leaves: tuple[str, ...]
    body: str


class Summed(NamedTuple):
    """An element of a sum, and the body under which it counts.

    Elements of one sum, at one `place` of a rule, are added for each instance of the variables
    `shared`. `negative` is whether negative weights count.
    """

    place: Place
    negative: bool
    terms: tuple[str, ...]
    shared: tuple[str, ...]
    body: str


class _Literal(NamedTuple):
    """A literal of a body or condition in clingo's syntax, and its variables."""

    text: str
    names: frozenset[str]

    def renamed(self, names: Mapping[str, str]) -> "_Literal":
        """Return the literal with other names for some variables."""
        if self.names.isdisjoint(names):
            return self
        return _Literal(
            _WORD.sub(lambda found: names.get(found[0], found[0]), self.text),
            frozenset(names.get(each, each) for each in self.names),
        )


class _Site(NamedTuple):
    """A term or literal whose arithmetic is examined, with the literals that hold `beside` it.

    `own` is the node itself if it is a literal that can bind variables, else empty.
    """

    node: SyntaxNode
    beside: tuple[_Literal, ...]
    own: tuple[_Literal, ...] = ()


def computations(texts: Iterable[str]) -> dict[str, tuple[Computed | Summed, ...]]:
    """Return the operations of each rule that can leave 32 bits."""
    # Most rules compute nothing.
    risky = (text for text in texts if "#sum" in text or any(map(_is_open, rule_operands(text))))
    return memoized("computations", (Path(__file__), *FILES), risky, _computations)


def _is_open(operand: Operand) -> bool:
    """Whether an operation depends on values of variables and may exceed 32 bits."""
    return isinstance(operand, Operation) and bool(leaves(operand)) and not _fits(operand)


def _fits(operand: Operand) -> bool:
    if isinstance(operand, Operation):
        return operand.sign in _FITS and all(map(_fits, operand.operands))
    return True


def leaves(operand: Operand) -> tuple[str, ...]:
    """Return the operands of an operation, without numbers and duplicates, at any depth."""
    if isinstance(operand, Operation):
        found = (leaf for inner in operand.operands for leaf in leaves(inner))
        return tuple(dict.fromkeys(found))
    return (operand,) if isinstance(operand, str) else ()


def _computations(text: str) -> tuple[Computed | Summed, ...]:
    found: dict[Computed | Summed, None] = {}
    reader = ArithmeticReader(text)
    for rule in variants(text):
        beside = _beside(rule)
        for site in _sites(rule, beside):
            for operation in reader.outermost(site.node):
                if isinstance(operation, Operation) and _is_open(operation):
                    result = leaves(operation)
                    body = _body(result, site)
                    if body is not None:
                        found[Computed(operation, result, _written(body))] = None
        found.update((summed, None) for summed in _sums(rule, beside, reader))
    return tuple(found)


def _sites(rule: SyntaxNode, beside: tuple[_Literal, ...]) -> Iterator[_Site]:
    """Yield the head and each literal of a rule, as sites, with the other literals of the body."""
    yield from _sites_in(rule.head, beside, ())
    for number, node in enumerate(rule.body):
        rest = (*beside[:number], *beside[number + 1 :])
        yield from _sites_in(node, rest, (_literal(node),))


def _sites_in(
    node: SyntaxNode, rest: tuple[_Literal, ...], own: tuple[_Literal, ...]
) -> Iterator[_Site]:
    """Yield each guard and element of a head or literal as a site; itself if it has none."""
    atom = atom_of(node)
    if atom.ast_type not in WITH_ELEMENTS:
        yield _Site(node, rest, own)
    for guard in guards_of(atom):
        yield _Site(guard, rest)
    for entries, condition in elements_of(atom):
        literals = tuple(map(_literal, condition))
        for entry in entries:
            yield _Site(entry, (*rest, *literals))
        for number, inner in enumerate(condition):
            others = (*literals[:number], *literals[number + 1 :])
            yield _Site(inner, (*rest, *others), (literals[number],))


def _beside(rule: SyntaxNode) -> tuple[_Literal, ...]:
    """Return the body of a rule, with the local variables of its elements renamed.

    So the literals can be joined with those of an element of the rule.
    """
    known = names_in(rule)
    body = tuple(map(_literal, rule.body))
    shared = global_names((rule.head, *rule.body))
    if known == shared:
        return body
    suffix = "_"
    while any(f"{name}{suffix}" in known for name in known):
        suffix += "_"
    local = {name: f"{name}{suffix}" for name in known - shared}
    return tuple(literal.renamed(local) for literal in body)


def _sums(
    rule: SyntaxNode, beside: tuple[_Literal, ...], reader: ArithmeticReader
) -> Iterator[Summed]:
    aggregates = [(rule.head, beside)]
    for number, literal in enumerate(rule.body):
        if literal.ast_type is Kind.Literal:
            aggregates.append((literal.atom, (*beside[:number], *beside[number + 1 :])))
    for aggregate, rest in aggregates:
        function = FUNCTIONS[getattr(aggregate, "function", 0)]
        if function not in _SUMS:
            continue
        names, outside = sorted(names_in(aggregate)), frozenset(rest)
        for element, (_, condition) in zip(aggregate.elements, elements_of(aggregate), strict=True):
            # An element without a term weighs nothing.
            if not element.terms:
                continue
            terms = tuple(map(str, element.terms))
            kept = _body(terms, _Site(aggregate, (*rest, *map(_literal, condition))))
            if kept is not None:
                varying = _unsafe_names(names, [each for each in kept if each in outside])
                shared = tuple(name for name in names if name not in varying)
                negative = function == "sum"
                yield Summed(reader.place(aggregate), negative, terms, shared, _written(kept))


def _body(values: Sequence[str], site: _Site) -> tuple[_Literal, ...] | None:
    """Return literals of a site that bind all `values`, or None if that is impossible.

    Literals are left out if only the computed result binds one of their variables.
    """
    kept = site.beside
    for own in ((), site.own):
        while missing := _unsafe_names(values, (*kept, *own)):
            bound = tuple(literal for literal in kept if not literal.names & missing)
            if len(bound) == len(kept):
                break
            kept = bound
        else:
            return (*kept, *own)
    whole = (*site.beside, *site.own)
    return None if _unsafe_names(values, whole) else whole


def _literal(node: SyntaxNode) -> _Literal:
    return _Literal(str(node), names_in(node))


def _written(literals: Iterable[_Literal]) -> str:
    """Return the literals as the text of a body."""
    return "; ".join(literal.text for literal in literals) or "#true"


def _unsafe_names(values: Sequence[str], literals: Iterable[_Literal]) -> frozenset[str]:
    """Return the variables that would be unsafe in a rule over `values` with such a body."""
    notes = refusals(f"_computed({','.join(values)}) :- {_written(literals)}.")
    # An anonymous variable can be bound by nothing else.
    return _NONE if notes is None else frozenset({"_"}.union(*map(_UNSAFE.findall, notes)))
