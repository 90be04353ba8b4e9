"""Read launch files of ROS 2 in XML and YAML, and of ROS 1, as actions."""

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from mars_asp.diagnostic import Diagnostic, MarsError, Span, beginning
from mars_asp.exchange.elements import XmlElement, read_elements
from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    Action,
    Declare,
    IncludeAction,
    LaunchArgument,
    LaunchDirectory,
    LaunchGroup,
    NodeParameter,
    PackageShare,
    Part,
    PushNamespace,
    Reads,
    Remap,
    SetParameters,
    Start,
    Test,
    Tests,
    Text,
    Undeclared,
    text_of,
    together,
)
from mars_asp.exchange.ros2.commands import of_command
from mars_asp.exchange.ros2.conditions import tests_of_text
from mars_asp.exchange.unread import CONTAINERS, Unread
from mars_asp.exchange.yaml_document import Items, Node, Pairs, Scalar, read_yaml

_DEEPEST = 60
_LONGEST_EXPRESSION = 500
#: What begins a substitution, and what may end or nest in one.
_MARK = re.compile(r"\$\(|\)")
_PARENTHESIS = re.compile(r"[()]")
#: In an expression a text, or an argument by its name.
_BARE_NAME = re.compile(
    r"""'[^']*'|"[^"]*"|arg\(\s*['"](?P<called>\w+)['"]\s*\)|(?P<name>[A-Za-z_]\w*)"""
)
_WORDS_OF_PYTHON = frozenset("and or not in is if else True False None true false int str".split())
#: An argument that a text of ROS 1 reads.
_ARGUMENT = re.compile(r"\$\(arg\s+(\w+)\s*\)")
_COMMAND = re.compile(r"\$\(command (.*)\)", re.DOTALL)
#: What holds no node and changes no name.
_PASSED = frozenset("env set_env unset_env log sys_setting machine master timer_period".split())


def read_markup(text: str, path: str) -> tuple[Action, ...]:
    """Return the actions of a launch file in XML or YAML.

    Raises:
        MarsError: it is neither, or no launch file.
    """
    if text.lstrip().startswith("<"):
        root = _of_element(read_elements(text, path, _DEEPEST, whole=True, code="launch"))
        if root.name != "launch":
            raise _markup_error(root.span, f"the document is `{root.name}`, not `launch`")
        undeclared = _undeclared(root) if path.endswith(".launch") else ()
        return (*undeclared, *_actions(root.children))
    document = read_yaml(text, path)
    if isinstance(document, Pairs):
        for key, value in document.pairs:
            if key.text == "launch":
                return tuple(_actions(list(_yaml_entities(value))))
    raise _markup_error(
        beginning(document.span), "the file has no `launch:` with a list of actions"
    )


def _undeclared(root: XmlElement) -> Iterator[Undeclared]:
    """Yield the arguments that the file certainly reads, and that it does not declare.

    In ROS 1 arguments belong to one file. Each attribute of an element is evaluated, unless the
    element is in one with a condition.
    """
    declared: set[str] = set()
    read: dict[str, Span] = {}
    waiting = [(root, False)]
    while waiting:
        entity, is_conditional = waiting.pop()
        for text in () if is_conditional else entity.attributes.values():
            for name in _ARGUMENT.findall(text):
                read.setdefault(name, entity.span)
        is_conditional |= not entity.attributes.keys().isdisjoint(("if", "unless"))
        for child in reversed(entity.children):
            if child.name == "arg" and entity.name != "include":
                declared.add(child.attributes.get("name", ""))
            waiting.append((child, is_conditional))
    for name, span in read.items():
        if name not in declared:
            yield Undeclared(name, span)


def _markup_error(place: Span, message: str) -> MarsError:
    help_text = "is this a launch file? name one in Python, XML or YAML"
    return MarsError((Diagnostic("launch", "error", message, place, help=help_text),))


def _of_element(element: XmlElement) -> XmlElement:
    path, line, column, _, _ = element.span
    span = Span(path, line, column, line, column + 1 + len(element.name))
    children = list(map(_of_element, element.children))
    return replace(element, name=element.name.replace("-", "_"), span=span, children=children)


def _yaml_entities(value: Node) -> Iterator[XmlElement]:
    """Yield the elements of a list of actions in YAML, whose items are maps by element names."""
    for item in value.nodes if isinstance(value, Items) else (value,):
        if isinstance(item, Pairs):
            for key, inner in item.pairs:
                yield _of_pair(key, inner)


