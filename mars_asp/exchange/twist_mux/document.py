"""The inputs and locks of the muxes of a YAML file, with their locations.

The dialects are those of https://wiki.ros.org/twist_mux (lists of maps), of its ROS 2 port (maps
under `ros__parameters`, whose keys may be dotted) and of cmd_vel_mux, which has `subscribers`.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal, NamedTuple, TypeAlias

from mars_asp.diagnostic import Diagnostic, MarsError, Span, beginning, whole_file
from mars_asp.exchange.unread import Unread
from mars_asp.exchange.yaml_document import (
    DECIMAL,
    WHOLE,
    Items,
    Node,
    Pairs,
    Scalar,
    part_of,
    read_yaml,
)
from mars_asp.model.declarations import FOREVER, Engine, Hold
from mars_asp.model.graph import Mux, MuxInput
from mars_asp.model.names import read_name, written
from mars_asp.model.ranges import MOST

Sort: TypeAlias = Literal["topics", "locks", "subscribers"]
#: The default name of the controlled topic.
OUTPUT = "cmd_vel_out"
PARAMETERS = "ros__parameters"
SORTS: tuple[Sort, ...] = ("topics", "locks", "subscribers")
_FIELDS = ("topic", "timeout", "priority")
_ENGINES: Mapping[Sort, Engine] = {
    "topics": "twist_mux",
    "subscribers": "cmd_vel_mux",
}
#: The noun for an entry of each sort.
_NOUNS: Mapping[Sort, str] = {"topics": "input", "locks": "lock", "subscribers": "input"}
#: What a byte holds, which is what twist_mux keeps a priority in.
_MOST_TWIST_MUX = 255


@dataclass(frozen=True, slots=True)
class MuxDocument:
    """The muxes of a file, its contents that were not read, and warnings.

    Names and topics are as they are written; the name of a mux is empty if its node is not named.
    """

    muxes: tuple[Mux, ...]
    unread: tuple[Unread, ...]
    warnings: tuple[Diagnostic, ...]


class _MuxEntry(NamedTuple):
    """An input or lock of a mux as written."""

    name: str
    span: Span
    fields: Mapping[str, tuple[Scalar, Node]]


class _Leaf(NamedTuple):
    """A value that is not a map, with the keys (`parts`) that lead to it."""

    parts: tuple[tuple[str, Span], ...]
    key: Scalar
    value: Node


class _Section(NamedTuple):
    """The parameters of a node, `names`, of which some describe a mux.

    Lists of inputs are errors unless `listed`, as in ROS 2 parameters.
    """

    names: tuple[str, ...]
    pairs: tuple[tuple[Scalar, Node], ...]
    listed: bool

    def has_inputs(self) -> bool:
        return any(key.text.partition(".")[0] in _ENGINES for key, _ in self.pairs)


def read_documents(files: Sequence[tuple[str, str]]) -> list[MuxDocument]:
    """Return the muxes of the YAML files of one robot, each file a text and its path.

    Locks in a file of their own are those of the mux with the same node name in another file, or of
    the only mux where one of the two has no node name.

    Raises:
        MarsError: files are not YAML, have nothing of a mux, or have errors (all are listed).
    """
    problems: list[Diagnostic] = []
    readers: list[_MuxReader] = []
    for text, path in files:
        try:
            readers.append(_reader_of(text, path))
        except MarsError as error:
            problems += error.diagnostics
    moves = _moves_of_locks([section for reader in readers for section in reader.sections])
    documents: list[MuxDocument] = []
    for reader in readers:
        has_parts = any(section is moved for section in reader.sections for moved, _ in moves)
        # The parameters of sections with locks alone are moved to those of their muxes.
        reader.sections = [
            section._replace(pairs=sum((m.pairs for m, o in moves if o is section), section.pairs))
            for section in reader.sections
            if all(section is not moved for moved, _ in moves)
        ]
        try:
            document = reader.document()
        except MarsError as error:
            problems += error.diagnostics
            continue
        documents.append(document)
        if not document.muxes and not has_parts:
            message = "the file has no mux: neither `topics` nor `subscribers` with an input"
            help_text = "give the parameters of a twist_mux or cmd_vel_mux"
            problems.append(Diagnostic("mux", "error", message, reader.place, help=help_text))
    if problems:
        raise MarsError(problems)
    return documents


def _moves_of_locks(sections: Sequence[_Section]) -> list[tuple[_Section, _Section]]:
    """Return the sections without inputs, each with the one of its mux, if there is exactly one."""
    owners = [section for section in sections if section.has_inputs()]
    moves = []
    for section in sections:
        if section.has_inputs():
            continue
        same = [owner for owner in owners if owner.names == section.names]
        if not same and len(owners) == 1 and () in (owners[0].names, section.names):
            same = owners
        moves += [(section, owner) for owner in same if len(same) == 1]
    return moves


def read_parts(text: str, path: str) -> MuxDocument:
    """Return the muxes of a YAML file, which may have none, for example only locks.

    Raises:
        MarsError: it is not YAML, or its muxes have errors (all of them are listed).
    """
    return _reader_of(text, path).document()


def _reader_of(text: str, path: str) -> "_MuxReader":
    root = read_yaml(text, path)
    reader = _MuxReader(whole_file(path))
    if isinstance(root, Pairs):
        reader.find(root, ())
    return reader


def read_parameters(root: Pairs, node: str) -> MuxDocument:
    """Return the mux in the parameters that a launch file gives a node.

    Raises:
        MarsError: all errors in the parameters.
    """
    reader = _MuxReader(root.span)
    reader.sections = [_Section(tuple(filter(None, node.split("/"))), root.pairs, listed=True)]
    return reader.document()


class _MuxReader:
    """A reader that collects muxes, skipped contents, errors and warnings."""

    def __init__(self, place: Span) -> None:
        self.place = place
        self.sections: list[_Section] = []
        self.muxes: list[Mux] = []
        self.unread: list[Unread] = []
        self.problems: list[Diagnostic] = []

    def document(self) -> MuxDocument:
        """Read the muxes of all sections; return them, skipped contents and warnings.

        Raises:
            MarsError: the muxes have errors.
        """
        for section in self.sections:
            self.mux(section)
        if any(problem.severity == "error" for problem in self.problems):
            raise MarsError(self.problems)
        return MuxDocument(tuple(self.muxes), tuple(self.unread), tuple(self.problems))

    def wrong(self, span: Span, message: str, help_text: str, *labels: tuple[Span, str]) -> None:
        """Add an error with a message and help to `problems`."""
        self.problems.append(Diagnostic("mux", "error", message, span, labels, help_text))

    def find(self, node: Pairs, names: tuple[str, ...]) -> None:
        """Find the sections of muxes in a map, recursively; `names` are the keys above it."""
        if any(key.text.partition(".")[0] in SORTS for key, _ in node.pairs):
            self.sections.append(_Section(names, node.pairs, listed=True))
            return
        for key, value in node.pairs:
            if key.text == PARAMETERS:
                self.parameters(key, value, names)
            elif isinstance(value, Pairs):
                self.find(value, (*names, key.text.strip("/")))
            else:
                self.unread.append(Unread("parameters", key.text, key.span))

    def parameters(self, key: Scalar, value: Node, names: tuple[str, ...]) -> None:
        """Find the section of a mux below `ros__parameters` of the node `names`, if it is one."""
        if isinstance(value, Items):
            self.wrong(
                key.span,
                f"`{PARAMETERS}` holds a list, which ROS 2 cannot read as parameters",
                f"write a map below `{PARAMETERS}`: `topics:`, and below it each input by its name",
            )
        elif isinstance(value, Pairs):
            if any(k.text.partition(".")[0] in SORTS for k, _ in value.pairs):
                self.sections.append(_Section(names, value.pairs, listed=False))
            else:
                node = "/".join(names) or PARAMETERS
                self.unread.append(Unread("other nodes", node, key.span))

    def mux(self, section: _Section) -> None:
        """Read one mux."""
        entries: dict[Sort, list[_MuxEntry]] = {}
        leaves: list[_Leaf] = []
        output = OUTPUT
        spans: dict[Sort, Span] = {}
        lists: list[tuple[Scalar, str]] = []
        for key, value in section.pairs:
            head = key.text.partition(".")[0]
            sort = next((sort for sort in SORTS if sort == head), None)
            if sort is None:
                if key.text == "publisher" and isinstance(value, Scalar):
                    output = value.text
                else:
                    self.unread.append(Unread("parameters", key.text, key.span))
                continue
            noun = _NOUNS[sort]
            spans.setdefault(sort, part_of(key, 0, len(head)))
            entries.setdefault(sort, [])
            if isinstance(value, Items) and key.text == head:
                if section.listed:
                    entries[sort] += self.listed(value, noun)
                else:
                    lists.append((key, noun))
            elif isinstance(value, Scalar) and key.text == head:
                if value.quoted or value.text.lower() not in ("", "~", "null"):
                    self.wrong(
                        value.span,
                        f"`{head}` is a scalar, not a map of {noun}s",
                        f"name each {noun} below",
                    )
            else:
                leaves += _leaves(key, value)
        for key, noun in lists[:1]:
            self.wrong(
                key.span,
                f"`{key.text}` is a list under `{PARAMETERS}`, which ROS 2 cannot read as"
                " parameters",
                f"write a map: each {noun} by its name, without `-` and `name:`",
                *((other.span, f"and `{other.text}`") for other, _ in lists[1:]),
            )
        for sort in entries:
            own = [leaf for leaf in leaves if leaf.parts[0][0] == sort]
            entries[sort] += self.mapped(own, _NOUNS[sort])
        if not entries.get("topics"):
            unused = entries.get("locks", ())
            self.unread += (Unread("locks", lock.name, lock.span) for lock in unused)
        for listening, engine in _ENGINES.items():
            if entries.get(listening):
                found = tuple(self.inputs(entries[listening]))
                locks: tuple[MuxInput, ...] = ()
                if engine == "twist_mux":
                    locks = tuple(self.inputs(entries.get("locks", ()), "lock"))
                    self.warn_of_high(found, entries[listening])
                    self.warn_of_high(locks, entries.get("locks", ()))
                at = spans[listening]
                name = "/".join(section.names)
                self.muxes.append(Mux(name, engine, at, output, found, locks=locks))

    def listed(self, items: Items, word: str) -> Iterator[_MuxEntry]:
        """Yield the entries of a list of maps, each a `word`; a repeated name gets a number.

        For the twist_mux of ROS 1, which reads lists, names are labels and need not differ.
        """
        seen: set[str] = set()
        times: defaultdict[str, int] = defaultdict(lambda: 1)
        for item in items.nodes:
            if not isinstance(item, Pairs):
                self.wrong(
                    item.span,
                    f"{_with_article(word)} of the list is not a map",
                    "write `- name: NAME` and below it `topic`, `timeout` and `priority`",
                )
                continue
            fields = {key.text: (key, value) for key, value in item.pairs}
            _, name = fields.pop("name", (None, None))
            if isinstance(name, Scalar) and name.text:
                own = name.text
                while own in seen:
                    times[name.text] += 1
                    own = f"{name.text}_{times[name.text]}"
                seen.add(own)
                yield _MuxEntry(own, name.span, fields)
            else:
                self.wrong(
                    beginning(item.span) if name is None else name.span,
                    f"{_with_article(word)} of the list has no name",
                    "add `name: NAME`",
                )

    def mapped(self, leaves: Sequence[_Leaf], word: str) -> Iterator[_MuxEntry]:
        """Yield the entries of maps and dotted keys, each a `word`, in the order of the file."""
        spans: dict[str, Span] = {}
        fields: dict[str, dict[str, tuple[Scalar, Node]]] = {}
        for parts, key, value in leaves:
            if len(parts) < 2:
                continue
            name, span = parts[1]
            if len(parts) == 2:
                if not isinstance(value, Pairs):
                    self.wrong(
                        value.span,
                        f"{word} `{name}` is not a map",
                        "write `topic`, `timeout` and `priority` below its name",
                    )
                    continue
                fields.setdefault(name, {})
                spans.setdefault(name, span)
                continue
            found = fields.setdefault(name, {})
            spans.setdefault(name, span)
            what = ".".join(part for part, _ in parts[2:])
            if what in found:
                first = found[what][0].span
                self.wrong(
                    key.span,
                    f"`{what}` of `{name}` is given twice",
                    "keep one of the two",
                    (first, "and here"),
                )
            found.setdefault(what, (key, value))
        for name, span in spans.items():
            yield _MuxEntry(name, span, fields[name])

    def inputs(self, entries: Sequence[_MuxEntry], word: str = "input") -> Iterator[MuxInput]:
        """Yield the complete inputs of a mux, or its locks, and note the errors of the others."""
        for entry in entries:
            if read_name(written(entry.name)) is None:
                owner = _with_article(word)
                message = f"the name of {owner} is empty, or has a line break or control character"
                self.wrong(entry.span, message, "write a name of one visible line")
            for what, (key, _) in entry.fields.items():
                if what not in _FIELDS:
                    self.unread.append(Unread(f"keys of {word}s", f"{entry.name}.{what}", key.span))
            missing = [what for what in _FIELDS if what not in entry.fields]
            if missing:
                self.wrong(
                    entry.span,
                    f"{word} `{entry.name}` has no {' and no '.join(f'`{m}`' for m in missing)}",
                    "state its topic, its timeout in seconds and its priority",
                )
            topic = self.topic(entry)
            hold = self.hold(entry)
            priority = self.priority(entry)
            if topic is not None and hold is not None and priority is not None:
                yield MuxInput(entry.name, topic, entry.span, priority, hold)

    def warn_of_high(self, inputs: Sequence[MuxInput], entries: Sequence[_MuxEntry]) -> None:
        """Add a warning for inputs with a priority above the limit of twist_mux."""
        high = [each for each in inputs if each.priority > _MOST_TWIST_MUX]
        if high:
            first, *others = high
            fields = {entry.name: entry.fields for entry in entries}
            place, *further = (fields[each.name]["priority"][1].span for each in high)
            message = f"the priority of `{first.name}` is above {_MOST_TWIST_MUX}"
            texts = (f"so is that of `{each.name}`" for each in others)
            labels = tuple(zip(further, texts, strict=True))
            help_text = f"twist_mux keeps priorities from 0 to {_MOST_TWIST_MUX}"
            self.problems.append(
                Diagnostic("mux", "warning", message, place, labels, help_text, kind="mux")
            )

    def field(
        self, entry: _MuxEntry, what: str, expected: str, fits: Callable[[Scalar], object]
    ) -> Scalar | None:
        """Return a scalar that fits, or None; a field that is none is an error (`expected`)."""
        _, value = entry.fields.get(what, (None, None))
        if value is None or (isinstance(value, Scalar) and fits(value)):
            return value
        self.mistyped(entry, what, value, expected)
        return None

    def mistyped(self, entry: _MuxEntry, what: str, value: Node, expected: str) -> None:
        """Add an error that a field has another type than expected."""
        match value:
            case Scalar(text, quoted):
                shown = text if len(text) <= 40 else f"{text[:37]}..."
                # What is empty, or quoted where a number belongs, is not seen otherwise.
                found = f"the text `{shown}`" if quoted else f"`{shown}`" if shown else "nothing"
            case Items():
                found = "a list"
            case _:
                found = "a map"
        self.wrong(
            value.span,
            f"the {what} of `{entry.name}` is {found}, not {expected}",
            f"write {expected}",
        )

    def topic(self, entry: _MuxEntry) -> str | None:
        """Return the topic of an input, or None and add an error."""
        value = self.field(
            entry,
            "topic",
            "the name of a topic",
            lambda found: found.text and (found.quoted or not DECIMAL.fullmatch(found.text)),
        )
        return None if value is None else value.text

    def hold(self, entry: _MuxEntry) -> Hold | None:
        """Return the timeout of an input, or None and add an error."""
        expected = "a number of seconds"
        value = self.field(
            entry, "timeout", expected, lambda v: not v.quoted and DECIMAL.fullmatch(v.text)
        )
        if value is None:
            return None
        seconds = Decimal(value.text)
        if seconds.is_zero():
            return FOREVER
        most = Decimal(MOST) / 1000
        if not 0 < seconds <= most:
            self.mistyped(entry, "timeout", value, f"{expected} from 0 to {most}")
            return None
        milliseconds = seconds.scaleb(3)
        whole = max(1, int(milliseconds.to_integral_value()))
        if milliseconds != whole:
            message = f"the timeout of `{entry.name}`, {value.text} s, is taken as {whole} ms"
            help_text = "holds are whole milliseconds: write at most three decimals"
            self.problems.append(
                Diagnostic("mux", "warning", message, value.span, help=help_text, kind="mux")
            )
        return whole

    def priority(self, entry: _MuxEntry) -> int | None:
        """Return the priority of an input, or None and add an error."""
        expected = f"a whole number from 0 to {MOST}"

        def fits(value: Scalar) -> bool:
            is_whole = not value.quoted and WHOLE.fullmatch(value.text) and len(value.text) < 20
            return bool(is_whole) and 0 <= int(value.text) <= MOST

        value = self.field(entry, "priority", expected, fits)
        return None if value is None else int(value.text)


def _with_article(word: str) -> str:
    return f"an {word}" if word == "input" else f"a {word}"


def _leaves(key: Scalar, value: Node) -> Iterator[_Leaf]:
    """Yield the values of nested maps; `a.b` is the same path as the key `b` in the map of `a`."""
    waiting: list[tuple[tuple[tuple[str, Span], ...], Scalar, Node]] = [((), key, value)]
    while waiting:
        before, at, node = waiting.pop()
        parts, start = before, 0
        for part in at.text.split("."):
            parts = (*parts, (part, part_of(at, start, start + len(part))))
            start += len(part) + 1
        if isinstance(node, Pairs) and (node.pairs or len(parts) == 1):
            waiting += reversed([(parts, inner, below) for inner, below in node.pairs])
        else:
            yield _Leaf(parts, at, node)
