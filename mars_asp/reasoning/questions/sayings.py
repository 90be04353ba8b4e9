"""What lines of data say, as far as it makes a difference to who reads what follows from them.

Many ways to ask for a service need the same node. So lines are compared by what rules see of them,
where the rules show that it follows from a line and its two modules alone.
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence, Set
from typing import NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import statements_of
from mars_asp.asp.rules.symbols import symbol_of
from mars_asp.asp.slice.portions import Portion
from mars_asp.asp.slice.seen import UNSEEN, Seen, seen_apart
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.term_ids import arguments, as_term, atoms, text
from mars_asp.reasoning.facts.compile import RELATIONSHIPS, given
from mars_asp.reasoning.facts.parts import Parts
from mars_asp.reasoning.questions.islands import Forms, Island, Map, Saying

#: Lines are compared where there are so many islands for each saying: to compare takes a grounding.
_WORTH = 32
#: The line and its client tell whose it is what follows.
_TELLING = 2


class Reading(NamedTuple):
    """Who reads what follows from lines: a portion, the base behind it, and the facts of both."""

    portion: Portion
    base: Rulebook
    wanted: Set[str]


def differences(
    map_: Map, parts: Parts, forms: Forms, islands: Sequence[Island], reading: Reading
) -> Mapping[Saying, Hashable]:
    """Return what is seen of sayings, of those where it may be less than all.

    They are those of clients that no other line names: the line and its modules say all of them.
    """
    first: dict[Saying, int] = {}
    if parts.has_ports or parts.has_muxes:
        return {}
    for island in islands:
        leaves, _ = map_.leaves(island)
        for (number, _, _, is_left), saying in zip(leaves, forms.sayings(island), strict=True):
            if is_left:
                first.setdefault(saying, number)
        if len(first) * _WORTH > len(islands):
            return {}
    base = statements_of(rule.text for rule in reading.base.rules)
    statements = [statement for each in base.values() for statement in each]
    clients = {signature: _of_clients(signature.name) for signature in parts.connected}
    seen = seen_apart(statements, reading.portion.sights, parts.connected, clients)
    if seen is None:
        return {}
    modules = {end for number in first.values() for end in map_.ends[number]}
    facts = parts.facts(modules, {*first.values()}, reading.wanted)
    things = [_things(map_, parts, number) for number in first.values()]
    found = _found(grounded(facts, reading.base), seen, things)
    return {} if found is None else dict(zip(first, found, strict=True))


def grounded(facts: Iterable[Fact], base: Rulebook) -> Grounding:
    """Return what rules of the base derive of facts, for nothing but to be read."""
    program = [*base.fragments("base"), given(facts)]
    return Grounding(program, solved=False)


def _of_clients(predicate: str) -> tuple[int, ...]:
    """Return the arguments that name a line or its client, of facts about lines."""
    if predicate == "uses_data_from":
        return 0, 1
    return (0,) if predicate in RELATIONSHIPS - {"place"} else ()


def _things(map_: Map, parts: Parts, number: int) -> Sequence[str | int]:
    """Return the names and identifiers of a line, its client and its source, in an order."""
    client, source = map_.ends[number]
    return number, client, source, *parts.annotations(client), *parts.annotations(source)


def _found(
    grounding: Grounding, seen: Sequence[Seen], things: Sequence[Sequence[str | int]]
) -> Sequence[Hashable] | None:
    """Return what is seen of lines; `None` where a value looks like a name and may be none."""
    places = [{as_term(symbol_of(thing)): at for at, thing in enumerate(each)} for each in things]
    # First come those that tell whose it is.
    owner = {term: n for n, own in enumerate(places) for term, at in own.items() if at < _TELLING}
    found: list[set[tuple[object, ...]]] = [set() for _ in things]
    for number, each in enumerate(seen):
        for atom in atoms(grounding.control, *each.sight.signature):
            values = arguments(atom)
            whose = owner.get(values[each.at])
            if whose is None:
                continue
            told: list[object] = [number]
            for at, (value, looked) in enumerate(zip(values, each.sight.terms, strict=True)):
                if looked is None:
                    place = places[whose].get(value)
                    if place is not None and at not in each.names:
                        return None
                    told.append(text(value) if place is None else place)
                elif looked not in (UNSEEN, text(value)):
                    break
            else:
                found[whose].add(tuple(told))
    return [frozenset(each) for each in found]
