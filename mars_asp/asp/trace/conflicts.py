"""Minimal sets of ground rules and facts that together exclude every answer.

Each instance of a rule is an element. An instance that is left open forces nothing: a constraint is
dropped, the bounds of a choice are dropped, and any other head becomes a choice. So an open
instance never excludes an answer, and a superset of a set without answer has no answer. `h(X) :-
b(X)` becomes

    h(X) :- b(X); _on(0,h(X),v(X)).
    { h(X) } :- b(X); not _on(0,h(X),v(X)).
    #external _on(0,h(X),v(X)) : b(X).

and the elements of a set are assumptions. An external is an element by its truth value.

A conflict is an unsatisfiable core, shrunk by leaving out one element after the other. A hitting
set tree finds all conflicts: below each conflict one of its elements is left open (Reiter, A theory
of diagnosis from first principles, 1987).
"""

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import clingo

from mars_asp.asp.messages import fill, shown
from mars_asp.asp.rules.externals import External
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.statements import variants
from mars_asp.asp.rules.trees import (
    Kind,
    Sign,
    SyntaxNode,
    Tree,
    changed,
    constant,
    global_names,
    names_in,
)
from mars_asp.asp.trace.document import rule_json
from mars_asp.asp.trace.firing_rules import Terms, atoms_of_head
from mars_asp.asp.trace.text import WIDTH, wrapped
from mars_asp.diagnostic import Span

#: The predicate of instances that are not left open.
ON = "_conflict_on"
_EXTERNAL = "_conflict_external"
_OPTIONS = ("--seed=1", "--warn=none", "--opt-mode=ignore")
#: Beyond so many searches there may be more conflicts.
_MOST_SEARCHES = 2_000


class Instance(NamedTuple):
    """A ground rule or fact, or an external with its truth value; `rule` is None for the latter."""

    text: str
    span: Span
    rule: Rule | None = None
    bindings: Mapping[str, clingo.Symbol] = {}

    @property
    def message(self) -> str | None:
        """Return the message of the rule for these values, or None if it has none."""
        return None if self.rule is None else fill(self.rule.because, self.bindings, shown)

    def json(self) -> dict[str, object]:
        """Return the ground rule as JSON: text, message, location, rule and bindings."""
        place = {"path": self.span.path, "line": self.span.line, "column": self.span.column}
        found = {"text": self.text, "message": self.message, "location": place}
        found["rule"] = None if self.rule is None else rule_json(self.rule)
        return {**found, "bindings": {name: str(value) for name, value in self.bindings.items()}}


#: Instances that together exclude every answer, in the order of their places.
Conflict = tuple[Instance, ...]


@dataclass(frozen=True)
class Conflicts:
    """The minimal conflicts of a program, smallest first; none if it has an answer.

    Where they are not `complete`, the search ended at a limit.
    """

    conflicts: tuple[Conflict, ...]
    complete: bool = True

    def __iter__(self) -> Iterator[Conflict]:
        """Yield the conflicts."""
        return iter(self.conflicts)

    def __len__(self) -> int:
        """Return the number of conflicts."""
        return len(self.conflicts)

    def text(self, width: int = WIDTH) -> str:
        """Return the conflicts as text: each instance with location and message."""
        if not self.conflicts:
            return "the program has an answer"
        count = len(self.conflicts)
        more = "" if self.complete else ", and there may be more"
        number = "1 minimal conflict" if count == 1 else f"{count} minimal conflicts"
        lines = [*wrapped(f"no answer: {number}{more}", 0, width)]
        for place, conflict in enumerate(self.conflicts, 1):
            if count > 1:
                lines += wrapped(f"conflict {place}", 1, width)
            lines += conflict_lines(conflict, 1 + (count > 1), width)
        return "\n".join(lines)

    def json(self) -> dict[str, object]:
        """Return the conflicts as JSON, with whether they are complete."""
        conflicts = [conflict_json(conflict) for conflict in self.conflicts]
        satisfiable = not self.conflicts
        return {"satisfiable": satisfiable, "complete": self.complete, "conflicts": conflicts}


def conflict_json(conflict: Conflict) -> list[dict[str, object]]:
    """Return the ground rules of a conflict, each as JSON."""
    return [instance.json() for instance in conflict]


