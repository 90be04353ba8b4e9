"""The modules of one source, and all problems of its annotations."""

from dataclasses import dataclass, field

from mars_asp.annotations.arguments import FUNCTIONS, ArgumentProblem, read_bounds, read_vertex
from mars_asp.annotations.directives import (
    MOST_OTHERS,
    OVERRIDES,
    Directive,
    Misspelt,
    Uncompared,
    directives,
)
from mars_asp.annotations.pending import Pending
from mars_asp.annotations.problems import Problems
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.model import attributes
from mars_asp.model.attributes import Attribute, read_attribute
from mars_asp.model.declarations import SERVICE_KINDS, Function, Module, Service, Vertex
from mars_asp.model.names import read_name
from mars_asp.model.ranges import Problem

#: The number of errors after which a file is not read further.
MOST_ERRORS = 500


def read_modules(source: Source) -> tuple[tuple[Module, ...], tuple[Diagnostic, ...]]:
    """Return the modules of a source, those with errors included, and the diagnostics."""
    reader = _ModuleReader(source)
    for found in directives(source):
        if isinstance(found, Uncompared):
            reader.note_uncompared(found)
        elif reader.problems.errors >= MOST_ERRORS:
            reader.give_up(found)
            break
        else:
            reader.read(found)
    reader.finish()
    return tuple(reader.modules), tuple(reader.problems.found)


@dataclass(slots=True)
class _OpenBlock:
    """A module whose `@module_end` was not read yet; `named` is whether it has a `@module_name`."""

    start: Directive
    named: bool = False
    name: str = ""
    place: Span | None = None
    services: list[Service] = field(default_factory=list)
    functions: dict[str, Function] = field(default_factory=dict)
    vertices: dict[int, Vertex] = field(default_factory=dict)
    moving: Directive | None = None
    guard: Directive | None = None
    reset: Directive | None = None
    attributes: dict[tuple[str, str], Attribute] = field(default_factory=dict)


