"""Many cases of rules in one program: the first argument of each atom is the case that it is of.

A small case spends most of its time on reading the rules, so that many cases are quick together.
No two cases have an atom in common: an answer set of the program contains one of each case, and is
minimal if each of these is. A case without answer sets is left out.
"""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from functools import cache
from typing import TypeVar

import clingo
from clingo import ast

from mars_asp.asp.contained import Lost, ask
from mars_asp.asp.rules.trees import SyntaxNode
from mars_asp.asp.signature import Signature

_Read = TypeVar("_Read")
_TYPE = ast.ASTType
#: Literals with the case as first argument, by their texts: many rules have the same.
_shown: dict[str, str] = {}
#: Statements that hold in each case, by their texts and the condition of the case.
_changed: dict[tuple[str, str], str] = {}
_LOCATION = ast.Location(ast.Position("side by side", 1, 1), ast.Position("side by side", 1, 1))
_CASE = ast.Variable(_LOCATION, "CASE_")
_NUMBER = clingo.Function("number_")
#: Above all that the rules of MARS minimise.
_LEVEL = 1_000
#: A fact, which is written as text in a tenth of the time.
_FACT = re.compile(r"([a-z]\w*)\(([^;:{}|&<>=!#]+)\)\.")
#: Any of the cases has an answer, or all that can where costs count.
ANY = f"case_(C) :- of_(C, _). {{ in_(C) }} :- case_(C). #minimize {{ -1@{_LEVEL}, C : in_(C) }}."
#: Statements that stay unchanged: they are about predicates and contain no atoms of a case.
_LEFT_OUT = {
    _TYPE.Program,
    _TYPE.Defined,
    _TYPE.ShowSignature,
    _TYPE.ShowTerm,
    _TYPE.ProjectSignature,
    _TYPE.ProjectAtom,
    _TYPE.Comment,
}


@cache
def together(rules: str) -> str:
    """Return rules that hold in each case; those that refuse an answer, where the case has one."""
    return "\n".join(_written(rules, _call("case_", _CASE)))


def each_together(
    bodies: Iterable[tuple[str, Sequence[SyntaxNode]]], number: int
) -> Iterator[tuple[str, str]]:
    """Yield rules that derive atoms of a number in each case where their bodies hold."""
    for name, body in bodies:
        for literal in body:
            if str(literal) not in _shown:
                _shown[str(literal)] = str(_FIRST(literal.tree))
        premises = [*(_shown[str(literal)] for literal in body), str(_call("case_", _CASE))]
        yield name, f"{name}({_CASE},{number}) :- {'; '.join(premises)}."


def apart(number: int, facts: str) -> str:
    """Return the statements of a case, for each case `C` with `of_(C, number)`."""
    return _of_any(facts).replace(str(_NUMBER), str(number))


@cache
def _of_any(facts: str) -> str:
    return "\n".join(_written(facts, _call("of_", _CASE, ast.SymbolicTerm(_LOCATION, _NUMBER))))


def answered(program: Iterable[str], wanted: Collection[Signature]) -> set[clingo.Symbol]:
    """Return the atoms of some predicates in a best answer set of any case."""
    found = _read_best(program, wanted, lambda model: model.symbols(shown=True))
    answering = {atom.arguments[0] for atom in found if atom.name == "in_"}
    return {a for a in found if a.name != "in_" and a.arguments[0] in answering}


def printed(program: Iterable[str], wanted: Collection[Signature]) -> str:
    """Return the atoms of `answered` as text, with `in_` of each case that has an answer.

    Many atoms are read in a tenth of the time. It is found by a child, as clingo keeps each term
    until its process ends, and forks of a large process are slow.
    """
    [(_, text)] = ask([program], lambda given: _read_best(given, wanted, str), 1)
    assert not isinstance(text, Lost)
    return text


def _read_best(
    program: Iterable[str], wanted: Collection[Signature], read: Callable[[clingo.Model], _Read]
) -> _Read:
    """Read the union of the best answer sets of all cases."""
    options = ["--opt-mode=optN", "--opt-strategy=usc", "--enum-mode=brave", "--models=0"]
    control = clingo.Control([*options, "--warn=none"])
    # Most atoms of a program are of other predicates; hidden, they are not read.
    shown = (f"#show {each.signed}/{each.arity}." for each in wanted)
    control.add("base", [], "\n".join([*program, ANY, "#show in_/1.", *shown]))
    control.ground()
    with control.solve(yield_=True) as handle:
        for _ in handle:
            pass
        # It is large, so that none before it is read.
        best = handle.last()
        assert best is not None and best.optimality_proven
        return read(best)


def _written(text: str, where: ast.AST) -> Iterator[str]:
    statements: list[ast.AST] = []
    ast.parse_string(text, statements.append)
    for statement in statements:
        if statement.ast_type in _LEFT_OUT:
            continue
        key = str(statement), str(where)
        if key not in _changed:
            _changed[key] = _with_case(statement, where)
        yield _changed[key]


def _with_case(statement: ast.AST, where: ast.AST) -> str:
    fact = _FACT.fullmatch(str(statement))
    if fact is not None:
        return f"{fact[1]}({_CASE},{fact[2]}) :- {where}."
    changed = _FIRST(statement)
    if changed.ast_type == _TYPE.Rule:
        refuses = [_IS_IN] if str(changed.head) == "#false" else []
        changed = changed.update(body=[*changed.body, where, *refuses])
    elif changed.ast_type == _TYPE.Minimize:
        changed = changed.update(terms=[*changed.terms, _CASE], body=[*changed.body, where, _IS_IN])
    return str(changed)


def _call(name: str, *terms: ast.AST) -> ast.AST:
    atom = ast.SymbolicAtom(ast.Function(_LOCATION, name, terms, 0))
    return ast.Literal(_LOCATION, ast.Sign.NoSign, atom)


class _First(ast.Transformer):
    """Puts the case before the arguments of each atom."""

    def visit_SymbolicAtom(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        return node.update(symbol=self._with_first(node.symbol))

    def visit_Comparison(self, node: ast.AST) -> ast.AST:  # noqa: N802
        return node

    def _with_first(self, node: ast.AST) -> ast.AST:
        if node.ast_type == _TYPE.UnaryOperation:
            return node.update(argument=self._with_first(node.argument))
        if node.ast_type == _TYPE.Pool:
            return node.update(arguments=[self._with_first(each) for each in node.arguments])
        return node.update(arguments=[_CASE, *node.arguments])


_FIRST = _First()
_IS_IN = _call("in_", _CASE)
