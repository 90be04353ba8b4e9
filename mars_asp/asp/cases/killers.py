"""The cases that detect mutants of rules, or a stronger check if one is provided.

A case can detect a mutant only if the mutant derives other heads or messages than its rule from the
case's own answer, or derives anything at all in a recursive rule. All mutants of a case are
examined for this at once, so that few programs are solved for each mutant. A mutant whose message
names unbound variables is rejected without a case.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TypeAlias

import clingo

from mars_asp.asp.cases.coverage import Case
from mars_asp.asp.cases.mutants import Mutant, MutantVerdict, MutatedFile, written
from mars_asp.asp.cases.probes import is_safe
from mars_asp.asp.contained import Lost, ask, limit_time
from mars_asp.asp.rules.expansions import Expansions, expanded
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import statements
from mars_asp.asp.rules.statements import written as tree_of
from mars_asp.asp.rules.trees import Kind, SyntaxNode
from mars_asp.asp.solve.cyclic import cyclic_components
from mars_asp.diagnostic import MarsError

#: The killer of a mutant that exceeds its time or memory.
RUNS_AWAY = "it runs away"
#: The seconds of CPU time for a case; a mutant that needs more runs away.
_SECONDS = 5.0
#: The holes of messages, by the file and the line of their rule.
_Holes: TypeAlias = Mapping[tuple[str, int], Sequence[str]]


@dataclass(frozen=True)
class Bench:
    """The rulebook and the cases for trying mutants.

    Attributes:
        deterministic: stages without choices, in which grounding alone gives the answer of a case.
        expansions: the expansion of each metadata key into rules, by key.
        check: called with a stage and a mutated rulebook; returns its own name on detection.
    """

    rulebook: Rulebook
    cases: Sequence[Case]
    deterministic: Sequence[str]
    expansions: Expansions
    check: Callable[[str, Rulebook], str | None] | None = None


def judge(
    files: Sequence[MutatedFile], mutants: Sequence[Mutant], bench: Bench, jobs: int
) -> Iterator[MutantVerdict]:
    """Yield the verdict on each mutant of the files, in any order; `jobs` are tried in parallel."""
    by_path = {file.path: file for file in files}
    holes = {
        (rule.span.path, rule.span.line): rule.holes
        for rule in bench.rulebook.rules
        if rule.listed is None
    }
    useful = _useful(files, mutants, bench, holes, jobs)
    kills: Counter[tuple[str, str]] = Counter()

    def rank(mutant: Mutant, case: Case) -> tuple[int, bool]:
        # Near is a case whose folder is named like the file of the mutant.
        is_far = f"/{case.path.parent.name}." not in f"/{mutant.path}"
        return -kills[mutant.before, _case_name(case)], is_far

    def questions() -> Iterator[tuple[Mutant, tuple[Case, ...]]]:
        for mutant in mutants:
            yield mutant, tuple(sorted(useful[mutant], key=partial(rank, mutant)))

    def answer(question: tuple[Mutant, tuple[Case, ...]]) -> tuple[str, bool]:
        mutant, tried = question
        if not _binds_holes(mutant, holes):
            return "its message", False
        file = by_path[mutant.path]
        changed = _exchanged(bench, file, mutant)
        killer = _killing_case(tried, changed)
        if killer is not None:
            return killer, True
        found = None if bench.check is None else bench.check(file.stage, changed)
        return ("", False) if found is None else (found, False)

    for (mutant, _), found in ask(questions(), answer, jobs):
        killer, by_case = (RUNS_AWAY, False) if isinstance(found, Lost) else found
        kills[mutant.before, killer] += by_case
        yield MutantVerdict(mutant, killer or None)


def _case_name(case: Case) -> str:
    return f"{case.path.parent.name}/{case.path.stem}"


def _killing_case(cases: Iterable[Case], rulebook: Rulebook) -> str | None:
    for case in cases:
        limit_time(_SECONDS)
        try:
            passed = case.passes(rulebook)
        except MarsError:
            passed = False
        if not passed:
            return _case_name(case)
    return None


def _exchanged(bench: Bench, file: MutatedFile, mutant: Mutant) -> Rulebook:
    """Return the rulebook with the mutant in place of its statement."""
    rulebook = bench.rulebook
    old = file.content.decode()
    texts = tuple((s, file.mutated(mutant) if text == old else text) for s, text in rulebook.texts)
    rules: list[Rule] = []
    for rule in rulebook.rules:
        if not _is_of(rule, mutant):
            rules.append(rule)
        elif mutant.after and rule.listed is None:
            changed = replace(rule, text=mutant.after)
            rules.append(changed)
            for key, listed in changed.lists:
                rules += expanded(changed, key, listed, changed.span, bench.expansions[key])
    assert texts != rulebook.texts
    return replace(rulebook, rules=tuple(rules), texts=texts)


def _is_of(rule: Rule, mutant: Mutant) -> bool:
    """Whether a rule is the original of a mutant, or was made from the original's metadata."""
    if (rule.span.path, rule.span.line) != (mutant.path, mutant.line):
        return False
    # Other rules may be in the same line.
    return rule.listed is not None or written(rule.node) == mutant.before


