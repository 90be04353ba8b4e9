"""What notices a mutant of a rule: a case of `tests/rules`, or else a stronger check.

A case can notice a mutant only where the mutant derives other heads than the rule from the case's
own answer, or says something else, or derives anything where the rule may support itself in a
circle. This is looked at for all mutants of a case at once, so that few programs are solved for
each mutant. A mutant whose message names what nothing binds any more is refused when it is read.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TypeAlias

import clingo
import networkx as nx
from clingo import ast

from mars_asp.asp.cases import find_cases
from mars_asp.asp.rules.expansions import expanded
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import sign_and_function
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.cases import run_case, stages_of
from mars_asp.reasoning.findings import EXPANSIONS
from mars_asp.reasoning.rules import STAGES, load_rulebook
from tests.mutate.children import ask, limit
from tests.mutate.mutant import RUNS_AWAY, Mutant, Verdict
from tests.mutate.rule_mutants import RuleFile, Statement, is_safe
from tests.mutate.stronger import CHECKS
from tests.support.documents import ROOT
from tests.support.rule_coverage import children

CASES = ROOT / "tests" / "rules"
#: Seconds of the processor that a case may take: a mutant that takes more runs away.
_SECONDS = 5.0
_TYPE = ast.ASTType
#: Stages without choices: what a case derives in them is one answer, known once it is grounded.
_DETERMINISTIC = ("base", "verify", "run", "repair")
#: What a message names, by the file and the line of its rule.
_Holes: TypeAlias = Mapping[tuple[str, int], Sequence[str]]


def judge_rules(
    files: Sequence[RuleFile],
    mutants: Sequence[Mutant],
    jobs: int,
    cases: Path = CASES,
    stronger: bool = True,
) -> Iterator[Verdict]:
    """Yield what notices each mutant of the files, in no order."""
    rulebook = _built_in()
    paths = find_cases([cases])
    by_path = {file.path: file for file in files}
    holes = {
        (rule.span.path, rule.span.line): rule.holes
        for rule in rulebook.rules
        if rule.listed is None
    }
    useful = _useful(files, mutants, paths, rulebook, holes, jobs)
    kills: Counter[tuple[str, Path]] = Counter()

    def rank(mutant: Mutant, path: Path) -> tuple[int, bool]:
        return -kills[mutant.before, path], path.parent.name != Path(mutant.path).stem

    def questions() -> Iterator[tuple[Mutant, tuple[Path, ...]]]:
        for mutant in mutants:
            yield mutant, tuple(sorted(useful[mutant], key=partial(rank, mutant)))

    def answer(question: tuple[Mutant, tuple[Path, ...]]) -> tuple[Path | str | None]:
        mutant, tried = question
        if not _is_told(mutant, holes):
            return ("its message",)
        file = by_path[mutant.path]
        changed = _exchanged(rulebook, file, mutant)
        killer = _killing_case(tried, changed)
        if killer is None and stronger:
            return (_killing_check(file.stage, changed),)
        return (killer,)

    for (mutant, _), found in ask(questions(), answer, jobs):
        killer = RUNS_AWAY if found is None else found[0]
        if isinstance(killer, Path):
            kills[mutant.before, killer] += 1
            killer = f"{killer.parent.name}/{killer.stem}"
        yield Verdict(mutant, killer)


@cache
def _built_in() -> Rulebook:
    return load_rulebook(stages=STAGES, strict=True)


def _killing_case(paths: Iterable[Path], rulebook: Rulebook) -> Path | None:
    for path in paths:
        limit(_SECONDS)
        try:
            passed = run_case(path, rulebook).passed
        except MarsError:
            passed = False
        if not passed:
            return path
    return None


def _killing_check(stage: str, rulebook: Rulebook) -> str | None:
    for check in CHECKS:
        if stage in check.stages:
            limit(check.seconds)
            try:
                check.run(rulebook)
            except Exception:
                return check.name
    return None


def _exchanged(rulebook: Rulebook, file: RuleFile, mutant: Mutant) -> Rulebook:
    """Return the rulebook with a mutant in the place of its statement."""
    old = file.content.decode()
    texts = tuple((s, file.mutated(mutant) if text == old else text) for s, text in rulebook.texts)
    rules: list[Rule] = []
    for rule in rulebook.rules:
        if (rule.span.path, rule.span.line) != (file.path, mutant.line):
            rules.append(rule)
        elif mutant.after and rule.listed is None:
            changed = replace(rule, text=mutant.after)
            rules += (changed, *_listed(changed))
    assert texts != rulebook.texts
    return replace(rulebook, rules=tuple(rules), texts=texts)


def _listed(rule: Rule) -> Iterator[Rule]:
    """Yield the rules that its metadata stand for, which have its body."""
    for key, written in rule.lists:
        yield from expanded(rule, key, written, rule.span, EXPANSIONS[key])


# ---- Which cases can notice a mutant -------------------------------------------------------------


def _useful(
    files: Sequence[RuleFile],
    mutants: Sequence[Mutant],
    paths: Sequence[Path],
    rulebook: Rulebook,
    holes: _Holes,
    jobs: int,
) -> Mapping[Mutant, list[Path]]:
    """Return the cases in which each mutant makes a difference, or may make one."""
    by_path = {file.path: file for file in files}
    circular = _circular(tuple(files))
    useful: dict[Mutant, list[Path]] = {mutant: [] for mutant in mutants}
    probed: dict[str, list[tuple[int, Mutant]]] = {}
    for number, mutant in enumerate(mutants):
        file = by_path[mutant.path]
        head = _head(file.statements[mutant.place].tree)
        if not _is_told(mutant, holes):
            continue
        if file.stage in _DETERMINISTIC and head is not None:
            probed.setdefault(file.stage, []).append((number, mutant))
        else:
            useful[mutant] = [path for path in paths if file.stage in _stages(path)]

    def answer(path: Path) -> set[int]:
        limit(60)
        stages = [stage for stage in _stages(path) if stage in _DETERMINISTIC]
        mine = [entry for stage in stages for entry in probed.get(stage, ())]
        rules = [rulebook.text(stage) for stage in stages]
        return _different(mine, "\n".join([read_case(path)[0], *rules]), circular, holes)

    for path, found in ask(paths, answer, jobs):
        everything = {number for entries in probed.values() for number, _ in entries}
        for number in everything if found is None else found:
            useful[mutants[number]].append(path)
    return useful


def _stages(path: Path) -> tuple[str, ...]:
    return ("base", *stages_of(path))


def _head(tree: ast.AST) -> ast.AST | None:
    """Return the atom that a rule derives, if it derives one and does not choose."""
    if tree.ast_type != _TYPE.Rule or tree.head.ast_type != _TYPE.Literal:
        return None
    atom: ast.AST = tree.head.atom
    return atom if atom.ast_type == _TYPE.SymbolicAtom else None


def _probe(name: str, statement: str, holes: Sequence[str]) -> str:
    """Return a rule that keeps what a statement derives and the values of its message's holes."""
    trees: list[ast.AST] = []
    ast.parse_string(statement, trees.append)
    tree = trees[-1]
    body = "; ".join(map(str, tree.body)) or "#true"
    return f"__probe({name},t({','.join([str(_head(tree)), *holes])})) :- {body}."


