"""Predicates that depend on each other."""

from collections.abc import Iterable, Mapping

from mars_asp.asp.lint.clauses import Clause
from mars_asp.asp.signature import Signature


def recursive_components(clauses: Iterable[Clause]) -> Mapping[Signature, int]:
    """Return the number of its component for each predicate that depends on itself.

    Predicates with and without the sign of classical negation are different ones.
    """
    import networkx  # noqa: PLC0415 -- slow to import, and lint alone needs it

    graph = networkx.DiGraph()
    for clause in clauses:
        for head, _ in clause.heads:
            graph.add_edges_from((head.signature, atom.signature) for atom in clause.read)
    return {
        signature: number
        for number, component in enumerate(networkx.strongly_connected_components(graph))
        for signature in component
        if len(component) > 1 or graph.has_edge(signature, signature)
    }
