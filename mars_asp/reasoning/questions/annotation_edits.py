"""Edits of annotations in their sources: additions, changes and removals."""

import re
from dataclasses import dataclass
from fractions import Fraction

from mars_asp.annotations.arguments import FUNCTIONS, parts
from mars_asp.annotations.declarations import SourceDeclaration
from mars_asp.annotations.directives import OVERRIDES, Directive, directives
from mars_asp.annotations.following import following
from mars_asp.annotations.overrides import Overrides
from mars_asp.annotations.services import read_signature
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Span
from mars_asp.language.text_edits import Draft
from mars_asp.model.declarations import SERVICE_KINDS, Function, Mode, Module, Service
from mars_asp.model.rates import as_written

#: The start of a comment in a language, if no other comment shows the style of its author.
_MARKS = {"python": "# ", "matlab": "% "}
_LINE_MARK = re.compile(r"\s*(?://[/!]?|#+|%+|\*)?\s*")
_BLOCK_MARK = re.compile(r"(\s*)/\*[*!]?\s*")
#: A frequency or a period at the end of a mode.
_NUMBER = re.compile(r"(?:\bevery\s+\S+\s+m?s|[+-]?[\d.]+)\s*$")
_PLAIN = re.compile(r"[A-Za-z_]\w*(?:::\w+)*")


class NoPlaceError(Exception):
    """An annotation has no location at which it would have the intended meaning."""


@dataclass(frozen=True, slots=True)
class _Marks:
    """The form of a comment line: the text before an annotation, and the text after it."""

    before: str
    after: str


@dataclass(frozen=True, slots=True)
class Read:
    """A source, its annotations, and the index of the annotation at each line and column."""

    source: Source
    directives: list[Directive]
    places: dict[tuple[int, int], int]


def read(source: Source) -> Read:
    """Return a source with its annotations, without those that have errors."""
    found = [found for found in directives(source) if isinstance(found, Directive)]
    return Read(source, found, {source.position(d.offset): n for n, d in enumerate(found)})


