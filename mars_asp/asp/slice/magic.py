"""Which instances of predicates a question can need: magic sets, from the question outwards.

After Bancilhon, Maier, Sagiv and Ullman (1986) and, for rules with negation, Faber, Greco and Leone
(2007). For a question about `a("M")` and the rules

    a(X) :- b(R, X), not c(R).        c(R) :- d(R, Y), not e(Y).

of which `b`, `d` and `e` are given, a demand program is written:

    _need1p0_a("M").
    _need2p1_b(X) :- _need1p0_a(X).
    _may2p1_b(R,X) :- _need2p1_b(X), (R,X,) = @given("b",(1,),(X,)).
    _need1p0_c(R) :- _need1p0_a(X), _may2p1_b(R,X).
    _may1p0_a(X) :- _need1p0_a(X), _may2p1_b(R,X).

and so on: `_need` atoms say which values bind some arguments of what is asked, `_may` atoms are a
superset of what is true of that, as negation, aggregates and comparisons are left out of them. An
argument that such a program cannot know, as the value of an aggregate or a sum, `_may` atoms leave
out, so there are finitely many. Where no value binds anything that facts are found by, all of the
predicate is needed.

Why this is exact: let U be the atoms that are needed. A rule whose head is in U either has all of
its body in U, or a positive literal in U that is no `_may` atom and so never true. Without the
rules of the second sort, U is a splitting set (Lifschitz and Turner 1994): the others decide U from
the given facts in U alone. Guarded by `_need` atoms, rules derive nothing outside of U. So that
grounding finds the same facts in any order, rules that choose or are recursive through negation
have no demand program, as have literals that it does not know.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field
from typing import NamedTuple

from mars_asp.asp.rules.statements import Literal, Pattern, Statement
from mars_asp.asp.signature import Signature


class Asked(NamedTuple):
    """A predicate of which some arguments are bound, by their positions from 0."""

    signature: Signature
    bound: tuple[int, ...]

    def atom(self, kind: str, terms: Iterable[str]) -> str:
        """Return an atom about this: `_need`, what is asked, or `_may`, what could be true."""
        name, arity, positive = self.signature
        sign = "p" if positive else "n"
        places = "_".join(map(str, self.bound))
        inside = ",".join(terms)
        return f"{kind}{arity}{sign}{places}_{name}" + (f"({inside})" if inside else "")


@dataclass(frozen=True, slots=True)
class Demand:
    """How to find out what a question of one form needs, and its rules restricted to that.

    `asked` is its form. `program` says what follows from the question, and calls
    `@given(Name, Positions, Values)` for the facts with some values of the given predicates
    `found`; of those in `whole` all facts are needed. `guarded` are rules that read `_need` atoms.
    """

    asked: tuple[Asked, ...]
    program: str
    guarded: str
    whole: frozenset[str]
    found: frozenset[str]

    def asking(self, values: Sequence[Sequence[str]]) -> str:
        """Return the program with the question: texts of the terms that bind what is asked."""
        facts = (f"{each.atom('_need', terms)}." for each in self.asked for terms in values)
        return "\n".join((*facts, self.program))


def demand_of(
    rules: Sequence[Statement],
    asked: Sequence[Asked],
    keys: Mapping[Signature, Sequence[int]],
) -> Demand | None:
    """Return the demand of atoms on the rules behind them; `None` where it cannot be told.

    `keys` are, for all given predicates, the positions of arguments by which their facts can be
    found.
    """
    if not are_forced(rules) or negates_itself(rules):
        return None
    writer = _Writer(keys)
    for rule in rules:
        writer.rules.setdefault(rule.head.signature, []).append(rule)
    if not all(writer.is_derived(each.signature) for each in asked):
        return None
    lines = writer.program(asked)
    return Demand(
        tuple(asked),
        "\n".join(lines),
        "\n".join(writer.guarded()),
        frozenset(each.name for each in writer.whole if each in keys),
        frozenset(each.signature.name for each in writer.seen if each.signature in keys),
    )


def are_forced(rules: Iterable[Statement]) -> bool:
    """Whether each rule forces one atom, by literals that are known."""
    return all(rule.known and rule.forces for rule in rules)


def negates_itself(rules: Iterable[Statement]) -> bool:
    """Whether recursion leads through anything but positive literals."""
    reads: dict[Signature, set[Signature]] = {}
    others: set[tuple[Signature, Signature]] = set()
    for rule in rules:
        head = rule.head.signature
        rest = {literal.signature for part in rule.parts for literal in part}
        read = reads.setdefault(head, set())
        read |= rule.reads
        others |= {(head, each) for each in rest}
    recursive = _recursive(reads)
    others = {pair for pair in others if recursive.keys() >= set(pair)}
    behind = {read: _behind(read, recursive) for _, read in others}
    return any(head in behind[read] for head, read in others)


def _recursive(reads: Mapping[Signature, Set[Signature]]) -> Mapping[Signature, Set[Signature]]:
    """Return the predicates that depend on a recursive one, each with its dependencies."""
    left = dict(reads)
    while idle := [head for head, read in left.items() if left.keys().isdisjoint(read)]:
        for head in idle:
            del left[head]
    return left


def _behind(
    start: Signature, reads: Mapping[Signature, Iterable[Signature]]
) -> frozenset[Signature]:
    """Return what a predicate reads, what that reads and so on, itself too."""
    found = {start}
    waiting = [start]
    while waiting:
        new = set(reads.get(waiting.pop(), ())) - found
        found |= new
        waiting += new
    return frozenset(found)


@dataclass
class _Writer:
    """Writes one demand program."""

    keys: Mapping[Signature, Sequence[int]]
    rules: dict[Signature, list[Statement]] = field(default_factory=dict)
    #: What is asked about, in the order in which it is found.
    seen: dict[Asked, None] = field(default_factory=dict)
    #: The predicates of which everything is needed.
    whole: set[Signature] = field(default_factory=set)
    #: The positions at which `_may` atoms have no value.
    unknown: dict[Asked, set[int]] = field(default_factory=dict)

    def is_derived(self, signature: Signature) -> bool:
        """Whether rules alone say what is true of a predicate."""
        return signature in self.rules and signature not in self.keys

    def program(self, asked: Sequence[Asked]) -> list[str]:
        """Return the demand program without the question itself.

        At first every argument is held to be known; what turns out not to be is noted, and all is
        written again.
        """
        before, unknown = -1, 0
        lines: list[str] = []
        while before != unknown:
            self.seen, self.whole, lines = dict.fromkeys(asked), set(), []
            waiting = list(asked)
            while waiting:
                each = waiting.pop()
                known = len(self.seen)
                lines += self._demand(each) if self.is_derived(each.signature) else _lookup(each)
                waiting += list(self.seen)[known:]
            before, unknown = unknown, sum(map(len, self.unknown.values()))
        return lines

    def guarded(self) -> Iterator[str]:
        """Yield the rules, restricted to what is needed."""
        for signature, rules in self.rules.items():
            guards = [asked for asked in self.seen if asked.signature == signature]
            for rule in rules:
                if signature in self.whole:
                    yield rule.with_body(())
                else:
                    yield from (rule.with_body((_needed(asked, rule),)) for asked in guards)

    def _demand(self, asked: Asked) -> Iterator[str]:
        """Yield what atoms that are asked for ask for in turn, and which of them could be true."""
        for rule in self.rules[asked.signature]:
            terms = rule.head.terms
            bound = {name for place in asked.bound for name in terms[place].variables}
            joined = [_needed(asked, rule)]
            yield from self._join(rule.body.positive, joined, bound)
            for part in rule.parts:
                inner, known = [*joined], {*bound}
                yield from self._join((each for each in part if each.binds), inner, known)
                for literal in part:
                    if not literal.binds:
                        yield from self._ask(literal, inner, known)
            unknown = self.unknown.setdefault(asked, set())
            for place, term in enumerate(terms):
                told = place in asked.bound and term.is_plain
                if not (told or _is_known(term, bound)):
                    unknown.add(place)
            yield f"{self._may(asked, [term.text for term in terms])} :- {', '.join(joined)}."

    def _join(
        self, literals: Iterable[Literal], joined: list[str], bound: set[str]
    ) -> Iterator[str]:
        """Ask for positive literals, first where known values lead; note what they bind."""
        waiting = list(literals)
        while waiting:
            literal = max(waiting, key=lambda each: self._promise(each, bound))
            waiting.remove(literal)
            yield from self._ask(literal, joined, bound)
            asked = self._way(literal, bound)
            if asked is not None:
                joined.append(self._may(asked, [term.or_any for term in literal.terms]))
                unknown = self.unknown.get(asked, ())
                for place, term in enumerate(literal.terms):
                    if place not in unknown:
                        bound |= term.variables

    def _ask(self, literal: Literal, joined: Sequence[str], bound: Set[str]) -> Iterator[str]:
        """Ask for an atom where what was joined holds."""
        asked = self._way(literal, bound)
        if asked is None:
            self._take_whole(literal.signature)
            return
        self.seen.setdefault(asked)
        needed = asked.atom("_need", (literal.terms[place].text for place in asked.bound))
        yield f"{needed} :- {', '.join(joined)}."

    def _promise(self, literal: Literal, bound: Set[str]) -> int:
        """Return how few instances known values may lead to; of equals the first is the best."""
        asked = self._way(literal, bound)
        if asked is None:
            return 0
        is_derived = self.is_derived(asked.signature)
        # A constant stands in very many atoms, an identifier or a name in few facts, and a fact
        # without variables, as what the architecture is, alone.
        if not any(literal.terms[place].is_variable for place in asked.bound):
            return 1 if is_derived or len(asked.bound) < asked.signature.arity else 4
        return 2 if is_derived else 3

    def _way(self, literal: Literal, bound: Set[str]) -> Asked | None:
        """Return how known values lead to a literal, if they do."""
        terms, signature = literal.terms, literal.signature
        places = [place for place, term in enumerate(terms) if _is_known(term, bound)]
        ways: Iterable[int] = places
        if not self.is_derived(signature):
            keys = () if signature in self.rules else self.keys.get(signature, ())
            ways = [place for place in places if place in keys]
        return Asked(signature, tuple(places)) if ways else None

    def _take_whole(self, signature: Signature) -> None:
        """Note that everything is needed of a predicate, and so of all that its rules read."""
        waiting = [signature]
        while waiting:
            each = waiting.pop()
            if each not in self.whole:
                self.whole.add(each)
                for rule in self.rules.get(each, ()):
                    waiting += rule.reads

    def _may(self, asked: Asked, terms: Sequence[str]) -> str:
        unknown = self.unknown.get(asked, set())
        return asked.atom("_may", (t for p, t in enumerate(terms) if p not in unknown))


def _needed(asked: Asked, rule: Statement) -> str:
    """Return the literal that asks for the head of a rule."""
    return asked.atom("_need", (rule.head.terms[place].or_any for place in asked.bound))


def _is_known(term: Pattern, bound: Set[str]) -> bool:
    """Whether a term is a known value; new ones are not made."""
    return term.is_constant or (term.is_variable and term.variables <= bound)


def _lookup(asked: Asked) -> Iterator[str]:
    """Yield the rule that finds given facts by their arguments."""
    names = [f"V{place}" for place in range(asked.signature.arity)]
    values = [names[place] for place in asked.bound]
    positions = ",".join(map(str, asked.bound))
    found = f'@given("{asked.signature.name}",({positions},),({",".join(values)},))'
    yield (
        f"{asked.atom('_may', names)} :- {asked.atom('_need', values)}, "
        f"({','.join(names)},) = {found}."
    )
