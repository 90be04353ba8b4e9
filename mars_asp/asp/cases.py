"""Regression tests on answer sets: facts and what the rules make of them, in one file.

A line `%= atom atom ...` is one expected answer set, which lines `%+ atom ...` below it continue,
restricted to the predicates that the case's own `#show` lines name, else to what rules find; no
such line means that there is none. A case in a folder named after a stage (`resolve`) has the
rules of that stage, too; of its answer sets the least count. A line `%~ 3@30 12@10` is what these
cost, each level that costs anything with its sum, the highest first. A line `%> id: message` is
what the rule of that id says; where a case has one, all is compared that is said by rules which
derive what it shows.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import clingo

from mars_asp.asp.fragments import Fragment, joined, refusals
from mars_asp.asp.messages import heard, predicate_of, saying
from mars_asp.asp.rules.arithmetic import telling, wrapped
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import Piece
from mars_asp.asp.rules.statements import shown as shows
from mars_asp.asp.signature import Signature, signature_of
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.diagnostic import Diagnostic, MarsError, point

_EXPECTED = re.compile(r"^%=(.*(?:\n%\+.*)*)$", re.MULTILINE)
_CONTINUED = re.compile(r"\r?\n%\+")
_COST = re.compile(r"^%~[ \t]*(.*?)[ \t\r]*$", re.MULTILINE)
_MESSAGE = re.compile(r"^%>[ \t]*(.*?)[ \t\r]*$", re.MULTILINE)
#: What is asked to be said here, beside what cases ask of rules themselves.
SPOKEN = "case"
_MOST_ANSWERS = 100
_MOST_MESSAGES = 10_000


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a case expects and what the rules gave, each a tuple of sorted answer sets."""

    path: Path
    expected: tuple[tuple[str, ...], ...]
    found: tuple[tuple[str, ...], ...]

    @property
    def passed(self) -> bool:
        """Whether the rules gave what is expected."""
        return self.expected == self.found

    def difference(self) -> Iterator[str]:
        """Yield lines that say what is missing and what is too much."""
        missing = [answer for answer in self.expected if answer not in self.found]
        extra = [answer for answer in self.found if answer not in self.expected]
        if not self.expected:
            yield "  no line `%=`, so no answer set is expected; rules of your own go with --rules"
        if len(missing) == len(extra) == 1:
            lost, new = set(missing[0]), set(extra[0])
            yield from (f"  - {atom}" for atom in sorted(lost - new))
            yield from (f"  + {atom}" for atom in sorted(new - lost))
            return
        yield from (f"  - answer set: {' '.join(answer)}" for answer in missing)
        yield from (f"  + answer set: {' '.join(answer)}" for answer in extra)


def find_cases(paths: Iterable[Path], packs: Iterable[Path] = ()) -> tuple[Path, ...]:
    """Return the case files that paths name, those of folders in the order of their names.

    Of what a folder holds, the files of rule packs are no cases.
    """
    rules = {path.resolve() for path in packs}
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            held = sorted(path.rglob("*.lp"))
            found += (p for p in held if not {p.resolve(), p.resolve().parent} & rules)
        else:
            found.append(path)
    return tuple(found)


def stages_of(path: Path, stages: Collection[str]) -> tuple[str, ...]:
    """Return the stages, of those there are, that the folders of a case are named after.

    Where a case lies in the current folder, what that folder is called says nothing.
    """
    full, here = path.absolute(), Path.cwd()
    parts = full.relative_to(here).parts if full.is_relative_to(here) else full.parts
    return tuple(stage for stage in stages if stage in parts)


class Case(NamedTuple):
    """The text of a case, the sorted answer sets that it expects, and what it compares of each.

    These are the atoms of predicates `wanted`, and where it has one of them messages and costs.
    """

    text: str
    expected: tuple[tuple[str, ...], ...]
    wanted: tuple[Signature, ...]
    has_messages: bool
    has_costs: bool

    def hears(self, rule: Rule) -> bool:
        """Whether what a rule says is compared."""
        return bool(self.has_messages and rule.because and rule.heads.intersection(self.wanted))

    def compared(self, atoms: Iterable[clingo.Symbol], speakers: Sequence[Rule]) -> Iterator[str]:
        """Yield what is compared of an answer with what rules say, whose `saying` is in it."""
        for atom in atoms:
            if signature_of(atom) in self.wanted:
                yield str(atom)
            elif self.has_messages and atom.name == predicate_of(SPOKEN):
                told = heard(as_term(atom), speakers)
                if self.hears(told.rule):
                    yield f"%> {told.rule.id}: {told.message}"


