"""The modules of one source, and everything that is wrong with its annotations."""

import re
from collections.abc import Callable
from dataclasses import replace

from mars_asp.annotations.arguments import (
    FUNCTIONS,
    Wrong,
    read_bounds,
    read_commands,
    read_cost,
    read_delivery,
    read_vertex,
)
from mars_asp.annotations.declarations import Declaration, NoFunction
from mars_asp.annotations.directives import (
    BOUNDARIES,
    MOST_CHARACTERS,
    OVERRIDES,
    Directive,
    Misspelt,
    directives,
)
from mars_asp.annotations.following import (
    MOST_DECLARED,
    Endless,
    Following,
    following,
    stated,
)
from mars_asp.annotations.overrides import Overrides, read_overrides
from mars_asp.annotations.services import Signature, read_signature
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Diagnostic, Severity
from mars_asp.model import SERVICE_KINDS, Function, Module, Service, Vertex
from mars_asp.source import Span

_NAME = re.compile(r"[A-Za-z_]\w*")
#: A file with so many errors is read no further; one declaration has at most so many annotations.
MOST_ERRORS = 500
MOST_ANNOTATIONS = 500
_MOST_SHOWN = 80
_BEFORE = "put the annotation before its function, or say it in `@Signature DECLARATION`"


def read_modules(source: Source) -> tuple[tuple[Module, ...], tuple[Diagnostic, ...]]:
    """Return the modules of a source, those with errors included, and the errors."""
    reader = _Reader(source)
    for directive in directives(source):
        if reader.errors >= MOST_ERRORS:
            reader.give_up(directive)
            break
        reader.read(directive)
    reader.finish()
    return tuple(reader.modules), tuple(reader.problems)


