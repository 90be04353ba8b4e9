"""Least answers for which names are asked only where several are least at every level."""

import random

import pytest

from mars_asp.asp.fragments import Fragment
from mars_asp.asp.solve.components import Component
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.optimum import Optimum
from mars_asp.asp.solve.term_ids import text

#: Each group puts one of its items first, which costs 1; at the lower level items differ.
RULES = """\
1 { first(G, I) : item(G, I, _) } 1 :- group(G).
group(G) :- item(G, _, _).
#minimize { 1@30, G, I : first(G, I) }.
#minimize { N@5, G, I : first(G, I), item(G, I, N) }.
#project first/2.
"""


def resolved(facts: str, rules: str = RULES) -> tuple[set[str], set[str], int, int]:
    """Return what both ways choose, how many components were solved, and how many tie."""

    def grounding() -> Grounding:
        return Grounding([Fragment(facts, "facts")])

    program = [Fragment(rules, "rules")]
    known: dict[Component, Optimum] = {}
    unnamed = grounding()
    resolution, ties = unnamed.resolve_unnamed(program, None, known)
    both = (resolution.answer, grounding().resolve(program).answer)
    chosen = [{text(atom) for atom in each.taken} for each in both]
    assert all(next(unnamed.telling(part), None) is not None for part in ties)
    return chosen[0], chosen[1], len(known), len(ties)


@pytest.mark.parametrize(
    ("facts", "solved", "ties"),
    [
        # The names of the items come in another order.
        ("item(r, a, 0). item(r, b, 1). item(s, d, 0). item(s, c, 1).", 1, 0),
        ("item(r, a, 0). item(r, b, 1). item(s, d, 1). item(s, c, 2).", 2, 0),
        ("item(r, a, 0). item(r, b, 0). item(s, d, 0). item(s, c, 1).", 3, 1),
        ("item(r, b, 0). item(r, a, 0).", 1, 1),
    ],
)
def test_names_make_a_difference_where_answers_tie_at_every_level(
    facts: str, solved: int, ties: int
) -> None:
    unnamed, named, components, tied = resolved(facts)
    assert unnamed == named
    assert tied == ties
    assert components == solved


def test_random_answers_are_those_that_names_choose() -> None:
    tied = 0
    for seed in range(60):
        rng = random.Random(seed)
        groups = {g: rng.sample("abcdef", rng.randint(1, 4)) for g in "rst"}
        facts = [
            f"item({g}, {i}, {rng.randint(0, 2)})." for g, each in groups.items() for i in each
        ]
        rng.shuffle(facts)
        unnamed, named, _, ties = resolved(" ".join(facts))
        assert unnamed == named, facts
        tied += ties
    assert tied > 10
