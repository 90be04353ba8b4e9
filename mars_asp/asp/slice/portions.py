"""Whether rules keep the things apart that no given fact connects.

Facts name things, and say by that which of them belong together. Rules keep
them apart when each instance is about one such part alone: all its literals that tell parts apart
are linked by variables whose values hold the name or identifier of something in the part. Then the
ground program of all facts is that of the parts side by side, and each can be resolved by
itself. That is found out from the rules alone, by the shapes that hold for the arguments of every
atom they can derive.

What the rules of the base derive is known as a whole; only the rules of the resolution need to
keep parts apart. Of the others no more is asked than what they promise of their heads.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import made_of
from mars_asp.asp.rules import statements
from mars_asp.asp.rules.statements import Cost, Program, Scope, Statement, program_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.slice import linked as links
from mars_asp.asp.slice import seen, shapes
from mars_asp.asp.slice.linked import Positions, Shapes, groups_of, is_apart, shapes_of, tells
from mars_asp.asp.slice.seen import UNSEEN, Sight, sights
from mars_asp.asp.slice.shapes import OWN
from mars_asp.asp.solve.disjoint_sets import DisjointSets


class Portion(NamedTuple):
    """Rules, and what they read that they do not derive, by predicate.

    `settled` are those that leave nothing open and depend on nothing that is; `choosing` are all
    others, with what is projected. `of_parts` has the position of an argument that is a name or
    identifier of the part to which an atom belongs; what is in `of_all` belongs to every part.
    `sights` are how they see all that.
    """

    settled: str
    choosing: str
    derived: frozenset[Signature]
    of_parts: Mapping[Signature, int]
    of_all: frozenset[Signature]
    sights: frozenset[Sight]


class Apart(NamedTuple):
    """A resolution, and the portions of it that decide something, each without the others.

    The base keeps parts apart, too, where every part has the facts of others that are needed
    `everywhere`: by their predicates, the arguments that rules look at. Of facts that are equal in
    these, one is enough.
    """

    whole: Portion
    deciding: tuple[Portion, ...]
    everywhere: Positions


def kept_apart(base: str, resolution: str, given: Positions) -> Apart | None:
    """Return how a resolution can be grounded part by part; `None` where that is not sure.

    `base` and `resolution` are the texts of the rules; `given` says of given predicates which
    arguments are names or identifiers of what a fact connects.
    """
    makers = (__file__, links.__file__, seen.__file__, shapes.__file__, statements.__file__)
    key = (base, resolution, tuple(sorted(given.items())))
    made = made_of("apart", map(Path, makers), [key], lambda _: _apart(base, resolution, given))
    return made[key]


def _live(statements: Sequence[Statement], known: Set[Signature]) -> tuple[Statement, ...]:
    """Return statements without those that rest on what nothing derives, or on its absence.

    What rule packs alone derive is nothing where there are none.
    """
    live = tuple(statements)
    while True:
        there = known | _derived(live)
        kept = tuple(
            each for each in live if all(one.signature in there for one in each.body.positive)
        )
        if len(kept) == len(live):
            return tuple(replace(each, body=_without(each.body, there)) for each in kept)
        live = kept


def _without(scope: Scope, there: Set[Signature]) -> Scope:
    others = tuple(each for each in scope.others if each.signature in there)
    return scope if len(others) == len(scope.others) else scope._replace(others=others)


def _apart(base: str, resolution: str, given: Positions) -> Apart | None:
    derivations, resolving = program_of(base), program_of(resolution)
    if derivations is None or resolving is None:
        return None
    known = given.keys() | _derived(derivations.statements)
    resolving = resolving._replace(statements=_live(resolving.statements, known))
    derived = _derived(resolving.statements)
    if derived & (given.keys() | _derived(derivations.statements)):
        return None
    own = shapes_of((*derivations.statements, *resolving.statements), given)
    if not all(is_apart(statement, own, derived) for statement in resolving.statements):
        return None
    if not _tell_costs_apart(resolving.statements, own):
        return None
    read = frozenset().union(*(each.reads for each in resolving.statements)) - derived
    plain = {
        signature: [at for at, shape in enumerate(own[signature]) if shape == OWN]
        for signature in read
        if tells(own, signature)
    }
    if not all(plain.values()):
        return None
    of_parts = {signature: positions[0] for signature, positions in plain.items()}
    whole, *deciding = (
        _portion(each, resolving.projected, of_parts)
        for each in (resolving.statements, *_deciding(resolving, derived))
    )
    return Apart(whole, tuple(deciding), _everywhere(derivations.statements, own))


def _derived(each: Iterable[Statement]) -> frozenset[Signature]:
    return frozenset().union(*(statement.derives for statement in each))


def _tell_costs_apart(each: Iterable[Statement], own: Shapes) -> bool:
    """Whether no tuple is one of two parts, as tuples say at one place whose they are."""
    places: dict[str, set[int]] = {}
    for statement in each:
        if statement.cost is not None:
            main = groups_of(statement.body.positive, own)
            known = main[0].shapes if main else {}
            terms = enumerate(statement.cost.terms)
            found = {at for at, term in terms if shapes.put_together(term.structure, known)}
            level = statement.cost.level
            places[level] = places.get(level, found) & found
    return all(places.values())


def _everywhere(base: Sequence[Statement], own: Shapes) -> Positions:
    """Return what is read, however indirectly, by statements that are about several parts.

    With such facts of others each of them has the instances that it has for the whole. All other
    statements are about one part, so what they derive of it needs no facts of another.
    """
    derived = _derived(base)
    behind: dict[str, Statement] = {}
    new = [each for each in base if not is_apart(each, own, derived)]
    while new:
        behind.update((each.text, each) for each in new)
        read = frozenset().union(*(each.reads for each in new))
        new = [each for each in base if each.derives & read and each.text not in behind]
    found: dict[Signature, set[int]] = {}
    for signature, terms in sights(behind.values()):
        if signature not in derived:
            looked = (at for at, term in enumerate(terms) if term != UNSEEN)
            found.setdefault(signature, set()).update(looked)
    return {signature: tuple(sorted(found[signature])) for signature in sorted(found)}


# ---- What decides --------------------------------------------------------------------------------


def _deciding(program: Program, derived: Set[Signature]) -> Iterator[Sequence[Statement]]:
    """Yield the statements on which choices, constraints and costs depend, as they hang together.

    Statements hang together when they name a predicate that the resolution derives, and costs when
    they could count a tuple once.
    """
    waiting = [s for s in program.statements if s.offers or not s.heads]
    found: dict[str, Statement] = {}
    while waiting:
        statement = waiting.pop()
        if statement.text not in found:
            found[statement.text] = statement
            needed = (statement.reads | statement.derives) & derived
            waiting += (s for s in program.statements if s.derives & needed)
    sets: DisjointSets[Signature] = DisjointSets()
    for statement in found.values():
        sets.join(sorted((statement.reads | statement.derives) & derived))
    costs = [s for s in found.values() if s.cost is not None and s.reads & derived]
    for one, other in combinations(costs, 2):
        if one.cost is not None and other.cost is not None and _meet(one.cost, other.cost):
            sets.join(sorted((one.reads | other.reads) & derived))
    for members in sets.members(sorted(sets.parent)).values():
        together = frozenset(members)
        yield [
            s
            for s in program.statements
            if s.text in found and not together.isdisjoint(s.reads | s.derives)
        ]


def _meet(one: Cost, other: Cost) -> bool:
    """Whether a tuple of one cost could be one of the other."""
    pairs = ((a.constant, b.constant) for a, b in zip(one.terms, other.terms, strict=False))
    return one.level == other.level and not any(a and b and a != b for a, b in pairs)


def _portion(
    each: Iterable[Statement], projected: Iterable[Signature], of_parts: Mapping[Signature, int]
) -> Portion:
    each = tuple(each)
    derived = _derived(each)
    read = frozenset().union(*(statement.reads for statement in each)) - derived
    own = {signature: at for signature, at in of_parts.items() if signature in read}
    looking = frozenset(sight for sight in sights(each) if sight.signature in read)
    settled = _settled(each)
    sure = [s.text for s in each if s.forces and s.derives <= settled]
    others = [s.text for s in each if not (s.forces and s.derives <= settled)]
    others += [f"#project {each}." for each in sorted(frozenset(projected) & derived)]
    texts = "\n".join(sure), "\n".join(others)
    return Portion(*texts, derived, own, read - own.keys(), looking)


def _settled(each: Sequence[Statement]) -> frozenset[Signature]:
    """Return the predicates on which no choice has any influence, not even by recursion.

    What rules do not read positively has to be settled without what they derive.
    """
    derived, settled = _derived(each), frozenset[Signature]()
    while True:
        more = derived
        while open_ := _derived(s for s in each if not _settles(s, more, settled, derived)) & more:
            more -= open_
        if more == settled:
            return settled
        settled = more


def _settles(
    statement: Statement, more: Set[Signature], settled: Set[Signature], derived: Set[Signature]
) -> bool:
    """Whether a rule leaves nothing open where predicates are `settled`, and `more` may be, too."""
    positive = {literal.signature for literal in statement.body.positive}
    others = {literal.signature for part in statement.parts for literal in part}
    return statement.forces and positive & derived <= more and others & derived <= settled
