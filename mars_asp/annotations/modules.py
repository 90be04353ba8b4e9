"""The modules of one source, and everything that is wrong with its annotations."""

import re
from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal

from mars_asp.annotations.comments import Lexed, lex
from mars_asp.annotations.declarations import Declaration, NoFunction, read_declaration
from mars_asp.annotations.directives import (
    BOUNDARIES,
    WORDS,
    Directive,
    Misspelt,
    directives,
)
from mars_asp.annotations.services import Overrides, read_signature
from mars_asp.diagnostic import Diagnostic, Severity
from mars_asp.model import (
    GRASP,
    MOTION_FUNCTIONS,
    SERVICE_KINDS,
    Function,
    Mode,
    Module,
    Service,
    Transformation,
    Vertex,
)
from mars_asp.modes import ModeProblem, parse_mode, parse_number
from mars_asp.source import Span
from mars_asp.tuples import read_transformation

_NAME = re.compile(r"[A-Za-z_]\w*")
_FUNCTIONS = (*MOTION_FUNCTIONS, GRASP)
_PERIODIC = "NotifyAtFrequency"


def read_modules(source: Lexed) -> tuple[tuple[Module, ...], tuple[Diagnostic, ...]]:
    """Return the modules of a source, those with errors included, and the errors."""
    reader = _Reader(source)
    for directive in directives(source):
        reader.read(directive)
    reader.finish()
    return tuple(reader.modules), tuple(reader.problems)


