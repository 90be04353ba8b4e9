"""Which rules the rule cases fire, and which they let fail by one literal alone.

A rule *fires* in a case where its body holds in a wanted answer set; it *just does not* where the
body holds but for one literal. Variables that only this literal binds count as any value. A
constraint fires where leaving it out changes the answer.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import clingo
from clingo import ast

from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.reasoning.cases import stages_of

_TYPE = ast.ASTType


@dataclass(frozen=True)
class Coverage:
    """The rules that fire in no case, and those that never fail by one literal alone."""

    silent: tuple[Rule, ...]
    never_near: tuple[Rule, ...]


def covered(rulebook: Rulebook, cases: Sequence[Path]) -> Coverage:
    """Run every case with probes beside the rules."""
    probes = {n: tuple(_safe(_probes(n, rule))) for n, rule in enumerate(rulebook.rules)}
    fired: set[int] = set()
    near: set[int] = set()
    for path in cases:
        stages = ("base", *stages_of(path))
        text = "\n".join(
            probe
            for number, rule in enumerate(rulebook.rules)
            if rule.stage in stages
            for kind, probe in probes[number]
            if number not in (fired if kind == "_fired" else near)
        )
        program = "\n".join([read_case(path)[0], *(rulebook.text(s) for s in stages), text])
        for name, number in _held(program):
            (fired if name == "_fired" else near).add(number)
    numbered = list(enumerate(rulebook.rules))
    return Coverage(
        tuple(
            rule
            for number, rule in numbered
            if rule.ast.body
            and number not in fired
            and not (
                str(rule.ast.head) == "#false"
                and _refuses(rule, probes[number][0][1], rulebook, cases)
            )
        ),
        tuple(
            rule
            for number, rule in numbered
            if number not in near and any(kind == "_near" for kind, _ in probes[number])
        ),
    )


def fired_in(rules: Sequence[Rule], rulebook: Rulebook, cases: Sequence[Path]) -> list[list[Path]]:
    """Return the cases that fire each of some rules."""
    probes = [next(_probes(number, rule))[1] for number, rule in enumerate(rules)]
    found: list[list[Path]] = [[] for _ in rules]
    for path in cases:
        stages = ("base", *stages_of(path))
        told = (probe for rule, probe in zip(rules, probes, strict=True) if rule.stage in stages)
        texts = (rulebook.text(stage) for stage in stages)
        for _, number in _held("\n".join([read_case(path)[0], *texts, *told])):
            found[number].append(path)
    return found


def _probes(number: int, rule: Rule) -> Iterator[tuple[str, str]]:
    body = list(rule.ast.body)
    yield "_fired", f"_fired({number}) :- {'; '.join(map(str, body)) or '#true'}."
    for index, literal in enumerate(body):
        rest = body[:index] + body[index + 1 :]
        elsewhere = {name for other in rest for name in _variables(other)}
        fails = _failing(literal, set(_variables(literal)) - elsewhere)
        yield "_near", f"_near({number}) :- {'; '.join([*map(str, rest), *fails])}."


def _failing(literal: ast.AST, own: set[str]) -> Iterator[str]:
    """Yield the literal that holds where this one does not, if it can be said as one."""
    if literal.ast_type != _TYPE.Literal:
        return
    if literal.sign == ast.Sign.NoSign:
        symbolic = literal.atom.ast_type == _TYPE.SymbolicAtom
        yield f"not {_Blank(own)(literal) if own and symbolic else literal}"
    else:
        yield str(literal.update(sign=ast.Sign.NoSign))


def _safe(probes: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    for kind, probe in probes:
        control = clingo.Control(["--warn=none"], logger=lambda *_: None)
        try:
            control.add("base", [], probe)
            control.ground()
        except RuntimeError:
            continue
        yield kind, probe


def _held(program: str) -> set[tuple[str, int]]:
    control = clingo.Control(["--opt-mode=optN", "--models=0", "--warn=none"])
    control.add("base", [], program)
    control.ground()
    found: set[tuple[str, int]] = set()

    def keep(model: clingo.Model) -> None:
        if model.cost and not model.optimality_proven:
            return
        for symbol in model.symbols(atoms=True):
            if symbol.name in ("_fired", "_near"):
                found.add((symbol.name, symbol.arguments[0].number))

    control.solve(on_model=keep)
    return found


def _refuses(rule: Rule, probe: str, rulebook: Rulebook, cases: Sequence[Path]) -> bool:
    """Say whether a constraint refuses a candidate in some case."""
    texts = dict.fromkeys(stage for stage, _ in rulebook.texts)
    for path in cases:
        if rule.stage not in stages_of(path):
            continue
        stages = [s for s in texts if s in ("base", *stages_of(path))]
        rules = "\n".join(rulebook.text(stage) for stage in stages)
        assert rules.count(rule.text) == 1
        program = [read_case(path)[0], rules.replace(rule.text, f"{probe} :- not _fired(_).")]
        control = clingo.Control(["--opt-mode=ignore", "--warn=none"])
        control.add("base", [], "\n".join(program))
        control.ground()
        if control.solve().satisfiable:
            return True
    return False


def children(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of clingo's syntax tree directly below one, in order of its keys."""
    for key in node.child_keys:
        child = getattr(node, key)
        if isinstance(child, ast.ASTSequence):
            yield from child
        elif child is not None:
            yield child


def _variables(node: ast.AST) -> Iterator[str]:
    if node.ast_type == _TYPE.Variable:
        yield node.name
        return
    for child in children(node):
        yield from _variables(child)


class _Blank(ast.Transformer):
    """Replaces variables by anonymous ones."""

    def __init__(self, names: set[str]) -> None:
        self.names = names

    def visit_Variable(self, node: ast.AST) -> ast.AST:  # noqa: N802 -- clingo's own name
        return node.update(name="_") if node.name in self.names else node


def places(rules: Iterable[Rule]) -> str:
    """Return rules with their places, a line each."""
    return "\n".join(f"{r.span.path}:{r.span.line}: {' '.join(r.text.split())}" for r in rules)
