"""Rule cases of the same stages, answered together where their rules choose nothing."""

import re
from collections.abc import Iterable, Iterator, Sequence, Set
from pathlib import Path
from typing import NamedTuple

import clingo

from mars_asp.asp.contained import Lost, ask
from mars_asp.asp.fragments import joined
from mars_asp.asp.messages import heard, predicate_of, saying
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import shown as shows
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.reasoning.cases.run import stages_of
from mars_asp.reasoning.findings import CONSEQUENCE
from tests.support.side_by_side import apart, together

_EXPECTED = re.compile(r"^%=(.*(?:\n%\+.*)*)$", re.MULTILINE)
_CONTINUED = re.compile(r"\r?\n%\+")
_COST = re.compile(r"^%~[ \t]*(.*?)[ \t\r]*$", re.MULTILINE)
_MESSAGE = re.compile(r"^%>[ \t]*(.*?)[ \t\r]*$", re.MULTILINE)
SPOKEN = "case"
#: Stages in which an answer is chosen.
CHOOSING = frozenset(("resolve", "can", "cost"))


class Case(NamedTuple):
    """The text of a case and its expected answer sets, sorted.

    Compared are the atoms of the predicates `wanted`, and messages and costs if the case has any.
    """

    text: str
    expected: tuple[tuple[str, ...], ...]
    wanted: tuple[Signature, ...]
    has_messages: bool
    has_costs: bool

    def hears(self, rule: Rule) -> bool:
        """Whether the case compares the messages of a rule."""
        return bool(self.has_messages and rule.because and rule.heads.intersection(self.wanted))

    def compared(self, atoms: Iterable[clingo.Symbol], speakers: Sequence[Rule]) -> Iterator[str]:
        """Yield the compared atoms and messages of an answer that contains atoms of `saying`."""
        for atom in atoms:
            if signature_of(atom) in self.wanted:
                yield str(atom)
            elif self.has_messages and atom.name == predicate_of(SPOKEN):
                result = heard(as_term(atom), speakers)
                if self.hears(result.rule):
                    yield f"%> {result.rule.id}: {result.message}"


def case_of(path: Path, finding: Signature) -> Case:
    """Return a case; `finding` is the predicate that is compared where it shows none.

    Raises:
        MarsError: it may not be given to clingo.
    """
    text, written = read_case(path)
    shown_in = tuple(s for piece in written if piece.sort == "shown" for s in shows(piece.text))
    messages = [f"%> {message}" for message in _MESSAGE.findall(text)]
    costs = [f"%~ {cost}" for cost in _COST.findall(text)]
    rest = [*messages, *costs]
    answers = (_CONTINUED.sub(" ", one) for one in _EXPECTED.findall(text))
    expected = tuple(sorted(tuple(sorted([*_atoms(each), *rest])) for each in answers))
    return Case(text, expected, shown_in or (finding,), bool(messages), bool(costs))


def _atoms(text: str) -> Iterator[str]:
    """Yield the atoms of a line, which blanks part outside of brackets and strings."""
    depth, quoted, current = 0, False, ""
    for character in text.strip() + " ":
        if character == '"':
            quoted = not quoted
        if not quoted:
            depth += (character == "(") - (character == ")")
        if character == " " and not depth and not quoted:
            if current:
                yield current
            current = ""
        else:
            current += character


class Outcome(NamedTuple):
    """The expected and the actual answer sets of a case, each sorted."""

    path: Path
    expected: tuple[tuple[str, ...], ...]
    found: tuple[tuple[str, ...], ...]

    @property
    def passed(self) -> bool:
        """Whether the actual answer sets are the expected ones."""
        return self.expected == self.found

    def difference(self) -> Iterator[str]:
        """Yield a line for each missing and each superfluous atom."""
        for name, these, those in (
            ("missing", self.expected, self.found),
            ("too much", self.found, self.expected),
        ):
            others = {atom for answer in those for atom in answer}
            for answer in these:
                yield from (f"  {name}: {atom}" for atom in answer if atom not in others)


def together_or_apart(paths: Sequence[Path]) -> tuple[list[list[Path]], list[Path]]:
    """Return cases by stages that are answered at once, and those that are answered alone."""
    groups: dict[tuple[str, ...], list[Path]] = {}
    alone: list[Path] = []
    for path in paths:
        stages = stages_of(path)
        if CHOOSING.isdisjoint(stages):
            groups.setdefault(stages, []).append(path)
        else:
            alone.append(path)
    return list(groups.values()), alone


def outcomes(paths: Sequence[Path], rulebook: Rulebook) -> Iterator[Outcome]:
    """Yield the outcome of each case; the cases have the same stages and no choices."""
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

    wanted = {each for case in cases for each in case.wanted}

    def compared(text: str) -> list[tuple[str, ...]]:
        answers = zip(cases, _answers(text, len(cases), wanted), strict=True)
        return [tuple(sorted(set(case.compared(atoms, speakers)))) for case, atoms in answers]

    # clingo keeps each term until its process ends, and forks of a large process are slow.
    [(_, found)] = ask(["\n".join(program)], compared, 1)
    assert not isinstance(found, Lost)
    for path, case, answer in zip(paths, cases, found, strict=True):
        yield Outcome(path, case.expected, (answer,))


def _answers(program: str, count: int, wanted: Set[Signature]) -> list[list[clingo.Symbol]]:
    """Return the wanted atoms and the messages of each case."""
    control = clingo.Control(["--warn=none"])
    control.add("base", [], program)
    control.ground()
    assert control.solve().satisfiable
    found: list[list[clingo.Symbol]] = [[] for _ in range(count)]
    atoms = control.symbolic_atoms
    for name, arity, positive in atoms.signatures:
        is_read = Signature(name, arity - 1, positive) in wanted or name == predicate_of(SPOKEN)
        for atom in atoms.by_signature(name, arity, positive):
            assert atom.is_fact, f"{atom.symbol} is chosen"
            if is_read:
                number, *rest = atom.symbol.arguments
                found[number.number].append(clingo.Function(name, rest, positive))
    return found
