"""The public interface of the engine: programs, answers, and explanations of atoms.

>>> program = Program.from_text("edge(a,b). reach(a). reach(Y) :- reach(X), edge(X,Y).")
>>> print(program.solve().why("reach(b)").text())
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, TypeAlias

import clingo

from mars_asp.asp.messages import predicate_of, rendered_messages, saying
from mars_asp.asp.rules.checks import refused_rules
from mars_asp.asp.rules.externals import External, externals_of
from mars_asp.asp.rules.metadata import repeated_ids
from mars_asp.asp.rules.program_files import BASE_PART, ProgramReader, of_part, parts_of
from mars_asp.asp.rules.read import NameSpace, RuleFile, with_unique_ids
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import without_rules
from mars_asp.asp.rules.symbols import symbol_in
from mars_asp.asp.solve.atoms import Fact
from mars_asp.asp.solve.grounding import Grounding, Lack, Resolution
from mars_asp.asp.solve.optimum import TooCostlyError, UnsatisfiableError
from mars_asp.asp.solve.term_ids import as_symbol, text
from mars_asp.asp.trace.absence import explain_absence
from mars_asp.asp.trace.conflicts import (
    Conflict,
    Conflicts,
    ConflictSearch,
    conflict_json,
    conflict_lines,
    instance_line,
)
from mars_asp.asp.trace.document import trace_json
from mars_asp.asp.trace.explainer import Explainer
from mars_asp.asp.trace.given import GivenFacts
from mars_asp.asp.trace.patterns import fits, pattern_in
from mars_asp.asp.trace.text import WIDTH, Chosen, leaves_of, traces_text
from mars_asp.asp.trace.tree import Derived, Given, Trace, atom_of
from mars_asp.diagnostic import Diagnostic, MarsError, Span, whole_file

#: The stage of a program without folders of stages.
_STAGE = "base"
#: The predicate that records the statement of each external atom.
_EXTERNAL = "_external_base"
_MOST_TRIED = 100
_MOST_NAMED = 10
#: Values of constants by their names, and of externals by their atoms.
Constants: TypeAlias = Mapping[str, int | str]
Externals: TypeAlias = Mapping[str, bool | None]


class NotDerived(MarsError):  # noqa: N818 -- the name describes an atom
    """An atom to explain does not hold in the answer, or the text is not an atom."""


class Unsatisfiable(MarsError):  # noqa: N818
    """A program has no answer."""


@dataclass(frozen=True)
class Program:
    """Rules and facts of any logic program, checked; it can be solved repeatedly."""

    files: tuple[RuleFile, ...]
    #: The whole program, if this one has only some of its parts.
    source: "Program | None" = None

    @classmethod
    def from_files(cls, *paths: str | Path) -> "Program":
        """Read files of rules.

        Raises:
            MarsError: all errors in them, with their locations.
        """
        problems: list[Diagnostic] = []
        reader = ProgramReader(_STAGE, problems)
        for path in paths:
            reader.read_path(path)
        return cls._checked(reader.files, problems)

    @classmethod
    def from_text(cls, text: str, path: str = "program.lp") -> "Program":
        """Read rules; `path` is the file name in locations.

        Raises:
            MarsError: all errors in them, with their locations.
        """
        problems: list[Diagnostic] = []
        reader = ProgramReader(_STAGE, problems)
        reader.read_text(text, path)
        return cls._checked(reader.files, problems)

    @classmethod
    def _checked(cls, found_files: Sequence[RuleFile], problems: Sequence[Diagnostic]) -> "Program":
        """Return the program of some files, after checks; `problems` are earlier errors.

        Raises:
            MarsError: there are problems, or two rules have one id.
        """
        (space,) = with_unique_ids([NameSpace("", tuple(found_files))])
        files = space.files
        found = [*problems, *repeated_ids(rule for file in files for rule in file.rules)]
        # clingo ends the process at some numbers that do not fit.
        if not found:
            found = [each for file in files for each in refused_rules(file.text, file.shown)]
        if found:
            raise MarsError(found)
        return cls(files)

    @cached_property
    def rulebook(self) -> Rulebook:
        """Return the rules and their texts."""
        return Rulebook(
            tuple(rule for file in self.files for rule in file.rules),
            tuple((file.stage, file.text) for file in self.files),
            paths=tuple(file.shown for file in self.files),
            documented=tuple(file.documented for file in self.files),
        )

    @cached_property
    def _fact_rules(self) -> tuple[Rule, ...]:
        """Return the rules that state facts without a message."""
        return tuple(
            rule
            for rule in self.rulebook.rules
            if rule.because is None
            and not rule.is_choice
            and all(s.forces and not s.literals[1:] and not s.written[1:] for s in rule.statements)
        )

    @cached_property
    def explained(self) -> Rulebook:
        """Return the rules that explain atoms: all except facts without a message."""
        declared = {id(rule) for rule in self._fact_rules}
        rules = tuple(rule for rule in self.rulebook.rules if id(rule) not in declared)
        return replace(self.rulebook, rules=rules)

    @cached_property
    def externals(self) -> tuple[External, ...]:
        """Return the `#external` statements of all files, in their order."""
        return tuple(each for file in self.files for each in externals_of(file.written, file.shown))

    def solve(
        self,
        constants: Constants | None = None,
        deadline: float | None = None,
        count: bool = False,
        externals: Externals | None = None,
        parts: Sequence[str] = ("base",),
    ) -> "Answer":
        """Return an optimal answer, or any answer if nothing is minimised.

        Independent components are solved one by one. `constants` replace the values of `#const`;
        `deadline` is a time of `time.monotonic`, after which an answer is no longer improved. With
        `count` the optimal answers are counted. `externals` are the truth values of external atoms,
        None to leave one open; `parts` are the grounded parts of the program, such as `step(1)`.

        Raises:
            MarsError: clingo refuses the program, or there is no such part or external.
            Unsatisfiable: there is no answer.
        """
        program = self.with_parts(parts)
        defined, given = _definitions(constants or {}), _externals(externals or {}, self._file_path)
        grounding = Grounding((), options=defined)
        declared = program._fact_rules
        marked = (e.fragment(_EXTERNAL, at) for at, e in enumerate(program.externals))
        fragments = [*program.rulebook.fragments(_STAGE), *saying(_STAGE, declared), *marked]
        try:
            resolution = grounding.choose(fragments, deadline, count, given)
        except UnsatisfiableError:
            resolution = None
        except TooCostlyError as error:
            place = whole_file(self._file_path)
            advice = "clingo adds up costs in 32 bits: make the weights smaller"
            found = Diagnostic("costs", "error", str(error), place, help=advice)
            raise MarsError((found,)) from None
        wrong = [each for each in given if each not in grounding.externals]
        if wrong:
            place = whole_file(self._file_path)
            names = [f"`{each}`" for each in sorted(grounding.externals)][:_MOST_NAMED]
            advice = f"external are {', '.join(names)}" if names else "declare it: `#external`"
            texts = (f"`{each}` is not an external of the program" for each in wrong)
            raise MarsError(Diagnostic("external", "error", t, place, help=advice) for t in texts)
        if resolution is None or not resolution.answer.exists:
            place = whole_file(self._file_path)
            message = "the program has no answer"
            advice = "`why_unsatisfiable` names rules that exclude every answer together"
            found = Diagnostic("unsatisfiable", "error", message, place, help=advice)
            raise Unsatisfiable((found,))
        spans: dict[str, Span] = {}
        for each in rendered_messages(grounding.control, _STAGE, declared):
            spans.setdefault(text(each.head), each.rule.span)
        return Answer(program, defined, grounding, resolution, spans)

    def why_unsatisfiable(
        self,
        constants: Constants | None = None,
        limit: int = 10,
        externals: Externals | None = None,
        parts: Sequence[str] = ("base",),
    ) -> Conflicts:
        """Return the minimal sets of ground rules and facts that together have no answer.

        There are none if the program has an answer, and at most `limit` are returned.

        Raises:
            MarsError: clingo refuses the program, or there is no such part or external.
        """
        given = _externals(externals or {}, self._file_path)
        search = self.with_parts(parts).conflicts(_definitions(constants or {}), given)
        return search.minimal(limit)

    def conflicts(
        self, defined: Sequence[str], externals: Mapping[clingo.Symbol, bool | None]
    ) -> ConflictSearch:
        """Return the search for conflicts with options of clingo and values of externals."""
        rest = "\n".join(without_rules(file.text) for file in self.files)
        return ConflictSearch(self.rulebook.rules, rest, self.externals, externals, defined)

    @contextmanager
    def session(self) -> Iterator["Session"]:
        """Return a context whose session memoizes the answers to questions."""
        yield Session(self)

    def with_parts(self, parts: Sequence[str]) -> "Program":
        """Return the program of the named `#program` parts alone, such as `base` and `step(1)`.

        Raises:
            MarsError: there is no such part.
        """
        known = parts_of(self.files)
        signatures = {(each.name, len(each.parameters)) for each in known}
        found = [(part, symbol_in(part)) for part in dict.fromkeys(parts)]
        for part, symbol in found:
            is_term = symbol is not None and symbol.type == clingo.SymbolType.Function
            if (
                symbol is None
                or not is_term
                or (symbol.name, len(symbol.arguments)) not in signatures
            ):
                names = " and ".join(f"`{each}`" for each in known)
                message, place = (
                    f"`{part}` is not a part of the program",
                    whole_file(self._file_path),
                )
                advice = f"it has {names}; give values for parameters"
                raise MarsError((Diagnostic("part", "error", message, place, help=advice),))
        if known == [BASE_PART] and found:
            return self
        files = tuple(
            of_part(file, symbol, not number)
            for number, (_, symbol) in enumerate(found)
            for file in self.files
            if symbol is not None
        )
        return replace(self, files=files, source=self)

    @property
    def _file_path(self) -> str:
        return self.files[0].shown if self.files else "program"

    def line_at(self, span: Span) -> str:
        """Return the text of a line, stripped, by a location in it."""
        files = (self.source or self).files
        text = next((file.text for file in files if file.shown == span.path), "")
        return "".join(text.split("\n")[span.line - 1 : span.line]).strip()


@dataclass(frozen=True)
class Session:
    """Answers questions to a program; answers are memoized."""

    program: Program
    _answers: dict[tuple[object, ...], "Answer"] = field(default_factory=dict)

    def solve(
        self,
        constants: Constants | None = None,
        externals: Externals | None = None,
        parts: Sequence[str] = ("base",),
    ) -> "Answer":
        """Return the result of `Program.solve` with these arguments, memoized."""
        values = (tuple(sorted((each or {}).items())) for each in (constants, externals))
        key = (*values, tuple(parts))
        if key not in self._answers:
            self._answers[key] = self.program.solve(constants, externals=externals, parts=parts)
        return self._answers[key]

    def why(self, atom: str, every: bool = False) -> "Reason":
        """Return the reason why an atom holds in the answer, as `Answer.why` does."""
        return self.solve().why(atom, every)

    def why_not(self, atom: str, depth: int = 8) -> "Reason":
        """Return the reason why an atom does not hold in the answer, as `Answer.why_not` does."""
        return self.solve().why_not(atom, depth)


class Choice(NamedTuple):
    """The comparison of a chosen atom with the answers that lack it.

    If no answer lacks it, `reasons` are instances of rules that together exclude such answers.
    """

    lack: Lack
    reasons: Conflict = ()


_REMARKS: Mapping[Lack, str] = {
    "never": "no answer lacks it",
    "free": "chosen freely: another answer lacks it",
    "equal": "chosen, though an answer without it costs as little",
    "dearer": "chosen as the cheapest",
}


def remark_on(choice: Choice) -> Chosen:
    """Return the sentence on a choice, and the reasons if no answer lacks the atom."""
    reasons = ("without it, these conflict:", *map(instance_line, choice.reasons))
    return Chosen(_REMARKS[choice.lack], reasons if choice.reasons else ())


def _choice_json(choice: Choice) -> Mapping[str, object]:
    return {"choice": choice.lack, "reasons": conflict_json(choice.reasons)}


@dataclass(frozen=True)
class Reason:
    """The reason why an atom holds or not: a trace, and the means to show it.

    For an absence, `extra` is the additional cost of the cheapest answer with the atom, by level,
    and `against` are instances of rules that together exclude every answer with it. Both are None
    if no rule offers the atom. `chosen` compares a step that a choice gives with the answers that
    lack its atom.
    """

    title: str
    trace: Trace
    line_at: Callable[[Span], str]
    extra: Mapping[int, int] | None = None
    against: Conflict | None = None
    chosen: Callable[[Derived], "Choice"] = lambda _: Choice("dearer")

    def text(self, width: int = WIDTH, depth: int | None = None) -> str:
        """Return the trace as text: messages and locations of rules, and facts with locations.

        A rule without message is shown by its atom. Below `depth`, only facts follow.
        """
        topics = [(self.title, self.trace)]
        lines = list(
            traces_text(
                topics,
                self.line_at,
                depth,
                width,
                folded=False,
                places=True,
                chosen=lambda step: remark_on(self.chosen(step)),
            )
        )
        if self.extra is not None:
            lines.append(f"  with it, an answer {_extra_cost_text(self.extra)}")
        if self.against is not None:
            lines += ["  no answer has it:", *conflict_lines(self.against, 1, width)]
        return "\n".join(lines)

    def json(self, depth: int | None = None) -> dict[str, object]:
        """Return the trace as values for JSON."""
        found = trace_json(self.trace, depth, lambda step: _choice_json(self.chosen(step)))
        if self.extra is not None:
            found["extra_cost"] = {str(level): cost for level, cost in self.extra.items()}
        if self.against is not None:
            found["against"] = conflict_json(self.against)
        return found

    def leaves(self) -> Sequence[Given]:
        """Return the facts that the trace rests on, each once, in the order of their locations."""
        return leaves_of(self.trace)

    @property
    def height(self) -> int:
        """Return the length of the longest path from the atom to a fact, in steps."""
        heights: dict[int, int] = {}
        stack: list[Trace] = [self.trace]
        while stack:
            step = stack[-1]
            below = step.premises if isinstance(step, Derived) else ()
            new = [each for each in below if id(each) not in heights]
            if new:
                stack += new
                continue
            stack.pop()
            heights[id(step)] = 1 + max((heights[id(each)] for each in below), default=-1)
        return heights[id(self.trace)]


@dataclass(frozen=True)
class Answer:
    """An optimal answer of a program, for any number of questions."""

    program: Program
    constants: Sequence[str]
    grounding: Grounding
    resolution: Resolution
    spans: Mapping[str, Span]

    def __post_init__(self) -> None:
        """Read the true atoms, as explanations detach the solver."""
        _ = self.atoms

    @property
    def cost(self) -> Mapping[int, int]:
        """Return the costs that rules minimise, as sums by priority; {} without such rules."""
        return self.resolution.cost

    @property
    def proven(self) -> bool:
        """Whether no answer costs less."""
        return self.resolution.proven

    @property
    def count(self) -> int | None:
        """Return the number of optimal answers, or None if `solve` did not count them."""
        return self.resolution.count

    @cached_property
    def atoms(self) -> frozenset[clingo.Symbol]:
        """Return the true atoms, facts included, without the auxiliary ones of this package."""
        control, own = self.grounding.control, predicate_of(_STAGE)
        facts = (atom.symbol for atom in control.symbolic_atoms if atom.is_fact)
        chosen = map(as_symbol, self.resolution.answer.taken)
        return frozenset(a for a in (*facts, *chosen) if a.name not in (own, _EXTERNAL))

    def holds(self, atom: str) -> bool:
        """Whether an atom in clingo's syntax is in the answer."""
        return symbol_in(atom) in self.atoms

    def why(self, atom: str, every: bool = False) -> Reason:
        """Return the reason why an atom holds; with `every`, with all derivations of each step.

        Raises:
            NotDerived: the atom does not hold.
        """
        symbol = symbol_in(atom)
        if symbol not in self.atoms or symbol is None:
            message = f"`{atom}` does not hold" if symbol else f"`{atom}` is not an atom"
            found = Diagnostic("atom", "error", message, whole_file(self._file_path))
            raise NotDerived((found,))
        trace = self._explainer.why([symbol], every)[symbol]
        return Reason(str(symbol), trace, self._line_at, chosen=self._choice)

    def why_not(self, atom: str, depth: int = 8) -> Reason:
        """Return the reason why an atom does not hold; variables and `_` are any value.

        Raises:
            NotDerived: the atom holds, or the text is not an atom.
        """
        pattern = pattern_in(atom)
        matching = [] if pattern is None else [each for each in self.atoms if fits(pattern, each)]
        if pattern is None or matching:
            message = f"`{atom}` is not an atom" if pattern is None else f"`{min(matching)}` holds"
            found = Diagnostic("atom", "error", message, whole_file(self._file_path))
            raise NotDerived((found,))
        trace = explain_absence(self._explainer, pattern, depth)
        extra, against = self._forced(pattern)
        return Reason(f"no {atom}", trace, self._line_at, extra, against, self._choice)

    def _forced(self, pattern: clingo.Symbol) -> tuple[Mapping[int, int] | None, Conflict | None]:
        """Return the additional cost of the cheapest answer with an atom, or a conflict."""
        found = self.grounding.symbols(pattern.name, len(pattern.arguments))
        best: Mapping[int, int] | None = None
        offered = [each for each in sorted(found) if fits(pattern, each)]
        for each in offered[:_MOST_TRIED]:
            extra = self.grounding.extra_cost(each)
            if extra is not None:
                extra = {level: extra.get(level, 0) for level in sorted(self.cost, reverse=True)}
                if best is None or [*extra.values()] < [*best.values()]:
                    best = extra
        if best is not None or not offered:
            return best, None
        return None, next(iter(self._conflicts.minimal(1, offered)), None)

    @cached_property
    def _conflicts(self) -> ConflictSearch:
        return self.program.conflicts(self.constants, self.grounding.externals)

    def _choice(self, step: Derived) -> Choice:
        symbol = as_symbol(step.head)
        if symbol not in self._choices:
            lack = self.grounding.lacks(symbol)
            reasons: Conflict = ()
            if lack == "never":
                reasons = next(iter(self._conflicts.minimal(1, [symbol], holds=False)), ())
            self._choices[symbol] = Choice(lack, reasons)
        return self._choices[symbol]

    @cached_property
    def _choices(self) -> dict[clingo.Symbol, Choice]:
        return {}

    @cached_property
    def _explainer(self) -> Explainer:
        external = self._externals
        spans = {**self.spans, **{each: at for each, at in external.items() if self.holds(each)}}
        symbols = ((clingo.parse_term(text), span) for text, span in spans.items())
        facts = [Fact(atom_of(symbol), span) for symbol, span in symbols]
        control, opened = self.grounding.control, self.resolution.answer.true
        given = GivenFacts(facts, self.program.explained.declarations, external)
        return Explainer(self.program.explained, control, given, opened)

    @property
    def _externals(self) -> dict[str, Span]:
        """Return the locations of external atoms, by their texts."""
        found = self.grounding.control.symbolic_atoms.by_signature(_EXTERNAL, 2)
        pairs = (atom.symbol.arguments for atom in found if self.grounding.externals)
        return {
            str(symbol): self.program.externals[number.number].span
            for number, symbol in pairs
            if symbol in self.grounding.externals
        }

    @property
    def _file_path(self) -> str:
        return self.program._file_path

    def _line_at(self, span: Span) -> str:
        return self.program.line_at(span)


