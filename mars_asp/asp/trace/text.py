"""Traces as text, without recursion."""

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Set
from typing import NamedTuple

import clingo

from mars_asp.asp.messages import shown
from mars_asp.asp.signature import Signature, plain
from mars_asp.asp.solve.term_ids import TermId, as_symbol
from mars_asp.asp.trace import DEPTH
from mars_asp.asp.trace.premise_order import PremiseOrder
from mars_asp.asp.trace.tree import (
    Absent,
    Derived,
    Given,
    NearMiss,
    Trace,
    Underivable,
    Unexplained,
    is_pseudo,
)
from mars_asp.asp.units import UNIT
from mars_asp.diagnostic import Span

#: The width of lines if the width of the terminal is unknown.
WIDTH = 80
#: The white space that `textwrap` replaces by spaces.
_SPACE = re.compile(r"[\t\n\x0b\x0c\r]")
#: A number before the end of a line, whose unit comes after it.
_NUMBER = re.compile(r" [(-]?[\d.]+$")
_ITS_UNIT = re.compile(f" {UNIT}")
#: The number of steps below a premise that are searched for entries which need no repetition.
NEAR = 200
#: The indentation of a level, and of the continuation of a line.
_STEP, _FURTHER = 4, 2


class Chosen(NamedTuple):
    """The remark on a chosen atom, and the reasons that exclude answers without it."""

    remark: str
    reasons: tuple[str, ...] = ()


CHEAPEST = Chosen("chosen as the cheapest")


def traces_text(
    topics: Sequence[tuple[str, Trace]],
    line_at: Callable[[Span], str],
    depth: int | None = DEPTH,
    width: int = WIDTH,
    folded: bool = True,
    places: bool = False,
    chosen: Callable[[Derived], Chosen] = lambda _: CHEAPEST,
) -> Iterator[str]:
    """Yield the lines of several traces, each under its title: messages, rules and locations.

    Steps without message are `folded` into the steps that they support; otherwise steps and facts
    are shown by their atoms. A shared step is printed once, and later occurrences refer to its
    number. Several derivations of an atom follow one another, each with its number. `places` adds
    the locations of rules. Quoted lines of files are not wrapped. `chosen` compares choices.
    """
    teller = _Teller(line_at, depth, folded, chosen)
    entries = [entry for topic in topics for entry in teller.entries(*topic)]
    numbers: dict[int, int] = {}
    for level, line, step in entries:
        if step is None:
            if isinstance(line, _Quoted):
                yield from _quoted_lines(line, level, width)
            else:
                yield from wrapped(line, level, width)
            continue
        key, text = id(step), _step_text(step, folded)
        if key in numbers:
            yield from wrapped(text, level, width, f", as in ({numbers[key]})")
        else:
            mark = ""
            if key in teller.again:
                numbers[key] = len(numbers) + 1
                mark = f"({numbers[key]}) "
            *lines, last = wrapped(f"{mark}{text}{line}", level, width, f"  [{step.rule.id}]")
            yield from lines
            yield from _placed(last, step.rule.span, level, width) if places else (last,)


class _NearStep(NamedTuple):
    """The nearest steps below a step by their `id`, their facts, and the lines of the facts."""

    steps: Set[int]
    facts: Set[str]
    lines: Set[tuple[object, ...]]


class _Quoted(NamedTuple):
    """A line of a file, and sentences of its facts that cannot be seen in the line."""

    place: str
    line: str
    notes: str


class _Entry(NamedTuple):
    """One line of output: a title or leaf, or a step with a text after its message.

    The message of a step is rendered only at printing: there are many steps.
    """

    level: int
    line: str | _Quoted
    step: Derived | NearMiss | None = None


def _step_text(step: Derived | NearMiss, folded: bool) -> str:
    if isinstance(step, NearMiss):
        return plain(step.sentence)
    return step.message or plain(_head_words(step.head) if folded else step.atom)


def _head_words(head: TermId) -> str:
    """Return words for an atom whose rule has no message: its predicate and its names."""
    symbol = as_symbol(head)
    texts = (each for each in symbol.arguments if each.type == clingo.SymbolType.String)
    names = ", ".join(f"`{each.string}`" for each in texts)
    words = symbol.name.replace("_", " ").strip()
    return f"{words}: {names}" if names else words


