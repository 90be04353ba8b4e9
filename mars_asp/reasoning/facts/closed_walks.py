"""Cycles of relationships as facts."""

from collections.abc import Iterable, Iterator, Set

from mars_asp.asp.solve.atoms import Atom, Fact
from mars_asp.model.cycles import Knot, knots
from mars_asp.model.declarations import Control, Data, Gating, Mount, Relationship
from mars_asp.reasoning.facts.ends import Ends

#: The kinds of relationships, as facts about cycles name them.
KNOTS = ("data", "control", "mount", "gate")
#: Of a longer cycle, modules in the middle are left out in messages.
_MOST_SPELT = 20


#: Follows the name of a module whose commands are meant, which may also be that of its only output.
_COMMANDS = "\n"


def closed_walks(
    lines: Iterable[tuple[int, Relationship]], ends: Ends, commanding: Set[str]
) -> Iterator[Fact]:
    """Yield the facts of the cycles among numbered relationships of one kind.

    `commanding` are the modules that a gate line without a port means the commands of.
    """
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
            case Gating(gated, trigger):
                taken = ends.taken(trigger, relationship.trigger_port)
                if relationship.trigger_port is None and trigger in commanding:
                    taken += _COMMANDS
                closed = ends.gated(relationship)
                if relationship.port is None and gated in commanding:
                    closed += _COMMANDS
                gates.append((taken, closed, number))
    for kind, edges in zip(KNOTS, (data, control, mounts, gates), strict=True):
        for index, knot in enumerate(knots(edges)):
            of = Atom(kind), index
            for step, (start, end, number) in enumerate(knot.walk):
                ends_of_step = start.removesuffix(_COMMANDS), end.removesuffix(_COMMANDS)
                yield Fact(Atom("closed_walk", (*of, step, *ends_of_step, number)), spans[number])
            span = spans[knot.walk[0][2]]
            for name in dict.fromkeys(node.removesuffix(_COMMANDS) for node in knot.nodes):
                yield Fact(Atom("entangled", (*of, name)), span)
            yield Fact(Atom("spelt", (*of, _spelt(kind, knot))), span)


def _spelt(kind: str, knot: Knot) -> str:
    """Return a cycle as `A -> B -> A`, from the controller on if `kind` is `control`."""
    first, *others = (start.removesuffix(_COMMANDS) for start, _, _ in knot.walk)
    if kind == "control":
        others.reverse()
    if len(others) > _MOST_SPELT:
        others[_MOST_SPELT // 2 : -(_MOST_SPELT // 2)] = ["..."]
    return " -> ".join([first, *others, first])