def _definitions(constants: Constants) -> tuple[str, ...]:
    """Return constants as options of clingo.

    Raises:
        MarsError: a value cannot be read as a term.
    """
    for name, value in constants.items():
        if symbol_in(str(value)) is None:
            message = f"`{value}` is not a value for the constant `{name}`"
            advice = "give a number, a constant or a string in quotes"
            place = whole_file("program")
            raise MarsError((Diagnostic("constant", "error", message, place, help=advice),))
    return tuple(f"-c{name}={value}" for name, value in constants.items())


def _extra_cost_text(extra: Mapping[int, int]) -> str:
    """Return the text of an additional cost by level, such as `would cost 1 more at level 2`."""
    if not extra:
        return "is as good: nothing is minimised"
    if not any(extra.values()):
        return "would cost as much"
    *others, last = (f"{difference(cost)} at level {level}" for level, cost in extra.items())
    return f"would cost {' and '.join(filter(None, (', '.join(others), last)))}"


def difference(cost: int) -> str:
    """Return a difference of costs in words: `2 more`, `1 less` or `as much`."""
    return f"{abs(cost)} {'more' if cost > 0 else 'less'}" if cost else "as much"


def _externals(values: Externals, path: str) -> dict[clingo.Symbol, bool | None]:
    """Return the values of externals by their symbols.

    Raises:
        MarsError: a name is not an atom.
    """
    found = {symbol_in(atom): value for atom, value in values.items()}
    if None in found:
        wrong = next(atom for atom in values if symbol_in(atom) is None)
        place, advice = whole_file(path), "write it as in an answer, such as `open(door)`"
        message = f"`{wrong}` is not an atom"
        raise MarsError((Diagnostic("external", "error", message, place, help=advice),))
    return {atom: value for atom, value in found.items() if atom is not None}
