"""Where the keys of a TOML text stand, and the entries of its lists; its reader keeps no places."""

import re
from collections.abc import Iterator

from mars_asp.diagnostic import Span, point

#: A table's header, the key at the start of a line, and one of its parts between dots.
_PART = re.compile(r"([\w-]+)|\"([^\"]*)\"|'([^']*)'")
_DOTTED = r"\s*((?:[\w-]+|\"[^\"]*\"|'[^']*'|\s*\.\s*)++)\s*"
_HEADER = re.compile(r"\s*\[\[?" + _DOTTED + r"\]")
_KEY = re.compile(_DOTTED + "=")
#: What decides where an entry of a list ends; strings and comments pass as a whole.
_MARK = re.compile(
    r"#[^\n]*|\"\"\"(?s:.*?)\"\"\"|'''(?s:.*?)'''|\"(?:[^\"\\\n]|\\.)*+\"|'[^'\n]*+'|[][{},]"
)
_BLANK = re.compile(r"(?:\s|#[^\n]*)*+")
#: No key of ours has more parts.
_DEEPEST = 4
#: Lines behind the start of a table in which a key of it is looked for.
_FAR = 200


class Places:
    """Places are found by looking for keys line by line; the text is known to be TOML."""

    def __init__(self, text: str, path: str) -> None:
        """Index the headers and keys that begin a line."""
        self._text, self._path = text, path
        self._lines = text.split("\n")
        self._starts = [0]
        for line in self._lines:
            self._starts.append(self._starts[-1] + len(line) + 1)
        self._stands: dict[tuple[str, ...], tuple[int, int]] = {}
        #: The lines of each header that stands several times.
        self._headers: dict[tuple[str, ...], list[int]] = {}
        under: tuple[str, ...] = ()
        for number, line in enumerate(self._lines):
            match = _HEADER.match(line) or _KEY.match(line)
            if match is None:
                continue
            parts = list(_PART.finditer(match[1]))[:_DEEPEST]
            keys = tuple(part[1] or part[2] or part[3] or "" for part in parts)
            if match.re is _HEADER:
                under = ()
                self._headers.setdefault(keys, []).append(number)
            for count, part in enumerate(parts, 1):
                column = match.start(1) + part.start() + 1
                self._stands.setdefault((*under, *keys[:count]), (number, column))
            if match.re is _HEADER:
                under = keys

    def of(self, key: str, under: tuple[str, ...], entry: int | None = None) -> Span:
        """Return where a key stands; one of an inline table is looked for behind the table.

        With `entry`, `under` is a list, and the key is one of its table with that index.
        """
        written = re.compile(rf"(?<![\w-])[\"']?{re.escape(key)}[\"']?\s*(?==|\]|\.)")
        if entry is not None:
            begin, end = self._entry(under, entry)
            match = written.search(self._text, begin, end)
            return self._point(match.start() if match else begin)
        wanted = (*under, key)
        if wanted in self._stands:
            number, column = self._stands[wanted]
            return point(self._path, number + 1, column)
        outer = (wanted[:count] for count in range(len(wanted) - 1, 0, -1))
        start = next((self._stands[keys][0] for keys in outer if keys in self._stands), 0)
        for number, line in enumerate(self._lines[start : start + _FAR], start + 1):
            match = written.search(line)
            if match:
                return point(self._path, number, match.start() + 1)
        return point(self._path, start + 1, 1)

    def of_entry(self, under: tuple[str, ...], number: int) -> Span:
        """Return where an entry of a list stands."""
        return self._point(self._entry(under, number)[0])

    def _entry(self, under: tuple[str, ...], number: int) -> tuple[int, int]:
        """Return the stretch of a list's entry, be it in brackets or a table with a header."""
        headers = self._headers.get(under, ())
        if number < len(headers):
            later = (line for lines in self._headers.values() for line in lines)
            end = min((line for line in later if line > headers[number]), default=len(self._lines))
            return self._starts[headers[number]], self._starts[end]
        place = self.of(under[-1], under[:-1])
        begin = self._starts[place.line - 1] + place.column - 1
        for count, stretch in enumerate(self._inside(self._text.find("[", begin))):
            if count == number:
                return stretch
        return begin, len(self._text)

    def _inside(self, opened: int) -> Iterator[tuple[int, int]]:
        """Yield the stretches of what stands in the bracket that is opened there."""
        depth, begin = 0, opened + 1
        for mark in _MARK.finditer(self._text, opened):
            if mark[0] in "[{":
                depth += 1
            elif mark[0] in "]}":
                depth -= 1
            if depth == 0 or (depth == 1 and mark[0] == ","):
                blank = _BLANK.match(self._text, begin)
                yield blank.end() if blank else begin, mark.start()
                begin = mark.end()
            if depth == 0:
                return

    def _point(self, offset: int) -> Span:
        line = self._text.count("\n", 0, offset)
        return point(self._path, line + 1, offset - self._starts[line] + 1)
