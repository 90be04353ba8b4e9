"""Variables that occur once, so that no premise restricts their values."""

from collections.abc import Iterator, Sequence
from itertools import chain

from mars_asp.asp.lint.clauses import Clause
from mars_asp.asp.lint.found import LintFinding
from mars_asp.asp.rules.rule import HOLE
from mars_asp.asp.rules.trees import Kind, SyntaxNode, below, names_in

SINGLETON = "rule-singleton"


def single_variables(clauses: Sequence[Clause], listed: Sequence[Clause]) -> Iterator[LintFinding]:
    """Yield the variables of a rule that occur once in every variant of its pools.

    `listed` are the rules that were made from its metadata. A name that begins with `_` declares a
    single occurrence, so it is reported if it is repeated.
    """
    rule = clauses[0].rule
    nodes = chain.from_iterable(below(clause.node) for clause in clauses)
    # `{ p(X) }` has an atom for each X, so the single X counts atoms.
    sets = (node for node in nodes if node.ast_type is Kind.Aggregate)
    counted = (names_in(element.literal) for each in sets for element in each.elements)
    listed_holes = {name for _, text in rule.lists for name, _ in HOLE.findall(text)}
    allowed = listed_holes.union(rule.holes, *counted)
    places: dict[str, SyntaxNode] = {}
    most: dict[str, int] = {}
    for clause in clauses:
        _count_variables(clause.node, most, places)
    own = dict(most)
    for clause in listed:
        _count_variables(clause.node, most, {})
    for name, node in places.items():
        if name.startswith("_"):
            if own[name] > 1:
                message = f"`{name}` occurs {own[name]} times, and its name means an unused value"
                advice = (
                    f"call it `{name.lstrip('_').capitalize() or 'X'}`, or write `_` in each place"
                )
                yield clauses[0].finding(SINGLETON, message, node, advice)
        elif most[name] == 1 and name not in allowed:
            message = f"`{name}` occurs once"
            advice = f"write `_`, or `_{name}`, where any value will do; else it is misspelt"
            yield clauses[0].finding(SINGLETON, message, node, advice)


def _count_variables(node: SyntaxNode, most: dict[str, int], places: dict[str, SyntaxNode]) -> None:
    counts: dict[str, int] = {}
    for each in below(node):
        if each.ast_type is Kind.Variable and each.name != "_":
            counts[each.name] = counts.get(each.name, 0) + 1
            places.setdefault(each.name, each)
    for name, count in counts.items():
        most[name] = max(count, most.get(name, 0))
