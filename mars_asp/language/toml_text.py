"""TOML texts: their tables, and the locations of keys and of list entries.

Python's own reader keeps no places; another one finds them, in texts that are wrong somewhere.
"""

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, TypeAlias

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point, whole_file

if TYPE_CHECKING:
    from tree_sitter import Node

#: Keys of tables and numbers of entries, from the top of a text.
Path: TypeAlias = tuple[str | int, ...]
_TABLES = ("table", "table_array_element")
#: No key of ours has more parts.
_DEEPEST = 4
#: One escape of a key in double quotes.
_ESCAPE = r"\\(?:u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|(.))"
_CONTROL = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r"}
#: As many bits as a whole number of TOML has, and a depth that no file of ours reaches.
_MOST_BITS, _MOST_NESTING = 64, 100
_DIGITS = re.compile(r"[0-9][0-9_]{4300}")
_NESTED = re.compile(r"[\[{](?:[^\[{\]}\n]*+[\[{]){100}")
#: A key of so many parts is none of ours, and takes its reader a time that grows as their square.
_DEEP = re.compile(r"(?<![\w.\"'-])(?:(?:[\w-]++|\"[^\"\n]*+\"|'[^'\n]*+')[ \t]*+\.[ \t]*+){100}")


def read_tables(text: str, path: str, code: str) -> dict[str, Any]:
    """Return the tables of a TOML text; `code` is the code of errors.

    Raises:
        MarsError: the text is not TOML.
    """
    import tomllib  # noqa: PLC0415 -- most commands read no TOML

    deep = _DEEP.search(text)
    if deep is not None:
        line = text.count("\n", 0, deep.start()) + 1
        raise _toml_error(point(path, line, 1), "a key with more than 100 parts", code)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line, column = (int(place[1]), int(place[2])) if place else (text.count("\n") + 1, 1)
        found = str(error).split(" (at")[0]
        raise _toml_error(
            point(path, line, column), found, code, "this file is read as TOML"
        ) from None
    except RecursionError:
        where = _match_span(text, _NESTED, path)
        raise _toml_error(where, "its lists and tables are nested too deep", code) from None
    except ValueError:  # more digits than Python reads
        where = long_number(text, path)
        raise _toml_error(where, "a number with more than 4300 digits", code) from None
    if (unusable := unusable_part(tables)) is not None:
        raise _toml_error(Places(text, path).of(*unusable[0]), unusable[1], code)
    return tables


def unusable_part(value: object) -> tuple[Path, str] | None:
    """Return path and reason of a value that is too large or nested too deep, or None."""
    waiting: list[tuple[Path, object]] = [((), value)]
    while waiting:
        path, each = waiting.pop()
        if isinstance(each, int) and each.bit_length() > _MOST_BITS:
            return path, f"a whole number with more than {_MOST_BITS} bits"
        if len(path) > _MOST_NESTING:
            return path[:_MOST_NESTING], "its lists and tables are nested too deep"
        if isinstance(each, dict):
            waiting += (((*path, key), inner) for key, inner in reversed(each.items()))
        elif isinstance(each, list):
            waiting += [((*path, number), inner) for number, inner in enumerate(each)][::-1]
    return None


def long_number(text: str, path: str) -> Span:
    """Return the location of the first number with more digits than Python reads."""
    return _match_span(text, _DIGITS, path)


def _match_span(text: str, pattern: re.Pattern[str], path: str) -> Span:
    """Return the location of the first match, else the begin of the text."""
    found = pattern.search(text)
    at = found.start() if found else 0
    return point(path, text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at))


class Places:
    """The locations of keys in a valid TOML text, found on demand."""

    def __init__(self, text: str, path: str) -> None:
        """Parse the text, and index tables and keys; values are indexed on demand."""
        # Most texts are right, and need no places.
        import tree_sitter_toml  # noqa: PLC0415
        from tree_sitter import Language, Parser  # noqa: PLC0415

        self._lines, self._path = text.split("\n"), path
        self._stands: dict[Path, Node] = {}
        #: Values that were not looked into yet.
        self._closed: dict[Path, Node] = {}
        #: How many tables each header in double brackets has begun.
        self._begun: dict[Path, int] = {}
        root = Parser(Language(tree_sitter_toml.language())).parse(text.encode()).root_node
        self._pairs(root, ())
        for table in root.named_children:
            if table.type in _TABLES:
                self._read_table(table)

    def of(self, *path: str | int) -> Span:
        """Return the location of a key or list entry, else of the table that would contain it."""
        for count in range(len(path), 0, -1):
            if self._open(path[:count]):
                line, column = self._stands[path[:count]].start_point
                # Columns of a node count bytes.
                before = self._lines[line].encode()[:column].decode()
                return point(self._path, line + 1, len(before) + 1)
        return whole_file(self._path)

    def _open(self, path: Path) -> bool:
        """Index the values above a path, and return whether the path exists."""
        for count in range(1, len(path)):
            value = self._closed.pop(path[:count], None)
            if value is not None:
                self._read_value(value, path[:count])
        return path in self._stands

    def _read_value(self, value: "Node", under: Path) -> None:
        if value.type == "inline_table":
            self._pairs(value, under)
        entries = value.named_children if value.type == "array" else ()
        for number, entry in enumerate(each for each in entries if each.type != "comment"):
            self._stands[*under, number] = self._closed[*under, number] = entry

    def _pairs(self, table: "Node", under: Path) -> None:
        for pair in table.named_children:
            if pair.type == "pair":
                key, value, *_ = pair.named_children  # a comment may follow
                self._closed[self._keys(key, under)] = value

    def _read_table(self, table: "Node") -> None:
        """Index a `[table]` or `[[table]]` with its keys."""
        under = self._keys(table.named_children[0], ())
        if table.type == "table_array_element":
            number = self._begun[under] = self._begun.get(under, -1) + 1
            under = (*under, number)
            self._stands[under] = table
        self._pairs(table, under)

    def _keys(self, written: "Node", under: Path) -> Path:
        """Return the path of a key below `under`, and index the first location of each part."""
        path = under
        for part in _key_parts(written):
            # What is below a name of several tables is in the last of them.
            path = (*path, self._begun[path]) if path in self._begun else path
            path = (*path, _meant(part))
            self._stands.setdefault(path, part)
        return path


def _key_parts(key: "Node") -> Iterable["Node"]:
    """Return the parts of a dotted key, at most `_DEEPEST`."""
    found: list[Node] = []
    while key.type == "dotted_key":
        rest, *last = key.named_children
        found += reversed(last)
        key = rest
    return [key, *reversed(found)][:_DEEPEST]


def _meant(part: "Node") -> str:
    """Return the text of a part of a key, unquoted."""
    text = (part.text or b"").decode()
    if part.type != "quoted_key":
        return text
    return text[1:-1] if text[0] == "'" else re.sub(_ESCAPE, _unescaped, text[1:-1])


def _unescaped(match: re.Match[str]) -> str:
    code = match[1] or match[2]
    return chr(int(code, 16)) if code else _CONTROL.get(match[3], match[3])


def _toml_error(span: Span, message: str, code: str, help_text: str | None = None) -> MarsError:
    return MarsError([Diagnostic(code, "error", message, span, help=help_text)])
