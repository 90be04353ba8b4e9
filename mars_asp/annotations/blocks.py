"""Module blocks in a `.mars` file: annotations without comment marks, C++ declarations."""

import difflib
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from decimal import Decimal

from mars_asp.diagnostic import Diagnostic
from mars_asp.model import (
    DELIVERY_MODES,
    GRASP,
    MOTION_FUNCTIONS,
    SERVICE_KINDS,
    Function,
    Mode,
    Module,
    Service,
)
from mars_asp.modes import ModeProblem, parse_mode, parse_number
from mars_asp.source import Span, point

WORDS = (
    "module_start",
    "module_name",
    "module_end",
    *SERVICE_KINDS,
    *MOTION_FUNCTIONS,
    GRASP,
    "Vertex",
    "Output",
    "Input",
    "Signature",
)
_DIRECTIVE = re.compile(r"\s*@([A-Za-z_]\w*)(.*)")
_COMMENT = re.compile(r"//[^\n]*|#[^\n]*|\s--\s.*")
_FUNCTION = re.compile(
    r"(?P<type>[A-Za-z_][\w:<>,\s*&\[\]]*?[\s*&>])(?P<name>[A-Za-z_]\w*)\s*\((?P<inside>[^()]*)\)"
)
_FALLS_AWAY = re.compile(
    r"\b(?:const|volatile|typename|struct|class|enum|static|inline|virtual)\b|[&*]"
)
_PRIMITIVE = frozenset({"void", ""})


@dataclass(frozen=True, slots=True)
class Blocks:
    """The modules of the blocks, what is wrong, and the (first, last) lines of each block."""

    modules: tuple[Module, ...]
    diagnostics: tuple[Diagnostic, ...]
    lines: tuple[tuple[int, int], ...]


def read_blocks(path: str, text: str) -> Blocks:
    """Read every module block of a `.mars` text."""
    reader = _Reader(path)
    for number, line in enumerate(text.split("\n"), 1):
        reader.read(number, line)
    reader.close(text.count("\n") + 1)
    return Blocks(tuple(reader.modules), tuple(reader.problems), tuple(reader.lines))


class _Reader:
    def __init__(self, path: str) -> None:
        self.path = path
        self.modules: list[Module] = []
        self.problems: list[Diagnostic] = []
        self.lines: list[tuple[int, int]] = []
        self.module: Module | None = None
        self.first = 0
        self.pending: Service | None = None

    def note(self, line: int, column: int, message: str, help_text: str) -> None:
        self.problems.append(
            Diagnostic(
                "annotation", "error", message, point(self.path, line, column), help=help_text
            )
        )

    def read(self, number: int, line: str) -> None:
        stripped = _COMMENT.sub("", line)
        match = _DIRECTIVE.match(stripped)
        if match and match[1] == "module_start":
            if self.module is not None:
                self.note(
                    number,
                    match.start(1),
                    "`@module_start` inside a module",
                    "write `@module_end` before it",
                )
                self.close(number - 1)
            self.first = number
            self.module = Module("", self.span(number, line))
        elif self.module is None:
            return
        elif match is None:
            self.declaration(number, stripped)
        elif match[1] == "module_end":
            self.close(number, ended=True)
        else:
            self.directive(number, line, match[1], match[2].strip(), match.start(1))

    def span(self, number: int, line: str) -> Span:
        column = len(line) - len(line.lstrip()) + 1
        return Span(self.path, number, column, number, len(line.rstrip()) + 1)

    def close(self, last: int, ended: bool = False) -> None:
        if self.module is None:
            return
        if not ended and not self.problems:
            self.note(self.first, 1, "`@module_start` is not closed", "write `@module_end`")
        if self.pending is not None:
            self.orphan(self.pending.span.line, self.pending.span.column)
        if self.module.name:
            self.modules.append(self.module)
        else:
            self.note(self.first, 1, "a module without `@module_name`", "name it")
        self.lines.append((self.first, last))
        self.module, self.pending = None, None

    def orphan(self, line: int, column: int) -> None:
        self.note(
            line, column, "no function declaration follows the annotation", "declare the function"
        )
        self.pending = None

    def directive(self, number: int, line: str, word: str, rest: str, column: int) -> None:
        assert self.module is not None
        span = self.span(number, line)
        if word == "module_name":
            self.module = replace(self.module, name=rest)
        elif word in SERVICE_KINDS:
            self.pending = self.service(word, rest, span)
        elif word in (*MOTION_FUNCTIONS, GRASP):
            bounds = [None if part == "_" else parse_number(part) for part in rest.split()]
            low, high, rate = (*bounds, None, None, None)[:3]
            function = Function(word, span, low, high, rate)
            self.module = replace(self.module, functions=(*self.module.functions, function))
        elif word not in WORDS:
            near = difflib.get_close_matches(word, WORDS, 1)
            self.note(
                number,
                column,
                f"`@{word}` is no annotation",
                f"did you mean `@{near[0]}`?" if near else "",
            )

    def service(self, kind: str, rest: str, span: Span) -> Service:
        name = next(k for k in SERVICE_KINDS if k == kind)
        if kind == "ControlOut":
            return Service(
                name, span, commands=tuple(p.strip() for p in rest.split(",") if p.strip())
            )
        if kind == "Converts":
            return Service(name, span, cost=int(rest) if rest.isdigit() and int(rest) else 1)
        modes: list[Mode] = []
        hz: Decimal | None = None
        match = re.fullmatch(r"(.*?)(?:\s+([0-9.]+))?", rest)
        if match and kind in ("Sense", "DataOut"):
            hz = parse_number(match[2]) if match[2] else None
            for part in re.split(r",(?![^()]*\))", match[1]):
                mode = parse_mode(part)
                if isinstance(mode, ModeProblem):
                    self.note(span.line, span.column, mode.message, mode.help)
                else:
                    modes.append(mode)
            if hz is None and any(mode.name == DELIVERY_MODES[1] for mode in modes):
                self.note(
                    span.line,
                    span.column,
                    "`NotifyAtFrequency` without a frequency",
                    "write its number of Hz",
                )
        return Service(name, span, modes=tuple(modes), hz=hz)

    def declaration(self, number: int, text: str) -> None:
        if not text.strip() or self.pending is None or self.module is None:
            return
        match = _FUNCTION.match(text.strip())
        if match is None:
            self.orphan(number, len(text) - len(text.lstrip()) + 1)
            return
        output = _normal(match["type"])
        service = replace(
            self.pending,
            function=match["name"],
            output=None if output in _PRIMITIVE else output,
            inputs=tuple(_inputs(match["inside"])),
        )
        self.module = replace(self.module, services=(*self.module.services, service))
        self.pending = None


def _inputs(inside: str) -> Iterator[str]:
    for part in re.split(r",(?![^<]*>)", inside):
        declared = re.sub(r"=.*", "", part).strip()
        words = _FALLS_AWAY.sub(" ", declared).split()
        if len(words) > 1 and re.fullmatch(r"[A-Za-z_]\w*", words[-1]):
            words.pop()
        name = "".join(words)
        if name not in _PRIMITIVE:
            yield name


def _normal(text: str) -> str:
    return "".join(_FALLS_AWAY.sub(" ", text).split())
