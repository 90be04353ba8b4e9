"""Parameters, parameter files and remappings of a node in a launch file in Python."""

from collections.abc import Iterator, Sequence

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    Declare,
    NodeParameter,
    Part,
    Reads,
    Remap,
    Text,
    plain,
    text_of,
)
from mars_asp.exchange.ros2.python_values import (
    MOST_ITEMS,
    Listed,
    MappedValue,
    Plain,
    PythonCall,
    PythonFile,
    Rewritten,
    Value,
    items_of,
    text_from,
)


def declared_by(call: PythonCall) -> Iterator[Declare]:
    """Yield the launch argument that a `DeclareLaunchArgument` declares, if its name is known."""
    name = plain(text_from(call.get("name", 0)))
    if name is not None:
        default = call.get("default_value")
        value = None if default is None else text_from(default)
        yield Declare(name, value, call.span)


def read_by(call: PythonCall) -> Iterator[Reads]:
    """Yield the files that a call opens to read, or passes to a command such as xacro."""
    match call.name:
        case "Command":
            yield Reads(text_from(call.get("command", 0)), call.span)
        case "process_file" | "FileContent":
            yield Reads(text_from(call.arguments[0] if call.arguments else None), call.span)
        case "open":
            mode = plain(text_from(call.get("mode", 1))) or "r"
            if mode.startswith("r"):
                yield Reads(text_from(call.get("file", 0)), call.span)


def parameters_of(value: Value, span: Span) -> Iterator[NodeParameter]:
    """Yield the parameters of a dictionary or a list of pairs; `span` is its location."""
    if isinstance(value, MappedValue):
        yield from (parameter_of(((key, span),), given, span) for key, given in value.pairs)
    for item in items_of(value):
        if isinstance(item, Listed) and len(item.items) == 2:
            yield parameter_of(((item.items[0], span),), item.items[1], span)


def parameter_of(keys: Sequence[tuple[Value, Span]], value: Value, span: Span) -> NodeParameter:
    """Return the parameter with a value; `keys` are the steps of its name.

    Locations in the arguments are for values that have none.
    """
    steps = tuple((text_from(key), _place_of(key, place)) for key, place in keys)
    # Texts without open parts are a list; with substitutions they are one text.
    items = tuple(map(text_from, value.items)) if isinstance(value, Listed) else ()
    is_list = len(items) > 0 and all(plain(item) is not None for item in items)
    return NodeParameter(
        steps, text_from(value), _place_of(value, span), items if is_list else None
    )


def _place_of(value: Value, otherwise: Span) -> Span:
    span = value.span if isinstance(value, Plain | PythonFile | Listed | PythonCall) else None
    return otherwise if span is None else span


def forced(value: Value, span: Span) -> Iterator[Declare]:
    """Yield the launch arguments that a dictionary sets, as declarations with forced values."""
    for each in parameters_of(value, span):
        name = plain(each.name)
        if name is not None:
            yield Declare(name, each.value, each.span, forced=True)


def given_to(value: Value, span: Span) -> tuple[tuple[Text, ...], tuple[NodeParameter, ...]]:
    """Return the parameter files and the single parameters in the value of `parameters=`."""
    files: list[Text] = []
    parameters: list[NodeParameter] = []
    for item in items_of(value) or ([] if value is None else [value]):
        if isinstance(item, MappedValue):
            parameters += _nested_parameters(item, span)
        elif isinstance(item, PythonCall) and item.name == "PythonExpression":
            # `"A" if HasNodeParams(A) else "B"`: B is used where A has nothing for the node.
            files += _texts_in_quotes(text_from(item.get("expression", 0)))[::-1] or [UNKNOWN]
        else:
            files.append(item.text if isinstance(item, PythonFile) else text_from(item))
        if isinstance(item, Rewritten):
            parameters += _nested_parameters(item.rewrites, item.span)
    return tuple(files), tuple(parameters)


def _texts_in_quotes(text: Text) -> list[Text]:
    """Return the texts between double quotes in an expression."""
    pieces: list[list[Part]] = [[]]
    for part in text:
        first, *others = part.split('"') if isinstance(part, str) else (part,)
        pieces[-1].append(first)
        pieces += [[each] for each in others]
    return [text_of(*((part,) for part in piece)) for piece in pieces[1::2]]


def _nested_parameters(value: MappedValue, span: Span) -> Iterator[NodeParameter]:
    """Yield the values of nested dictionaries as parameters, in their order."""
    waiting: list[tuple[tuple[tuple[Value, Span], ...], Value]] = [((), value)]
    for _ in range(MOST_ITEMS):
        if not waiting:
            return
        keys, held = waiting.pop()
        if isinstance(held, MappedValue) and len(waiting) < MOST_ITEMS:
            waiting += [((*keys, (key, span)), inner) for key, inner in reversed(held.pairs)]
        else:
            yield parameter_of(keys, held, span)


def remaps_of(call: PythonCall) -> tuple[tuple[Remap, ...], tuple[tuple[str, Span], ...]]:
    """Return the known remappings of a node, and the texts and locations of unknown ones."""
    found: list[Remap] = []
    unread: list[tuple[str, Span]] = []
    value = call.named.get("remappings")
    if "remappings" in call.named and not isinstance(value, Listed):
        unread.append(("remappings", call.span))
    for item in items_of(value):
        if isinstance(item, Listed) and len(item.items) == 2:
            source, target = map(text_from, item.items)
            found.append(Remap(source, target, item.span or call.span))
        else:
            unread.append(("remappings", item.span if isinstance(item, Plain) else call.span))
    return tuple(found), tuple(unread)
