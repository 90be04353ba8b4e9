"""Random rule packs whose text is hard to read: comments of both kinds anywhere, strings that look
like rules, pools, classical negation, constants defined by others.

Each predicate reads facts and the predicates before it. Comments and line ends occur between any
two tokens, so that the same rules also exist without them.
"""

import random
import re
from itertools import pairwise
from typing import NamedTuple

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|:-|\.\.|!=|<=|>=|#[a-z]+|[\w\']+|\S')
STRINGS = (
    '"%* no comment *%"',
    '"%* opened"',
    '"closed *%"',
    '":- module(X)."',
    '"say \\"x\\" :- y."',
    '"{ a; b }"',
    '"% to the end"',
    '"@f(x), not p"',
    '"\\\\"',
    '"ünïcödé → 机器人"',
    '"Base"',
)
REMARKS = (
    "module(X), not priority(R, _)",
    ":- everything.",
    'an open " quote',
    "{ [ (",
    "} ] )",
    "p0(X) :- p1(X).",
    "form\x0cfeed",
    "carriage\rreturn",
    "separators \x1c \x85 \u2028 of lines",
    "größer als → 机器人",
    "#const nothing = 1.",
    "@module_start",
    "%! id: no/rule",
    "",
)
GIVEN = (
    "module(A), module(B)",
    "uses_data_from(R, A, B)",
    "is_controlled_by(R, A, B)",
    "is_controlled_by(R, A, B), priority(R, N)",
    "uses_data_from(_, A, _), module(B)",
    "module(A), B = A",
)


class Pack(NamedTuple):
    """A rule pack, and for each of its rules the line where it begins and its plain text.

    `predicates` are the derived predicates, classically negated ones with `-`; `constants` are the
    `#const` statements.
    """

    text: str
    rules: tuple[tuple[int, str], ...]
    predicates: tuple[tuple[str, int], ...]
    constants: tuple[str, ...]


def random_pack(seed: int) -> Pack:
    """Return a random rule pack, which derives at least one predicate of its own."""
    return _Writer(random.Random(seed)).pack()


