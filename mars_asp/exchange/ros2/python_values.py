"""Values that Python builds, texts with open parts among them, and the table of known calls."""

import ast
import operator
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from string import Formatter
from typing import TypeAlias

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    LaunchArgument,
    LaunchDirectory,
    PackageShare,
    Text,
    plain,
    text_of,
)

#: What no launch file needs in one list, and in one text.
MOST_ITEMS = 10_000
MOST_PARTS = 1000
_WHOLE = re.compile(r"-?[0-9]{1,9}")
_PERCENT = re.compile(r"%[sd]")
_ARITHMETIC = {ast.Add: operator.add, ast.Mult: operator.mul, ast.Div: operator.truediv}
#: A longer numerator or denominator is of no quantity.
MOST_BITS = 256
#: Functions that return one of their arguments as a path.
_PATHS = frozenset(
    {"abspath", "realpath", "normpath", "expanduser", "Path", "str", "PathSubstitution"}
    | {"FileContent"}
)
_SHARES = frozenset(
    {
        "get_package_share_directory",
        "get_package_share_path",
        "FindPackageShare",
        "FindPackage",
        "FindPackagePrefix",
    }
)


#: Methods that return the same text without some of its ends, and those that keep it.
_STRIPS = frozenset({"strip", "lstrip", "rstrip"})
_KEEPS = frozenset({"perform", "as_posix", "resolve", "absolute"})


@dataclass(frozen=True, slots=True)
class PythonCall:
    """A call that was not evaluated: the name of its function, and its arguments."""

    name: str
    arguments: "tuple[Value, ...]"
    named: "Mapping[str, Value]"
    span: Span

    def get(self, name: str, position: int | None = None) -> "Value":
        """Return an argument by name or position; None (unknown) if it is not passed."""
        if name in self.named:
            return self.named[name]
        if position is not None and position < len(self.arguments):
            return self.arguments[position]
        return None


@dataclass(slots=True)
class Listed:
    """A list, which may be appended to."""

    items: "list[Value]" = field(default_factory=list)
    span: Span | None = None


@dataclass(frozen=True, slots=True, match_args=False)
class MappedValue:
    """A dictionary, of which keys may be texts with open parts.

    `entries` are in the order in which they were set, those that were replaced among them.
    """

    __match_args__ = ("pairs",)
    entries: "tuple[tuple[Value, Value], ...]"

    @property
    def pairs(self) -> "tuple[tuple[Value, Value], ...]":
        """Return the keys with their last values; a key that is not known replaces none."""
        last: dict[int | str, tuple[Value, Value]] = {}
        for number, pair in enumerate(self.entries):
            at = _key(pair[0])
            last[number if at is None else at] = pair
        return tuple(last.values())

    def without(self, key: "Value") -> "MappedValue":
        """Return the dictionary without the entry of a key; the same if the key is not known."""
        at = _key(key)
        return MappedValue(tuple(e for e in self.entries if at is None or _key(e[0]) != at))

    def updated(self, *entries: "tuple[Value, Value]") -> "MappedValue":
        """Return the dictionary with further entries, which replace those of equal keys."""
        # To look for the replaced ones here would take the square of many assignments.
        return MappedValue((*self.entries, *entries)[:MOST_ITEMS])