def _is_told(mutant: Mutant, holes: _Holes) -> bool:
    """Say whether a mutant still binds what its message names."""
    named = holes.get((mutant.path, mutant.line), ())
    return not mutant.after or not named or is_safe(_probe("0", mutant.after, named))


def _different(
    mutants: Sequence[tuple[int, Mutant]],
    program: str,
    circular: set[tuple[str, str]],
    holes: _Holes,
) -> set[int]:
    """Return the numbers of the mutants that derive something else than their rules do."""
    originals = {mutant.before: index for index, (_, mutant) in enumerate(mutants)}
    named = {mutant.before: holes.get((mutant.path, mutant.line), ()) for _, mutant in mutants}
    text = [program]
    text += [_probe(f"rule({n})", before, named[before]) for before, n in originals.items()]
    text += [_probe(str(n), m.after, named[m.before]) for n, m in mutants if m.after]
    control = clingo.Control(["--warn=none"])
    control.add("base", [], "\n".join(text))
    control.ground()
    derived: dict[clingo.Symbol, set[clingo.Symbol]] = {}
    uncertain: set[clingo.Symbol] = set()
    for atom in control.symbolic_atoms.by_signature("__probe", 2):
        name, head = atom.symbol.arguments
        derived.setdefault(name, set()).add(head)
        if not atom.is_fact:
            uncertain.add(name)
    found: set[int] = set()
    for number, mutant in mutants:
        old = clingo.Function("rule", [clingo.Number(originals[mutant.before])])
        new = clingo.Number(number)
        itself = new in derived and mutant.key[:2] in circular
        if itself or {old, new} & uncertain or derived.get(old) != derived.get(new):
            found.add(number)
    return found


@cache
def _circular(files: tuple[RuleFile, ...]) -> set[tuple[str, str]]:
    """Return the rules, as path and text, whose heads and bodies depend on each other."""
    uses: nx.DiGraph[tuple[str, int]] = nx.DiGraph()
    rules = [
        (file.path, statement.text, *_signatures(statement))
        for file in files
        for statement in file.statements
        if statement.tree.ast_type == _TYPE.Rule
    ]
    for _, _, heads, bodies in rules:
        uses.add_edges_from((head, body) for head in heads for body in bodies)
    group = {
        name: number
        for number, names in enumerate(nx.strongly_connected_components(uses))
        for name in names
    }
    return {
        (path, text)
        for path, text, heads, bodies in rules
        if {group.get(head) for head in heads} & {group.get(body) for body in bodies}
    }


def _signatures(statement: Statement) -> tuple[set[tuple[str, int]], set[tuple[str, int]]]:
    heads = set(_predicates(statement.tree.head))
    return heads, {each for node in statement.tree.body for each in _predicates(node)}


def _predicates(node: ast.AST) -> Iterator[tuple[str, int]]:
    """Yield the predicates in a tree, without signs."""
    if node.ast_type != ast.ASTType.SymbolicAtom:
        for child in children(node):
            yield from _predicates(child)
        return
    _, symbol = sign_and_function(node.symbol)
    pooled = symbol.ast_type == ast.ASTType.Pool
    for variant in symbol.arguments if pooled else (symbol,):
        yield variant.name, len(variant.arguments)
