"""What a demand program finds is enough, and no more is derived than from all."""

import random
from collections.abc import Iterator, Sequence

import clingo
import pytest

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import Statement
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.slice.magic import Asked, demand_of
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.trace import Explainer
from mars_asp.asp.trace.document import trace_json
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.diagnostic import Span
from tests.support.campaigns import seeds
from tests.support.programs import atom_of, rulebook_of

#: Given predicates, and the arguments by which their facts are found.
KEYS = {Signature("e", 2): (0, 1), Signature("f", 2): (0,), Signature("g", 1): ()}
DERIVED = {"p": 1, "q": 2, "r": 1, "s": 2, "t": 2}
MOST = 7


def random_rules(rng: random.Random) -> Iterator[str]:
    """Yield rules; each predicate may read itself and what stands before it, negated the latter."""
    names = list(DERIVED)
    for place, name in enumerate(names):
        for _ in range(rng.randint(1, 3)):
            lower = [(each, DERIVED[each]) for each in names[:place]] + [each[:2] for each in KEYS]
            readable = [*lower, (name, DERIVED[name])] if rng.random() < 0.4 else lower
            bound: list[str] = []
            body = []
            for _ in range(rng.randint(1, 3)):
                read, arity = rng.choice(readable)
                terms = [rng.choice(("X", "Y", "Z", "X", "Y", "_", "3")) for _ in range(arity)]
                bound += [term for term in terms if term.isalpha()]
                body.append(_atom(read, terms))
            body += _others(rng, lower, bound)
            yield f"{_head(rng, name, bound, body)} :- {'; '.join(body)}."


def _others(
    rng: random.Random, lower: Sequence[tuple[str, int]], bound: list[str]
) -> Iterator[str]:
    def inner(local: str) -> str:
        read, arity = rng.choice(lower)
        terms = [rng.choice((*bound, "2", local)) for _ in range(arity)]
        terms[rng.randrange(arity)] = local
        return _atom(read, terms)

    if rng.random() < 0.4:
        read, arity = rng.choice(lower)
        yield f"not {_atom(read, [rng.choice((*bound, '_', '1')) for _ in range(arity)])}"
    if rng.random() < 0.2:
        yield f"#count {{ V : {inner('V')} }} {rng.choice(('< 2', '>= 1', '!= 1'))}"
    if rng.random() < 0.2:
        yield f"{inner('W')} : {inner('W')}"
    if bound and rng.random() < 0.2:
        yield f"{rng.choice(bound)} {rng.choice(('<', '!=', '>='))} {rng.choice((*bound, '4'))}"
    if rng.random() < 0.1:
        total = f"N = #sum {{ V : {inner('V')}, V < 3 }}"
        bound.append("N")
        yield total


def _head(rng: random.Random, name: str, bound: list[str], body: list[str]) -> str:
    terms = [rng.choice((*bound, *bound, "5")) for _ in range(DERIVED[name])]
    if bound and rng.random() < 0.2:
        # What counts up ends somewhere.
        terms[0] = rng.choice((f"{bound[0]}+1", f"h({bound[0]})", f"({bound[0]};1)"))
        body.append(f"{bound[0]} < {MOST}")
    return _atom(name, terms)


def _atom(name: str, terms: Sequence[str]) -> str:
    return f"{name}({','.join(terms)})"


class Given:
    """Finds facts as a demand program asks for them, and notes them."""

    def __init__(self, facts: Sequence[clingo.Symbol]) -> None:
        self.facts = facts
        self.found: set[clingo.Symbol] = set()

    def given(
        self, name: clingo.Symbol, positions: clingo.Symbol, values: clingo.Symbol
    ) -> list[clingo.Symbol]:
        places = [place.number for place in positions.arguments]
        assert any(place in KEYS[Signature(name.string, 2)] for place in places)
        found = [
            fact
            for fact in self.facts
            if fact.name == name.string
            and [fact.arguments[place] for place in places] == values.arguments
        ]
        self.found.update(found)
        return [clingo.Function("", fact.arguments) for fact in found]


def _grounded(text: str, context: Given | None = None) -> clingo.Control:
    control = clingo.Control(["--warn=none"])
    control.add("base", [], text)
    control.ground([("base", [])], context)
    return control


def _facts(facts: Sequence[clingo.Symbol]) -> str:
    return "".join(f"{fact}." for fact in facts)