class _Writer:
    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        #: What was derived so far: each name with its arity, `-` before what is negated.
        self.lower: list[tuple[str, int]] = []
        self.constants = rng.random() < 0.25
        self.negates = rng.random() < 0.3

    def pack(self) -> Pack:
        rng = self.rng
        constants = ("#const least = 1.", "#const renamed = kind1.") if self.constants else ()
        plain = [*constants]
        for number in range(rng.randint(2, 5)):
            derived = (f"p{number}", rng.choice((1, 1, 2)))
            if self.negates and rng.random() < 0.4:
                derived = (f"-m{number}", derived[1])
            plain += [self.rule(*derived) for _ in range(rng.randint(1, 3))]
            self.lower.append(derived)
        plain += [self.consequence() for _ in range(rng.randint(0, 3))]
        text, rules = "", []
        for each in plain:
            text += self.between() if rng.random() < 0.5 else ""
            if not each.startswith("#"):
                rules.append((text.count("\n") + 1, each))
            text += self.written(each) + rng.choice(("\n", "\n", " ", "\n\n"))
        text += self.between()
        return Pack(f"{text}\n", tuple(rules), tuple(self.lower), constants)

    def written(self, plain: str) -> str:
        """Write a rule with something between its tokens."""
        dense = self.rng.choice((0, 0.1, 0.3))
        tokens = _TOKEN.findall(plain)
        text = str(tokens[0])
        for before, token in pairwise(tokens):
            words = re.fullmatch(r"[\w']+", before[-1] + token[0])
            gap = " " if words or token == ":-" or before in (":-", ":", ",", ";") else ""
            if self.rng.random() < dense and before + token != ":-":
                gap = self.between()
            text += gap + token
        return text

    def between(self) -> str:
        rng = self.rng
        remark = rng.choice(REMARKS)
        # In a block comment `%` begins one to the end of its line.
        end = "\n" if "%" in remark else ""
        match rng.randrange(5):
            case 0:
                return f" % {remark} %* open\n"
            case 1:
                return f"\n\t% {remark}\n  "
            case 2:
                return rng.choice(("  ", "\n", "\r\n  ", " \t "))
            case 3:
                inner = f" %* {remark} {end} %* inner :- {rng.choice(STRINGS[3:6])} *% "
                return f"{inner}\n {remark}{end}*%\n "
        return f"%*{end and ' '}{remark}{end}*%"

    def atom(self, name: str, arity: int, bound: tuple[str, ...] = ("A", "B")) -> str:
        rng = self.rng
        terms = [rng.choice((*bound, *bound, "_", rng.choice(STRINGS))) for _ in range(arity)]
        return f"{name}({', '.join(terms)})"

    def read(self, bound: tuple[str, ...] = ("A", "B")) -> str:
        """Return an atom of an earlier predicate, or one of the facts."""
        if not self.lower or self.rng.random() < 0.2:
            return f"uses_data_from(_, {self.rng.choice(bound)}, _)"
        return self.atom(*self.rng.choice(self.lower), bound)

    def body(self) -> str:
        rng = self.rng
        literals = [rng.choice(GIVEN)]
        literals += [self.literal() for _ in range(rng.choice((0, 1, 1, 2, 3)))]
        # A comma after a condition continues the condition.
        conditional = any(" : " in literal for literal in literals)
        return rng.choice(("; ",) if conditional else (", ", "; ")).join(literals)

    def literal(self) -> str:
        rng = self.rng
        inner = self.read(("V",)) if rng.random() < 0.5 else "module(V)"
        if "V" not in inner:
            inner = "module(V)"
        return rng.choice(
            (
                self.read(),
                self.read(),
                f"not {self.read()}".replace("_,", "A,").replace("_)", "B)"),
                f"not not {self.read()}".replace("_,", "A,").replace("_)", "B)"),
                "A != B",
                f"A != {rng.choice(STRINGS)}",
                f"2 <= #count {{ V, A : {inner}, V != A; x : {self.read()} }}",
                f"C = #sum {{ 1, V : {inner} ; 2, {rng.choice(STRINGS)} }}, C > -3",
                f"#min {{ 3 ; -2, V : {inner} }} < 4",
                f"{{ {inner} }} >= {'least' if self.constants else '1'}",
                f"{self.read(('V', 'A'))} : {inner}, V != B",
                f"#false : {inner}, V = A, V != A",
                "K = 1..2, K < 2",
                "#true",
                f"module((A ; {rng.choice(STRINGS)}))",
                "not A = (B ; 1)",
                "|-2| = 2",
            )
        )

    def rule(self, name: str, arity: int) -> str:
        rng = self.rng
        choices = ("A", "B", "A", "f(B)", "(A ; B)", "(A, B)", "1..2", "-3", rng.choice(STRINGS))
        terms = [rng.choice(choices) for _ in range(arity)]
        inside = ", ".join(terms)
        if arity == 1 and rng.random() < 0.15:
            inside += f" ; {rng.choice(STRINGS)}"
        if rng.random() < 0.1:
            ground = [rng.choice(STRINGS) for _ in range(arity)]
            return f"{name}({', '.join(ground)})."
        return f"{name}({inside}) :- {self.body()}."

    def consequence(self) -> str:
        rng = self.rng
        kinds = [f"kind{number}" for number in range(3)]
        about = rng.choice(("A", "A", "B", "f(A)", rng.choice(STRINGS)))
        kind, other = rng.sample(kinds, 2)
        severity = rng.choice(("note", "warning", "error"))
        case = rng.choice(("1", rng.choice(STRINGS), "B", "f(A, B)"))
        if self.constants and rng.random() < 0.4:
            kind = "renamed"
        text = f"{kind}, {severity}, {about}, {case}"
        extra = ""
        if rng.random() < 0.5:
            text, extra = f"K, {severity}, {about}, {case}", f"K = ({kind} ; {other}); "
        return f"consequence({text}) :- {extra}{self.body()}."