def _of_pair(key: Scalar, value: Node) -> XmlElement:
    """Return an entry of YAML as the XML element that it corresponds to."""
    name = key.text.replace("-", "_")
    attributes: dict[str, str] = {}
    children: list[XmlElement] = []
    match value:
        case Pairs(pairs):
            for inner, held in pairs:
                if isinstance(held, Scalar):
                    attributes[inner.text] = held.text
                elif isinstance(held, Items) and inner.text not in ("children", "actions"):
                    children += (_of_pair(_at(inner, each), each) for each in held.nodes)
                elif isinstance(held, Items):
                    children += _yaml_entities(held)
                else:
                    children.append(_of_pair(inner, held))
        case Items():
            children += _yaml_entities(value)
        case Scalar(text):
            attributes["value"] = text
    return XmlElement(name, attributes, key.span, children)


def _at(key: Scalar, item: Node) -> Scalar:
    """Return the key of a list as the key of one of its items, located at the item."""
    first = item.pairs[0][0] if isinstance(item, Pairs) and item.pairs else item
    return Scalar(key.text, key.quoted, first.span)


def _text(entity: XmlElement, *names: str) -> Text | None:
    """Return the first existing attribute of some names as a text, or None without any."""
    return next((substituted(entity.attributes[n]) for n in names if n in entity.attributes), None)


def _actions(entities: Sequence[XmlElement]) -> Iterator[Action]:
    """Yield the actions of elements, in their order."""
    for entity in entities:
        tests = _tests(entity)
        match entity.name:
            case "node" | "composable_node":
                yield from _started_node(entity, tests)
            case "node_container" | "load_composable_node":
                if entity.name == "node_container":
                    called = entity.attributes.get("name", "?")
                    yield Unread(CONTAINERS, called, entity.span)
                inner = tuple(_actions(list(entity.named("composable_node"))))
                yield together(inner, tests)
            case "group":
                namespace = _text(entity, "ns")
                pushed = () if not namespace else (PushNamespace(namespace, entity.span),)
                scoped = entity.attributes.get("scoped", "true").lower() != "false"
                yield LaunchGroup((*pushed, *_actions(entity.children)), scoped, tests)
            case "include":
                yield from _included(entity, tests)
            case "push_ros_namespace" | "push_namespace":
                named = _text(entity, "namespace", "ns", "value") or UNKNOWN
                yield PushNamespace(named, entity.span)
            case "remap" | "set_remap":
                yield _remap(entity)
            case "arg" | "let" | "declare_arg":
                yield from _declared_argument(entity)
            case "set_parameter" | "rosparam" | "set_parameters_from_file":
                yield SetParameters(*_given((entity,)))
            case "executable":
                command = _text(entity, "cmd") or UNKNOWN
                yield of_command((command,), entity.span, tests)
            case "test":
                called = entity.attributes.get("name", "?")
                yield Unread("programs that are not nodes", called, entity.span)
            case "param":
                yield from _read_by(entity)
            case name if name in _PASSED:
                continue
            case _:
                yield together(tuple(_actions(entity.children)), tests)


def _tests(entity: XmlElement) -> Tests:
    """Return the tests for an element's start, from `if` and `unless`."""
    found: list[Test] = []
    for name in ("if", "unless"):
        written = entity.attributes.get(name)
        if written is not None:
            inner = written.strip()
            if inner.startswith("$(eval ") and inner.endswith(")"):
                text = text_of(*_evaluated(inner[7:-1]))
            else:
                text = substituted(inner)
            found += tests_of_text(text, name == "if", entity.span)
    return tuple(found)


def _evaluated(written: str) -> Iterator[Part | Text]:
    """Yield the parts of an expression: substitutions of ROS 2, or bare argument names of ROS 1."""
    inside = written.strip()
    if len(inside) > 1 and inside[0] == inside[-1] and inside[0] in "'\"" and "$(" in inside:
        inside = inside[1:-1]
    if "$(" in inside:
        yield substituted(inside)
        return
    at = 0
    for match in _BARE_NAME.finditer(inside):
        name = match["called"] or match["name"]
        if name is not None and name not in _WORDS_OF_PYTHON:
            yield inside[at : match.start()]
            yield LaunchArgument(name)
            at = match.end()
    yield inside[at:]