class _Reader:
    """Walks over the annotations of one source."""

    def __init__(self, source: Lexed) -> None:
        self.source = source
        self.modules: list[Module] = []
        self.problems: list[Diagnostic] = []
        self.start: Directive | None = None
        self.module = Module("", self.span(0, 0))
        self.named = False
        self.pending: list[tuple[Directive, Service | None]] = []
        self.overrides: list[Directive] = []
        self.troubled = False

    def span(self, begin: int, end: int) -> Span:
        return Span(
            self.source.path, *self.source.position(begin), *self.source.position(max(begin, end))
        )

    def note(
        self,
        code: str,
        begin: int,
        end: int,
        message: str,
        help_text: str,
        severity: Severity = "error",
    ) -> None:
        span = self.span(begin, end)
        self.problems.append(
            Diagnostic(
                code,
                severity,
                message,
                span,
                help=help_text,
                excerpt=self.source.line(span.line)[:400],
            )
        )
        self.troubled = self.troubled or severity == "error"

    def read(self, directive: Directive | Misspelt) -> None:
        if isinstance(directive, Misspelt):
            if self.start is not None or directive.meant in BOUNDARIES:
                self.note(
                    "MARS109",
                    directive.offset,
                    directive.offset + len(directive.written) + 1,
                    f"`@{directive.written}` is no annotation",
                    f"did you mean `@{directive.meant}`?",
                )
            if directive.meant not in BOUNDARIES:
                return
            # Read as if spelt right, so that one mistake is told once.
            directive = directive.corrected
        wrong_case = directive.written != directive.word
        if wrong_case and self.start is None and directive.word not in BOUNDARIES:
            return
        self.settle(directive.offset)
        if wrong_case:
            self.note(
                "MARS110",
                directive.offset,
                directive.offset + len(directive.written) + 1,
                f"`@{directive.written}` is written with other capitals",
                f"write `@{directive.word}`",
            )
        if directive.word == "module_start":
            self.begin(directive)
        elif self.start is None:
            self.orphan(directive)
        elif directive.word == "module_end":
            self.end(directive.offset)
        elif directive.word == "module_name":
            self.name(directive)
        else:
            self.annotate(directive)

    def orphan(self, directive: Directive) -> None:
        self.note(
            "MARS103",
            directive.offset,
            directive.end,
            f"`@{directive.word}` outside of a module",
            "write `@module_start` and `@module_name NAME` before it",
        )

    def begin(self, directive: Directive) -> None:
        if self.start is not None:
            self.note(
                "MARS102",
                directive.offset,
                directive.end,
                "`@module_start` inside a module that is not closed",
                "write `@module_end` before it",
            )
            self.end(directive.offset)
        self.start = directive
        self.module = Module("", self.span(directive.offset, directive.end))
        self.named = self.troubled = False

    def name(self, directive: Directive) -> None:
        if self.named:
            self.note(
                "MARS106",
                directive.offset,
                directive.end,
                "a second `@module_name` in one module",
                "a module has one name; begin another module for another one",
            )
            return
        self.named = True
        if not directive.rest:
            self.note(
                "MARS105",
                directive.offset,
                directive.end,
                "`@module_name` without a name",
                "write `@module_name NAME`",
            )
        elif not _NAME.fullmatch(directive.rest):
            self.note(
                "MARS107",
                directive.rest_offset,
                directive.rest_offset + len(directive.rest),
                f"`{directive.rest}` is no module name",
                "a name is one word of letters, digits and `_`",
            )
        else:
            self.module = replace(self.module, name=directive.rest)

    def end(self, offset: int) -> None:
        """Close the module that is open; keep it where it has a name."""
        if self.start is None:
            return
        self.settle(offset, closing=True)
        if not self.named:
            self.note(
                "MARS104",
                self.start.offset,
                self.start.end,
                "a module without `@module_name`",
                "name it: `@module_name NAME`",
            )
        if self.module.name:
            self.modules.append(self.module)
            sensing = [s for s in self.module.services if s.kind == "Sense"]
            if sensing and self.module.functions:
                span = self.module.functions[0].span
                self.problems.append(
                    Diagnostic(
                        "MARS120",
                        "error",
                        f"`{self.module.name}` is a sensor with the motion function"
                        f" `{self.module.functions[0].name}`",
                        span,
                        ((sensing[0].span, "the sensor"),),
                        "a sensor moves only with what it is mounted on; make two modules of it",
                    )
                )
        self.start = None
        self.pending, self.overrides = [], []

    def finish(self) -> None:
        if self.start is not None:
            start = self.start
            self.end(len(self.source.text))
            self.note(
                "MARS101",
                start.offset,
                start.end,
                "`@module_start` is never closed",
                "write `@module_end` behind the module",
            )

    def annotate(self, directive: Directive) -> None:
        if directive.word in SERVICE_KINDS:
            service = self.service(directive)
            self.pending.append((directive, service))
        elif directive.word in _FUNCTIONS:
            self.function(directive)
        elif directive.word == "Vertex":
            self.vertex(directive)
        elif not directive.rest:
            self.note(
                "MARS108",
                directive.offset,
                directive.end,
                f"`@{directive.word}` without anything behind it",
                f"write it behind `@{directive.word}`",
            )
        else:
            self.overrides.append(directive)

    def service(self, directive: Directive) -> Service | None:
        """Read a function annotation; `None` where its modes are wrong."""
        kind = next(kind for kind in SERVICE_KINDS if kind == directive.word)
        span = self.span(directive.offset, directive.end)
        rest = directive.rest
        if kind == "ControlOut":
            commands = tuple(part.strip() for part in re.split(r"[,\s]+", rest) if part.strip())
            for command in commands:
                if command not in _FUNCTIONS:
                    self.note_in(directive, command, "MARS114", f"`{command}` is no function")
                    return None
            return Service(kind, span, commands=commands)
        if kind == "Converts":
            if rest and not (re.fullmatch(r"[0-9]{1,10}", rest) and 0 < int(rest) < 2**31):
                self.note_in(directive, rest, "MARS115", f"`{rest}` is no cost")
                return None
            return Service(kind, span, cost=int(rest) if rest else 1)
        if kind == "DataIn":
            return Service(kind, span)
        return self.delivery(directive, Service(kind, span))

    def note_in(self, directive: Directive, part: str, code: str, message: str) -> None:
        at = directive.rest_offset + max(0, directive.rest.find(part))
        self.note(code, at, at + len(part), message, _EXPECTED.get(code, ""))

    def delivery(self, directive: Directive, service: Service) -> Service | None:
        """Read `MODES [HZ]`."""
        modes: list[Mode] = []
        hz: Decimal | None = None
        offset = 0
        for part in _parts(directive.rest):
            begin = directive.rest_offset + offset + len(part) - len(part.lstrip())
            offset += len(part) + 1
            words = re.fullmatch(r"\s*([A-Za-z_]\w*\s*(?:\([^()]*\))?)\s*(.*)", part)
            if words is None:
                found = part.strip()
                where = begin if found else directive.offset
                number = bool(re.match(r"[-+.\d]", found))
                self.note(
                    "MARS113" if number else "MARS111",
                    where,
                    where + len(found),
                    f"`{found}` is no delivery mode" if found else "no delivery mode is stated",
                    _EXPECTED["MARS111"],
                )
                return None
            mode = parse_mode(words[1])
            if isinstance(mode, ModeProblem):
                at = begin + mode.offset
                self.note("MARS111", at, at + len(words[1].strip()), mode.message, mode.help)
                return None
            modes.append(mode)
            if words[2]:
                at = directive.rest_offset + (offset - len(part) - 1) + words.start(2)
                value = parse_number(words[2])
                if value is None or not 0 < value <= 2_000_000 or hz is not None:
                    self.note(
                        "MARS113",
                        at,
                        at + len(words[2]),
                        f"`{words[2]}` is no frequency",
                        _EXPECTED["MARS113"],
                    )
                    return None
                hz = value
        periodic = any(mode.name == _PERIODIC for mode in modes)
        if periodic and hz is None:
            self.note(
                "MARS112",
                directive.offset,
                directive.end,
                f"`{_PERIODIC}` without a frequency",
                f"write its number of Hz: `{_PERIODIC} 25`",
            )
            return None
        if hz is not None and not periodic:
            self.note_in(
                directive,
                directive.rest.split()[-1],
                "MARS113",
                "a frequency without `NotifyAtFrequency`",
            )
            return None
        return replace(service, modes=tuple(modes), hz=hz)

    def function(self, directive: Directive) -> None:
        """Read `[MIN MAX [RATE]]`."""
        words = directive.rest.split()
        values = [None if word == "_" else parse_number(word) for word in words]
        for word, value in zip(words, values, strict=True):
            if value is None and word != "_":
                self.note_in(directive, word, "MARS116", f"`{word}` is no bound")
                return
        low, high, rate = (*values, None, None, None)[:3]
        wrong = len(words) not in (0, 2, 3) or (low is not None and high is not None and low > high)
        if wrong or (rate is not None and rate <= 0):
            self.note_in(directive, directive.rest, "MARS116", f"`{directive.rest}` are no bounds")
            return
        span = self.span(directive.offset, directive.end)
        if any(function.name == directive.word for function in self.module.functions):
            self.note(
                "MARS117",
                directive.offset,
                directive.end,
                f"`@{directive.word}` stands twice in one module",
                "keep one of the two",
            )
            return
        function = Function(directive.word, span, low, high, rate)
        self.module = replace(self.module, functions=(*self.module.functions, function))

    def vertex(self, directive: Directive) -> None:
        match = re.fullmatch(r"(\d{1,6})\s*(?:\((.*)\))?", directive.rest)
        transformation: Transformation | tuple[int, str, str] = Transformation()
        if match and match[2] is not None:
            transformation = read_transformation([slot.strip() for slot in match[2].split(",")])
        if match is None or isinstance(transformation, tuple):
            self.note_in(directive, directive.rest, "MARS118", f"`{directive.rest}` is no vertex")
            return
        vertex = Vertex(int(match[1]), transformation, self.span(directive.offset, directive.end))
        self.module = replace(self.module, vertices=(*self.module.vertices, vertex))

    def settle(self, offset: int, closing: bool = False) -> None:
        """Give what is pending the declaration that stands before `offset`, if one does."""
        if self.start is None or not self.pending:
            return
        last = max((d for d, _ in self.pending), key=lambda d: d.end).end
        last = max([last, *(d.end for d in self.overrides)])
        signature = next((d for d in self.overrides if d.word == "Signature"), None)
        source = self.source
        if signature is not None:
            python = source.language == "python"
            text = signature.rest.rstrip(":;") + (":" if python else ";")
            inner = lex(source.path, source.language, text)
            read = read_declaration(source.language, inner.text, inner.code, 0, len(inner.code))
            shift = signature.rest_offset
        else:
            read = read_declaration(source.language, source.text, source.code, last, offset)
            shift = 0
        if read is None and not closing:
            return
        pending, self.pending = self.pending, []
        overrides, self.overrides = self.overrides, []
        first = pending[0][0]
        if read is None:
            self.note(
                "MARS201",
                first.offset,
                first.end,
                f"no function declaration follows `@{first.word}`",
                _EXPECTED["MARS202"],
            )
        elif isinstance(read, NoFunction):
            begin = read.offset + shift
            self.note(
                "MARS202",
                begin,
                begin + len(read.found),
                f"`{read.found}` begins no function declaration",
                _EXPECTED["MARS202"],
            )
        else:
            self.bind(pending, read, shift, _read_overrides(overrides))

    def bind(
        self,
        pending: list[tuple[Directive, Service | None]],
        declaration: Declaration,
        shift: int,
        overrides: Overrides,
    ) -> None:
        for _, service in pending:
            if service is None:
                continue
            delivers = service.kind in ("Sense", "DataOut", "Converts")
            signature = read_signature(declaration, overrides, delivers)
            at = declaration.offset + shift
            for code, message, help_text in signature.remarks:
                severity: Severity = "note" if code == "MARS207" else "warning"
                self.note(code, at, at, message, help_text, severity)
            if service.kind == "Converts" and len(signature.inputs) != 1:
                self.note(
                    "MARS208",
                    at,
                    at,
                    f"a converter with {len(signature.inputs)} inputs",
                    "a converter has one parameter; `@Input TYPE` says which it is",
                )
                continue
            found = replace(
                service,
                function=declaration.name,
                output=signature.output,
                inputs=signature.inputs,
            )
            self.module = replace(self.module, services=(*self.module.services, found))
        if declaration.conditional is not None and overrides.inputs is None:
            self.note(
                "MARS204",
                declaration.conditional,
                declaration.conditional + 1,
                f"`#if` inside the declaration of `{declaration.name}`: all branches are read",
                "say what it takes: `@Input TYPE, TYPE`",
                "warning",
            )