class _Teller:
    """Arranges traces as lines; a step that an earlier trace showed is not repeated."""

    def __init__(
        self,
        line_at: Callable[[Span], str],
        depth: int | None,
        folded: bool,
        chosen: Callable[[Derived], Chosen],
    ) -> None:
        self._read, self._chosen = line_at, chosen
        #: The lines of files by location; a line is quoted in every trace that contains its fact.
        self._wrapped_lines: dict[Span, str] = {}
        self._paths: dict[str, str] = {}
        self._depth = depth
        self._folded = folded
        #: The steps that occur more than once.
        self.again: set[int] = set()
        self._opened: set[int] = set()
        self._near: dict[int, _NearStep] = {}
        self._order = PremiseOrder()

    def entries(self, title: str, trace: Trace) -> Iterator[_Entry]:
        """Yield the lines of one trace."""
        yield _Entry(0, title)
        depth = self._depth
        stack: list[tuple[Trace | NearMiss | str | _Quoted, int]] = [(trace, 1)]
        if not isinstance(trace, Derived | Underivable):
            stack = [(leaf, 1) for leaf in self._leaves([trace])[::-1]]
        remarks: dict[int, str] = {}
        #: The leaves printed at each level since the last step above it.
        items: list[set[str | _Quoted]] = []
        while stack:
            step, level = stack.pop()
            if isinstance(step, Derived | NearMiss):
                del items[level + 1 :]
                if id(step) in self._opened:
                    self.again.add(id(step))
                    yield _Entry(level, "", step)
                    continue
                self._opened.add(id(step))
            below: Sequence[Trace | NearMiss | str]
            match step:
                case Underivable() if step.attempts:
                    stack += [(attempt, level) for attempt in reversed(step.nearest)]
                    continue
                case Derived():
                    choice = self._chosen(step) if step.chosen else None
                    remark = "" if choice is None else f", {choice.remark}"
                    if step.others:
                        remarks |= _numbered(step, self._folded)
                        stack += [(other, level) for other in reversed(step.others)]
                    if id(step) in remarks:
                        remark += f", {remarks[id(step)]}"
                    yield _Entry(level, remark, step)
                    below = self._interesting(step.premises, level == 1 or depth is None)
                    if depth is not None and level >= depth:
                        cut = any(isinstance(premise, Derived) for premise in below)
                        below = leaves_of(step) if cut else below
                    below = (*below, *(() if choice is None else choice.reasons))
                case NearMiss():
                    yield _Entry(level, "", step)
                    below = step.reasons(depth is None or level < depth)
                    below = (*below, *self._interesting(step.held, False))
                case str() | tuple():
                    items += (set[str | _Quoted]() for _ in range(len(items), level + 1))
                    if step not in items[level]:
                        items[level].add(step)
                        yield _Entry(level, step)
                    continue
                case _:
                    continue
            stack += [(premise, level + 1) for premise in reversed(self._leaves(below))]

    def _leaves(
        self, below: Sequence[Trace | NearMiss | str]
    ) -> Sequence[Trace | NearMiss | str | _Quoted]:
        """Return the entries below a step, with leaves as quoted lines, each line of a file once.

        Adjacent lines are sorted by rank, then by location.
        """
        found: list[Trace | NearMiss | str | _Quoted] = []
        quoted: dict[tuple[object, ...], list[Given]] = {}
        for each in below:
            if isinstance(each, Given) and self._folded and not _is_sentence(each):
                assert each.span is not None
                quoted.setdefault(each.span[:2], []).append(each)
                continue
            if quoted:
                found += self._quotations(quoted)
                quoted.clear()
            goes_on = isinstance(each, Underivable) and bool(each.attempts)
            if goes_on or isinstance(each, Derived | NearMiss | str):
                found.append(each)
            elif (line := self._plain(each)) is not None:
                found.append(line)
        if quoted:
            found += self._quotations(quoted)
        return found

    def _line_at(self, span: Span) -> str:
        line = self._wrapped_lines.get(span)
        if line is None:
            line = self._wrapped_lines[span] = self._read(span)
        return line

    def _location_text(self, span: Span) -> str:
        path = self._paths.get(span.path)
        if path is None:
            path = self._paths[span.path] = _shown_path(span.path)
        return f"{path}:{span.line}" if span.line else path

    def _quotations(self, quoted: Mapping[tuple[object, ...], Sequence[Given]]) -> list[_Quoted]:
        found = []
        for givens in self._order.lines(list(quoted.values())):
            span = givens[0].span
            assert span is not None
            line = self._line_at(span)
            notes = dict.fromkeys(filter(None, (_fact_sentence(each, line) for each in givens)))
            found.append(_Quoted(self._location_text(span), line, "; ".join(notes)))
        if len(found) == 1:
            return found
        width = max(len(leaf.place) for leaf in found)
        return [leaf._replace(place=leaf.place.ljust(width)) for leaf in found]

    def _plain(self, step: Trace) -> str | None:
        """Return the line of a leaf, or None for a fact that no line of a file states."""
        match step:
            case Given(atom, span, origin):
                result = step.message or atom
                if origin == "observed" and self._folded:
                    when = "" if step.seconds is None else f" at {step.seconds:g} s"
                    return f"{result}  (observed{when})"
                if span is None or (self._folded and is_pseudo(span)):
                    return result if self._folded and step.message else None
                place = self._location_text(span)
                if origin == "external":
                    return f"{result}, external  {place}"
                return (
                    f"{result}  (computed from {place})" if self._folded else f"{result}  {place}"
                )
            case Absent() if step.external is not None:
                return f"{step.message}  {self._location_text(step.external)}"
            case Absent() | Underivable():
                return step.sentence if self._folded else step.message
            case Unexplained(atom, reason):
                return f"{atom}: not traced, because {reason}"
            case _:
                return None

    def _interesting(self, premises: Sequence[Trace], absences: bool) -> Sequence[Trace]:
        """Return the premises that add information, in their order.

        Premises without a message are replaced by their own premises, and premises that also occur
        below another premise are left out. Beside a message, absences are left out.
        """
        if not self._folded:
            unique = {id(each): each for each in premises}.values()
            return [each for each in unique if absences or not isinstance(each, Absent)]
        found: list[Trace] = []
        stack = list(reversed(premises))
        seen: set[int] = set()
        while stack:
            premise = stack.pop()
            if id(premise) in seen:
                continue
            seen.add(id(premise))
            if isinstance(premise, Derived) and premise.rule.because is None and not premise.others:
                stack += reversed(premise.premises)
            elif absences or not isinstance(premise, Absent):
                found.append(premise)
        if len(found) == 1:
            return found
        found = self._order.among(found)
        steps = [premise for premise in found if isinstance(premise, Derived)]
        if not steps:
            return found
        nears: list[_NearStep] = []
        entries: set[int] = set()
        for step in steps:
            if id(step) not in entries:
                near = self._near.get(id(step))
                if near is None:
                    near = self._near[id(step)] = _near(step)
                nears.append(near)
                entries |= near.steps
        return [
            premise
            for premise in found
            if id(premise) not in entries
            and not isinstance(premise, Absent)
            and not (isinstance(premise, Given) and self._is_seen(premise, nears))
        ]

    def _is_seen(self, given: Given, nears: Sequence[_NearStep]) -> bool:
        """Whether a fact is visible anyway, below other steps or in a line quoted there."""
        if any(given.atom in near.facts for near in nears):
            return True
        if given.span is None or _is_sentence(given):
            return False
        line = given.span[:2]
        if not any(line in near.lines for near in nears):
            return False
        return _fact_sentence(given, self._line_at(given.span)) is None