def _started_node(entity: XmlElement, tests: Tests) -> Iterator[Action]:
    """Yield the node that an element starts, with its tests."""
    package = _text(entity, "pkg", "package") or UNKNOWN
    plugin = entity.name == "composable_node"
    executable = _text(entity, "plugin") if plugin else _text(entity, "exec", "type", "executable")
    arguments, ros_arguments = _text(entity, "args"), _text(entity, "ros_args")
    for_ros: tuple[Text, ...] = (("--ros-args",), ros_arguments) if ros_arguments else ()
    words = [part for part in arguments or () if isinstance(part, str)]
    if package == ("nodelet",) and not plugin:
        load = " ".join(words).split()
        called = entity.attributes.get("name", "?")
        if len(load) < 2 or load[0] not in ("load", "standalone"):
            yield Unread(CONTAINERS, called, entity.span)
            return
        # ROS 1 writes the class of a component after its package: `package/Class`.
        plugin, executable = True, text_of(load[1])
        package = text_of(load[1].partition("/")[0])
    files, parameters = _given(entity.children)
    for child in entity.named("param"):
        yield from _read_by(child)
    yield Start(
        entity.span,
        package,
        executable or UNKNOWN,
        plugin,
        _text(entity, "name"),
        _text(entity, "namespace", "ns"),
        tuple(_remap(child) for child in entity.named("remap")),
        files,
        parameters,
        tuple(filter(None, (arguments, *for_ros))),
        tests,
    )


def _included(entity: XmlElement, tests: Tests) -> Iterator[Action]:
    path = _text(entity, "file") or UNKNOWN
    namespace = _text(entity, "ns")
    given = tuple(
        NodeParameter(
            ((_text(each, "name") or UNKNOWN, each.span),),
            _text(each, "value", "default") or (),
            each.span,
            tests=_tests(each),
        )
        for each in entity.children
        if each.name in ("arg", "let")
    )
    # Only ROS 1 writes `$(find ...)`, and passes arguments on where it is asked to.
    passed = entity.attributes.get("pass_all_args", "false").lower() in ("true", "1")
    file = entity.attributes.get("file", "")
    is_old = entity.span.path.endswith(".launch") and "$(find-pkg-" not in file
    inherits = passed or not (is_old or "$(find " in file)
    include = IncludeAction(path, entity.span, given, tests, inherits)
    yield LaunchGroup((PushNamespace(namespace, entity.span), include)) if namespace else include


def _declared_argument(entity: XmlElement) -> Iterator[Declare]:
    name = entity.attributes.get("name")
    if name is not None:
        forced = "value" in entity.attributes
        yield Declare(name, _text(entity, "value", "default"), entity.span, forced, _tests(entity))


def _remap(entity: XmlElement) -> Remap:
    source, target = _text(entity, "from", "src"), _text(entity, "to", "dst")
    return Remap(source or UNKNOWN, target or UNKNOWN, entity.span)


def _given(entities: Sequence[XmlElement]) -> tuple[tuple[Text, ...], tuple[NodeParameter, ...]]:
    """Return the parameter files, and the single parameters, that elements of a node state."""
    files: list[Text] = []
    parameters: list[NodeParameter] = []
    for entity in entities:
        if entity.name in ("param", "rosparam", "set_parameter", "set_parameters_from_file"):
            file = _text(entity, "from", "file", "filename")
            if file is not None:
                files.append(file)
            else:
                parameters += _parameter_values(entity, ())
                parameters += _yaml_parameters(entity)
    return tuple(files), tuple(parameters)


def _read_by(entity: XmlElement) -> Iterator[Reads]:
    """Yield the files that a parameter element reads, or passes to a command such as xacro."""
    command = _COMMAND.fullmatch(entity.attributes.get("value", ""))
    within = None if command is None else substituted(command[1].strip("'\""))
    for words in (_text(entity, "command"), _text(entity, "textfile"), within):
        if words is not None:
            yield Reads(words, entity.span)


def _parameter_values(
    entity: XmlElement, before: tuple[tuple[Text, Span], ...]
) -> Iterator[NodeParameter]:
    """Yield a parameter and those nested in it; `before` are the outer steps of its name."""
    name = _text(entity, "name")
    if name is None:
        return
    keys = (*before, (name, entity.span))
    value = _text(entity, "value")
    listed = tuple(_text(each, "value") or () for each in entity.named("value"))
    if listed:
        yield NodeParameter(keys, (), entity.span, listed)
    if value is not None:
        apart = entity.attributes.get("value-sep", entity.attributes.get("value_sep"))
        shown = entity.attributes["value"]
        words = shown.split(apart) if apart else None
        # ROS 2 takes a value for YAML, in which a list has brackets.
        listing = re.fullmatch(r"\s*\[([^][]*)\]\s*", shown)
        if listing and not words:
            words = [word.strip(" \t\n'\"") for word in listing[1].split(",") if word.strip()]
        items = None if words is None else tuple(map(substituted, words))
        yield NodeParameter(keys, value, entity.span, items)
    for inner in entity.named("param"):
        yield from _parameter_values(inner, keys)