_EXPECTED = {
    "MARS111": "write delivery modes, such as `NotifyWhenReady` or `NotifyAtFrequency 25`",
    "MARS113": "write a positive number of Hz without a unit, such as `NotifyAtFrequency 25`",
    "MARS114": f"write functions: {', '.join(_FUNCTIONS)}",
    "MARS115": "write a positive whole number",
    "MARS116": "write `MIN MAX` or `MIN MAX RATE` as numbers, `_` for an open bound",
    "MARS118": "write a number and a tuple: `@Vertex 1 (_,_,_,_,0,0,100)`",
    "MARS202": "put the annotation before its function, or say it in `@Signature DECLARATION`",
}


def _read_overrides(found: list[Directive]) -> Overrides:
    output: str | None = None
    inputs: tuple[str, ...] | None = None
    named: dict[str, str] = {}
    for directive in found:
        if directive.word == "Output":
            output = directive.rest.strip()
        elif directive.word == "Input":
            single = re.fullmatch(r"([A-Za-z_]\w*)\s*:(?!:)\s*(.+)", directive.rest)
            if single:
                named[single[1]] = single[2].strip()
            else:
                inputs = tuple(part.strip() for part in _parts(directive.rest))
    return Overrides(output, inputs, named)


def _parts(text: str) -> Iterator[str]:
    """Yield what commas outside of brackets part."""
    depth, current = 0, ""
    for character in text:
        depth += (character in "<([") - (character in ">)]")
        if character == "," and not depth:
            yield current
            current = ""
        else:
            current += character
    yield current


__all__ = ["WORDS", "read_modules"]