def _is_sentence(given: Given) -> bool:
    """Whether a fact is printed as a sentence and not by quoting the line that states it."""
    return given.span is None or given.origin != "stated" or is_pseudo(given.span)


def _fact_sentence(given: Given, line: str) -> str | None:
    """Return the sentence of a fact; None if the quoted line shows all its values."""
    result = given.declared_sentence
    if result is None or all(value.partition(" ")[0] in line for value in result.values):
        return None
    return result.sentence


def _quoted_lines(leaf: _Quoted, level: int, width: int) -> Iterator[str]:
    """Yield a quoted line, with its notes after or below it."""
    indent = " " * _indent(level, width)
    line = f"{indent}{leaf.place}  {_SPACE.sub(' ', leaf.line)}".rstrip(" ")
    if leaf.notes and len(line) + 4 + len(leaf.notes) <= width:
        line += f"    {leaf.notes}"
        yield line
        return
    yield line
    if leaf.notes:
        further = indent + " " * _FURTHER
        yield from _wrapped_lines(leaf.notes, further, further, width)


def _placed(line: str, span: Span, level: int, width: int) -> Sequence[str]:
    """Return the last line of a rule, with its location beside it, or in a line below."""
    place = f"{_shown_path(span.path)}:{span.line}"
    if len(line) + 1 + len(place) <= width:
        return (f"{line} {place}",)
    return line, " " * (_indent(level, width) + _FURTHER) + place


def _shown_path(path: str) -> str:
    """Return a path relative to the current directory if it is inside."""
    return path.removeprefix(os.path.join(os.getcwd(), ""))  # noqa: PTH109, PTH118


