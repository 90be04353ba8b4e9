"""Where the keys of a TOML text stand, and the entries of its lists; its reader keeps no places."""

import re
from collections.abc import Iterable
from typing import TypeAlias

import tree_sitter_toml
from tree_sitter import Language, Node, Parser

from mars_asp.diagnostic import Span, point

#: Keys of tables and numbers of entries, from the top of a text.
Path: TypeAlias = tuple[str | int, ...]
_LANGUAGE = Language(tree_sitter_toml.language())
_TABLES = ("table", "table_array_element")
#: No key of ours has more parts.
_DEEPEST = 4
#: One escape of a key in double quotes.
_ESCAPE = re.compile(r"\\(?:u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|(.))")
_CONTROL = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r"}


class Places:
    """Places are found when they are asked for; the text is known to be TOML."""

    def __init__(self, text: str, path: str) -> None:
        """Read the text; of its tables only the headers and the keys."""
        self._lines, self._path = text.split("\n"), path
        self._stands: dict[Path, Node] = {}
        #: Values that were not looked into yet.
        self._closed: dict[Path, Node] = {}
        #: How many tables each header in double brackets has begun.
        self._begun: dict[Path, int] = {}
        root = Parser(_LANGUAGE).parse(text.encode()).root_node
        self._pairs(root, ())
        for table in root.named_children:
            if table.type in _TABLES:
                self._table(table)

    def of(self, *path: str | int) -> Span:
        """Return where a key stands, or an entry of a list; else what it would be in."""
        for count in range(len(path), 0, -1):
            if self._open(path[:count]):
                return self._span(self._stands[path[:count]])
        return point(self._path, 1, 1)

    def _open(self, path: Path) -> bool:
        """Return whether a path stands in the text, when all that it is in has been read."""
        for count in range(1, len(path)):
            value = self._closed.pop(path[:count], None)
            if value is not None:
                self._value(value, path[:count])
        return path in self._stands

    def _value(self, value: Node, under: Path) -> None:
        if value.type == "inline_table":
            self._pairs(value, under)
        entries = value.named_children if value.type == "array" else ()
        for number, entry in enumerate(each for each in entries if each.type != "comment"):
            self._stands[*under, number] = self._closed[*under, number] = entry

    def _pairs(self, table: Node, under: Path) -> None:
        for pair in table.named_children:
            if pair.type == "pair":
                key, value, *_ = pair.named_children  # a comment may follow
                self._closed[self._keys(key, under)] = value

    def _table(self, table: Node) -> None:
        """Read a table with a header, which may be one more of its name."""
        under = self._keys(table.named_children[0], ())
        if table.type == "table_array_element":
            number = self._begun[under] = self._begun.get(under, -1) + 1
            under = (*under, number)
            self._stands[under] = table
        self._pairs(table, under)

    def _keys(self, written: Node, under: Path) -> Path:
        """Return the path of a key below a table, each part of it noted where it first stands."""
        path = under
        for part in _parts(written):
            # What is below a name of several tables is in the last of them.
            path = (*path, self._begun[path]) if path in self._begun else path
            path = (*path, _meant(part))
            self._stands.setdefault(path, part)
        return path

    def _span(self, node: Node) -> Span:
        """Return a node's place; the column counts characters, where the node counts bytes."""
        line, column = node.start_point
        before = self._lines[line].encode()[:column].decode()
        return point(self._path, line + 1, len(before) + 1)


def _parts(key: Node) -> Iterable[Node]:
    """Return the first parts of a key, whose node holds all but the last in another node."""
    found: list[Node] = []
    while key.type == "dotted_key":
        rest, *last = key.named_children
        found += reversed(last)
        key = rest
    return [key, *reversed(found)][:_DEEPEST]


def _meant(part: Node) -> str:
    """Return what a part of a key means."""
    text = (part.text or b"").decode()
    if part.type != "quoted_key":
        return text
    return text[1:-1] if text[0] == "'" else _ESCAPE.sub(_unescaped, text[1:-1])


def _unescaped(match: re.Match[str]) -> str:
    code = match[1] or match[2]
    return chr(int(code, 16)) if code else _CONTROL.get(match[3], match[3])
