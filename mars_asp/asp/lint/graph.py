"""Which predicates rest on which: those that rest on themselves are in one circle."""

from collections.abc import Iterable, Mapping
from functools import cached_property

from mars_asp.asp.lint.clauses import Clause
from mars_asp.asp.signature import Signature


class PredicateGraph:
    """The predicates that heads rest on; signs of classical negation tell two apart."""

    def __init__(self, clauses: Iterable[Clause]) -> None:
        self._below: dict[Signature, dict[Signature, None]] = {}
        for clause in clauses:
            read = dict.fromkeys(atom.signature for atom in clause.read)
            for head, _ in clause.heads:
                self._below.setdefault(head.signature, {}).update(read)

    @cached_property
    def circle(self) -> Mapping[Signature, int]:
        """Return the number of its circle by each predicate that rests on itself."""
        order: dict[Signature, int] = {}
        least: dict[Signature, int] = {}
        open_: dict[Signature, None] = {}
        found: dict[Signature, int] = {}
        for start in self._below:
            if start in order:
                continue
            # Tarjan's components, by hand, for chains of rules are long.
            order[start] = least[start] = len(order)
            open_[start] = None
            stack = [(start, iter(self._below[start]))]
            while stack:
                one, rest = stack[-1]
                other = next(rest, None)
                if other is None:
                    stack.pop()
                    if stack:
                        above = stack[-1][0]
                        least[above] = min(least[above], least[one])
                    if least[one] == order[one]:
                        self._close(one, open_, found)
                elif other not in order:
                    order[other] = least[other] = len(order)
                    open_[other] = None
                    stack.append((other, iter(self._below.get(other, ()))))
                elif other in open_:
                    least[one] = min(least[one], order[other])
        return found

    def _close(
        self, one: Signature, open_: dict[Signature, None], found: dict[Signature, int]
    ) -> None:
        component = []
        while one in open_:
            component.append(open_.popitem()[0])
        if len(component) > 1 or one in self._below.get(one, ()):
            number = len(found)
            found.update((each, number) for each in component)