def _numbered(step: Derived, folded: bool) -> dict[int, str]:
    """Return remarks such as `derivation 1 of 2` for a step and its others, by `id`.

    Derivations with the same rule and message are followed by the values in which they differ;
    where steps are folded, only by names.
    """
    every = (step, *step.others)
    alike: dict[tuple[int, str | None], list[Derived]] = {}
    for one in every:
        alike.setdefault((id(one.rule), one.message), []).append(one)
    values: dict[int, str] = {}
    for group in alike.values():
        bindings = [one.bindings for one in group]
        names = [n for n in bindings[0] if len({bound.get(n) for bound in bindings}) > 1]
        for one, bound in zip(group, bindings, strict=True):
            if folded:
                found = (bound[name] for name in names)
                lines = [f"`{v.string}`" for v in found if v.type == clingo.SymbolType.String]
            else:
                lines = [f"{name} = {shown(bound[name])}" for name in names]
            values[id(one)] = f" for {', '.join(lines)}" if lines else ""
    return {
        id(one): f"derivation {number} of {len(every)}{values[id(one)]}"
        for number, one in enumerate(every, 1)
    }


def _near(step: Derived) -> _NearStep:
    """Return the nearest steps and facts below a step, up to a limit."""
    waiting = [step]
    seen = {id(step)}
    facts: set[str] = set()
    lines: set[tuple[object, ...]] = set()
    for part in waiting:
        for premise in part.premises:
            if id(premise) in seen:
                continue
            seen.add(id(premise))
            if isinstance(premise, Derived):
                waiting.append(premise)
            elif isinstance(premise, Given):
                facts.add(premise.atom)
                if premise.span is not None:
                    lines.add(premise.span[:2])
        if len(seen) >= NEAR:
            break
    seen.remove(id(step))
    return _NearStep(seen, facts, lines)


def steps_of(step: Trace, without: Iterable[Signature] = ()) -> list[Trace]:
    """Return a step and all its reasons, the nearest first; none of some predicates' atoms."""
    found: list[Trace] = [step]
    seen = {id(step)}
    for part in found:
        if isinstance(part, Derived) and not any(map(part.rule.derives, without)):
            for premise in part.premises:
                if id(premise) not in seen:
                    seen.add(id(premise))
                    found.append(premise)
    return found


def leaves_of(trace: Trace) -> Sequence[Given]:
    """Return the facts that a trace rests on, each once, in the order of their locations."""
    found: dict[str, Given] = {}
    for part in steps_of(trace):
        if isinstance(part, Given) and part.span is not None:
            found.setdefault(part.atom, part)
    return sorted(found.values(), key=lambda leaf: (leaf.span or (), leaf.atom))


def wrapped(text: str, level: int, width: int = WIDTH, end: str = "") -> Sequence[str]:
    """Return the lines of a text, wrapped and indented by `level`.

    `end` is appended to the last word, so that it is never alone in a line.
    """
    indent = " " * _indent(level, width)
    if not text.isprintable():
        text = _SPACE.sub(" ", text.expandtabs())
    text = text.strip(" ")
    if len(indent) + len(text) + len(end) <= width:
        return (indent + text + end,) if text or end else ()
    further = indent + " " * _FURTHER
    lines = list(_wrapped_lines(text, indent, further, width))
    if not end:
        return lines
    last = lines.pop() if lines else indent
    begin, space, word = last.rpartition(" ")
    if _ITS_UNIT.match(f" {word}") and (number := _NUMBER.search(begin)):
        begin, word = begin[: number.start()], last[number.start() + 1 :]
    if len(last) + len(end) > width and space and begin.strip(" "):
        lines.append(begin.rstrip(" "))
        last = further + word
    return [*lines, last + end]


def _indent(level: int, width: int) -> int:
    """Return the number of blanks for a level, at most half of the width."""
    return _STEP * min(level, width // 2 // _STEP)


def _wrapped_lines(text: str, indent: str, further: str, width: int) -> Iterator[str]:
    """Yield the wrapped lines of a text, as `textwrap` does but much faster."""
    while text:
        end = len(text)
        if len(indent) + end > width:
            end = text.rfind(" ", 0, width - len(indent) + 1)
            if _ITS_UNIT.match(text, max(end, 0)) and (number := _NUMBER.search(text[:end])):
                end = number.start()
            if end < 0:
                # A word longer than a line is a line of its own.
                end = len(text.partition(" ")[0])
        line = indent + text[:end].rstrip(" ")
        # An atom has no spaces; it is broken after a comma.
        while len(line) > width and (comma := line.rfind(",", len(further), width) + 1):
            yield line[:comma]
            line = further + line[comma:]
        yield line
        text, indent = text[end:].lstrip(" "), further