@dataclass(frozen=True, slots=True)
class Local:
    """A function of the file, and the names that are visible at its definition."""

    of: ast.FunctionDef | ast.Lambda
    names: "Names" = field(repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class NoneValue:
    """The constant `None` of a launch file, whereas Python's None is an unknown value."""


@dataclass(frozen=True, slots=True)
class LaunchClass:
    """A class that the launch file itself defines; `of` is its definition."""

    of: ast.ClassDef


@dataclass(slots=True, eq=False)
class LaunchObject:
    """An object of a class of the file, with its attributes."""

    of: LaunchClass
    attributes: "Names" = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Plain:
    """A known text: a string, a substitution, a path or a number, with its location."""

    text: Text
    span: Span
    number: Fraction | None = None


@dataclass(frozen=True, slots=True)
class PythonName:
    """A name that is imported from outside the workspace, such as that of a message type."""

    full: str


@dataclass(frozen=True, slots=True)
class Rewritten:
    """A parameter file with replaced values, as of `RewrittenYaml`."""

    text: Text
    rewrites: MappedValue
    span: Span


@dataclass(frozen=True, slots=True)
class PythonFile:
    """The content of an opened file, or a part of it."""

    text: Text
    span: Span


Value: TypeAlias = (
    Plain
    | PythonName
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
    """Return the text of a value, `UNKNOWN` if it has none; a list of texts is concatenated."""
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
    """Return the items of a list; an empty list for other values."""
    return value.items if isinstance(value, Listed) else []


def each_of(value: Value) -> list[Value]:
    """Return the items over which a loop runs; one unknown item if they are unknown."""
    items = _known_items(value)
    return [None] if items is None else items


def _known_items(value: Value) -> list[Value] | None:
    if isinstance(value, MappedValue):
        return [key for key, _ in value.pairs]
    return list(value.items) if isinstance(value, Listed) else None


def inserted(value: Value) -> Text:
    """Return the text of a value as `str()` would insert it, `UNKNOWN` for a list."""
    return UNKNOWN if isinstance(value, Listed) else text_from(value)


def filled(
    text: Text, arguments: Sequence[Value], named: Mapping[str, Value], by_percent: bool = False
) -> Text:
    """Return a text with placeholders replaced, as by `str.format` or, if `by_percent`, by `%`."""
    template = plain(text)
    if template is None:
        return UNKNOWN
    pieces: list[tuple[str, str | None, str | None]]
    if by_percent:
        *before, last = _PERCENT.split(template)
        if len(before) != len(arguments) or any("%" in each for each in (*before, last)):
            return UNKNOWN
        pieces = [*((each, "", "") for each in before), (last, None, None)]
    else:
        try:
            pieces = [each[:3] for each in Formatter().parse(template)]
        except ValueError:
            return UNKNOWN
    found: list[Text] = []
    given = {**{str(at): value for at, value in enumerate(arguments)}, **named}
    position = 0
    for literal, name, form in pieces[:MOST_PARTS]:
        found.append((literal,))
        if name is not None:
            found.append(UNKNOWN if form else inserted(given.get(name or str(position))))
            position += not name
    return text_of(*found)


def combined(sign: ast.operator, first: Value, second: Value, span: Span) -> Value:
    """Return the result of an operation: a number, path, text or list; None if unknown."""
    match first, second:
        case Plain(number=Fraction() as left), Plain(number=Fraction() as right):
            return _calculated(sign, (left, right), (plain(first.text), plain(second.text)), span)
        case _ if isinstance(sign, ast.Div):
            return Plain(path_of(text_from(first), text_from(second)), span)
        case _ if not isinstance(sign, ast.Add):
            return None
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


def _calculated(
    sign: ast.operator, numbers: tuple[Fraction, Fraction], texts: Sequence[str | None], span: Span
) -> Value:
    """Return the exact result of an operation on numbers, or None if it has none."""
    if isinstance(sign, ast.Div) and not numbers[1]:
        return None
    number = _ARITHMETIC[type(sign)](*numbers)
    if max(number.numerator.bit_length(), number.denominator.bit_length()) > MOST_BITS:
        return None
    if None in texts:
        return Plain(UNKNOWN, span, number)
    is_whole = not isinstance(sign, ast.Div) and all(_WHOLE.fullmatch(each or "") for each in texts)
    return Plain((str(number) if is_whole else repr(float(number)),), span, number)


def counted(call: PythonCall) -> Value:
    """Return the values of `range`, `enumerate` or `zip` as a list, or None if unknown."""
    if call.name == "range":
        texts = [plain(text_from(each)) for each in call.arguments]
        bounds = [int(text) for text in texts if text is not None and _WHOLE.fullmatch(text)]
        if not bounds or len(bounds) != len(texts) or bounds[2:] == [0]:
            return None
        return Listed([_whole(n, call.span) for n in range(*bounds[:3])[:MOST_PARTS]])
    columns = [_known_items(each) for each in call.arguments]
    if call.name == "enumerate":
        items = each_of(call.get("iterable", 0))
        start = call.get("start", 1)
        first = "0" if start is None else plain(text_from(start)) or ""
        if not _WHOLE.fullmatch(first):
            return None
        columns = [[_whole(int(first) + n, call.span) for n in range(len(items))], items]
    # A list that only a run knows is as long as the others.
    size = min((len(each) for each in columns if each is not None), default=1)
    rows = zip(*([None] * size if each is None else each for each in columns), strict=False)
    return Listed([Listed(list(row)) for row in rows])


def _whole(number: int, span: Span) -> Plain:
    return Plain((str(number),), span, Fraction(number))


def _key(value: Value) -> str | None:
    """Return the text of a key, or None if it is not known."""
    return None if value is None else plain(text_from(value))


def picked(owner: Value, key: Value) -> Value:
    """Return the item at a key, None if unknown; of a file's content, the file itself."""
    if isinstance(owner, PythonFile):
        return owner
    at = _key(key)
    match owner:
        case Listed(items) if at is not None and _WHOLE.fullmatch(at):
            index = int(at)
            return items[index] if -len(items) <= index < len(items) else None
        case MappedValue(pairs):
            return next((v for k, v in pairs if k is not None and _key(k) == at), None)
        case _:
            return None


def folder_of(text: Text) -> Text:
    """Return the folder that contains a path: without its last part, or with `/..` added."""
    if text and isinstance(text[-1], str):
        above, slash, last = text[-1].rpartition("/")
        # The folder above another is not that one.
        if slash and last != "..":
            return text_of(*text[:-1], above)
    return text_of(*text, "/..")


def path_of(*parts: Text) -> Text:
    """Return the parts joined to a path."""
    return join_texts(("/",), parts)


def join_texts(between: Text, parts: Iterable[Text]) -> Text:
    """Return texts joined by a separator."""
    return text_of(*[each for part in parts for each in (between, part)][1:])


class NotKnown:
    """The result of a method that is not supported."""


NOT_KNOWN = NotKnown()


def known(call: PythonCall) -> Value:  # noqa: C901 -- one case for each function
    """Return the value of a call of a supported function, else the call itself."""
    first = call.arguments[0] if call.arguments else None
    match call.name:
        case "LaunchDescription":
            entities = call.get("initial_entities", 0)
            copy = Listed(list(items_of(entities)), call.span)
            return PythonCall(call.name, (copy,), {}, call.span)
        case "LaunchConfiguration" | "LaunchConfigAsBool":
            name = plain(text_from(call.get("variable_name", 0)))
            default = call.named.get("default")
            if name is None:
                return Plain(UNKNOWN, call.span)
            text = None if default is None else text_from(default)
            return Plain((LaunchArgument(name, text),), call.span)
        case "TextSubstitution":
            return Plain(text_from(call.get("text", 0)), call.span)
        case "ThisLaunchFileDir":
            return Plain((LaunchDirectory(),), call.span)
        case "EnvironmentVariable" | "getenv":
            called = plain(text_from(call.get("name", 0)))
            value = call.get("default_value", 1)
            otherwise = None if value is None else text_from(value)
            return Plain((LaunchArgument(f"env {called}", otherwise),), call.span)
        case "PathJoinSubstitution" | "PathJoin":
            parts = items_of(first) if isinstance(first, Listed) else call.arguments
            return Plain(path_of(*map(text_from, parts)), call.span)
        case "join":
            return Plain(path_of(*map(text_from, call.arguments)), call.span)
        case "dirname":
            return Plain(folder_of(text_from(first)), call.span)
        case "open" | "safe_load" | "full_load" | "load":
            # Of a file of parameters it is enough to know which.
            return PythonFile(
                first.text if isinstance(first, PythonFile) else text_from(first), call.span
            )
        case "ParameterFile":
            file = call.get("param_file", 0)
            return file if isinstance(file, Rewritten) else Plain(text_from(file), call.span)
        case "RewrittenYaml":
            rewrites = call.get("param_rewrites", 1)
            given = rewrites if isinstance(rewrites, MappedValue) else MappedValue(())
            return Rewritten(text_from(call.get("source_file", 0)), given, call.span)
        case "ReplaceString":
            return Plain(text_from(call.get("source_file", 0)), call.span)
        case "ParameterValue":
            return call.get("value", 0)
        case "list" | "tuple" | "sorted" | "reversed":
            return first
        case "range" | "enumerate" | "zip":
            return counted(call)
        case "dict":
            pairs = tuple((Plain((key,), call.span), value) for key, value in call.named.items())
            return MappedValue((*(first.pairs if isinstance(first, MappedValue) else ()), *pairs))
        case name if name in _SHARES:
            return Plain((PackageShare(text_from(call.get("package", 0))),), call.span)
        case name if name in _PATHS:
            return Plain(path_of(*map(text_from, call.arguments)), call.span)
        case _:
            return call


def known_method(
    owner: Value, name: str, arguments: Sequence[Value], named: Mapping[str, Value]
) -> Value | NotKnown:
    """Return the result of a method of a list, dictionary or text; it may change the list."""
    first = arguments[0] if arguments else None
    match owner, name:
        case Listed(), "append":
            owner.items += [first][: MOST_ITEMS - len(owner.items)]
            return None
        case Listed(), "extend":
            owner.items += items_of(first)[: MOST_ITEMS - len(owner.items)]
            return None
        case Listed(), "insert":
            owner.items += arguments[1:2][: MOST_ITEMS - len(owner.items)]
            return None
        case MappedValue(pairs), "items":
            return Listed([Listed([key, value]) for key, value in pairs])
        case MappedValue(pairs), "keys" | "values":
            return Listed([pair[name == "values"] for pair in pairs])
        case MappedValue(), "get":
            return picked(owner, first)
        case Plain(text, span), "format":
            return Plain(filled(text, arguments, named), span)
        case Plain(text, span), "join":
            parts = map(inserted, items_of(first)) if isinstance(first, Listed) else (UNKNOWN,)
            return Plain(join_texts(text, parts), span)
        case Plain((PackageShare(),), span), "find":
            # FindPackageShare looks for the package that this method names.
            return Plain((PackageShare(text_from(first)),), span)
        case Plain(text, span), _ if name in _STRIPS and plain(text) is not None:
            ends = [plain(text_from(each)) for each in arguments[:1]]
            stripped = getattr(plain(text), name)(*ends)
            return Plain(UNKNOWN if None in ends else (stripped,), span)
        case Plain(), _ if name in _KEEPS or (name == "strip" and not arguments):
            return owner
        case Plain(text, span), "joinpath":
            return Plain(path_of(text, *map(text_from, arguments)), span)
        case _:
            return NOT_KNOWN
