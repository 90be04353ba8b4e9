"""What launch files in Python build: texts with open parts, lists, dictionaries and calls."""

import ast
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from string import Formatter
from typing import TypeAlias

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    Text,
    plain,
    text_of,
)

#: What no launch file needs in one list, and in one text.
MOST_ITEMS = 10_000
MOST_PARTS = 1000
_WHOLE = re.compile(r"-?[0-9]{1,9}")


@dataclass(frozen=True, slots=True)
class PythonCall:
    """A call that was not carried out: what is called, with what."""

    name: str
    arguments: "tuple[Value, ...]"
    named: "Mapping[str, Value]"
    span: Span

    def get(self, name: str, position: int | None = None) -> "Value":
        """Return an argument by its name or its position; the unknown where there is none."""
        if name in self.named:
            return self.named[name]
        if position is not None and position < len(self.arguments):
            return self.arguments[position]
        return None


@dataclass(slots=True)
class Listed:
    """A list, which grows as it does in the file."""

    items: "list[Value]" = field(default_factory=list)
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class MappedValue:
    """A dictionary, of which keys may be texts with open parts."""

    pairs: "tuple[tuple[Value, Value], ...]"


@dataclass(frozen=True, slots=True)
class Local:
    """A function of the file, and the names where it stands."""

    of: ast.FunctionDef | ast.Lambda
    names: "Names" = field(repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class NoneValue:
    """The value `None`, which is false; an unknown value is no object at all."""

    def __bool__(self) -> bool:
        """Return false."""
        return False


@dataclass(frozen=True, slots=True)
class LaunchClass:
    """A class of the file."""

    of: ast.ClassDef


@dataclass(slots=True, eq=False)
class LaunchObject:
    """An object of a class of the file, with its attributes."""

    of: LaunchClass
    attributes: "Names" = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Plain:
    """A text that is there already: strings, substitutions, paths; with its place."""

    text: Text
    span: Span


@dataclass(frozen=True, slots=True)
class Rewritten:
    """A file of parameters, some of which get other values."""

    text: Text
    rewrites: MappedValue
    span: Span


@dataclass(frozen=True, slots=True)
class PythonFile:
    """What a file holds that was opened, or a part of it."""

    text: Text
    span: Span


Value: TypeAlias = (
    Plain
    | PythonFile
    | Rewritten
    | PythonCall
    | Listed
    | MappedValue
    | Local
    | LaunchClass
    | LaunchObject
    | NoneValue
    | None
)
Names: TypeAlias = dict[str, Value]


def text_from(value: Value) -> Text:
    """Return the text that a value is; a list of texts is one, as substitutions are."""
    if isinstance(value, Plain | Rewritten):
        return value.text
    if not isinstance(value, Listed):
        return UNKNOWN
    found: list[Text] = []
    waiting: list[Value] = [value]
    for _ in range(MOST_PARTS):
        if not waiting:
            return text_of(*found)
        each = waiting.pop()
        if isinstance(each, Listed):
            waiting += reversed(each.items[:MOST_PARTS])
        else:
            found.append(text_from(each))
    return UNKNOWN


def items_of(value: Value) -> "list[Value]":
    """Return the items of a list, none of all else."""
    return value.items if isinstance(value, Listed) else []


def each_of(value: Value) -> "list[Value]":
    """Return the rounds of a loop over a value, one without a known item where it is not known."""
    if isinstance(value, MappedValue):
        return [key for key, _ in value.pairs]
    return list(value.items) if isinstance(value, Listed) else [None]


def filled(text: Text, arguments: "Sequence[Value]", named: "Mapping[str, Value]") -> Text:
    """Return a text with values in place of its braces, as `str.format` puts them there."""
    template = plain(text)
    if template is None:
        return UNKNOWN
    found: list[Text] = []
    given = {**{str(at): value for at, value in enumerate(arguments)}, **named}
    try:
        pieces = list(Formatter().parse(template))
    except ValueError:
        return UNKNOWN
    position = 0
    for literal, name, form, _ in pieces[:MOST_PARTS]:
        found.append((literal,))
        if name is not None:
            found.append(UNKNOWN if form else text_from(given.get(name or str(position))))
            position += not name
    return text_of(*found)


def summed(first: Value, second: Value) -> Value:
    """Return the sum of two values: a longer list, or a longer text."""
    match first, second:
        case Listed(items), Listed(more):
            return Listed([*items, *more][:MOST_ITEMS], first.span)
        case Plain(text, span), _:
            return Plain(text_of(text, text_from(second)), span)
        case _, Plain(text, span):
            return Plain(text_of(text_from(first), text), span)
        case Listed(), _:
            return first
        case _, Listed():
            return second
        case _:
            return None


def counted(call: PythonCall) -> Value:
    """Return the values of `range`, `enumerate` or `zip`, as far as they are written out."""
    if call.name == "range":
        texts = [plain(text_from(each)) for each in call.arguments]
        bounds = [int(text) for text in texts if text is not None and _WHOLE.fullmatch(text)]
        if not bounds or len(bounds) != len(texts) or bounds[2:] == [0]:
            return None
        return Listed([Plain((str(n),), call.span) for n in range(*bounds[:3])[:MOST_PARTS]])
    lists = [each_of(each) for each in call.arguments]
    if call.name == "enumerate":
        lists = (
            [[Plain((str(n),), call.span) for n in range(len(lists[0]))], *lists[:1]]
            if lists
            else []
        )
    return Listed([Listed(list(each)) for each in zip(*lists, strict=False)])


def picked(owner: Value, key: Value) -> Value:
    """Return the item of a list or dictionary at a key, or the file of which it is a part."""
    if isinstance(owner, PythonFile):
        return owner
    at = plain(text_from(key)) if key is not None else None
    match owner:
        case Listed(items) if at is not None and at.lstrip("-").isdigit():
            index = int(at)
            return items[index] if -len(items) <= index < len(items) else None
        case MappedValue(pairs):
            return next((v for k, v in pairs if k is not None and plain(text_from(k)) == at), None)
        case _:
            return None


def folder_of(text: Text) -> Text:
    """Return the folder of a path."""
    if text and isinstance(text[-1], str):
        above, slash, last = text[-1].rpartition("/")
        # The folder above another is not that one.
        if slash and last != "..":
            return text_of(*text[:-1], above)
    return text_of(*text, "/..")


def path_of(*parts: Text) -> Text:
    """Return a path of parts."""
    joined: list[Text] = []
    for part in parts:
        if joined:
            joined.append(("/",))
        joined.append(part)
    return text_of(*joined)
