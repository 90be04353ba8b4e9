"""Parsed statements to model values, with the checks that need no more than one statement."""

from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from typing import TypeAlias, cast

from lark import Token, Transformer

from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.language.layout import Layout
from mars_asp.model.declarations import (
    Allocation,
    Architecture,
    Configuration,
    Control,
    Data,
    Mode,
    Mount,
    Name,
    Relationship,
    Transformation,
)
from mars_asp.model.modes import ModeProblem, parse_mode
from mars_asp.model.ranges import FREQUENCY, HOLD, PERIOD, PRIORITY, VERTEX, NumberProblem, Range
from mars_asp.model.transformation import read_transformation

#: The name of a statement's rule and what stands in it: tokens, absences, statements within.
Raw: TypeAlias = tuple[str, list["Token | Raw | None"]]
PERIODIC = "NotifyAtFrequency"


_RULES = (
    "header",
    "modules",
    "sources",
    "mount",
    "transformation",
    "control",
    "controller",
    "data",
)


class Statements(Transformer[Token, list[Raw]]):
    """Keeps each statement as its rule's name and its children."""

    def start(self, children: list[Raw]) -> list[Raw]:
        """Return the statements of a text."""
        return children


def _keep(rule: str) -> Callable[[Statements, list["Token | Raw | None"]], Raw]:
    return lambda _, children: (rule, children)


for _rule in _RULES:
    setattr(Statements, _rule, _keep(_rule))


