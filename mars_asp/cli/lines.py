"""Lines of files, as traces and findings show them."""

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.diagnostic import Span
from mars_asp.language.parse import plain_lines
from mars_asp.output import counted, visible
from mars_asp.reading import check_walls, decoded, is_hidden

if TYPE_CHECKING:
    from mars_asp.asp.rules.rule import Rule
    from mars_asp.language.text_edits import LineEdit

#: Two lines of a terminal; the location has the line and column for the whole text.
MOST = 150
#: Lines of larger files are not shown.
_MOST_BYTES = 256 * 1024 * 1024
#: The lines of files that were quoted or are to be, by path.
_kept: dict[str, Sequence[str]] = {}


def remember(path: str, text: str) -> None:
    """Keep the text of a file, to quote lines of it later; a pipe can be read only once."""
    lines = text.split("\n")
    _kept[path] = lines if lines[-1] else lines[:-1]


def forget(path: str) -> None:
    """Discard the kept text of a file, so that it is read again."""
    _kept.pop(path, None)


def forget_all() -> None:
    """Discard the kept texts of all files."""
    _kept.clear()


def line_at(span: Span) -> str:
    """Return the line at the start of a span; a long one is cut around the column."""
    return shortened(whole_line(span), span.column)


def whole_line(span: Span) -> str:
    """Return the line of a file at the start of a span; empty if it cannot be read."""
    # Of a whole file there is no line, and it would be read.
    lines = lines_of(span.path) if span.line else ()
    return lines[span.line - 1] if 0 < span.line <= len(lines) else ""


def lines_of(path: str) -> Sequence[str]:
    """Return the lines of a file without their ends; none if it cannot be read."""
    if is_hidden(path):
        return ()
    if path not in _kept:
        try:
            check_walls(path)
            # Opening a pipe would block, and a large file would be read whole.
            if not os.path.isfile(path) or os.path.getsize(path) > _MOST_BYTES:  # noqa: PTH113, PTH202
                return ()
            remember(path, plain_lines(decoded(Path(path).read_bytes())))
        except (OSError, ValueError):
            return ()
    return _kept[path]


def shortened(line: str, column: int) -> str:
    """Return a line without the white space around it, cut to whole words around a column.

    Columns count from 1. The first word stays, as it shows the kind of the line.
    """
    # A tab counts as one column.
    bare = line.replace("\t", " ").strip()
    if len(bare) <= MOST:
        return bare
    place = column - 1 - (len(line) - len(line.lstrip()))
    start = 0
    if place > MOST // 2:
        # A very long word is cut.
        start = max(bare.rfind(" ", 0, place - MOST // 3) + 1, place - MOST // 2)
    end = start + MOST
    if end < len(bare):
        space = bare.rfind(" ", place, end)
        end = end if space < 0 else space
    first = bare[:start].partition(" ")[0]
    before = "" if not start else f"{first} ... " if len(first) < MOST // 6 else "... "
    return f"{before}{bare[start:end]}{' ...' if end < len(bare) else ''}"


def located_lines(spans: Iterable[Span], indent: str, most: int) -> Iterator[str]:
    """Yield the lines at spans after their locations, each once; more than `most` are counted."""
    located = [*{span[:2]: span for span in spans}.values()]
    places = [visible(f"{span.path}:{span.line}") for span in located[:most]]
    width = max(map(len, places), default=0)
    # Lines of the user are not broken.
    for span, place in zip(located, places, strict=False):
        yield f"{indent}{place:{width}}  {visible(line_at(span))}"
    if len(located) > most:
        yield f"{indent}and {counted(len(located) - most, 'more line')}"


def location_json(span: Span) -> dict[str, object]:
    """Return the start of a span with the keys of the contract."""
    return {"path": span.path, "line": span.line, "column": span.column}


def located_line_json(span: Span) -> dict[str, object]:
    """Return the start of a span and the text of its line with the keys of the contract."""
    return {**location_json(span), "text": line_at(span)}


def rule_location_json(rule: "Rule") -> dict[str, object]:
    """Return the id and the location of a rule with the keys of the contract."""
    return {"id": rule.id, "path": rule.span.path, "line": rule.span.line}


def line_text(line: "LineEdit") -> Iterator[str]:
    """Yield the lines that show an edit: the removed lines, then the added lines."""
    place = visible(f"{line.path}:{line.line}")
    if line.old is not None:
        for text in line.old.split("\n"):
            yield f"       - {place}: {visible(text)}"
        where = place
    else:
        # JSON keeps `behind`, the word of its contract.
        word = "after" if line.where == "behind" else line.where
        where = visible(f"{word} {line.path}:{line.line}")
    for text in [] if line.new is None else line.new.split("\n"):
        yield f"       + {where}: {visible(text)}"


def line_json(line: "LineEdit") -> dict[str, object]:
    """Return an edit with the keys of the contract."""
    return asdict(line)