class Annotations:
    """The annotations of one source, and a draft of its text in which they are edited."""

    def __init__(self, read: Read, draft: Draft) -> None:
        """Begin with the annotations of a source, and the draft for its edits."""
        self._source = read.source
        self._found = read.directives
        self._places = read.places
        self._draft = draft

    def offer(self, service: Service, mode: Mode, hz: Fraction | None) -> None:
        """Add a mode to an annotation, or replace the frequency of the mode that it has."""
        directive = self._found[self._index(service.span)]
        if mode not in service.modes:
            rate = "" if hz is None else f" {as_written(hz)}"
            at = directive.place(len(directive.rest))
            self._draft.put(at, at, f", {mode.text}{rate}")
        elif hz is not None:
            for start, part in parts(directive.rest):
                number = _NUMBER.search(part)
                if number is not None:
                    first, last = start + number.start(), start + len(part.rstrip())
                    begin, end = directive.place(first), directive.place(last)
                    self._draft.put(begin, end, as_written(hz))

    def remove(self, annotation: Service | Function) -> None:
        """Remove an annotation, with its overrides unless another annotation shares them."""
        index = self._index(annotation.span)
        group = self._group(index)
        gone = [self._found[index]]
        if all(other is gone[0] or other.word in OVERRIDES for other in group):
            gone = group
        for directive in gone:
            self._take_out(directive)

    def give(self, module: Module, word: str, output: str | None = None) -> None:
        """Write the annotation `@WORD` into a module: a motion, `DataOut` or `ControlOut`.

        `output` is the representation of a `DataOut` whose declaration does not state it.

        Raises:
            NoPlaceError: the module has no declaration that can carry the annotation.
        """
        first = self._index(module.span) + 1
        words = [each.word for each in self._found]
        inside = self._found[first : words.index("module_end", first) + 1]
        if word in FUNCTIONS:
            heads = [d for d in inside if d.word in FUNCTIONS or d.word == "module_name"]
            self._write_after(heads[-1], f"@{word}")
            return
        lines = ["@DataOut NotifyWhenReady" if word == "DataOut" else f"@{word}"]
        if module.services:
            carrier = module.services[0]
            lines += _output(word, carrier.output, output)
            self._before(self._found[self._index(carrier.span)], lines)
            return
        name, end = inside[0], inside[-1]
        after = following(self._source, max(d.until for d in inside[:-1]), end.offset)
        if isinstance(after.found, SourceDeclaration):
            declared = read_signature(after.found, Overrides(), delivers=True).output
            lines += _output(word, declared, output)
            line, column = self._draft.position(after.place(after.found.offset))
            indent = self._draft.line(line)[: column - 1]
            mark = indent + self._mark(name) if not indent.strip() else self._mark(name)
            self._draft.insert(line, "before", [mark + text for text in lines])
        elif self._source.is_configuration:
            # A block is the whole description of a module, so it may declare another function.
            kind = output or "void"
            lines += [f"@Output {output}"] if output and not _PLAIN.fullmatch(output) else []
            declared = kind if _PLAIN.fullmatch(kind) else "void"
            lines.append(f"{declared} {'deliver' if word == 'DataOut' else 'control'}();")
            if word == "DataOut" and output is None:
                raise NoPlaceError
            self._draft.insert(self._draft.line_at(end.offset), "before", lines)
        else:
            raise NoPlaceError

    def _index(self, span: Span) -> int:
        return self._places[span.line, span.column]

    def _group(self, index: int) -> list[Directive]:
        """Return the annotation at an index with those of the same declaration."""
        words = (*SERVICE_KINDS, *OVERRIDES)
        first = last = index
        # The annotations of other kinds at both ends of a module stop the loops.
        while self._found[first - 1].word in words and self._adjoin(first - 1):
            first -= 1
        while self._found[last + 1].word in words and self._adjoin(last):
            last += 1
        return self._found[first : last + 1]

    def _adjoin(self, index: int) -> bool:
        """Whether no code separates the annotation at an index from the next one."""
        begin, end = self._found[index].until, self._found[index + 1].offset
        return not self._source.stretch(begin, end, end - begin).code.strip()

    def _take_out(self, directive: Directive) -> None:
        marks = self._marks(directive)
        last, end = self._draft.position(directive.end)
        after = self._draft.line(last)[end - 1 :].strip().removeprefix("*/")
        if marks is None or ("/*" in marks.before) != bool(marks.after) or after:
            self._draft.put(directive.offset, directive.end, "")
            return
        for line in range(self._draft.line_at(directive.offset), last + 1):
            self._draft.delete(line)

    def _marks(self, directive: Directive) -> _Marks | None:
        """Return the form of the line of an annotation, or None if code precedes it."""
        line, column = self._draft.position(directive.offset)
        before = self._draft.line(line)[: column - 1]
        if not (_LINE_MARK.fullmatch(before) or _BLOCK_MARK.fullmatch(before)):
            return None
        last, end = self._draft.position(directive.end)
        after = self._draft.line(last)[end - 1 :].strip()
        return _Marks(before, " */" if after.startswith("*/") else "")

    def _mark(self, like: Directive) -> str:
        """Return the start of a new comment, copied from another annotation."""
        marks = self._marks(like)
        if marks is not None and "*" not in marks.before:
            return marks.before.lstrip()
        return _MARKS.get(self._source.language, "// ")

    def _write_after(self, directive: Directive, text: str) -> None:
        """Write an annotation on a line of its own after another."""
        line = self._draft.line_at(directive.end)
        marks = self._marks(directive)
        if marks is None:
            self._draft.insert(line, "behind", [self._mark(directive) + text])
            return
        opened = _BLOCK_MARK.fullmatch(marks.before)
        if opened and not marks.after:
            self._draft.insert(line, "behind", [f"{opened[1]} * {text}"])
        elif marks.after and not opened:
            line = self._draft.line_at(directive.offset)
            self._draft.insert(line, "before", [marks.before + text])
        else:
            self._draft.insert(line, "behind", [marks.before + text + marks.after])

    def _before(self, directive: Directive, lines: list[str]) -> None:
        """Write annotations on own lines before `directive`; after it if code precedes it."""
        marks = self._marks(directive)
        line = self._draft.line_at(directive.offset)
        if marks is None:
            mark, last = self._mark(directive), self._draft.line_at(directive.end)
            self._draft.insert(last, "behind", [mark + text for text in lines])
            return
        opened = _BLOCK_MARK.fullmatch(marks.before)
        end = " */" if opened else ""
        self._draft.insert(line, "before", [marks.before + text + end for text in lines])


def _output(word: str, declared: str | None, output: str | None) -> list[str]:
    """Return the lines `@Output ...` that a new `DataOut` needs; none if its declaration suffices.

    `word` is the annotation, `declared` the output of the declaration, `output` the wanted one.

    Raises:
        NoPlaceError: nothing to deliver is known, or the declaration delivers already.
    """
    if word != "DataOut":
        return []
    if (declared is None) != (output is not None):
        raise NoPlaceError
    return [] if output is None else [f"@Output {output}"]
