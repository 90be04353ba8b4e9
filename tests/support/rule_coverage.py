"""Which rules the rule cases fire, and which they let fail by one literal alone.

A rule *fires* in a case where its body holds in a wanted answer set; it *just does not* where the
body holds but for one literal. Variables that only this literal binds count as any value. A
constraint fires where leaving it out changes the answer.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import clingo
from clingo import ast

from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import children
from mars_asp.asp.rules.statements import shown as shown_in
from mars_asp.asp.signature import Signature
from mars_asp.reasoning.cases import stages_of
from tests.support.side_by_side import answered, apart, batched, together

_TYPE = ast.ASTType


@dataclass(frozen=True)
class Coverage:
    """The rules that fire in no case, and those that never fail by one literal alone."""

    silent: tuple[Rule, ...]
    never_near: tuple[Rule, ...]


def covered(rulebook: Rulebook, cases: Sequence[Path]) -> Coverage:
    """Run every case with probes beside the rules."""
    probes = {n: tuple(_safe(_probes(n, rule))) for n, rule in enumerate(rulebook.rules)}
    told = dict[str, list[str]]()
    for number, rule in enumerate(rulebook.rules):
        told.setdefault(rule.stage, []).extend(probe for _, probe in probes[number])
    held = {(name, number) for _, name, number in _held(rulebook, told, cases)}
    numbered = list(enumerate(rulebook.rules))
    return Coverage(
        tuple(
            rule
            for number, rule in numbered
            if rule.ast.body
            and ("_fired", number) not in held
            and not (
                str(rule.ast.head) == "#false"
                and _refuses(rule, probes[number][0][1], rulebook, cases)
            )
        ),
        tuple(
            rule
            for number, rule in numbered
            if ("_near", number) not in held and any(kind == "_near" for kind, _ in probes[number])
        ),
    )


def fired_in(rules: Sequence[Rule], rulebook: Rulebook, cases: Sequence[Path]) -> list[list[Path]]:
    """Return the cases that fire each of some rules."""
    told = dict[str, list[str]]()
    for number, rule in enumerate(rules):
        told.setdefault(rule.stage, []).append(next(_probes(number, rule))[1])
    found: list[list[Path]] = [[] for _ in rules]
    for path, _, number in sorted(_held(rulebook, told, cases)):
        found[number].append(path)
    return found


def _held(
    rulebook: Rulebook, probes: Mapping[str, Iterable[str]], cases: Iterable[Path]
) -> set[tuple[Path, str, int]]:
    """Return each case with the probes, by stage, that hold in one of its answers."""
    groups: dict[tuple[str, ...], list[Path]] = {}
    for path in cases:
        groups.setdefault(("base", *stages_of(path)), []).append(path)
    found = set[tuple[Path, str, int]]()
    for stages, paths in groups.items():
        rules = [together(rulebook.text(stage)) for stage in stages]
        rules += [together("\n".join(probes.get(stage, ()))) for stage in stages]
        for part in batched(paths):
            facts = [apart(number, read_case(path)[0]) for number, path in enumerate(part)]
            facts += [f"of_({number}, {number})." for number in range(len(part))]
            for atom in answered([*rules, *facts], ("_fired", "_near")):
                case, number = (argument.number for argument in atom.arguments)
                found.add((part[case], atom.name, number))
    return found


def unnoticed(lists: Sequence[Rule], rulebook: Rulebook, cases: Sequence[Path]) -> list[Rule]:
    """Return what metadata lists and may be left out without another answer of any case.

    A case notices it by what it shows, so that an answer is as it is expected only with it.
    """
    number = {rule: at for at, rule in enumerate(lists)}
    left = replace(
        rulebook,
        rules=tuple(
            replace(rule, text=f"{rule.text.rstrip().removesuffix('.')}, not out_({number[rule]}).")
            if rule in number
            else rule
            for rule in rulebook.rules
        ),
    )
    groups: dict[tuple[str, ...], list[tuple[Path, int]]] = {}
    for rule, paths in zip(lists, fired_in(lists, rulebook, cases), strict=True):
        for path in paths:
            groups.setdefault(("base", *stages_of(path)), []).append((path, number[rule]))
    noticed = set[int]()
    for stages, pairs in groups.items():
        rules = [together(left.text(stage)) for stage in stages]
        paths = sorted({path for path, _ in pairs})
        shown = [_shown(path) for path in paths]
        facts = [apart(at, read_case(path)[0]) for at, path in enumerate(paths)]
        # Those without anything left out have the numbers of their cases, the others follow.
        copies = [
            *enumerate(paths),
            *((len(paths) + at, path) for at, (path, _) in enumerate(pairs)),
        ]
        told = [f"of_({copy}, {paths.index(path)})." for copy, path in copies]
        told += [f"out_({len(paths) + at}, {out})." for at, (_, out) in enumerate(pairs)]
        names = {each.name for wanted in shown for each in wanted}
        answers = [set[str]() for _ in copies]
        for atom in answered([*rules, *facts, *told], sorted(names)):
            copy, *rest = atom.arguments
            wanted = shown[paths.index(copies[copy.number][1])]
            if Signature(atom.name, len(rest), atom.positive) in wanted:
                answers[copy.number].add(str(clingo.Function(atom.name, rest, atom.positive)))
        for at, (path, out) in enumerate(pairs):
            if answers[len(paths) + at] != answers[paths.index(path)]:
                noticed.add(out)
    return [rule for rule in lists if number[rule] not in noticed]


def _shown(path: Path) -> frozenset[Signature]:
    pieces = (piece for piece in read_case(path)[1] if piece.sort == "shown")
    return frozenset(each for piece in pieces for each in shown_in(piece.text))


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
