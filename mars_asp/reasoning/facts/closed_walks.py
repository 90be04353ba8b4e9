"""Cycles of relationships as facts."""

from collections.abc import Iterable, Iterator

from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.model.cycles import Knot, knots
from mars_asp.model.declarations import Control, Data, Gating, Mount, Relationship
from mars_asp.reasoning.facts.ends import Ends

#: The kinds of relationships, as facts about cycles name them.
KNOTS = ("data", "control", "mount", "gate")
#: Of a longer cycle, modules in the middle are left out in messages.
_MOST_SPELT = 20


def closed_walks(lines: Iterable[tuple[int, Relationship]], ends: Ends) -> Iterator[Fact]:
    """Yield the facts of the cycles among numbered relationships of one kind."""
    data, control, mounts, gates = [], [], [], []
    spans = {}
    for number, relationship in lines:
        spans[number] = relationship.span
        match relationship:
            case Data(client, source):
                data.append((source, client, number))
            case Control(controlled, controller):
                control.append((controlled, controller, number))
            case Mount(mounting, mounted):
                mounts.append((mounting, mounted, number))
            case Gating(_, trigger, trigger_port=port):
                taken = ends.taken(trigger, port), ends.gated(relationship)
                gates.append((*taken, number))
    for kind, edges in zip(KNOTS, (data, control, mounts, gates), strict=True):
        for index, knot in enumerate(knots(edges)):
            of = Atom(kind), index
            for step, (start, end, number) in enumerate(knot.walk):
                yield Fact(Atom("closed_walk", (*of, step, start, end, number)), spans[number])
            span = spans[knot.walk[0][2]]
            for name in knot.nodes:
                yield Fact(Atom("entangled", (*of, name)), span)
            yield Fact(Atom("spelt", (*of, _spelt(kind, knot))), span)


def _spelt(kind: str, knot: Knot) -> str:
    """Return a cycle as `A -> B -> A`, from the controller on if `kind` is `control`."""
    first, *others = (start for start, _, _ in knot.walk)
    if kind == "control":
        others.reverse()
    if len(others) > _MOST_SPELT:
        others[_MOST_SPELT // 2 : -(_MOST_SPELT // 2)] = ["..."]
    return " -> ".join([first, *others, first])
