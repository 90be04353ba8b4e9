"""A checker of traces and absences that is independent of the tracer.

Rules are rewritten so that clingo itself judges: a positive literal `p(X)` becomes `in(P,p(X))`,
true for the premises of a step P; a negated literal or a condition becomes `true(p(X))`, true for
the answer set. An aggregate that more elements can only make true must be true of both; one that
they can only make false, of the answer set; of any other, P must have all elements.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

import clingo
from clingo import ast

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import tree
from mars_asp.asp.trace import Absent, Derived, Given, NearMiss, Trace, Underivable

Values = Mapping[str, clingo.Symbol]
_TYPE = ast.ASTType
_AGGREGATES = (_TYPE.BodyAggregate, _TYPE.Aggregate)
_UP = (ast.ComparisonOperator.LessEqual, ast.ComparisonOperator.LessThan)
_DOWN = (ast.ComparisonOperator.GreaterEqual, ast.ComparisonOperator.GreaterThan)


class _Reading(ast.Transformer):
    """Puts values for variables, and for atoms where they are looked up."""

    def __init__(self, place: str | None, values: Values) -> None:
        self.place, self.values = place, values

    def visit_Variable(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        value = self.values.get(node.name)
        return node if value is None else ast.SymbolicTerm(node.location, value)

    def visit_Literal(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        plain = node.sign == ast.Sign.NoSign
        if node.atom.ast_type != _TYPE.SymbolicAtom:
            reading = self if plain else _Reading(None, self.values)
            return node.update(**reading.visit_children(node))
        term = self.visit(node.atom.symbol)
        sign = ("", "not ", "not not ")[node.sign]
        looked_up = f"in({self.place},{term})" if plain and self.place else f"true({term})"
        return literal_of(f"{sign}{looked_up}")


def literal_of(text: str) -> ast.AST:
    """Return a body literal's syntax tree."""
    found: list[ast.AST] = []
    ast.parse_string(f":- {text}.", found.append)
    literal: ast.AST = found[-1].body[0]
    return literal


def _body(literals: Iterable[ast.AST], place: str | None, values: Values) -> Iterator[str]:
    """Yield the literals of a body, rewritten for the premises of `place` and the answer set."""
    resting, true = _Reading(place, values), _Reading(None, values)
    for literal in literals:
        if literal.ast_type == _TYPE.ConditionalLiteral:
            condition = ", ".join(str(true(part)) for part in literal.condition)
            yield f"{resting(literal.literal)} : {condition}"
        elif literal.sign == ast.Sign.NoSign and literal.atom.ast_type in _AGGREGATES:
            yield str(true(literal))
            need = _need(literal.atom)
            if need == "enough":
                yield str(resting(literal))
            for element in literal.atom.elements if need == "all" else ():
                parts = [getattr(element, "literal", None), *element.condition]
                inside = [part for part in parts if part is not None]
                condition = ", ".join(str(true(part)) for part in inside)
                yield from (f"{resting(part)} : {condition}" for part in inside)
        else:
            yield str(resting(literal))


def _need(atom: ast.AST) -> str:
    """Return how many elements support an aggregate of positive weights: none, enough or all."""
    least = getattr(atom, "function", None) == ast.AggregateFunction.Min
    up, down = (_DOWN, _UP) if least else (_UP, _DOWN)
    left = [] if atom.left_guard is None else [atom.left_guard.comparison]
    right = [] if atom.right_guard is None else [atom.right_guard.comparison]
    if any(c in up for c in left) or any(c in down for c in right):
        return "enough"
    return "none" if all(c in down for c in left) and all(c in up for c in right) else "all"


def _heads(rule: ast.AST) -> Iterator[tuple[ast.AST, Sequence[ast.AST]]]:
    """Yield each literal that a head can derive, with its conditions.

    Variables of elements in the head and in the body are different, even with equal names.
    """
    head = rule.head
    if head.ast_type == _TYPE.Literal:
        yield head, ()
    outside = {name for literal in rule.body for name in _names(_outside(literal))}
    outside |= {name for guard in _guards(head) for name in _names(guard)}
    inside = {name for literal in rule.body for name in _names(str(literal))} - outside
    for element in getattr(head, "elements", ()):
        inner = element.condition if head.ast_type == _TYPE.HeadAggregate else element
        apart = _Apart(inside)
        yield apart(inner.literal), tuple(map(apart, inner.condition))


