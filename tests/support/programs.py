"""Small programs for the tests of traces: rules as text, solved by clingo."""

from collections.abc import Iterable

import clingo
from clingo import ast

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.atoms import Atom, Fact, Term
from mars_asp.asp.solve.term_ids import TermId, as_term
from mars_asp.asp.trace import Explainer
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.diagnostic import Span


def rulebook_of(text: str) -> Rulebook:
    """Return the rules of a program, each with its text as its message."""
    rules: list[Rule] = []

    def add(statement: ast.AST) -> None:
        if statement.ast_type == ast.ASTType.Rule:
            begin = statement.location.begin
            span = Span("program", begin.line, begin.column, begin.line, begin.column)
            name = f"program/{len(rules)}"
            rules.append(Rule(name, str(statement), None, span, str(statement), "base"))

    ast.parse_string(text, add)
    return Rulebook(tuple(rules), (("base", text),))


def explainer_of(
    text: str, given: Iterable[str] = ()
) -> tuple[Explainer, frozenset[clingo.Symbol]] | None:
    """Return an explainer of a program's first answer set, and that; `None` where there is none.

    `given` are atoms, as facts of the input.
    """
    facts = [clingo.parse_term(atom) for atom in given]
    control = clingo.Control(["--seed=1", "--warn=none"])
    control.add("base", [], text + "".join(f"\n{fact}." for fact in facts))
    control.ground([("base", [])])
    found: list[frozenset[clingo.Symbol]] = []
    control.solve(on_model=lambda model: found.append(frozenset(model.symbols(atoms=True))))
    if not found:
        return None
    rulebook = rulebook_of(text)
    opened: dict[Signature, list[TermId]] = {}
    for atom in control.symbolic_atoms:
        if not atom.is_fact:
            opened[signature_of(atom.symbol)] = []
    for symbol in found[0]:
        signature = signature_of(symbol)
        if signature in opened:
            opened[signature].append(as_term(symbol))
    place = Span("facts", 1, 1, 1, 1)
    leaves = GivenFacts(Fact(atom_of(fact), place) for fact in facts)
    return Explainer(rulebook, control, leaves, opened), found[0]


def atom_of(symbol: clingo.Symbol) -> Atom:
    """Return clingo's symbol of an atom as an atom of ours."""
    return Atom(symbol.name, tuple(map(_term_of, symbol.arguments)))


def _term_of(symbol: clingo.Symbol) -> Term:
    if symbol.type == clingo.SymbolType.Number:
        return symbol.number
    return symbol.string if symbol.type == clingo.SymbolType.String else atom_of(symbol)