def case_of(path: Path, finding: Signature) -> Case:
    """Return a case; `finding` is the predicate that is compared where it shows none.

    Raises:
        MarsError: it may not be given to clingo.
    """
    text, written = read_case(path)
    messages = [f"%> {message}" for message in _MESSAGE.findall(text)]
    costs = [f"%~ {cost}" for cost in _COST.findall(text)]
    rest = [*messages, *costs]
    expected = tuple(
        sorted(tuple(sorted([*_atoms(e), *rest])) for e in map(_one_line, _EXPECTED.findall(text)))
    )
    return Case(text, expected, _shown(written) or (finding,), bool(messages), bool(costs))


def run_case(
    path: Path, rulebook: Rulebook, stages: Collection[str], finding: Signature
) -> Outcome:
    """Run one case with the rules of the base and of `stages`.

    `finding` is the predicate that is compared where the case shows none.

    Raises:
        MarsError: the case may not be given to clingo.
    """
    case = case_of(path, finding)
    stages = ("base", *stages)
    speakers = [rule for rule in rulebook.rules if case.hears(rule) and rule.stage in stages]
    program = [Fragment(case.text, str(path))]
    program += [fragment for stage in stages for fragment in rulebook.fragments(stage)]
    program += saying(SPOKEN, speakers)
    asked = rulebook.asked
    program += [Fragment(telling(at, each), "rules", each.span) for at, each in enumerate(asked)]
    control = _grounded(program)
    overflowing = tuple(wrapped(control, asked))
    if overflowing:
        raise MarsError(overflowing)
    return Outcome(path, case.expected, _answers(control, case, speakers))


def _shown(written: Iterable[Piece]) -> tuple[Signature, ...]:
    return tuple(each for piece in written if piece.sort == "shown" for each in shows(piece.text))


def _grounded(program: Sequence[Fragment]) -> clingo.Control:
    """Return a control with a program.

    Raises:
        MarsError: clingo refuses it, or an operation has no value.
    """
    said: list[tuple[clingo.MessageCode, str]] = []
    options = ["--opt-mode=optN", f"--models={_MOST_ANSWERS}", "--warn=no-atom-undefined"]
    control = clingo.Control(options, lambda code, note: said.append((code, note)), _MOST_MESSAGES)
    reason = ""
    try:
        control.add("base", [], joined(program))
        control.ground()
    except RuntimeError as error:
        reason = str(error)
    undefined = clingo.MessageCode.OperationUndefined
    wrong = [note for code, note in said if reason or code == undefined]
    if reason or wrong:
        place = point(program[0].path, 1, 1)
        whole = Diagnostic("rules-refused", "error", f"clingo refuses this: {reason}", place)
        raise MarsError(tuple(refusals(wrong, program)) or (whole,))
    return control


def _answers(
    control: clingo.Control, case: Case, speakers: Sequence[Rule]
) -> tuple[tuple[str, ...], ...]:
    found: set[tuple[str, ...]] = set()

    def keep(model: clingo.Model) -> None:
        if model.cost and not model.optimality_proven:
            return
        answer = set(case.compared(model.symbols(atoms=True), speakers))
        if case.has_costs:
            answer.add(_cost(model))
        found.add(tuple(sorted(answer)))

    control.solve(on_model=keep)
    return tuple(sorted(found))


def _cost(model: clingo.Model) -> str:
    levels = zip(model.cost, model.priority, strict=True)
    return " ".join(["%~", *(f"{cost}@{level}" for cost, level in levels if cost)])


def _one_line(text: str) -> str:
    return _CONTINUED.sub(" ", text)


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
