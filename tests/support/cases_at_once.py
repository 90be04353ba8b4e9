"""Rule cases of one folder, answered together where their rules choose nothing."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import clingo

from mars_asp.asp.cases import SPOKEN, Outcome, case_of
from mars_asp.asp.fragments import joined
from mars_asp.asp.messages import saying
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.reasoning.cases import stages_of
from mars_asp.reasoning.findings import CONSEQUENCE
from tests.support.side_by_side import apart, together

#: Stages in which an answer is chosen.
CHOOSING = frozenset(("resolve", "can", "cost"))


def together_or_apart(paths: Sequence[Path]) -> tuple[list[list[Path]], list[Path]]:
    """Return cases by folders that are answered at once, and those that are answered alone."""
    groups: dict[Path, list[Path]] = {}
    alone: list[Path] = []
    for path in paths:
        if CHOOSING.isdisjoint(stages_of(path)):
            groups.setdefault(path.parent, []).append(path)
        else:
            alone.append(path)
    return list(groups.values()), alone


def outcomes(paths: Sequence[Path], rulebook: Rulebook) -> Iterator[Outcome]:
    """Yield what becomes of cases of the same stages, of which none chooses."""
    stages = ("base", *stages_of(paths[0]))
    cases = [case_of(path, CONSEQUENCE) for path in paths]
    heard = [case for case in cases if case.has_messages]
    speakers = [
        rule
        for rule in rulebook.rules
        if rule.stage in stages and any(case.hears(rule) for case in heard)
    ]
    program = ["case_(C) :- of_(C, _). in_(C) :- case_(C)."]
    program += [together(rulebook.text(stage)) for stage in stages]
    program.append(together(joined(saying(SPOKEN, speakers))))
    for number, case in enumerate(cases):
        program += (apart(number, case.text), f"of_({number}, {number}).")
    answers = _answers("\n".join(program), len(cases))
    for path, case, atoms in zip(paths, cases, answers, strict=True):
        yield Outcome(path, case.expected, (tuple(sorted(set(case.compared(atoms, speakers)))),))


def _answers(program: str, count: int) -> list[list[clingo.Symbol]]:
    control = clingo.Control(["--warn=none"])
    control.add("base", [], program)
    control.ground()
    assert control.solve().satisfiable
    found: list[list[clingo.Symbol]] = [[] for _ in range(count)]
    for atom in control.symbolic_atoms:
        symbol = atom.symbol
        assert atom.is_fact, f"{symbol} is chosen"
        number, *rest = symbol.arguments
        found[number.number].append(clingo.Function(symbol.name, rest, symbol.positive))
    return found