def _yaml_parameters(entity: XmlElement) -> Iterator[NodeParameter]:
    """Yield the parameters that are written out as YAML within an element of ROS 1.

    Raises:
        MarsError: the text is not YAML.
    """
    if entity.name != "rosparam" or not any(text.strip() for _, _, text in entity.pieces):
        return
    (line, before, _), *_ = entity.pieces
    text = "".join(piece for _, _, piece in entity.pieces)
    document = read_yaml(text, entity.span.path, (line, before + 1))
    name = _text(entity, "param")
    within = () if name is None else ((name, entity.span),)
    yield from _of_yaml(document, within)


def _of_yaml(node: Node, keys: tuple[tuple[Text, Span], ...]) -> Iterator[NodeParameter]:
    match node:
        case Pairs(pairs):
            for key, value in pairs:
                yield from _of_yaml(value, (*keys, (substituted(key.text), key.span)))
        case Items() | Scalar() if keys:
            yield NodeParameter(keys, (), node.span, written=node)


def substituted(written: str) -> Text:
    """Return a text in which substitutions, such as `$(var name)`, are parts."""
    parts: list[Part | Text] = []
    at = 0
    while (begin := written.find("$(", at)) >= 0:
        depth, end = 0, None
        # Expressions have parentheses of their own.
        marks = _PARENTHESIS if written.startswith("$(eval ", begin) else _MARK
        for mark in marks.finditer(written, begin):
            depth += -1 if mark[0] == ")" else 1
            if not depth:
                end = mark.end()
                break
        parts.append(written[at:begin])
        if end is None:
            return UNKNOWN
        parts.append(_substitution(written[begin + 2 : end - 1]))
        at = end
    return text_of(*parts, written[at:])


def _has_text(tree: ast.AST) -> bool:
    """Whether an expression of ROS 1 joins texts: it contains a string or a package's folder."""
    return any(
        isinstance(each, ast.Call) and isinstance(each.func, ast.Name) and each.func.id == "find"
        for each in ast.walk(tree)
    ) or (
        isinstance(tree, ast.Expression)
        and isinstance(tree.body, ast.BinOp)
        and any(
            isinstance(each, ast.Constant) and isinstance(each.value, str)
            for each in (tree.body.left, tree.body.right)
        )
    )


def _sum_of_texts(node: ast.expr) -> Text:
    """Return the text of an expression of ROS 1 that joins texts, `UNKNOWN` for others."""
    match node:
        case ast.Constant(value=str(text)):
            return (text,)
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return text_of(_sum_of_texts(left), _sum_of_texts(right))
        case ast.Call(func=ast.Name(id="arg"), args=[ast.Constant(value=str(name))]):
            return (LaunchArgument(name),)
        case ast.Call(func=ast.Name(id="find"), args=[package]):
            return (PackageShare(_sum_of_texts(package)),)
        case ast.Name(id=name) if name not in _WORDS_OF_PYTHON:
            return (LaunchArgument(name),)
        case _:
            return UNKNOWN


def _substitution(inside: str) -> Part | Text:
    """Return the part for the inside of `$(...)`, `UNKNOWN` if it is not supported."""
    word, _, rest = inside.strip().partition(" ")
    rest = rest.strip()
    if "$(" in rest:
        return (
            PackageShare(substituted(rest))
            if word == "find-pkg-share" and len(rest) < 500
            else UNKNOWN
        )
    match word:
        case "var" | "arg":
            name, _, default = rest.partition(" ")
            return LaunchArgument(
                name.strip("'\""), None if not default else (default.strip("'\" "),)
            )
        case "find-pkg-share" | "find" | "find-pkg-prefix":
            return PackageShare((rest,))
        case "dirname":
            return LaunchDirectory()
        case "env" | "optenv":
            name, blank, default = rest.partition(" ")
            return LaunchArgument(f"env {name}", (default.strip("'\" "),) if blank else None)
        case "anon":
            return f"$(anon {rest})"
        case "eval" if len(rest) < _LONGEST_EXPRESSION:
            try:
                tree = ast.parse(rest.strip("\"'") if "$(" in rest else rest, mode="eval")
            except (SyntaxError, ValueError, RecursionError, MemoryError):
                return UNKNOWN
            return _sum_of_texts(tree.body) if _has_text(tree) else UNKNOWN
        case _:
            return UNKNOWN
