"""YAML as plain nodes with their locations; scalars stay texts.

Only the YAML of robots' files is read: one document of maps with plain keys, lists and scalars.
It is read event by event, so that neither depth nor aliases cost more than their limits.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple, TypeAlias

import yaml

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point, whole_file

#: The loader of libyaml, where PyYAML was built with it.
_LIBYAML: type[yaml.SafeLoader] | None = getattr(yaml, "CSafeLoader", None)
#: A file of parameters has some hundred lines.
MOST_BYTES = 256 * 1024
MOST_DEPTH = 64
#: The limit of nodes, where each alias counts as many as the value that it repeats.
MOST_NODES = 100_000
#: The same for the dump of a graph, which a program wrote.
MOST_BYTES_OF_DUMP = 16 * 1024 * 1024
MOST_NODES_OF_DUMP = 1_000_000
_TAGS = frozenset(f"tag:yaml.org,2002:{of}" for of in "str int float bool null map seq".split())
#: Tags of rosparam (https://github.com/ros/ros_comm), which turns angles into radians.
_ANGLES = frozenset({"!degrees", "!radians"})


@dataclass(frozen=True, slots=True)
class Scalar:
    """A scalar as it is written; `quoted` is whether it can only be text."""

    text: str
    quoted: bool
    span: Span


@dataclass(frozen=True, slots=True)
class Items:
    """A YAML sequence: its entries and its location."""

    nodes: tuple["Node", ...]
    span: Span


@dataclass(frozen=True, slots=True)
class Pairs:
    """A map, its keys in the order of the file; merged keys (`<<`) keep their own locations."""

    pairs: tuple[tuple[Scalar, "Node"], ...]
    span: Span

    def value(self, *keys: str) -> "Node | None":
        """Return the value of the first of some keys that the map has."""
        found = {key.text: node for key, node in self.pairs}
        return next((found[key] for key in keys if key in found), None)

    def word(self, *keys: str) -> Scalar | None:
        """Return the value of the first of these keys in the map; None if empty or no scalar."""
        found = self.value(*keys)
        return found if isinstance(found, Scalar) and found.text else None


Node: TypeAlias = Scalar | Items | Pairs


class Repeat(NamedTuple):
    """A key that a map has twice: the second one, and the location of the first.

    `is_merged` is whether the values are maps, which were merged; `within` is whether the key is in
    such a merged map.
    """

    key: Scalar
    first: Span
    is_merged: bool = False
    within: bool = False


def read_yaml(
    text: str,
    path: str,
    begins: tuple[int, int] = (1, 1),
    repeated: list[Repeat] | None = None,
    *,
    merges: bool = False,
) -> Node:
    """Return the one document of a YAML text.

    Args:
        text: The text.
        path: Its file, as places show it.
        begins: The line and column of the file at which the text begins.
        repeated: Gets the keys that a map has twice, of which the last one counts; otherwise they
            are errors.
        merges: Whether two maps of one key are one map, as for the parser of parameters of ROS 2
            (https://github.com/ros2/rcl, rcl_yaml_param_parser, `parse_key`).

    Raises:
        MarsError: the first error of the syntax, or all repeated keys.
    """
    make = partial(_YamlReader, path, MOST_NODES, begins, repeated is not None, merges)
    try:
        root, found = make().document(text, yaml.SafeLoader)
    except MarsError:
        # ROS reads parameters with libyaml, which takes tabs before comments.
        if repeated is None or "\t" not in text or _LIBYAML is None:
            raise
        root, found = make().document(text, _LIBYAML)
    if found and repeated is None:
        raise MarsError(map(_twice, found))
    if repeated is not None:
        repeated += found
    return root


def read_dump(text: str, path: str) -> Node:
    """Return the one document of a YAML text that a program wrote, which may be large.

    Raises:
        MarsError: as `read_yaml`, and where the text is larger than any dump.
    """
    if len(text) > MOST_BYTES_OF_DUMP:
        message = f"the file has more than {MOST_BYTES_OF_DUMP} characters, which no robot needs"
        raise _yaml_error(whole_file(path), message, "give the file of the graph alone")
    # The same events some ten times as fast, where PyYAML was built with libyaml.
    reader = _YamlReader(path, MOST_NODES_OF_DUMP)
    root, found = reader.document(text, _LIBYAML or yaml.SafeLoader)
    if found:
        raise MarsError(map(_twice, found))
    return root


@dataclass(slots=True)
class _YamlReader:
    """Makes nodes of events; `allows_copies` is whether a key may have the same value twice."""

    path: str
    most_nodes: int
    begins: tuple[int, int] = (1, 1)
    allows_copies: bool = False
    merges: bool = False
    root: Node | None = None
    repeated: list[Repeat] = field(default_factory=list)
    anchored: dict[str, tuple[Node, int]] = field(default_factory=dict)
    events: Iterator[yaml.Event] = field(init=False)
    #: The location of the last event.
    here: Span = field(init=False)

    def document(self, text: str, loader: type[yaml.SafeLoader]) -> tuple[Node, list[Repeat]]:
        """Return the document of a text, and the keys that a map has twice.

        Raises:
            MarsError: the text has an error, at which reading stops.
        """
        strange = yaml.reader.Reader.NON_PRINTABLE.search(text)
        if strange is not None:
            before = text[: strange.start()]
            line, column = before.count("\n"), len(before) - (before.rfind("\n") + 1)
            place = point(self.path, *self.at(line, column))
            message = f"character U+{ord(strange[0]):04X} is not allowed in YAML"
            raise _yaml_error(place, message, "is this a text file? if so, save it as UTF-8")
        try:
            self.read(yaml.parse(text, Loader=loader))
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            line, column = (0, 0) if mark is None else (mark.line, mark.column)
            place = point(self.path, *self.at(line, column))
            message = f"this is not YAML: {error.problem or error.context or 'it cannot be read'}"
            raise _yaml_error(place, message, "fix the line, or what is above it") from None
        if self.root is None:
            begin = point(self.path, *self.begins)
            raise _yaml_error(begin, "the file is empty", "give a file with content")
        return self.root, self.repeated

    def read(self, events: Iterator[yaml.Event]) -> None:
        """Read the documents of events.

        Raises:
            MarsError: an event is an error, so that reading stops.
        """
        self.events, documents = events, 0
        while (event := self.following()) is not None:
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                # The parser of parameters of ROS 2 does not mind where a document begins.
                if documents > 1 and not (self.merges and isinstance(self.root, Pairs)):
                    raise _yaml_error(
                        self.here, "a second document begins here", "give each a file of its own"
                    )
            elif isinstance(event, yaml.NodeEvent):
                node, _ = self.node(event, 0)
                if isinstance(self.root, Pairs) and self.root.pairs and isinstance(node, Pairs):
                    node = Pairs((*self.root.pairs, *node.pairs), node.span)
                self.root = node

    def following(self) -> yaml.Event | None:
        """Return the next event, or None after the last.

        Raises:
            MarsError: the event has a tag that is neither of plain values nor of angles.
        """
        event = next(self.events, None)
        if event is not None:
            self.here = self.span(event)
            tag = getattr(event, "tag", None)
            if tag is not None and tag != "!" and tag not in _TAGS | _ANGLES:
                raise _yaml_error(
                    self.here, f"tag `{tag}` is not read", "write the plain value, without a tag"
                )
        return event

    def node(self, event: yaml.NodeEvent, depth: int) -> tuple[Node, int]:
        """Return the node that begins with an event, and its size in nodes."""
        start = self.here
        match event:
            case yaml.AliasEvent():
                if event.anchor not in self.anchored:
                    message = f"alias `*{event.anchor}` has no complete anchor above it"
                    help_text = f"write `&{event.anchor}` before the value that it repeats"
                    raise _yaml_error(start, message, help_text)
                return self.anchored[event.anchor]
            case yaml.ScalarEvent():
                found: tuple[Node, int] = Scalar(event.value, bool(event.style), start), 1
            case _:
                if depth == MOST_DEPTH:
                    message = f"lists and maps are nested deeper than {MOST_DEPTH}"
                    raise _yaml_error(start, message, "no file of parameters needs that")
                nodes, size = list[Node](), 1
                while isinstance(inner := self.following(), yaml.NodeEvent):
                    node, added = self.node(inner, depth + 1)
                    nodes.append(node)
                    size += added
                    if size > self.most_nodes:
                        message = f"with its aliases the file has more than {self.most_nodes} nodes"
                        help_text = "write values out instead of aliases, as far as they are needed"
                        raise _yaml_error(self.here, message, help_text)
                whole = start._replace(end_line=self.here.line, end_column=self.here.column)
                is_map = isinstance(event, yaml.MappingStartEvent)
                found = self.mapped(nodes, whole) if is_map else Items(tuple(nodes), whole), size
        if event.anchor is not None:
            self.anchored[event.anchor] = found
        return found

    def span(self, event: yaml.Event) -> Span:
        """Return the location of an event."""
        start, end = event.start_mark, event.end_mark
        if start is None or end is None:
            return point(self.path, *self.begins)
        return Span(self.path, *self.at(start.line, start.column), *self.at(end.line, end.column))

    def at(self, line: int, column: int) -> tuple[int, int]:
        """Return line and column in the file for those (from 0) in the text."""
        first, before = self.begins
        return first + line, column + (before if line == 0 else 1)

    def mapped(self, nodes: Sequence[Node], span: Span) -> Pairs:
        """Return the map of a sequence that alternates keys and values."""
        given: list[tuple[Scalar, Node]] = []
        merged: list[tuple[Scalar, Node]] = []
        for key, value in zip(nodes[::2], nodes[1::2], strict=True):
            if not isinstance(key, Scalar):
                raise _yaml_error(key.span, "a key is a list or a map", "write a word as the key")
            if key.text == "<<" and not key.quoted:
                merged += _merged(value)
                continue
            given.append((key, value))
        noted = len(self.repeated)
        pairs = self.by_key(given, within=False)
        self.repeated[noted:] = sorted(self.repeated[noted:], key=lambda each: each.key.span)
        for key, value in merged:
            pairs.setdefault(key.text, (key, value))
        return Pairs(tuple(pairs.values()), span)

    def by_key(
        self, given: Sequence[tuple[Scalar, Node]], *, within: bool
    ) -> dict[str, tuple[Scalar, Node]]:
        """Return the entries of a map by key; note repeated keys, `within` a merged map."""
        pairs: dict[str, tuple[Scalar, Node]] = {}
        # Joined once at the end: a key may have thousands of maps.
        maps: dict[str, list[tuple[Scalar, Node]]] = {}
        for key, value in given:
            if key.text not in pairs:
                pairs[key.text] = key, value
                continue
            first, old = pairs[key.text]
            if self.merges and isinstance(value, Pairs) and isinstance(old, Pairs):
                if not within:
                    self.repeated.append(Repeat(key, first.span, is_merged=True))
                maps.setdefault(key.text, list(old.pairs)).extend(value.pairs)
                continue
            if not (self.allows_copies and _is_copy(value, old)):
                self.repeated.append(Repeat(key, first.span, within=within))
                pairs[key.text] = key, value
                # Keys that repeat in the lost maps are noted as well.
                self.by_key(maps.pop(key.text, ()), within=True)
        for text, inner in maps.items():
            first, old = pairs[text]
            pairs[text] = first, Pairs(tuple(self.by_key(inner, within=True).values()), old.span)
        return pairs


def _is_copy(node: Node, of: Node) -> bool:
    """Whether two nodes have the same content; booleans may differ in case."""
    match node, of:
        case Scalar(text), Scalar(other):
            same = text.lower() if not (node.quoted or of.quoted) else ""
            return text == other or (same in ("true", "false") and same == other.lower())
        case Items(nodes), Items(others):
            return len(nodes) == len(others) and all(map(_is_copy, nodes, others))
        case Pairs(pairs), Pairs(others):
            return len(pairs) == len(others) and all(
                _is_copy(key, other) and _is_copy(value, theirs)
                for (key, value), (other, theirs) in zip(pairs, others, strict=True)
            )
    return False


def _merged(value: Node) -> Iterator[tuple[Scalar, Node]]:
    """Yield the entries of the map or maps after the merge key `<<`."""
    for each in value.nodes if isinstance(value, Items) else (value,):
        if not isinstance(each, Pairs):
            raise _yaml_error(each.span, "`<<` expects a map", "name a map after `<<`")
        yield from each.pairs


def part_of(key: Scalar, start: int, end: int) -> Span:
    """Return the location of characters `start` to `end` (excluded) of an unquoted key."""
    span = key.span
    if key.quoted or span.line != span.end_line:
        return span
    return span._replace(column=span.column + start, end_column=span.column + end)


def _twice(repeat: Repeat) -> Diagnostic:
    message = f"`{repeat.key.text}` is given twice in one map"
    help_text = "keep one of the two: readers differ in which counts"
    labels = ((repeat.first, "and here"),)
    return Diagnostic("yaml", "error", message, repeat.key.span, labels, help_text)


#: Numbers as every reader of YAML understands them; leading zeros would be octal for some.
WHOLE = re.compile(r"[-+]?(?:0|[1-9][0-9]*)")
DECIMAL = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")


def _yaml_error(span: Span, message: str, help_text: str) -> MarsError:
    return MarsError((Diagnostic("yaml", "error", message, span, help=help_text),))