class Builder:
    """Collects the statements of one file."""

    def __init__(self, layout: Layout) -> None:
        """Start with nothing."""
        self.layout = layout
        self.problems: list[Diagnostic] = []
        self._base = 0
        self._header: tuple[Token, Token | None] | None = None
        self._period: int | None = None
        self._header_span = layout.span(0, 0)
        self._modules: dict[str, Name] | None = None
        self._sources: list[Name] = []
        self._relationships: list[Relationship] = []

    def add(self, base: int, raw: Raw) -> None:
        """Add a statement whose offsets count from `base`."""
        self._base = base
        rule, children = raw
        getattr(self, f"_add_{rule}")(children)

    def configuration(self, complete: bool) -> Configuration:
        """Return what was added; note what is missing, where all statements could be read."""
        if self._header is None and not complete:
            return Configuration(self.layout.path, self._header_span)
        if self._header is None:
            self._base = 0
            first = len(self.layout.grammatical) - len(self.layout.grammatical.lstrip())
            at = min(first, max(0, len(self.layout.text) - 1))
            self._note(at, at, "the file has no `@configuration`", "begin it with `@configuration`")
            return Configuration(self.layout.path, self._header_span)
        kind, architecture = self._header
        if self._modules is None and complete:
            self._note_token(
                kind, f"`{kind}` without `@modules`", "name its modules: `@modules A, B`"
            )
        stated: Architecture = "hierarchical" if architecture == "hierarchical" else "flat"
        return Configuration(
            self.layout.path,
            self._header_span,
            "specification" if kind == "@specification" else "configuration",
            stated,
            architecture is not None,
            self._period,
            tuple(self._sources),
            tuple((self._modules or {}).values()),
            tuple(self._relationships),
        )

    def _add_header(self, children: list[Token | None]) -> None:
        kind, architecture, period = children
        assert kind is not None
        if self._header is not None:
            self._note_token(kind, f"`{kind}` occurs twice in the file", "keep one of the two")
            return
        self._header = (kind, architecture)
        self._period = self._whole(period, PERIOD)
        self._header_span = self._span(kind, kind)

    def _add_modules(self, children: list[Token]) -> None:
        if self._modules is not None:
            self._note_token(
                children[0], "`@modules` occurs twice in the file", "name all modules in one list"
            )
        self._modules = self._modules or {}
        for token in children:
            if token in self._modules:
                self._note_token(token, f"`{token}` is named twice in `@modules`", "name it once")
            else:
                self._modules[str(token)] = Name(str(token), self._span(token, token))

    def _add_sources(self, children: list[Token]) -> None:
        for token in children:
            self._sources.append(Name(token.strip(), self._span(token, token)))

    def _add_mount(self, children: list["Token | Raw | None"]) -> None:
        mounting, vertex, mounted, on, transformation = children
        assert isinstance(mounting, Token)
        assert isinstance(mounted, Token)
        last, value = mounted, None
        if isinstance(transformation, tuple):
            slots = [token for token in transformation[1] if isinstance(token, Token)]
            last, value = slots[-1], self._transformation(slots)
        elif isinstance(on, Token):
            last = on
        self._relationships.append(
            Mount(
                str(mounting),
                str(mounted),
                self._span(mounting, last),
                self._whole(vertex, VERTEX),
                self._whole(on, VERTEX),
                value,
            )
        )

    def _transformation(self, slots: list[Token]) -> Transformation | None:
        found = read_transformation([str(slot) for slot in slots])
        if isinstance(found, Transformation):
            text = self.layout.grammatical
            begin = text.rindex("(", 0, self._base + (slots[0].start_pos or 0))
            end = text.index(")", self._base + (slots[-1].end_pos or 0)) + 1
            return replace(found, text=text[begin:end])
        for problem in found:
            self._note_token(slots[problem.slot], problem.message, problem.help)
        return None

    def _add_control(self, children: list["Token | Raw"]) -> None:
        controlled, *controllers = children
        assert isinstance(controlled, Token)
        for order, controller in enumerate(controllers):
            assert isinstance(controller, tuple)
            name, priority, hold, allocation = controller[1]
            assert isinstance(name, Token)
            last = next(t for t in (allocation, hold, priority, name) if isinstance(t, Token))
            begin = controlled if len(controllers) == 1 else name
            rank = self._whole(priority, PRIORITY)
            if len(controllers) > 1:
                if isinstance(priority, Token):
                    self._note_token(
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
                    self._whole(hold, HOLD),
                    None if allocation is None else cast("Allocation", str(allocation)),
                    len(controllers) > 1,
                )
            )

    def _add_data(self, children: list[Token | None]) -> None:
        client, source, written, number = children
        assert client is not None
        assert source is not None
        mode = None
        if written is not None:
            read = parse_mode(str(written))
            if isinstance(read, ModeProblem):
                self._note_offset(written, read)
            else:
                mode = read
        hz = self._number(number, FREQUENCY)
        if number is not None and written is None:
            mode = Mode(PERIODIC, text=PERIODIC)
        if number is not None and mode is not None and mode.name != PERIODIC:
            self._note_token(
                number,
                f"a frequency after `{mode.text}`",
                f"a frequency belongs to `{PERIODIC}`; leave it out or require that mode",
            )
        last = next(token for token in (number, written, source) if token is not None)
        span = self._span(client, last)
        self._relationships.append(Data(str(client), str(source), span, mode, hz))

    def _number(self, token: "Token | Raw | None", wanted: Range) -> Decimal | None:
        """Return the number that a token writes; note what is wrong with it."""
        if not isinstance(token, Token):
            return None
        found = wanted.read(str(token))
        if isinstance(found, NumberProblem):
            self._note_token(token, found.message, found.help)
            return None
        return found

    def _whole(self, token: "Token | Raw | None", wanted: Range) -> int | None:
        found = self._number(token, wanted)
        return None if found is None else int(found)

    def _span(self, first: Token, last: Token) -> Span:
        begin, end = first.start_pos, last.end_pos
        assert begin is not None
        assert end is not None
        return self.layout.span(self._base + begin, self._base + end)

    def _note_token(self, token: Token, message: str, help_text: str) -> None:
        begin, end = token.start_pos or 0, token.end_pos or 0
        self._note(self._base + begin, self._base + end, message, help_text)

    def _note_offset(self, token: Token, problem: ModeProblem) -> None:
        begin = self._base + (token.start_pos or 0) + problem.offset
        self._note(begin, self._base + (token.end_pos or 0), problem.message, problem.help)

    def _note(self, begin: int, end: int, message: str, help_text: str) -> None:
        span = self.layout.span(begin, end)
        excerpt = self.layout.line(span.line)
        self.problems.append(
            Diagnostic("syntax", "error", message, span, help=help_text, excerpt=excerpt)
        )
