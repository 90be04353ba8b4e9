"""Each rule rewritten into rules that find its firings, asked from the head down.

For a rule `h(X) :- b(X,Y), not c(Y)` with number r, and question k:

    _s(k,r,h(X),p(b(X,Y)),a(c(Y)),v(X,Y)) :- _ask_h(k,X), b(X,Y), not c(Y).
    _ask_b(k,X,Y) :- _s(k,r,h(X),p(b(X,Y)),a(c(Y)),v(X,Y)).

Elements of aggregates and instances of conditional literals come as `_e` atoms of a firing.
A predicate that is decided only by solving, `open`, is read from copies `_t_h` of its true atoms.
The terms of the firing atom are evaluated by clingo itself, so arithmetic needs no second reading.
"""

import re
from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass, field
from typing import TypeAlias

from clingo import ast

from mars_asp.rulebook import Rule

Signature: TypeAlias = tuple[str, int]
_TYPE = ast.ASTType
_AGGREGATES = (_TYPE.BodyAggregate, _TYPE.Aggregate)


@dataclass
class Rewriter:
    """Writes the explanation rules of one rulebook."""

    open: Set[Signature]
    #: For rules with a construct that cannot be traced: its name, by rule number.
    unsupported: dict[int, str] = field(default_factory=dict)

    def text(self, rules: Sequence[Rule], numbers: Iterable[int]) -> str:
        """Return the explanation rules of the rules with these numbers."""
        lines: list[str] = []
        for number in numbers:
            for statement in rules[number].ast.unpool():
                lines += self._rule(number, statement)
        return "\n".join(lines)

    def _rule(self, number: int, statement: ast.AST) -> Iterator[str]:
        head = statement.head
        if head.ast_type == _TYPE.Literal:
            if head.atom.ast_type == _TYPE.SymbolicAtom:
                yield from self._firing(number, head, statement.body, ())
        elif head.ast_type == _TYPE.Aggregate:
            for element in head.elements:
                yield from self._firing(number, element.literal, statement.body, element.condition)
        elif head.ast_type == _TYPE.HeadAggregate:
            for element in head.elements:
                inner = element.condition
                yield from self._firing(number, inner.literal, statement.body, inner.condition)
        elif head.ast_type == _TYPE.Disjunction:
            for element in head.elements:
                yield from self._firing(number, element.literal, statement.body, element.condition)
        else:
            self.unsupported[number] = str(head.ast_type)

    def _firing(
        self, number: int, head: ast.AST, body: Sequence[ast.AST], condition: Sequence[ast.AST]
    ) -> Iterator[str]:
        if head.atom.ast_type != _TYPE.SymbolicAtom:
            return
        terms = _Terms()
        shown = terms.atom(head.atom.symbol, fresh_complex=True)
        premises: list[tuple[str, str]] = []
        absent: list[str] = []
        rest: list[str] = []
        sets: list[tuple[str, tuple[tuple[str, Sequence[ast.AST]], ...]]] = []
        for literal in (*body, *condition):
            if literal.ast_type == _TYPE.ConditionalLiteral:
                rest.append(self._renamed(literal))
                sets.append(
                    ("c", ((_inner(literal.literal), (literal.literal, *literal.condition)),))
                )
            elif literal.ast_type != _TYPE.Literal:
                self.unsupported[number] = str(literal.ast_type)
            elif literal.atom.ast_type == _TYPE.SymbolicAtom:
                self._symbolic(literal, terms, premises, absent, rest)
            else:
                rest.append(self._renamed(literal))
                if literal.atom.ast_type in _AGGREGATES:
                    sets.append(("e", tuple(_elements(literal.atom))))
                elif literal.atom.ast_type == _TYPE.TheoryAtom:
                    self.unsupported[number] = "a theory atom"
        variables = sorted(_variables((head, *terms.definitions_of(body, condition))) | terms.names)
        firing = (
            f"_s(k,{number},{shown},p({','.join(term for _, term in premises)}),"
            f"a({','.join(absent)}),v({','.join(_pair(name) for name in variables)}))"
        )
        name, arguments = _split(shown)
        asked = f"_ask_{name}(k{arguments})"
        wanted = [asked, *(text for text, _ in premises), *rest, *terms.equations]
        yield f"{firing} :- {'; '.join(wanted)}."
        for _, term in premises:
            inner, inner_arguments = _split(term)
            yield f"_ask_{inner}(k{inner_arguments}) :- {firing}."
        for index, (_, elements) in enumerate(sets):
            for _, literals in elements:
                yield from self._element(index, firing, literals)

    def _symbolic(
        self,
        literal: ast.AST,
        terms: "_Terms",
        premises: list[tuple[str, str]],
        absent: list[str],
        rest: list[str],
    ) -> None:
        symbol = literal.atom.symbol
        if literal.sign == ast.Sign.NoSign:
            shown = terms.atom(symbol)
            premises.append((self._source(shown, symbol), shown))
        else:
            rest.append(self._renamed(literal))
            if literal.sign == ast.Sign.Negation:
                absent.append(terms.pattern(symbol))

    def _element(self, index: int, firing: str, literals: Sequence[ast.AST]) -> Iterator[str]:
        terms = _Terms("E")
        premises: list[tuple[str, str]] = []
        absent: list[str] = []
        rest: list[str] = []
        for literal in literals:
            if literal.ast_type == _TYPE.Literal and literal.atom.ast_type == _TYPE.SymbolicAtom:
                self._symbolic(literal, terms, premises, absent, rest)
            elif literal.ast_type == _TYPE.Literal:
                rest.append(str(literal))
        shown = ",".join(term for _, term in premises)
        element = f"_e({firing},{index},p({shown}),a({','.join(absent)}))"
        wanted = [firing, *(text for text, _ in premises), *rest, *terms.equations]
        yield f"{element} :- {'; '.join(wanted)}."
        for _, term in premises:
            name, arguments = _split(term)
            yield f"_ask_{name}(k{arguments}) :- {element}."

    def _source(self, shown: str, symbol: ast.AST) -> str:
        """Return where the true atoms of a premise are found."""
        return f"_t_{shown}" if _signature(symbol) in self.open else shown

    def _renamed(self, literal: ast.AST) -> str:
        """Return a literal's text with open predicates read from their copies."""
        return str(_Renaming(self.open)(literal))