class _Reader:
    """Walks over the annotations of one source."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.modules: list[Module] = []
        self.problems: list[Diagnostic] = []
        self.start: Directive | None = None
        self.module = Module("", self.span(0, 0))
        self.named = False
        #: Whether what stands outside of modules follows from an error that was told already.
        self.excused = False
        self.services: list[Service] = []
        self.functions: dict[str, Function] = {}
        self.moving: Directive | None = None
        self.vertices: dict[int, Vertex] = {}
        self.pending: list[tuple[Directive, Service | None]] = []
        self.overrides: list[Directive] = []
        #: Behind the last annotation: where code may stand that belongs to what is pending.
        self.until = 0
        self.errors = 0

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
        span, excerpt = self.span(begin, end), self.source.excerpt(begin)
        self.problems.append(
            Diagnostic(code, severity, message, span, help=help_text, excerpt=excerpt)
        )
        self.errors += severity == "error"

    def note_word(self, code: str, directive: Directive, message: str, help_text: str) -> None:
        """Report an annotation at its `@`."""
        self.note(code, directive.offset, directive.end, message, help_text)

    def note_wrong(self, directive: Directive, wrong: Wrong) -> None:
        """Report a part of what stands behind an annotation's word, or all of the annotation."""
        begin, end = directive.offset, directive.end
        if wrong.begin is not None:
            begin = directive.place(self.source, wrong.begin)
            end = directive.place(self.source, wrong.end)
        self.note(wrong.code, begin, end, wrong.message, wrong.help)

    def read(self, found: Directive | Misspelt) -> None:
        directive = found.corrected if isinstance(found, Misspelt) else found
        wrong_case = directive.written != directive.word
        if self.start is None and directive.word not in BOUNDARIES:
            # Outside of modules a word that is not spelt as ours is another's, unless it is plain.
            if (isinstance(found, Misspelt) or wrong_case) and not directive.is_plainly_ours:
                return
        self.settle(directive.offset)
        if isinstance(found, Misspelt):
            self.note(
                "MARS109",
                directive.offset,
                self.behind(directive, found.written),
                f"`@{found.written}` is no annotation",
                f"did you mean `@{directive.word}`?",
            )
        elif wrong_case:
            self.note(
                "MARS110",
                directive.offset,
                self.behind(directive, directive.written),
                f"`@{directive.written}` is written with other capitals",
                f"write `@{directive.word}`",
            )
        if directive.word in BOUNDARIES or self.start is None:
            # Read as if spelt right, so that one mistake is told once.
            if self.start is not None or directive.word == "module_start":
                self.bound(directive)
            elif not isinstance(found, Misspelt) and not wrong_case:
                self.orphan(directive)
        elif not isinstance(found, Misspelt) or directive.word in OVERRIDES:
            self.annotate(directive)
        elif directive.word in SERVICE_KINDS:
            # What it is meant to say is not known, yet what follows belongs to it.
            self.pending.append((directive, None))
        self.until = directive.until

    def behind(self, directive: Directive, word: str) -> int:
        """Return the offset behind the word of an annotation."""
        return self.source.within(directive.offset, f"@{word}", len(word) + 1)

    def bound(self, directive: Directive) -> None:
        if directive.word == "module_start":
            self.begin(directive)
        elif directive.word == "module_end":
            self.end(directive.offset)
        else:
            self.name(directive)

    def orphan(self, directive: Directive) -> None:
        """Report the first of the annotations that a missing `@module_start` leaves outside."""
        # What is not told counts as well, so that reading ends.
        self.errors += self.excused
        if not self.excused:
            self.note_word(
                "MARS103",
                directive,
                f"`@{directive.word}` outside of a module",
                "write `@module_start` and `@module_name NAME` before it",
            )
        self.excused = directive.word != "module_end"

    def begin(self, directive: Directive) -> None:
        self.excused = self.start is not None
        if self.start is not None:
            self.note_word(
                "MARS102",
                directive,
                "`@module_start` inside a module that is not closed",
                "write `@module_end` before it",
            )
            self.end(directive.offset)
        self.start = directive
        self.module = Module("", self.span(directive.offset, directive.end))
        self.named = False
        self.services, self.functions, self.vertices = [], {}, {}
        self.moving = None

    def name(self, directive: Directive) -> None:
        rest = directive.rest
        begin, end = directive.place(self.source, 0), directive.place(self.source, len(rest))
        if not rest:
            begin, end = directive.offset, directive.end
        if self.named:
            self.note(
                "MARS106",
                begin,
                end,
                "a second `@module_name` in one module",
                "a module has one name; begin another module for another one",
            )
            return
        self.named = True
        if self.is_too_long(directive):
            return
        if not rest:
            self.note_word(
                "MARS105", directive, "`@module_name` without a name", "write `@module_name NAME`"
            )
        elif not _NAME.fullmatch(rest):
            self.note(
                "MARS107",
                begin,
                end,
                f"`{rest}` is no module name",
                "a name is one word of letters, digits and `_`",
            )
        else:
            self.module = replace(self.module, name=rest, named=self.span(begin, end))

    def end(self, offset: int) -> None:
        """Close the module that is open; keep it where it has a name."""
        if self.start is None:
            return
        self.settle(offset, closing=True)
        if not self.named:
            self.note_word(
                "MARS104",
                self.start,
                "a module without `@module_name`",
                "name it: `@module_name NAME`",
            )
        if self.module.name:
            self.note_moving_sensor()
            self.modules.append(
                replace(
                    self.module,
                    services=tuple(self.services),
                    functions=tuple(self.functions.values()),
                    vertices=tuple(self.vertices.values()),
                )
            )
        self.start = None

    def note_moving_sensor(self) -> None:
        sensing = [service for service in self.services if service.kind == "Sense"]
        if not sensing or self.moving is None:
            return
        function = self.functions[self.moving.word]
        self.problems.append(
            Diagnostic(
                "MARS120",
                "error",
                f"`{self.module.name}` is a sensor with the motion function `{function.name}`",
                function.span,
                ((sensing[0].span, "the sensor"),),
                "a sensor moves only with what it is mounted on; make two modules of it",
                self.source.excerpt(self.moving.offset),
            )
        )

    def finish(self) -> None:
        if self.start is not None:
            start = self.start
            self.end(len(self.source.data))
            self.note_word(
                "MARS101",
                start,
                "`@module_start` is never closed",
                "write `@module_end` behind the module",
            )

    def give_up(self, found: Directive | Misspelt) -> None:
        """Say that the rest is not read, and let nothing that is open be an error of its own."""
        self.start = None
        directive = found.corrected if isinstance(found, Misspelt) else found
        message = f"{self.errors} errors before this: the rest of the file was not read"
        self.note_word("MARS119", directive, message, "mend those first, or leave the file out")

    def annotate(self, directive: Directive) -> None:
        if len(self.pending) + len(self.overrides) >= MOST_ANNOTATIONS:
            message = f"more than {MOST_ANNOTATIONS} annotations of one declaration"
            self.note_word("MARS213", directive, message, "leave out those that say the same")
            return
        if self.is_too_long(directive):
            if directive.word in SERVICE_KINDS:
                self.pending.append((directive, None))
        elif directive.word in SERVICE_KINDS:
            read = _read_service(directive, self.span(directive.offset, directive.end))
            if isinstance(read, Wrong):
                self.note_wrong(directive, read)
            self.pending.append((directive, None if isinstance(read, Wrong) else read))
        elif directive.word in FUNCTIONS:
            self.function(directive)
        elif directive.word == "Vertex":
            self.vertex(directive)
        else:
            if not directive.rest:
                self.note_word(
                    "MARS108",
                    directive,
                    f"`@{directive.word}` without anything behind it",
                    f"write it behind `@{directive.word}`",
                )
            self.overrides.append(directive)

    def is_too_long(self, directive: Directive) -> bool:
        """Report an annotation that was cut for its length."""
        if len(directive.rest) <= MOST_CHARACTERS:
            return False
        message = f"`@{directive.word}` with more than {MOST_CHARACTERS} characters behind it"
        self.note_word(
            "MARS214", directive, message, "after a comma, the next line goes on with it"
        )
        return True

    def function(self, directive: Directive) -> None:
        bounds = read_bounds(directive.rest)
        if isinstance(bounds, Wrong):
            self.note_wrong(directive, bounds)
        elif directive.word in self.functions:
            self.note_twice(directive, f"@{directive.word}")
        else:
            span = self.span(directive.offset, directive.end)
            self.moving = self.moving or directive
            self.functions[directive.word] = Function(directive.word, span, *bounds)

    def vertex(self, directive: Directive) -> None:
        read = read_vertex(directive.rest)
        if isinstance(read, Wrong):
            self.note_wrong(directive, read)
        elif read[0] in self.vertices:
            self.note_twice(directive, f"@Vertex {read[0]}")
        else:
            span = self.span(directive.offset, directive.end)
            self.vertices[read[0]] = Vertex(*read, span)

    def note_twice(self, directive: Directive, what: str) -> None:
        message = f"`{what}` stands twice in one module"
        self.note_word("MARS117", directive, message, "keep one of the two")

    def settle(self, offset: int, closing: bool = False) -> None:
        """Give what is pending the declaration that stands before `offset`, if one does."""
        if self.start is None or not (self.pending or self.overrides):
            return
        if not self.pending:
            if closing or following(self.source, self.until, offset).over:
                self.note_idle(self.overrides)
                self.overrides = []
            return
        behind = self.following(offset)
        if not (behind.over or closing):
            return
        pending, self.pending = self.pending, []
        overrides, self.overrides = self.overrides, []
        found, first = behind.found, pending[0][0]
        if found is None:
            message = f"no function declaration follows `@{first.word}`"
            self.note_word("MARS201", first, message, _BEFORE)
        elif isinstance(found, NoFunction):
            # A string may go on for many lines.
            word = '"' if found.found.startswith('"') else found.found[:_MOST_SHOWN]
            begin, end = behind.place(found.offset), behind.place(found.offset + len(word))
            message = f"`{word}` begins no function declaration"
            self.note("MARS202", begin, end, message, _BEFORE)
        elif isinstance(found, Endless):
            begin = behind.place(found.offset)
            message = f"this declaration has no end within {MOST_DECLARED} bytes"
            self.note("MARS212", begin, begin, message, "state it by `@Signature DECLARATION`")
        else:
            written = [d for d in overrides if d.word != "Signature" and d.rest]
            said, wrong = read_overrides(written, found)
            for directive, problem in wrong:
                self.note_wrong(directive, problem)
            self.bind([s for _, s in pending if s is not None], found, behind.place, said)

    def note_idle(self, overrides: list[Directive]) -> None:
        for directive in overrides:
            self.note_word(
                "MARS203",
                directive,
                f"`@{directive.word}` belongs to no function annotation",
                "write it beside `@Sense`, `@DataOut`, `@ControlOut`, `@DataIn` or `@Converts`,"
                " before the function",
            )

    def following(self, offset: int) -> Following:
        """Read the declaration that a `@Signature` states, else the one before an offset."""
        signatures = [d for d in self.overrides if d.word == "Signature" and d.rest]
        for again in signatures[1:]:
            self.note_word("MARS210", again, "a second `@Signature`", "keep one of the two")
        if signatures:
            return stated(self.source, signatures[0])
        return following(self.source, self.until, offset)

    def bind(
        self,
        services: list[Service],
        declaration: Declaration,
        place: Callable[[int], int],
        overrides: Overrides,
    ) -> None:
        at = place(declaration.offset)
        signatures: dict[bool, Signature] = {}
        for service in services:
            delivers = service.kind in ("Sense", "DataOut", "Converts")
            if delivers not in signatures:
                signatures[delivers] = read_signature(declaration, overrides, delivers)
            signature = signatures[delivers]
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
            self.services.append(found)
        if declaration.conditional is not None and overrides.inputs is None:
            conditional = place(declaration.conditional)
            self.note(
                "MARS204",
                conditional,
                conditional + 1,
                f"`#if` inside the declaration of `{declaration.name}`: all branches are read",
                "say what it takes: `@Input TYPE, TYPE`",
                "warning",
            )


def _read_service(directive: Directive, span: Span) -> Service | Wrong:
    """Read a function annotation; its declaration is yet to come."""
    kind = next(kind for kind in SERVICE_KINDS if kind == directive.word)
    if kind == "ControlOut":
        commands = read_commands(directive.rest)
        return commands if isinstance(commands, Wrong) else Service(kind, span, commands=commands)
    if kind == "Converts":
        cost = read_cost(directive.rest)
        return cost if isinstance(cost, Wrong) else Service(kind, span, cost=cost)
    if kind == "DataIn":
        return Service(kind, span)
    delivery = read_delivery(directive.rest)
    if isinstance(delivery, Wrong):
        return delivery
    return Service(kind, span, modes=delivery[0], hz=delivery[1])
