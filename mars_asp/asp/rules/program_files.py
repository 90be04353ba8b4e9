"""The files of a caller's own program, with their included files and their parts.

clingo reads no file by itself: each `#include` is resolved here, relative to its own file, and
blanked before clingo sees the text. As with clingo, a file is included once, its statements belong
to the part in which it is included, and those after the `#include` are in `base`.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate
from pathlib import Path

import clingo

from mars_asp.asp.fragments import blank
from mars_asp.asp.rules.gate import IncludedFile, included, read_text
from mars_asp.asp.rules.read import RuleFile, read_rules
from mars_asp.asp.rules.statements import Piece, Place, ProgramPart, part_of, with_constants
from mars_asp.diagnostic import Diagnostic, MarsError, point

_MOST_FILES, _MOST_DEPTH = 1_000, 100
#: Statements that hold in every part.
_GLOBAL = ("constant", "declaration", "shown")


BASE_PART = ProgramPart("base")


class ProgramReader:
    """Reads files and the files that they include, each once."""

    def __init__(self, stage: str, problems: list[Diagnostic]) -> None:
        """Begin to read files of a stage; errors are added to `problems`."""
        self._stage, self._problems = stage, problems
        self._seen: set[Path] = set()
        self.files: list[RuleFile] = []

    def read_path(self, path: str | Path) -> None:
        """Read a file, and those that it includes."""
        if Path(path).resolve() not in self._seen:
            try:
                self._read_part(read_text(Path(path), str(path)), str(path), BASE_PART, ())
            except MarsError as error:
                self._problems += error.diagnostics

    def read_text(self, text: str, path: str) -> None:
        """Read a text as the content of a file at `path`, with the files that it includes."""
        self._read_part(text, path, BASE_PART, ())

    def _read_part(self, text: str, shown: str, part: ProgramPart, above: tuple[Path, ...]) -> None:
        path = Path(shown).resolve()
        self._seen.add(path)
        text, includes, problems = included(text, shown)
        self._problems += problems
        if problems:
            return
        file = read_rules(text, shown, self._stage, self._problems, is_own=True)
        if file is None:
            return
        at = len(self.files)
        self.files.append(file)
        begins: list[tuple[Place, ProgramPart]] = [((1, 0), part)]
        starts = [piece for piece in file.written if piece.sort == "begin" and piece.text]
        events: list[Piece | IncludedFile] = [*starts, *includes]
        for each in sorted(events, key=lambda each: each.begin):
            if isinstance(each, Piece):
                part = ProgramPart(*part_of(each.text))
            elif self._include(each, shown, part, (*above, path)):
                part = BASE_PART
            begins.append((each.begin, part))
        self.files[at] = file._replace(begins=tuple(begins))

    def _include(
        self, include: IncludedFile, shown: str, part: ProgramPart, above: tuple[Path, ...]
    ) -> bool:
        """Read an included file; return False if it was read before or has an error."""
        written = str(Path(shown).parent / include.path)
        path = Path(written).resolve()
        place = point(shown, *include.begin)
        problem = None
        if path in above:
            problem = ("includes itself", "leave out one `#include` of the circle")
        elif path in self._seen:
            return False
        elif len(above) > _MOST_DEPTH or len(self.files) > _MOST_FILES:
            problem = ("is one file too many", f"include at most {_MOST_FILES}")
        if problem is not None:
            message = f"`{written}` {problem[0]}"
            found = Diagnostic("rules-include", "error", message, place, help=problem[1])
            self._problems.append(found)
            return False
        try:
            text = read_text(Path(written), written)
        except MarsError as error:
            for each in error.diagnostics:
                self._problems.append(replace(each, code="rules-include", span=place))
            return False
        self._read_part(text, written, part, above)
        return True


def parts_of(files: Sequence[RuleFile]) -> list[ProgramPart]:
    """Return the `base` part and the parts that files begin, each once."""
    found = dict.fromkeys(part for file in files for _, part in file.begins)
    return list(dict.fromkeys((BASE_PART, *found)))


def of_part(file: RuleFile, part: clingo.Symbol, is_first: bool) -> RuleFile:
    """Return a file with only the statements of a part, its parameters replaced by values.

    All statements keep their lines. Statements without a part are kept if `is_first`.
    """
    kept: list[Piece] = []
    text = file.text
    changed: dict[Place, str] = {}
    offsets = [0, *accumulate(len(line) + 1 for line in text.split("\n"))]
    edits: list[tuple[int, int, str]] = []
    for piece in file.written:
        own = [each for begin, each in file.begins if begin <= piece.begin][-1]
        is_own = (own.name, len(own.parameters)) == (part.name, len(part.arguments))
        is_kept = is_first if piece.sort in _GLOBAL else is_own and piece.sort != "begin"
        if piece.sort == "comment":
            continue
        written = blank(piece.text)
        if is_kept:
            values = dict(zip(own.parameters, map(str, part.arguments), strict=False))
            written = piece.text
            if is_own and values and piece.sort not in _GLOBAL:
                written = with_constants(piece.text, values)
            changed[piece.begin] = written
            kept.append(piece._replace(text=written))
        begin = offsets[piece.begin[0] - 1] + piece.begin[1] - 1
        edits.append((begin, begin + len(piece.text), written))
    done = 0
    texts: list[str] = []
    for begin, end, written in edits:
        texts += (text[done:begin], written)
        done = end
    text = "".join((*texts, text[done:]))
    rules = tuple(
        replace(rule, text=changed[rule.span.line, rule.span.column])
        for rule in file.rules
        if (rule.span.line, rule.span.column) in changed
    )
    return file._replace(text=text, written=tuple(kept), rules=rules)