# ---- Which cases can notice a mutant -------------------------------------------------------------


def _useful(
    files: Sequence[MutatedFile],
    mutants: Sequence[Mutant],
    bench: Bench,
    holes: _Holes,
    jobs: int,
) -> Mapping[Mutant, list[Case]]:
    """Return for each mutant the cases whose result it may change; only these are tried."""
    by_path = {file.path: file for file in files}
    circular = _circular(tuple(files))
    useful: dict[Mutant, list[Case]] = {mutant: [] for mutant in mutants}
    probed: dict[str, list[tuple[int, Mutant]]] = {}
    for number, mutant in enumerate(mutants):
        file = by_path[mutant.path]
        head = _head(file.statements[mutant.place].tree)
        if not _binds_holes(mutant, holes):
            continue
        if file.stage in bench.deterministic and head is not None:
            probed.setdefault(file.stage, []).append((number, mutant))
        else:
            useful[mutant] = [case for case in bench.cases if file.stage in case.stages]

    def answer(case: Case) -> set[int]:
        limit_time(60)
        stages = [stage for stage in case.stages if stage in bench.deterministic]
        mine = [entry for stage in stages for entry in probed.get(stage, ())]
        rules = [bench.rulebook.text(stage) for stage in stages]
        found = set[int]()
        for facts in case.texts:
            found |= _different(mine, "\n".join([facts, *rules]), circular, holes)
        return found

    everything = {number for entries in probed.values() for number, _ in entries}
    for case, found in ask(bench.cases, answer, jobs) if everything else ():
        for number in everything if isinstance(found, Lost) else found:
            useful[mutants[number]].append(case)
    return useful


def _head(rule: SyntaxNode) -> SyntaxNode | None:
    """Return the atom that a rule derives, or None for choices, constraints and others."""
    if rule.ast_type != Kind.Rule or rule.head.ast_type != Kind.Literal:
        return None
    atom: SyntaxNode = rule.head.atom
    return atom if atom.ast_type == Kind.SymbolicAtom else None


def _probe(name: str, statement: str, holes: Sequence[str]) -> str:
    """Return a rule deriving `__probe(name, ...)` with a statement's head and message values."""
    rule = tree_of(statement)
    body = "; ".join(map(str, rule.body)) or "#true"
    return f"__probe({name},t({','.join([str(_head(rule)), *holes])})) :- {body}."


def _binds_holes(mutant: Mutant, holes: _Holes) -> bool:
    """Whether the body of a mutant still binds the variables of its message."""
    named = holes.get((mutant.path, mutant.line), ())
    return not mutant.after or not named or is_safe(_probe("0", mutant.after, named))


def _different(
    mutants: Sequence[tuple[int, Mutant]],
    program: str,
    circular: set[tuple[str, str]],
    holes: _Holes,
) -> set[int]:
    """Return the numbers of mutants that may derive other heads or messages than the originals.

    `program` is the text of a case with its rules, `circular` are the recursive rules.
    """
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
def _circular(files: tuple[MutatedFile, ...]) -> set[tuple[str, str]]:
    """Return the recursive rules, as path and text."""
    rules = [
        (file.path, rule.text, {s.unsigned for s in one.derives}, {s.unsigned for s in one.reads})
        for file in files
        for rule in file.statements
        if rule.tree.ast_type == Kind.Rule
        for one in statements(rule.text)
    ]
    group = cyclic_components(
        (head, body) for _, _, heads, bodies in rules for head in heads for body in bodies
    )
    return {
        (path, text)
        for path, text, heads, bodies in rules
        if {group[head] for head in heads & group.keys()}
        & {group[body] for body in bodies & group.keys()}
    }