def instance_line(instance: Instance) -> str:
    """Return the text of an instance with its location."""
    return f"{instance.text}  {instance.span.path}:{instance.span.line}"


def conflict_lines(conflict: Conflict, level: int, width: int) -> Iterator[str]:
    """Yield the lines of a conflict, indented by `level` and wrapped at `width`."""
    for each in conflict:
        rule = "" if each.message is None or each.rule is None else f"  [{each.rule.id}]"
        yield from wrapped(instance_line(each), level, width)
        if each.message is not None:
            yield from wrapped(each.message, level + 1, width, rule)


class ConflictSearch:
    """The ground instances of a program, any of which can be left open."""

    def __init__(
        self,
        rules: Sequence[Rule],
        rest: str,
        externals: Sequence[External],
        values: Mapping[clingo.Symbol, bool | None],
        options: Sequence[str] = (),
    ) -> None:
        """Ground rules and other statements (`rest`) with the values of externals."""
        self._statements: list[tuple[Rule, SyntaxNode]] = []
        lines = [rest, *(each.marked(_EXTERNAL, at) for at, each in enumerate(externals))]
        for rule in rules:
            for statement in variants(rule.text):
                lines += open_rules(statement, len(self._statements))
                self._statements.append((rule, statement))
        self._control = clingo.Control([*_OPTIONS, *options], lambda *_: None)
        self._control.add("base", [], "\n".join(lines))
        self._control.ground()
        atoms = self._control.symbolic_atoms
        #: The elements, by the literals that are assumed of them.
        self._elements: dict[int, tuple[External | None, clingo.Symbol]] = {}
        for atom in atoms.by_signature(ON, 3):
            self._elements[atom.literal] = (None, atom.symbol)
            self._control.assign_external(atom.symbol, None)
        for atom in atoms.by_signature(_EXTERNAL, 2):
            number, symbol = atom.symbol.arguments
            each = externals[number.number]
            given = atoms[symbol]
            if given is None or not given.is_external:
                continue
            value = values.get(symbol, each.value)
            self._control.assign_external(symbol, None)
            if value is not None:
                self._elements[given.literal if value else -given.literal] = (each, symbol)
        self._searches = 0

    def minimal(
        self, limit: int, atoms: Iterable[clingo.Symbol] = (), holds: bool = True
    ) -> Conflicts:
        """Return at most `limit` minimal conflicts that exclude every answer with one of `atoms`.

        Without `holds` they exclude every answer that lacks the first atom, without atoms every
        answer.
        """
        fixed = self._fixed([*atoms], holds)
        found: list[frozenset[int]] = []
        open_: list[frozenset[int]] = []
        waiting, seen = deque([frozenset[int]()]), {frozenset[int]()}
        self._searches = 0
        while waiting and len(found) <= limit and self._searches < _MOST_SEARCHES:
            removed = waiting.popleft()
            if any(each <= removed for each in open_):
                continue
            conflict = next((each for each in found if not each & removed), None)
            if conflict is None:
                conflict = self._conflict(removed, fixed)
                if conflict is None:
                    open_.append(removed)
                    continue
                found.append(conflict)
            for literal in sorted(conflict):
                below = removed | {literal}
                if below not in seen:
                    seen.add(below)
                    waiting.append(below)
        written = sorted(
            (self._conflict_of(each) for each in found[:limit]),
            key=lambda each: (len(each), [(one.span, one.text) for one in each]),
        )
        return Conflicts(tuple(written), not waiting and len(found) <= limit)

    def _fixed(self, atoms: Sequence[clingo.Symbol], holds: bool) -> list[int]:
        known = self._control.symbolic_atoms
        literals = [each.literal for each in map(known.__getitem__, atoms) if each is not None]
        if not atoms:
            return []
        if not holds:
            return [-literals[0]] if literals else []
        with self._control.backend() as backend:
            one = backend.add_atom()
            for literal in literals:
                backend.add_rule([one], [literal])
        return [one]

    def _conflict(self, removed: frozenset[int], fixed: Sequence[int]) -> frozenset[int] | None:
        """Return a minimal conflict without the `removed` elements, None if there is an answer."""
        rest = [literal for literal in sorted(self._elements) if literal not in removed]
        core = self._core([*fixed, *rest])
        if core is None:
            return None
        kept = [literal for literal in core if literal not in fixed]
        for literal in sorted(kept):
            if literal in kept:
                smaller = self._core([*fixed, *(other for other in kept if other != literal)])
                if smaller is not None:
                    kept = [each for each in smaller if each not in fixed]
        return frozenset(kept)

    def _core(self, assumptions: Sequence[int]) -> list[int] | None:
        """Return a subset of assumptions that excludes every answer, or None without one."""
        self._searches += 1
        with self._control.solve(assumptions=list(assumptions), yield_=True) as handle:
            return None if handle.get().satisfiable else list(handle.core())

    def _conflict_of(self, conflict: frozenset[int]) -> Conflict:
        found = {(each.span, each.text): each for each in map(self._instance, conflict)}
        return tuple(found[key] for key in sorted(found))

    def _instance(self, literal: int) -> Instance:
        external, symbol = self._elements[literal]
        if external is not None:
            value = "true" if literal > 0 else "false"
            return Instance(f"#external {symbol} is {value}", external.span)
        number, head, values = symbol.arguments
        rule, statement = self._statements[number.number]
        names = instance_variables(statement)
        bindings = dict(zip(names, values.arguments, strict=True))
        return Instance(ground_text(statement, head, bindings), rule.span, rule, bindings)


