"""Numbers in rules that do not fit into 32 bits, which clingo would wrap without a word."""

import random
from dataclasses import replace

import clingo
import pytest

from mars_asp.asp.lint.arithmetic import risks
from mars_asp.asp.lint.clauses import clauses_of
from mars_asp.asp.rules.arithmetic import LEAST, MOST, Arithmetic, overflows, telling, wrapped
from mars_asp.asp.rules.computed import computations
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import pieces
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Span


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("p(2147483647).", []),
        ("p(-2147483648).", []),
        ("p(- 2147483648, 2147483647 - 1, 2 ** 30 * 2 - 1).", [(1, 33, "2 ** 30 * 2")]),
        ("p(2147483648).", [(1, 3, "2147483648")]),
        ("p(X) :- q(X), X < 3000000000.", [(1, 19, "3000000000")]),
        ("p(0xffffffff).", [(1, 3, "4294967295")]),
        ("p(2147483647+1).", [(1, 3, "2147483647+1")]),
        ('p("größer", 2147483647 + 1).', [(1, 13, "2147483647 + 1")]),
        ("p(-2147483647 - 2).", [(1, 3, "-2147483647 - 2")]),
        ("p(f(1;65536*65536)).", [(1, 7, "65536*65536")]),
        ("-p(2**31). -p(X) :- X = 1..2147483648.", [(1, 4, "2**31"), (1, 28, "2147483648")]),
        ("p(10**1000000000000).", [(1, 7, "1000000000000")]),
        ("p(10**100000).", [(1, 3, "10**100000")]),
        ("p(|-2147483648|).", [(1, 3, "|-2147483648|")]),
        ("p(-(-2147483648)).", [(1, 3, "-(-2147483648)")]),
        ("p(-2147483648 / -1, 5 / 0, 2 ** -1).", [(1, 3, "-2147483648 / -1")]),
        ("#const most = 2147483647.\np(most + 1).", [(2, 3, "most + 1")]),
        ("#const a = b + 1. #const b = a. p(a + b).", []),
        ("#const most = 2147483648.", [(1, 15, "2147483648")]),
        ("#minimize { 2147483648@1, X : p(X) }.", [(1, 13, "2147483648")]),
        ("p(%* 2147483648 *% 1). % 2147483648", []),
        ('p("2147483648", "2147483647 + 1").', []),
        ("p(2147483647\n  + 1).", [(1, 3, "(2147483647+1)")]),
    ],
)
def test_an_overflow_is_reported_at_its_location(
    text: str, wrong: list[tuple[int, int, str]]
) -> None:
    found = [(d.span.line, d.span.column, d.message.split("`")[1]) for d in overflows(text, "a.lp")]
    assert found == wrong


@pytest.mark.parametrize("sign", ["+", "-", "*", "/", "**"])
def test_results_that_fit_are_those_of_clingo(sign: str) -> None:
    numbers = (LEAST, LEAST + 1, -65536, -3, -1, 0, 1, 2, 7, 46340, 46341, 65536, MOST - 1, MOST)
    for left in numbers:
        for right in numbers:
            if sign == "**" and not 0 <= right <= 64:
                continue
            if (sign == "/" and right == 0) or (left, right, sign) == (LEAST, -1, "/"):
                continue
            exact = {
                "+": left + right,
                "-": left - right,
                "*": left * right,
                "/": 0 if right == 0 else abs(left) // abs(right) * (1 if left * right > 0 else -1),
                "**": left**right if sign == "**" else 0,
            }[sign]
            text = f"p(({left}){sign}({right}))."
            assert bool(list(overflows(text, "a.lp"))) == (not LEAST <= exact <= MOST), text
            if LEAST <= exact <= MOST and sign != "/":
                control = clingo.Control(["--warn=none"])
                control.add("base", [], text)
                control.ground()
                (atom,) = control.symbolic_atoms
                assert atom.symbol.arguments[0].number == exact, text


#: Numbers that a user may state however large.
FREE_NUMBERS = {Signature("priority", 2): (1,), Signature("hold", 2): (1,)}


