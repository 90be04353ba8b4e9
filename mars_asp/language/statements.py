"""Converts parsed statements to model values, and checks each statement by itself."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any, TypeAlias, cast

from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.language.layout import Layout
from mars_asp.model.attributes import (
    PROPERTY,
    TAG,
    Attribute,
    Attributed,
    read_attribute,
)
from mars_asp.model.declarations import (
    FOREVER,
    GATING,
    Allocation,
    Architecture,
    Configuration,
    Control,
    Data,
    Gating,
    Include,
    Limit,
    Lock,
    Mode,
    Mount,
    Name,
    Relationship,
    Reset,
    Strategy,
    StrategyName,
    Transformation,
)
from mars_asp.model.modes import parse_mode
from mars_asp.model.names import BARE, QUOTED, read_name
from mars_asp.model.ranges import (
    CLOSED,
    HOLD,
    PERIOD,
    PERIODS,
    PRIORITY,
    VERTEX,
    NumberRange,
    Problem,
)
from mars_asp.model.rates import every, read_frequency
from mars_asp.model.transformation import read_transformation

#: The name of a statement's rule and its children: words, absent ones as None, and statements.
#: The methods that add statements declare the children that the grammar gives each rule.
Raw: TypeAlias = tuple[str, list[Any]]
PERIODIC = "NotifyAtFrequency"
#: A path, and the prefix of the included names: after the last `as` before a valid name, else the
#: text after `as`.
_AS = (
    rf"(?P<path>.*\S)\s+as\s+(?P<name>{BARE}|{QUOTED})",
    r"(?P<path>.*?\S)\s+as\s+(?P<name>.*)",
)


class Word(str):
    """A word or number of a statement, with the offsets where it begins and ends."""

    __slots__ = ("begin", "end")

    begin: int
    end: int

    def __new__(cls, text: str, begin: int, end: int) -> "Word":
        """Return a text with its offsets."""
        word = str.__new__(cls, text)
        word.begin, word.end = begin, end
        return word


def begin_of(raw: Raw) -> int:
    """Return the offset of the first word of a statement."""
    return min(
        child.begin if isinstance(child, Word) else begin_of(child)
        for child in raw[1]
        if child is not None
    )


def _instance(child: "Word | Raw") -> tuple[Word, Word | None]:
    """Return a name in `@modules`, and the module that describes it (`A: B`), or None."""
    if isinstance(child, Word):
        return child, None
    word, described = child[1]
    return word, described


class Builder:
    """Collects the statements of one file."""

    def __init__(self, layout: Layout) -> None:
        """Begin without statements."""
        self.layout = layout
        self.problems: list[Diagnostic] = []
        self._base = 0
        self._header: tuple[Word, Word | None] | None = None
        self._period: int | None = None
        self._header_span = layout.span(0, 0)
        self._modules: dict[str, Name] | None = None
        self._includes: list[Include] = []
        self._sources: list[Name] = []
        self._relationships: list[Relationship] = []
        self._attributed: list[Attributed] = []

    def add(self, base: int, raw: Raw) -> None:
        """Add a statement whose offsets are relative to `base`."""
        self._base = base
        rule, children = raw
        _ADD[rule](self, tuple(children))

    def configuration(self, complete: bool) -> Configuration:
        """Return the configuration; if `complete`, add errors for missing statements."""
        if self._header is None and not complete:
            return Configuration(self.layout.path, self._header_span)
        if self._header is None:
            self._base = 0
            first = len(self.layout.grammatical) - len(self.layout.grammatical.lstrip())
            at = min(first, max(0, len(self.layout.text) - 1))
            self._note_problem(
                at, at, "the file has no `@configuration`", "begin it with `@configuration`"
            )
            return Configuration(self.layout.path, self._header_span)
        kind, architecture = self._header
        if self._modules is None and not self._includes and complete:
            self._note_word(
                kind, f"`{kind}` without `@modules`", "name its modules: `@modules A, B`"
            )
        declared: Architecture = "hierarchical" if architecture == "hierarchical" else "flat"
        return Configuration(
            self.layout.path,
            self._header_span,
            "specification" if kind == "@specification" else "configuration",
            declared,
            architecture is not None,
            self._period,
            tuple(self._sources),
            tuple((self._modules or {}).values()),
            tuple(self._relationships),
            includes=tuple(self._includes),
            attributed=tuple(self._attributed),
        )

    def _add_header(self, children: tuple[Word, Word | None, Word | None]) -> None:
        kind, architecture, period = children
        if self._header is not None:
            first, _ = self._header
            twice = f"`{kind}` occurs twice in the file"
            message = twice if kind == first else f"`{kind}` in a file that has `{first}`"
            self._note_word(kind, message, "keep one of the two")
            return
        self._header = (kind, architecture)
        self._period = self._read_integer(period, PERIOD)
        self._header_span = self._span(kind, kind)

    def _add_modules(self, children: Sequence[Word | Raw]) -> None:
        named = [_instance(child) for child in children]
        if self._modules is not None:
            self._note_word(
                named[0][0], "`@modules` occurs twice in the file", "name all modules in one list"
            )
        self._modules = self._modules or {}
        for word, description in named:
            if word in self._modules:
                self._note_word(word, f"`{word}` is named twice in `@modules`", "name it once")
            else:
                span = self._span(word, description or word)
                described = None if description is None else str(description)
                self._modules[str(word)] = Name(str(word), span, described)

    def _add_sources(self, children: Sequence[Word]) -> None:
        self._sources += (Name(word.strip(), self._span(word, word)) for word in children)

    def _add_include(self, children: tuple[Word]) -> None:
        (word,) = children
        path, name = word.strip(), None
        match = next(filter(None, (re.fullmatch(form, path) for form in _AS)), None)
        if match is not None:
            name = read_name(match["name"])
            path = match["path"]
            if name is None:
                begin, end = word.begin + match.start("name"), word.begin + match.end("name")
                message = f"expected a name after `as`, found `{match['name']}`"
                help_text = "write letters, digits, `_`, `-` and `/`, or put the name in quotes"
                self._note_problem(self._base + begin, self._base + end, message, help_text)
        self._includes.append(Include(path, name, self._span(word, word)))

    def _add_attribute(self, word: str, children: Sequence[Word]) -> None:
        module, first, last = children[0], children[1], children[-1]
        text = self.layout.grammatical[self._base + first.begin : self._base + last.end]
        read = read_attribute(word, text)
        if isinstance(read, Problem):
            begin = self._base + first.begin
            self._note_problem(begin + read.begin, begin + read.end, read.message, read.help)
        else:
            name, value = read
            attribute = Attribute(name, self._span(module, last), value)
            self._attributed.append(Attributed(str(module), attribute))

    def _add_mount(self, children: tuple[Word, Word | None, Word, Word | None, Raw | None]) -> None:
        mounting, vertex, mounted, on, transformation = children
        last, value = on or mounted, None
        if transformation is not None:
            slots = [word for word in transformation[1] if word is not None]
            last, value = slots[-1], self._transformation(slots)
        self._relationships.append(
            Mount(
                str(mounting),
                str(mounted),
                self._span(mounting, last),
                self._read_integer(vertex, VERTEX),
                self._read_integer(on, VERTEX),
                value,
            )
        )

    def _transformation(self, slots: list[Word]) -> Transformation | None:
        found = read_transformation([str(slot) for slot in slots])
        if isinstance(found, Transformation):
            text = self.layout.grammatical
            begin = text.rindex("(", 0, self._base + slots[0].begin)
            end = text.index(")", self._base + slots[-1].end) + 1
            return replace(found, text=text[begin:end])
        for problem in found:
            self._note_word(slots[problem.begin], problem.message, problem.help)
        return None

    def _add_control(self, children: tuple[Word, *tuple[Raw, ...]]) -> None:
        controlled, *controllers = children
        for order, (_, controller) in enumerate(controllers):
            name, priority, hold, allocation = controller
            last = allocation or hold or priority or name
            begin = controlled if len(controllers) == 1 else name
            rank = self._read_integer(priority, PRIORITY)
            if len(controllers) > 1:
                if priority is not None:
                    self._note_word(
                        priority,
                        "a priority in a list of controllers",
                        "the list already ranks them from 0; write one line for each controller",
                    )
                rank = order
            self._relationships.append(
                Control(
                    str(controlled),
                    str(name),
                    self._span(begin, last),
                    rank,
                    FOREVER if hold == FOREVER else self._read_integer(hold, HOLD),
                    None if allocation is None else cast("Allocation", str(allocation)),
                    len(controllers) > 1,
                )
            )

    def _add_data(
        self,
        children: tuple[Word, Word | None, Word, Word | None, Word | None, Word | Raw | None],
    ) -> None:
        client, client_port, source, source_port, written, number = children
        ports = self._read_port(client, client_port), self._read_port(source, source_port)
        mode = None
        if written == "every":
            help_text = "write a period with its unit, such as `every 17 ms` or `every 3 s`"
            self._note_word(written, "a period without a unit", help_text)
        elif written is not None:
            read = parse_mode(str(written))
            if isinstance(read, Problem):
                begin, end = written.begin + read.begin, written.end
                self._note_problem(self._base + begin, self._base + end, read.message, read.help)
            else:
                mode = read
        hz, declared = self._read_rate(number)
        if declared is not None and written is None:
            mode = Mode(PERIODIC, text=PERIODIC)
        if declared is not None and mode is not None and mode.name != PERIODIC:
            self._note_word(
                declared,
                f"a frequency after `{mode.text}`",
                f"a frequency belongs to `{PERIODIC}`; leave it out or require that mode",
            )
        last = number[1][-1] if isinstance(number, tuple) else number
        span = self._span(client, last or written or source_port or source)
        self._relationships.append(Data(str(client), str(source), span, mode, hz, *ports))

    def _add_gating(
        self, children: tuple[Word, Word | None, Word, Word, Word | None, Word]
    ) -> None:
        gated, port, word, trigger, trigger_port, number = children
        ms = self._read_integer(number, CLOSED)
        sign = next(each for each, text in GATING.items() if text == word)
        ports = (self._read_port(gated, port), self._read_port(trigger, trigger_port))
        span = self._span(gated, number)
        self._relationships.append(Gating(str(gated), str(trigger), span, sign, ms or 1, *ports))

    def _add_reset(self, children: tuple[Word, Word, Word | None]) -> None:
        module, source, port = children
        span = self._span(module, port or source)
        self._relationships.append(
            Reset(str(module), str(source), span, self._read_port(source, port))
        )

    def _add_lock(self, children: tuple[Word, Word, Word | None, Word | None, Word | None]) -> None:
        controlled, source, port, priority, hold = children
        self._relationships.append(
            Lock(
                str(controlled),
                str(source),
                self._span(controlled, hold or priority or port or source),
                self._read_integer(priority, PRIORITY),
                self._read_integer(hold, HOLD),
                self._read_port(source, port),
            )
        )

    def _add_limit(self, children: tuple[Word, Word, Word | None, Word | None]) -> None:
        controlled, source, port, hold = children
        self._relationships.append(
            Limit(
                str(controlled),
                str(source),
                self._span(controlled, hold or port or source),
                self._read_integer(hold, HOLD),
                self._read_port(source, port),
            )
        )

    def _add_strategy(self, children: tuple[Word, Word, Word | None]) -> None:
        controlled, strategy, period = children
        if period is not None and strategy not in ("flat", "weighted"):
            help_text = "only `flat` and `weighted` take means over a period; leave it out"
            at = self.layout.grammatical.index("period", self._base + strategy.end)
            message = f"`{strategy}` takes no period"
            self._note_problem(at, self._base + period.end, message, help_text)
        self._relationships.append(
            Strategy(
                str(controlled),
                self._span(controlled, period or strategy),
                cast("StrategyName", str(strategy)),
                self._read_integer(period, PERIOD),
            )
        )

    def _read_port(self, name: Word, port: Word | None) -> str | None:
        """Return the text of a port, if there is one, and add an error for a blank before it."""
        if port is None:
            return None
        begin, end = self._base + name.end, self._base + port.end
        if self.layout.grammatical[begin] != ".":
            message = f"a blank before `.{port}`"
            self._note_problem(begin, end, message, "write `MODULE.PORT` without a blank")
        return str(port)

    def _read_rate(self, child: Word | Raw | None) -> tuple[Fraction | None, Word | None]:
        """Return a stated rate and the word of its number; None for a missing or wrong rate."""
        if isinstance(child, tuple):
            number, unit = child[1]
            period = self._read_integer(number, PERIODS[str(unit)])
            return (None if period is None else every(period, str(unit))), number
        if child is None:
            return None, None
        found = read_frequency(str(child))
        if isinstance(found, Problem):
            self._note_word(child, found.message, found.help)
            return None, child
        return found, child

    def _read_integer(self, word: Word | None, wanted: NumberRange) -> int | None:
        """Return the number in a word; None without a word, and with an error if invalid."""
        if word is None:
            return None
        found = wanted.read(str(word))
        if isinstance(found, Problem):
            self._note_word(word, found.message, found.help)
            return None
        return int(found)

    def _span(self, first: Word, last: Word) -> Span:
        return self.layout.span(self._base + first.begin, self._base + last.end)

    def _note_word(self, word: Word, message: str, help_text: str) -> None:
        begin, end = word.begin, word.end
        self._note_problem(self._base + begin, self._base + end, message, help_text)

    def _note_problem(self, begin: int, end: int, message: str, help_text: str) -> None:
        span = self.layout.span(begin, end)
        excerpt = self.layout.line(span.line).rstrip(" ")
        self.problems.append(
            Diagnostic("syntax", "error", message, span, help=help_text, excerpt=excerpt)
        )


#: By the rules of the grammar, what adds a statement.
_ADD: Mapping[str, Callable[[Builder, Any], None]] = {
    "header": Builder._add_header,
    "modules": Builder._add_modules,
    "sources": Builder._add_sources,
    "include": Builder._add_include,
    "mount": Builder._add_mount,
    "control": Builder._add_control,
    "data": Builder._add_data,
    "gating": Builder._add_gating,
    "reset": Builder._add_reset,
    "lock": Builder._add_lock,
    "limit": Builder._add_limit,
    "strategy": Builder._add_strategy,
    "tag": lambda builder, children: builder._add_attribute(TAG, children),
    "property": lambda builder, children: builder._add_attribute(PROPERTY, children),
}
