"""Random programs over twelve atoms, to hold traces against a checker of their own.

`a` and `b` are propositions, `p`, `q` and `r` are about 1 and 2, `s` about pairs of them. Recursion
is free through positive literals and monotone aggregates. Negated, conditional and exactly counted
atoms are of an earlier stratum, except in some loops through negation: with these, clingo picks an
answer set or finds none.
"""

import random
from collections.abc import Iterator

PREDICATES = {"a": 0, "b": 0, "p": 1, "q": 1, "r": 1, "s": 2}
_PAIRS = ((1, 1), (1, 2), (2, 1), (2, 2))
ATOMS = (
    "a",
    "b",
    *(f"{name}({x})" for name in "pqr" for x in (1, 2)),
    *(f"s({x},{y})" for x, y in _PAIRS),
)
_LOOP = 0.08


def random_program(seed: int) -> tuple[str, tuple[str, ...]]:
    """Return the rules of a program and the atoms that are given."""
    rng = random.Random(seed)
    names = list(PREDICATES)
    rng.shuffle(names)
    strata = {name: place // rng.choice((2, 3, 6)) for place, name in enumerate(names)}
    rules = [_Rule(rng, strata).text() for _ in range(rng.randint(3, 9))]
    given = tuple(atom for atom in ATOMS if rng.random() < 0.15)
    return "\n".join(rules), given


class _Rule:
    """Writes one rule; at the end it binds the variables that no literal binds."""

    def __init__(self, rng: random.Random, strata: dict[str, int]) -> None:
        self.rng, self.strata = rng, strata
        self.head = rng.choice(list(strata))
        self.named: set[str] = set()
        self.bound: set[str] = set()

    def text(self) -> str:
        rng = self.rng
        head = self.written_head()
        body = [self.literal() for _ in range(rng.choice((0, 1, 1, 2, 2, 3)))]
        condition = ""
        if head.startswith("{"):
            head, condition = head[1:], " }"
            if rng.random() < 0.4:
                condition = f" : {self.local(self.below(0))}, V = 1..2 }}"
            head = f"{rng.choice(('', '', '1 '))}{{ {head}"
        body += [f"{name} = {self.domain()}" for name in sorted(self.named - self.bound)]
        return f"{head}{condition}{' :- ' if body else ''}{'; '.join(body)}."

    def written_head(self) -> str:
        rng = self.rng
        arguments = [self.term() for _ in range(PREDICATES[self.head])]
        if arguments and rng.random() < 0.25:
            arguments[0] = rng.choice(("1..2", "(1;2)", "3-X", "3-Y"))
            self.named |= {name for name in "XY" if name in arguments[0]}
        atom = _atom(self.head, arguments)
        if rng.random() < 0.15:
            return "{" + atom
        if rng.random() < 0.05:
            other = rng.choice(list(self.strata))
            return f"{atom} ; {_atom(other, [self.term() for _ in range(PREDICATES[other])])}"
        return atom

    def literal(self) -> str:
        kinds = (self.positive, self.negative, self.test, self.aggregate, self.conditional)
        lowest = self.strata[self.head] == 0
        return self.rng.choices(kinds, (5, 0, 1, 0, 0) if lowest else (5, 2, 1, 2, 1))[0]()

    def positive(self) -> str:
        name = self.below(0)
        arguments = [self.term() for _ in range(PREDICATES[name])]
        if arguments and self.rng.random() < 0.2:
            arguments[-1] = self.rng.choice(("_", "1..2", "(1;2)", "3-Y"))
        self.bound |= {name for name in "XY" if name in arguments or f"3-{name}" in arguments}
        return _atom(name, arguments)

    def negative(self) -> str:
        name = self.below(0 if self.rng.random() < _LOOP else 1)
        arguments = [self.term() for _ in range(PREDICATES[name])]
        if arguments and self.rng.random() < 0.2:
            arguments[-1] = "_"
        return f"not {self.rng.choice(('', '', 'not '))}{_atom(name, arguments)}"

    def test(self) -> str:
        self.named |= {"X", "Y"}
        return self.rng.choice(("X < Y", "X != Y", "X+Y > 2", "Y = 3-X", "X = 1..2", "1 <= X <= Y"))

    def aggregate(self) -> str:
        """Write an aggregate; in recursion only one that more elements can only make true."""
        rng = self.rng
        rises = rng.random() < 0.6
        inner = [self.local(self.below(0 if rises else 1)) for _ in range(rng.randint(1, 2))]
        if rng.random() < 0.3:
            inner.append(f"not {self.local(self.below(1))}")
        terms = rng.choice(("V", "V,X", "X,V"))
        self.named |= {"X"} if "X" in terms else set()
        bound = rng.choice(("1", "2", "3", "X"))
        self.named |= {"X"} if bound == "X" else set()
        shape = rng.choice(("count", "count", "sum", "max", "min", "set"))
        if shape == "set":
            condition = f"{inner[0]} : {', '.join((*inner[1:], 'V = 1..2'))}"
            return f"{bound} {{ {condition} }}" if rises else f"{{ {condition} }} {bound}"
        elements = f"{terms} : {', '.join((*inner, 'V = 1..2'))}"
        if rng.random() < 0.2:
            elements += f"; 1,c : {self.local(self.below(0 if rises else 1))}, V = 1"
        text = f"#{shape} {{ {elements} }}"
        if rises:
            return f"{text} <= {bound}" if shape == "min" else f"{bound} <= {text}"
        if rng.random() < 0.15:
            return f"not {text} > {bound}"
        if "Y" not in text and rng.random() < 0.4:
            self.bound.add("Y")
            return f"Y = {text}"
        return f"{text} {rng.choice(('=', '<=', '!=', '>=', '<'))} {bound}"

    def conditional(self) -> str:
        sign = self.rng.choice(("", "", "not "))
        inside = self.local(self.below(1 if sign else 0))
        return f"{sign}{inside} : {self.local(self.below(1))}, V = 1..2"

    def local(self, name: str) -> str:
        """Return an atom of an element, which has a variable of its own."""
        arguments = [self.term() for _ in range(PREDICATES[name])]
        if arguments:
            arguments[self.rng.randrange(len(arguments))] = "V"
        self.named |= set(arguments) & {"X", "Y"}
        return _atom(name, arguments)

    def below(self, strata: int) -> str:
        """Return a predicate so many strata below the head at least; the lowest where none is."""
        most = self.strata[self.head] - strata
        found = [name for name, stratum in self.strata.items() if stratum <= most]
        return self.rng.choice(found) if found else min(self.strata, key=self.strata.__getitem__)

    def term(self) -> str:
        term = self.rng.choice(("X", "X", "Y", "1", "2"))
        self.named |= {term} & {"X", "Y"}
        return term

    def domain(self) -> str:
        return self.rng.choice(("1..2", "(1;2)", "1", "2"))


def _atom(name: str, arguments: list[str]) -> str:
    return f"{name}({','.join(arguments)})" if arguments else name


def atoms_besides(true: Iterator[str]) -> tuple[str, ...]:
    """Return the atoms of the twelve that are not among the true ones."""
    known = set(true)
    return tuple(atom for atom in ATOMS if atom not in known)