class _Renaming(ast.Transformer):
    """Replaces open predicates by their copies."""

    def __init__(self, opened: Set[Signature]) -> None:
        self.opened = opened

    def visit_SymbolicAtom(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        symbol = node.symbol
        if symbol.ast_type == _TYPE.Function and _signature(symbol) in self.opened:
            return node.update(symbol=symbol.update(name=f"_t_{symbol.name}"))
        return node


class _Terms:
    """Names what a term cannot show: anonymous variables, intervals, arithmetic in heads."""

    def __init__(self, prefix: str = "F") -> None:
        self.prefix = prefix
        self.names: set[str] = set()
        self.equations: list[str] = []
        self._count = 0

    def fresh(self) -> str:
        self._count += 1
        return f"_{self.prefix}{self._count}"

    def atom(self, symbol: ast.AST, fresh_complex: bool = False) -> str:
        """Return an atom's text with every argument a term that matches as it evaluates."""
        arguments = [self._argument(term, fresh_complex) for term in symbol.arguments]
        return f"{symbol.name}({','.join(arguments)})" if arguments else symbol.name

    def pattern(self, symbol: ast.AST) -> str:
        """Return a negated atom's text; what is anonymous stays so."""
        arguments = [_anonymous(term) for term in symbol.arguments]
        return f"{symbol.name}({','.join(arguments)})" if arguments else symbol.name

    def _argument(self, term: ast.AST, fresh_complex: bool) -> str:
        bare = _bare(term)
        if bare == "_":
            return self.fresh()
        if ".." in bare or (fresh_complex and _OPERATOR.search(bare)):
            name = self.fresh()
            self.equations.append(f"{name} = {term}")
            return name
        if _ANONYMOUS.search(bare) and term.ast_type == _TYPE.Function:
            inner = [self._argument(argument, fresh_complex) for argument in term.arguments]
            comma = "," if not term.name and len(inner) == 1 else ""
            return f"{term.name}({','.join(inner)}{comma})"
        return str(term)

    @staticmethod
    def definitions_of(*parts: Sequence[ast.AST]) -> list[ast.AST]:
        """Return the literals whose variables a firing is told apart by."""
        found = []
        for literal in (literal for part in parts for literal in part):
            if literal.ast_type != _TYPE.Literal or literal.sign != ast.Sign.NoSign:
                continue
            atom = literal.atom
            if atom.ast_type in _AGGREGATES:
                for guard in (atom.left_guard, atom.right_guard):
                    if guard is not None:
                        found.append(guard.term)
            else:
                found.append(literal)
        return found


def _signature(symbol: ast.AST) -> Signature:
    return symbol.name, len(symbol.arguments)


def _split(shown: str) -> tuple[str, str]:
    """Return an atom's name and its arguments, with a comma before each."""
    name, bracket, inside = shown.partition("(")
    return name, f",{inside[:-1]}" if bracket else ""


def _pair(name: str) -> str:
    return f'("{name}",{name})'


def _inner(literal: ast.AST) -> str:
    return str(literal)


def _elements(atom: ast.AST) -> Iterator[tuple[str, Sequence[ast.AST]]]:
    for element in atom.elements:
        if atom.ast_type == _TYPE.BodyAggregate:
            yield str(element), tuple(element.condition)
        else:
            yield str(element), (element.literal, *element.condition)


# Reading a term's text is many times faster than walking its tree through the foreign interface.
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')
_VARIABLE = re.compile(r"(?<![\w'])_*[A-Z][\w']*")
_ANONYMOUS = re.compile(r"(?<![\w'])_(?![\w'])")
_OPERATOR = re.compile(r"[-+*/\\&?^~|]|\.\.")


def _bare(node: ast.AST) -> str:
    """Return a node's text without its strings."""
    return _STRING.sub('""', str(node))


def _variables(nodes: Sequence[ast.AST]) -> set[str]:
    return {name for node in nodes for name in _VARIABLE.findall(_bare(node))}


def _anonymous(term: ast.AST) -> str:
    bare = _bare(term)
    if bare == "_":
        return "_any"
    if _ANONYMOUS.search(bare) and term.ast_type == _TYPE.Function:
        inner = [_anonymous(argument) for argument in term.arguments]
        comma = "," if not term.name and len(inner) == 1 else ""
        return f"{term.name}({','.join(inner)}{comma})"
    return str(term)