class _Apart(ast.Transformer):
    def __init__(self, names: Set[str]) -> None:
        self.names = names

    def visit_Variable(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        return node.update(name=f"_In{node.name}") if node.name in self.names else node


def _names(text: str) -> list[str]:
    return re.findall(r"(?<!\w)[A-Z]\w*", text)


def _guards(node: ast.AST) -> list[str]:
    both = [getattr(node, f"{side}_guard", None) for side in ("left", "right")]
    return [str(guard.term) for guard in both if guard is not None]


def _outside(literal: ast.AST) -> str:
    """Return the text of a body literal outside of its elements."""
    if literal.ast_type == _TYPE.ConditionalLiteral:
        return ""
    return " ".join(_guards(literal.atom)) if literal.atom.ast_type in _AGGREGATES else str(literal)


def _instances(rule: ast.AST, place: str | None, values: Values, given: str) -> Iterator[str]:
    """Yield bodies, one for each head, that bind `_H` to the derived atom."""
    for head, condition in _heads(rule):
        if head.atom.ast_type == _TYPE.SymbolicAtom:
            symbol = _Reading(None, values)(head.atom.symbol)
            body = _body((*rule.body, *condition), place, values)
            yield "; ".join([given, f"_H = {symbol}", *body])


def _solved(lines: Iterable[str], true: Iterable[clingo.Symbol]) -> frozenset[clingo.Symbol]:
    control = clingo.Control(["--warn=none"])
    facts = [f"true({atom})." for atom in true]
    control.add("base", [], "\n".join(["#defined true/1. #defined in/2.", *facts, *lines]))
    control.ground()
    found: list[frozenset[clingo.Symbol]] = []
    control.solve(on_model=lambda model: found.append(frozenset(model.symbols(atoms=True))))
    (only,) = found
    return only


def least_heights(
    rules: Iterable[Rule], given: Set[clingo.Symbol], true: Set[clingo.Symbol]
) -> dict[clingo.Symbol, int]:
    """Return each true atom's height, by deriving level after level until nothing is new."""
    lines = [f"level(0..{len(true)}).", *(f"in(0,{atom})." for atom in given)]
    lines.append("in(_N+1,_A) :- in(_N,_A); level(_N).")
    for rule in rules:
        for body in _instances(tree(rule.text), "_N", {}, "level(_N)"):
            lines.append(f"in(_N+1,_H) :- {body}; true(_H).")
    heights: dict[clingo.Symbol, int] = {}
    for atom in _solved(lines, true):
        if atom.match("in", 2):
            level, inside = atom.arguments
            heights[inside] = min(level.number, heights.get(inside, level.number))
    return heights


#: What tells one firing of a rule from another: the rule's number, its bindings, its head.
Fired = tuple[int, frozenset[tuple[str, clingo.Symbol]], clingo.Symbol]


def standing_firings(
    rules: Sequence[Rule], given: Set[clingo.Symbol], true: Set[clingo.Symbol]
) -> frozenset[Fired]:
    """Return all firings of which the premises can be derived without the head.

    For each true atom A, `in(without(A),...)` is all that can be derived when A is not; the firings
    of A that hold there count. Bindings are those of a rule's global variables.
    """
    lines = [f"place(without({atom}))." for atom in true]
    lines += [f"in(_P,{atom}) :- place(_P); _P != without({atom})." for atom in given]
    for number, rule in enumerate(rules):
        for unpooled in tree(rule.text).unpool():
            names = sorted(_globals(unpooled))
            pairs = "".join(f'("{name}",{name}),' for name in names)
            for body in _instances(unpooled, "_P", {}, "place(_P)"):
                lines.append(f"in(_P,_H) :- {body}; true(_H); _P != without(_H).")
                fired = f"fired({number},v({pairs.rstrip(',')}),_H)"
                lines.append(f"{fired} :- {body}; true(_H); _P = without(_H).")
    found: set[Fired] = set()
    for atom in _solved(lines, true):
        if atom.match("fired", 3) and atom.arguments[2] not in given:
            index, values, head = atom.arguments
            bindings = frozenset((p.arguments[0].string, p.arguments[1]) for p in values.arguments)
            found.add((index.number, bindings, head))
    return frozenset(found)


def _globals(rule: ast.AST) -> set[str]:
    """Return the variables that some literal outside of aggregates and conditions names."""
    found: list[str] = []
    for head, condition in _heads(rule):
        found.append(str(head))
        found += map(str, condition)
    for literal in rule.body:
        if literal.ast_type == _TYPE.Literal and literal.sign == ast.Sign.NoSign:
            found.append(_outside(literal))
    return {name for text in found for name in _names(text)}


def all_steps(traces: Iterable[Trace]) -> list[Derived]:
    """Return each step in and below traces, and below their others, once."""
    found: dict[int, Derived] = {}
    waiting = list(traces)
    while waiting:
        step = waiting.pop()
        if isinstance(step, Derived) and id(step) not in found:
            found[id(step)] = step
            waiting += (*step.premises, *step.others)
    return list(found.values())


class _Claims:
    """The claims of traces, as rules for clingo, and the faults that need no solving."""

    def __init__(self, given: Set[clingo.Symbol]) -> None:
        self.given = given
        self.wrong: list[str] = []
        self.lines: list[str] = []
        self.texts: dict[clingo.Symbol, str] = {}
        self._below: dict[int, frozenset[str]] = {}

    def claim(self, text: str, *bodies: str) -> None:
        """Claim that one of some bodies holds."""
        number = len(self.texts)
        self.texts[clingo.Function("ok", [clingo.Number(number)])] = text
        self.lines.extend(f"ok({number}) :- {body}." for body in bodies)

    def claim_not(self, text: str, body: str) -> None:
        """Claim that no instance of a body holds."""
        self.lines.append(f"holds({len(self.texts)}) :- {body}.")
        self.claim(text, f"not holds({len(self.texts)})")

    def look(self, trace: Trace | NearMiss) -> frozenset[str]:
        """Check a trace once; return the atoms in and below it."""
        if id(trace) in self._below:
            return self._below[id(trace)]
        inside: frozenset[str] = frozenset()
        match trace:
            case Given(atom):
                if clingo.parse_term(atom) not in self.given:
                    self.wrong.append(f"{atom} is not given")
            case Absent(atom) if atom.startswith("not "):
                self.claim(f"not {atom}", f"true({atom[4:]})")
            case Absent(atom):
                self.claim_not(f"no {atom}", f"true({atom})")
            case Derived():
                inside = frozenset[str]().union(*map(self.look, trace.premises))
                self.step(trace)
                if trace.atom in inside:
                    self.wrong.append(f"{trace.atom} is among its own reasons")
            case Underivable():
                self.claim_not(f"no {trace.atom}", f"true({trace.atom})")
                for attempt in trace.attempts:
                    self.attempt(attempt)
            case _:
                self.wrong.append(f"{trace} is no reason")
        self._below[id(trace)] = inside | {trace.atom}
        return self._below[id(trace)]

    def step(self, step: Derived) -> None:
        """Claim that a rule gives an atom from the premises of a step."""
        place = f"step({len(self.texts)})"
        rests = [p.atom for p in step.premises if isinstance(p, Given | Derived)]
        self.lines.extend(f"in({place},{atom})." for atom in rests)
        bodies = _instances(tree(step.rule.text), place, step.bindings, f"_H = {step.atom}")
        self.claim(f"{step.atom} by {step.rule.text} from {rests}", *bodies)

    def attempt(self, attempt: NearMiss) -> None:
        """Claim that the failed literal of a near miss is false."""
        text = f"{attempt.fails} fails for {attempt.bindings} in {attempt.rule.text}"
        if attempt.fails is None:
            bodies = _instances(
                tree(attempt.rule.text), None, attempt.bindings, f"_H = {attempt.atom}"
            )
            self.claim(text, *bodies)
            if tree(attempt.rule.text).head.ast_type == _TYPE.Literal:
                self.wrong.append(f"{attempt.rule.text} is no choice")
        else:
            literal = literal_of(attempt.fails)
            if literal.ast_type == _TYPE.ConditionalLiteral:
                (failing,) = _body((literal,), None, attempt.bindings)
            else:
                failing = str(_Reading(None, attempt.bindings)(literal))
            self.claim_not(text, failing)
        for part in (attempt.cause, *attempt.held):
            if part is not None:
                self.look(part)


def faults(
    traces: Iterable[Trace],
    given: Set[clingo.Symbol],
    true: Set[clingo.Symbol],
    constants: Iterable[str] = (),
) -> list[str]:
    """Return the faults of traces: a step, a leaf, or an atom among its own reasons.

    `constants` are the `#const` statements of the program. Of the other derivations of a step
    this checks only that the rule derives the atom.
    """
    claims = _Claims(given)
    queried = tuple(traces)
    steps = all_steps(queried)
    others = {id(other): other for step in steps for other in step.others}
    for trace in (*queried, *(step for step in steps if id(step) not in others)):
        claims.look(trace)
    for other in others.values():
        claims.step(other)
        for premise in other.premises:
            claims.look(premise)
    held = _solved((*constants, *claims.lines), true)
    return claims.wrong + [item for atom, item in claims.texts.items() if atom not in held]


def height(trace: Trace) -> int:
    """Return the height of a trace, 0 for facts and absent atoms."""
    if not isinstance(trace, Derived):
        return 0
    return 1 + max(map(height, trace.premises), default=0)


def could_give(rule: Rule, atom: clingo.Symbol) -> bool:
    """Whether a head of a rule is an atom for values from 0 to 3 of its variables."""
    lines = []
    for head, _ in _heads(tree(rule.text)):
        if re.match(rf"{atom.name}\b", str(head)):
            values = "; ".join(f"{name} = 0..3" for name in ("X", "Y"))
            lines.append(f"ok :- {values}; {head.atom.symbol} = {atom}.")
    return bool(lines) and clingo.Function("ok") in _solved(lines, ())