# ---- Texts of instances --------------------------------------------------------------------------


def instance_variables(statement: SyntaxNode) -> list[str]:
    """Return the global variables of a statement, sorted."""
    return sorted(global_names((statement.head, *statement.body)))


def is_forced_atom(head: SyntaxNode) -> bool:
    """Whether a head is a single atom, and no choice."""
    is_literal = head.ast_type == Kind.Literal and head.sign == Sign.NoSign
    return is_literal and head.atom.ast_type == Kind.SymbolicAtom


def open_rules(statement: SyntaxNode, number: int) -> Iterator[str]:
    """Yield rules equivalent to a statement whose instances can be left open."""
    head, terms = statement.head, Terms()
    body = [*map(str, statement.body)]
    text, key, choice = str(head), "none", None
    if is_forced_atom(head):
        text = key = choice = terms.atom(head.atom.symbol, fresh_complex=True)
        body += terms.equations
    elif head.ast_type in (Kind.Aggregate, Kind.HeadAggregate):
        if head.left_guard is None and head.right_guard is None:
            yield str(statement)
            return
    if choice is None and head.ast_type != Kind.Literal:
        found = (
            f"{atom}{' : ' if condition else ''}{', '.join(map(str, condition))}"
            for atom, condition in atoms_of_head(statement)
        )
        choice = "; ".join(found)
    on = f"{ON}({number},{key},v({','.join(instance_variables(statement))}))"
    yield f"{text} :- {'; '.join([*body, on])}."
    if choice is not None:
        yield f"{{ {choice} }} :- {'; '.join([*body, f'not {on}'])}."
    yield f"#external {on} : {'; '.join(body)}." if body else f"#external {on}."


def _with_values(node: SyntaxNode, values: Mapping[str, clingo.Symbol]) -> str:
    """Return the text of a node with values of variables, and of arithmetic on values."""

    def value(tree: Tree) -> Tree:
        if tree.ast_type == Kind.Variable and tree.name in values:
            return constant(tree, values[tree.name])
        if tree.ast_type in (Kind.BinaryOperation, Kind.UnaryOperation):
            with suppress(RuntimeError):
                return constant(tree, clingo.parse_term(str(tree)))
        return tree

    return str(changed(node, value))


def ground_text(
    statement: SyntaxNode, head: clingo.Symbol, values: Mapping[str, clingo.Symbol]
) -> str:
    """Return the text of an instance; true comparisons of values are left out."""
    body = []
    for literal in statement.body:
        is_test = literal.ast_type == Kind.Literal and literal.atom.ast_type == Kind.Comparison
        if not is_test or names_in(literal) - values.keys():
            body.append(_with_values(literal, values))
    is_forced = is_forced_atom(statement.head)
    shown_head = str(head) if is_forced else _with_values(statement.head, values)
    shown_head = "" if shown_head == "#false" else shown_head
    after = f":- {', '.join(body)}" if body or not shown_head else ""
    return f"{' '.join(filter(None, (shown_head, after)))}."