class _ModuleReader:
    """Reads the annotations of one source in order."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems = Problems(source)
        self.pending = Pending(self.problems)
        self.modules: list[Module] = []
        self.open: _OpenBlock | None = None
        #: Whether annotations outside of modules follow from an error that was reported already.
        self.excused = False

    def read(self, found: Directive | Misspelt) -> None:
        """Read an annotation; a misspelt one is corrected, to report one mistake once."""
        directive = found.corrected if isinstance(found, Misspelt) else found
        wrong_case = directive.written != directive.word
        if self.open is not None:
            self.open.services += self.pending.settle(directive.offset)
        if isinstance(found, Misspelt):
            self.problems.note(
                "MARS109",
                directive.offset,
                directive.offset + len(found.written) + 1,
                f"unknown annotation `@{found.written}`",
                f"did you mean `@{directive.word}`?",
            )
        elif wrong_case:
            self.problems.note(
                "MARS110",
                directive.offset,
                directive.offset + len(directive.written) + 1,
                f"`@{directive.written}` has the wrong case",
                f"write `@{directive.word}`",
            )
        if directive.word == "module_start":
            self.begin(directive)
        elif self.open is not None:
            self.read_inside(self.open, directive, isinstance(found, Misspelt))
        elif not isinstance(found, Misspelt) and not wrong_case:
            self.orphan(directive)
        self.pending.until = directive.until

    def read_inside(self, module: _OpenBlock, directive: Directive, misspelt: bool) -> None:
        """Read an annotation in a module; a misspelt one only as far as it is clear."""
        word = directive.word
        if word == "module_end":
            self.end(module, directive.offset)
        elif word == "module_name":
            self.name(module, directive)
        elif (misspelt and word not in OVERRIDES) or self.problems.is_too_long(directive):
            # Its meaning is unknown, but the next declaration belongs to it.
            if word in SERVICE_KINDS:
                self.pending.add_unread(directive)
        elif word in FUNCTIONS:
            self.function(module, directive)
        elif word == "Vertex":
            self.vertex(module, directive)
        elif word == "Guard":
            self.guard(module, directive)
        elif word in attributes.WORDS:
            self.attribute(module, directive)
        elif word == "Reset" and module.reset is not None:
            self.problems.note_twice(directive, "@Reset")
            self.pending.add_unread(directive)
        else:
            module.reset = directive if word == "Reset" else module.reset
            self.pending.add(directive)

    def orphan(self, directive: Directive) -> None:
        """Report an annotation outside of a module, if the one before was not outside as well."""
        if self.excused:
            # Unreported problems count as well, so that reading ends.
            self.problems.errors += 1
        else:
            self.problems.note_word(
                "MARS103",
                directive,
                f"`@{directive.word}` outside of a module",
                "write `@module_start` and `@module_name NAME` before it",
            )
        self.excused = directive.word != "module_end"

    def begin(self, directive: Directive) -> None:
        self.excused = self.open is not None
        if self.open is not None:
            self.problems.note_word(
                "MARS102",
                directive,
                "`@module_start` inside a module that is not closed",
                "write `@module_end` before it",
            )
            self.end(self.open, directive.offset)
        self.open = _OpenBlock(directive)

    def name(self, module: _OpenBlock, directive: Directive) -> None:
        rest = directive.rest
        begin, end = directive.place(0), directive.place(len(rest))
        if not rest:
            begin, end = directive.offset, directive.end
        if module.named:
            message = "a second `@module_name` in one module"
            help_text = "a module has one name; start a new module for another one"
            self.problems.note("MARS106", begin, end, message, help_text)
            return
        module.named = True
        if self.problems.is_too_long(directive):
            return
        if not rest:
            message = "`@module_name` without a name"
            self.problems.note("MARS105", begin, end, message, "write `@module_name NAME`")
        elif (name := read_name(rest)) is None:
            message = f"expected a module name, found `{rest}`"
            help_text = "write letters, digits, `_`, `-` and `/`, or put the name in quotes"
            self.problems.note("MARS107", begin, end, message, help_text)
        else:
            module.name, module.place = name, self.problems.span(begin, end)

    def function(self, module: _OpenBlock, directive: Directive) -> None:
        bounds = read_bounds(directive.rest)
        if isinstance(bounds, list):
            self.problems.note_wrong(directive, *bounds)
        elif directive.word in module.functions:
            self.problems.note_twice(directive, f"@{directive.word}")
        else:
            span = self.problems.span(directive.offset, directive.end)
            module.moving = module.moving or directive
            module.functions[directive.word] = Function(directive.word, span, *bounds)

    def vertex(self, module: _OpenBlock, directive: Directive) -> None:
        read = read_vertex(directive.rest)
        if isinstance(read, list):
            self.problems.note_wrong(directive, *read)
        elif read[0] in module.vertices:
            self.problems.note_twice(directive, f"@Vertex {read[0]}")
        else:
            span = self.problems.span(directive.offset, directive.end)
            module.vertices[read[0]] = Vertex(*read, span)

    def guard(self, module: _OpenBlock, directive: Directive) -> None:
        if directive.rest:
            message = f"expected nothing after `@Guard`, found `{directive.rest}`"
            self.problems.note_word("MARS124", directive, message, "write `@Guard` alone on a line")
        elif module.guard is not None:
            self.problems.note_twice(directive, "@Guard")
        else:
            module.guard = directive

    def attribute(self, module: _OpenBlock, directive: Directive) -> None:
        read = read_attribute(directive.word, directive.rest)
        if isinstance(read, Problem):
            place = (None,) if not directive.rest else (read.begin, read.end)
            self.problems.note_wrong(
                directive, ArgumentProblem("MARS125", read.message, read.help, *place)
            )
            return
        name, value = read
        key = directive.word, name
        if key in module.attributes:
            earlier = module.attributes[key].span
            self.problems.note_twice(directive, f"@{directive.word} {name}", earlier)
        else:
            span = self.problems.span(directive.offset, directive.end)
            module.attributes[key] = Attribute(name, span, value)

    def end(self, module: _OpenBlock, offset: int) -> None:
        """End a module at an offset of the source; add it unless its name is missing, an error."""
        module.services += self.pending.settle(offset, closing=True)
        self.open = None
        if not module.named:
            message, help_text = "a module without `@module_name`", "name it: `@module_name NAME`"
            self.problems.note_word("MARS104", module.start, message, help_text)
        if not module.name:
            return
        self.note_moving_sensor(module)
        self.note_idle_guard(module)
        self.modules.append(
            Module(
                module.name,
                self.problems.span(module.start.offset, module.start.end),
                tuple(module.services),
                tuple(module.functions.values()),
                tuple(module.vertices.values()),
                module.place,
                module.guard and self.problems.span(module.guard.offset, module.guard.end),
                tuple(module.attributes.values()),
            )
        )

    def note_idle_guard(self, module: _OpenBlock) -> None:
        kinds = {service.kind for service in module.services}
        if module.guard is not None and "ControlOut" not in kinds:
            self.problems.note_word(
                "MARS123",
                module.guard,
                f"`@Guard` in `{module.name}`, which sends no commands",
                "a guard is a ControlOutAlgorithm: annotate its function with `@ControlOut`",
            )

    def note_moving_sensor(self, module: _OpenBlock) -> None:
        sensing = [service for service in module.services if service.kind == "Sense"]
        if not sensing or module.moving is None:
            return
        self.problems.note(
            "MARS120",
            module.moving.offset,
            module.moving.end,
            f"`{module.name}` is a sensor with the motion function `{module.moving.word}`",
            "a sensor moves only with its mount; split it into two modules",
            labels=((sensing[0].span, "the sensor"),),
        )

    def finish(self) -> None:
        if self.open is None:
            return
        start = self.open.start
        self.end(self.open, len(self.source.text))
        message, help_text = (
            "`@module_start` is never closed",
            "write `@module_end` after the module",
        )
        self.problems.note_word("MARS101", start, message, help_text)

    def note_uncompared(self, found: Uncompared) -> None:
        message = (
            f"{MOST_OTHERS} unknown words after `@` above: misspelt annotations are no longer found"
        )
        help_text = "check the annotations below this line yourself"
        self.problems.note("MARS122", found.offset, found.offset + 1, message, help_text, "note")

    def give_up(self, found: Directive | Misspelt) -> None:
        """Report that the rest of the file is not read, and drop an open module without error."""
        self.open = None
        directive = found.corrected if isinstance(found, Misspelt) else found
        errors = self.problems.errors
        message = f"{errors} errors above: the rest of the file was not read"
        help_text = "fix those first, or leave the file out"
        self.problems.note_word("MARS119", directive, message, help_text)