@pytest.mark.parametrize(
    ("text", "risky"),
    [
        ("p(X * Y) :- q(X, Y).", ["X * Y"]),
        ("p(X ** Y) :- q(X, Y).", ["X ** Y"]),
        ("p(2 * X, X / Y, X \\ Y) :- q(X, Y).", []),
        ("p(I + 1) :- q(I).", []),
        ("p(P + 1) :- priority(_, P).", ["P + 1"]),
        ("p(2 * P) :- priority(_, P).", ["2 * P"]),
        ("p(R) :- priority(R, P), P > R + 1.", []),
        ("p(P - Q, P - 1) :- priority(_, P), priority(_, Q).", []),
        ("p(P - Q - Q) :- priority(_, P), priority(_, Q).", ["P - Q - Q"]),
        ("q(f(P)) :- priority(_, P). p(Q + 1) :- q(f(Q)).", ["Q + 1"]),
        ("h(H) :- H = #max { P : priority(_, P) }. p(H + 1) :- h(H).", ["H + 1"]),
        ("n(N) :- N = #count { P : priority(_, P) }. p(N + 1) :- n(N).", []),
        ("p :- #sum { P + 1, R : hold(R, P) } > 3.", ["P + 1"]),
        ("p((P' - P) * (Q' - Q)) :- q(P, P', Q, Q').", ["(P' - P) * (Q' - Q)"]),
        ("p(X * Y) :- q(X, Y), X < 40000, 50000 >= Y.", []),
        ("p(X * Y) :- q(X, Y), X <= 60000, Y <= 60000.", ["X * Y"]),
        ("p(X * Y) :- q(X, Y), X < 40000, Y != 5.", ["X * Y"]),
        ("p(X * Y) :- q(X, Y), X > 40000, Y < 5.", ["X * Y"]),
        ("p(X * Y) :- q(X, Y), not X >= 40000, Y = 5.", []),
        ("p(X * Y) :- q(X, Y), X = (5; 9), Y < 5.", []),
        ("p(X * Y) :- q(X, Y), X < Z, Z = (5; 9), Y < 5.", ["X * Y"]),
        ("p(P + 1) :- priority(_, P), P < 2147483647.", []),
        ("p(P + 1) :- priority(_, P), P <= 2147483647.", ["P + 1"]),
        ("p(P + Q) :- priority(_, P), hold(_, Q), P < 5.", ["P + Q"]),
        ("p :- #sum { X * Y : q(X, Y) } > 3, r(X), X < 5, Y < 5, r(Y).", []),
    ],
)
def test_products_and_sums_of_numbers_of_users_are_risks(text: str, risky: list[str]) -> None:
    rules = [
        Rule("a", None, None, Span("a.lp", *each.begin, *each.end), each.text, "base")
        for each in pieces(text)
        if each.sort == "rule"
    ]
    found = [
        (each.message.split("`")[1], each.span.column)
        for each in (one.diagnostic for one in risks(clauses_of(rules).values(), FREE_NUMBERS))
    ]
    fitting = clauses_of(replace(rule, fits="it does") for rule in rules).values()
    assert not list(risks(fitting, FREE_NUMBERS))
    assert [written for written, _ in found] == risky
    assert all(text.startswith(written, column - 1) for written, column in found)


class _Exact:
    """A random expression of X and Y in the syntax of rules, with its value in exact integers."""

    def __init__(self, rng: random.Random, depth: int = 3) -> None:
        self.sign = rng.choice(["+", "-", "*", "&", "X", "Y", "1", "2147483647"]) if depth else "X"
        self.inside = [_Exact(rng, depth - 1) for _ in range(2)] if self.sign in "+-*&" else []

    def __str__(self) -> str:
        return f"({self.inside[0]}{self.sign}{self.inside[1]})" if self.inside else self.sign

    def value(self, known: dict[str, int]) -> int:
        """Return the value, and raise an error where one inside does not fit."""
        if not self.inside:
            return known[self.sign] if self.sign in known else int(self.sign)
        one, other = (each.value(known) for each in self.inside)
        found = {"+": one + other, "-": one - other, "*": one * other, "&": one & other}[self.sign]
        if not LEAST <= found <= MOST:
            raise OverflowError
        return found

    def fits(self, known: dict[str, int]) -> bool:
        """Whether nothing inside leaves 32 bits."""
        try:
            self.value(known)
        except OverflowError:
            return False
        return True


#: Rules with an expression: each holds for each X of `x/1` and each Y of `y/1` except 7.
FORMS = (
    "p({}) :- x(X), y(Y), Y != 7.",
    "p(Z) :- x(X), Z = {}, y(Y), not z(Y).",
    "p :- x(X), {} > 5, y(Y), not z(Y).",
    "p(X) :- x(X), 1 < #count {{ Y,{} : y(Y), Y != 7 }}.",
    "p(X) :- x(X), 1 < #count {{ Z : y(Y), Z = {}, Y != 7 }}, 0 < #count {{ Y : x(Y) }}.",
    "p(X) :- x(X), not q({}) : y(Y), Y != 7.",
    "{{ p({}) : y(Y), not z(Y) }} :- x(X).",
    "p(X,Y) :- x(X), y(Y), Y != 7, not q(f({})).",
    ":- x(X), q({}), y(Y), Y != 7.",
    "p(V) :- x(X), y(Y), Y != 7, V = #sum {{ {},Z : y(Z), Z = 1 ; 1 : q(X) }}.",
)