def _true(control: clingo.Control) -> set[clingo.Symbol]:
    atoms = {atom.symbol for atom in control.symbolic_atoms if atom.is_fact}
    return {atom for atom in atoms if not atom.name.startswith("_")}


def _explained(
    rules: Rulebook, control: clingo.Control, given: Sequence[clingo.Symbol], atom: clingo.Symbol
) -> object:
    place = Span("facts", 1, 1, 1, 1)
    explainer = Explainer(rules, control, GivenFacts(Fact(atom_of(g), place) for g in given))
    return trace_json(explainer.why([atom], True)[atom])


def read(rulebook: Rulebook) -> list[Statement]:
    return [statement for rule in rulebook.rules for statement in rule.statements]


def _checked(seed: int) -> tuple[int, int]:
    """Compare what is asked of one random program; return how many facts that took, and of all."""
    rng = random.Random(seed)
    rulebook = rulebook_of("\n".join(random_rules(rng)))
    numbers = range(MOST)
    given = [
        clingo.Function(name, [clingo.Number(rng.choice(numbers)) for _ in range(arity)])
        for (name, arity, _), count in zip(KEYS, (8, 8, 3), strict=True)
        for _ in range(count)
    ]
    given = sorted(set(given))
    every = f"{rulebook.text('base')}{_facts(given)}"
    true = _true(_grounded(every))
    told = sorted(true - set(given))
    never = [clingo.Function(name, [clingo.Number(6)] * arity) for name, arity in DERIVED.items()]
    used = count = 0
    for atom in [*rng.sample(told, min(3, len(told))), rng.choice(never)]:
        asked = Asked(signature_of(atom), tuple(range(len(atom.arguments))))
        demand = demand_of(read(rulebook), [asked], KEYS)
        assert demand is not None
        context = Given(given)
        asking = _grounded(demand.asking([tuple(map(str, atom.arguments))]), context)
        needs = [str(found.symbol) for found in asking.symbolic_atoms]
        needs = [f"{need}." for need in needs if need.startswith("_need")]
        found = [fact for fact in given if fact in context.found or fact.name in demand.whole]
        part = _grounded(f"{demand.guarded}{''.join(needs)}{_facts(found)}")
        derived = _true(part)
        assert derived <= true, f"{seed}: {atom} takes {sorted(derived - true)}"
        assert (atom in derived) == (atom in true), f"{seed}: {atom}"
        if atom in true:
            wanted = _explained(rulebook, _grounded(every), given, atom)
            assert _explained(rulebook, part, found, atom) == wanted, f"{seed}: {atom}"
        used, count = used + len(found), count + len(given)
    return used, count


@pytest.mark.parametrize("first", [15 * each for each in seeds(2, 4)])
def test_random_rules_need_what_is_found(first: int) -> None:
    counts = [_checked(seed) for seed in range(first, first + 15)]
    used, count = map(sum, zip(*counts, strict=True))
    assert used < 0.9 * count


REFUSED = [
    "{ a(X) } :- e(X, _).",
    "a(X) ; b(X) :- e(X, _).",
    "a(X) :- e(X, Y), not a(Y).",
    "a(X) :- e(X, _), 2 <= #count { Y : b(Y) }. b(X) :- a(X).",
    "a(X) :- e(X, _), b(Y) : f(X, Y). b(X) :- e(X, Y), a(Y).",
    "b(X) :- e(X, _).",
]


@pytest.mark.parametrize("text", REFUSED)
def test_choices_and_loops_through_negation_have_no_demand(text: str) -> None:
    rules = read(rulebook_of(text))
    assert demand_of(rules, [Asked(Signature("a", 1), (0,))], KEYS) is None


def test_only_what_leads_to_the_question_is_asked_for() -> None:
    rules = read(rulebook_of("a(X) :- e(X, Y), not f(Y, _), not g(_). c(X) :- f(X, _)."))
    demand = demand_of(rules, [Asked(Signature("a", 1), (0,))], KEYS)
    assert demand is not None
    assert demand.found == {"e", "f"}
    assert demand.whole == {"g"}
    numbers = [(1, 2), (1, 3), (2, 4), (3, 5), (4, 1)]
    facts = [
        clingo.Function(name, [clingo.Number(x), clingo.Number(y)])
        for name in "ef"
        for x, y in numbers
    ]
    context = Given(facts)
    _grounded(demand.asking([("1",)]), context)
    assert sorted(map(str, context.found)) == ["e(1,2)", "e(1,3)", "f(2,4)", "f(3,5)"]