@pytest.mark.parametrize("form", FORMS)
def test_grounding_wraps_exactly_the_values_that_do_not_fit(form: str) -> None:
    wrapping = 0
    for seed in range(60):
        rng = random.Random(f"{form}{seed}")
        pool = [0, 1, 2, -1, 46340, 46341, 65536, MOST, LEAST + 1, -46341, 2**30]
        xs, ys = rng.sample(pool, 3), [*rng.sample(pool, 2), 1, 7]
        expression = _Exact(rng)
        if not expression.inside:
            continue
        rule = form.format(expression)
        expected = not all(expression.fits({"X": x, "Y": y}) for x in xs for y in ys if y != 7)
        entries = [
            Arithmetic(Span("a.lp", 1, 1, 1, 1), each)
            for each in computations([rule]).get(rule, ())
        ]
        facts = [*(f"x({x})." for x in xs), *(f"y({y})." for y in ys), "z(7).", "#defined q/1."]
        control = clingo.Control(["--warn=none"])
        program = [rule, *facts, *(telling(number, each) for number, each in enumerate(entries))]
        control.add("base", [], "\n".join(program))
        control.ground()
        found = [each.message for each in (*wrapped(control, entries), *overflows(rule, "a.lp"))]
        assert bool([each for each in found if "sum" not in each]) == expected, (
            rule,
            xs,
            ys,
            found,
        )
        wrapping += expected
    assert wrapping > 10


@pytest.mark.parametrize(
    ("rule", "facts", "wrong"),
    [
        ("s(S) :- S = #sum { W : w(W) }.", "w(2147483647). w(1).", ["2147483648"]),
        ("s(S) :- S = #sum { W : w(W) }.", "w(2147483647). w(1). w(-1).", []),
        ("s(S) :- S = #sum { W : w(W) }.", "w(-2147483648). w(-1).", ["-2147483649"]),
        ("s(S) :- S = #sum+ { W : w(W) }.", "w(2147483647). w(1). w(-1).", ["2147483648"]),
        ("s :- 5 > #sum { W,1 : w(W) ; W,1 : v(W) }.", "w(2000000000). v(2000000000).", []),
        (
            "s :- 5 > #sum { W,1 : w(W) ; W,2 : v(W) }.",
            "w(2000000000). v(2000000000).",
            ["4000000000"],
        ),
        ("s(G) :- g(G), 5 > #sum { W : w(G,W) }.", "g(1..2). w(1,2147483647). w(2,1).", []),
        (
            "s(G) :- g(G), 5 > #sum { W : w(G,W) }.",
            "g(1..2). w(1,2147483647). w(1,1).",
            ["2147483648"],
        ),
        ("s :- 5 > #sum { W : w(W) }.", "{ w(2147483647;1) }. w(-1).", []),
        ("s :- 5 > #sum { W : w(W) }.", "{ w(2147483647;1;-3) }.", ["2147483648"]),
        ("s :- 5 > #sum { W : w(W) }.", "w(2147483646). { w(1;2) }.", ["2147483649"]),
    ],
)
def test_sums_that_may_overflow_are_reported_with_their_bounds(
    rule: str, facts: str, wrong: list[str]
) -> None:
    entries = [Arithmetic(Span("a.lp", 1, 1, 1, 1), each) for each in computations([rule])[rule]]
    control = clingo.Control(["--warn=none"])
    # The sum itself would end the process of a clingo that adds in 32 bits, or refuse.
    rules = (telling(number, each) for number, each in enumerate(entries))
    control.add("base", [], "\n".join((facts, "#defined w/1. #defined v/1. #defined w/2.", *rules)))
    control.ground()
    assert [each.message.split()[4].rstrip(",") for each in wrapped(control, entries)] == wrong


def test_local_variables_beside_an_element_are_renamed() -> None:
    text = 'm(M) :- M = #count { S : p(S,"S") }; 3 < #sum { S*S*N,S : q(S), r(N) }.'
    bodies = [each.body for each in computations([text])[text]]
    assert bodies == ['M = #count { S_: p(S_,"S") }; q(S); r(N)'] * 2
