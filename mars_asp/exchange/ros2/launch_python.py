"""Launch files in Python as actions, by their syntax trees; nothing of them ever runs.

Names are followed to the values that are assigned to them, through loops over lists that are
written out and through calls of the file's own functions. Of a condition both branches are read.
"""

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point
from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    Action,
    Argument,
    Declare,
    Group,
    Here,
    Include,
    NotRead,
    Parameter,
    PushNamespace,
    Remap,
    SetParameters,
    SetRemap,
    Share,
    Start,
    Text,
    text_of,
    together,
)

#: How deep functions may call each other and expressions nest, and how many are evaluated.
_DEEPEST_CALL = 16
_DEEPEST = 150
_MOST_STEPS = 200_000
#: What no launch file needs in one list, and in one text.
_MOST_ITEMS = 10_000
_MOST_PARTS = 1000
#: Functions that return one of their arguments as a path.
_PATHS = frozenset(
    {"abspath", "realpath", "normpath", "expanduser", "Path", "str", "PathSubstitution"}
    | {"TextSubstitution", "FileContent"}
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
_NODES = {
    "Node": False,
    "LifecycleNode": False,
    "ComposableNode": True,
    "ComposableLifecycleNode": True,
}
_CONTAINERS = frozenset({"ComposableNodeContainer", "LoadComposableNodes"})
_WHOLE = re.compile(r"-?[0-9]{1,9}")
_ENTRY = "generate_launch_description"


@dataclass(frozen=True, slots=True)
class Call:
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
class Mapped:
    """A dictionary, of which keys may be texts with open parts."""

    pairs: "tuple[tuple[Value, Value], ...]"


@dataclass(frozen=True, slots=True)
class Local:
    """A function of the file."""

    of: ast.FunctionDef


@dataclass(frozen=True, slots=True)
class Plain:
    """A text that is there already: strings, substitutions, paths; with its place."""

    text: Text
    span: Span


@dataclass(frozen=True, slots=True)
class File:
    """What a file holds that was opened, or a part of it."""

    text: Text
    span: Span


Value: TypeAlias = Plain | File | Call | Listed | Mapped | Local | None
_Names: TypeAlias = dict[str, Value]


def read_python(text: str, path: str) -> tuple[Action, ...]:
    """Return what a launch file in Python starts.

    Raises:
        MarsError: the file is not Python.
    """
    try:
        tree = ast.parse(text)
    except SyntaxError as error:
        place = point(path, error.lineno or 1, error.offset or 1)
        raise _wrong(place, f"this is not Python: {error.msg}") from None
    except (ValueError, RecursionError, MemoryError):
        raise _wrong(point(path, 1, 1), "this Python is nested too deeply, or not text") from None
    reader = _Reader(path, text)
    try:
        return reader.actions(tree)
    except RecursionError:
        raise _wrong(point(path, 1, 1), "this Python is nested too deeply") from None


def _wrong(place: Span, message: str) -> MarsError:
    help_text = "is this a launch file? `ros2 launch` would also refuse it"
    return MarsError((Diagnostic("launch", "error", message, place, help=help_text),))


class _Reader:
    """Evaluates what a launch file builds."""

    def __init__(self, path: str, text: str) -> None:
        self.path = path
        self.lines = text.split("\n")
        self.steps = 0
        self.calls = 0
        self.launched: set[tuple[int, int]] = set()
        self.globals: _Names = {}
        self.called: dict[str, str] = {}
        self.declarations: list[Declare] = []

    def actions(self, tree: ast.Module) -> tuple[Action, ...]:
        """Return the actions of the description that the file generates."""
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom):
                self.called.update((n.asname, n.name) for n in node.names if n.asname)
        self.run(tree.body, self.globals)
        entry = self.globals.get(_ENTRY)
        if not isinstance(entry, Local):
            place = point(self.path, 1, 1)
            raise _wrong(place, f"the file has no function `{_ENTRY}` at its outer level")
        found = tuple(self.interpret(self.call_local(entry, (), {}), False))
        names = self.entered(entry)
        declared = tuple(self.declared(tree, names))
        return (*self.declarations, *declared, *found, *self.left_out(tree, names))

    def span(self, node: ast.expr | ast.stmt) -> Span:
        """Return where a node of the tree stands; the tree counts columns in bytes."""
        line = node.lineno
        column = self.column(line, node.col_offset)
        if isinstance(node, ast.Call):
            # What a call is about stands on its first line.
            func = node.func
            end = func.end_col_offset or func.col_offset
            last = func.end_lineno or line
            return Span(self.path, line, column, last, self.column(last, end))
        last = node.end_lineno or line
        end = node.end_col_offset or node.col_offset
        return Span(self.path, line, column, last, self.column(last, end))

    def column(self, line: int, offset: int) -> int:
        """Return the column, from 1, that stands a number of bytes into a line."""
        text = self.lines[line - 1] if line <= len(self.lines) else ""
        if text.isascii():
            return offset + 1
        return len(text.encode()[:offset].decode(errors="ignore")) + 1

    # ---- Statements

    def run(self, body: Iterable[ast.stmt], names: _Names) -> Value:
        """Run statements; return what they return, of several the lists joined."""
        returned: Value = None
        for statement in body:
            found = self.statement(statement, names)
            if found is not None:
                returned = _either(returned, found)
        return returned

    def statement(self, node: ast.stmt, names: _Names) -> Value:  # noqa: C901 -- one case each
        """Run one statement; return what it returns."""
        match node:
            case ast.FunctionDef(name=name):
                names[name] = Local(node)
            case ast.Assign(targets=targets, value=value):
                found = self.value(value, names)
                for target in targets:
                    self.assign(target, found, names)
            case ast.AnnAssign(target=target, value=ast.expr() as value):
                self.assign(target, self.value(value, names), names)
            case ast.AugAssign(target=ast.Name(id=name), op=ast.Add(), value=value):
                added = self.value(value, names)
                before = names.get(name, self.globals.get(name))
                if isinstance(before, Listed) and isinstance(added, Listed):
                    before.items += added.items[: _MOST_ITEMS - len(before.items)]
                else:
                    names[name] = _sum(before, added)
            case ast.Expr(value=value):
                self.value(value, names)
            case ast.Return(value=ast.expr() as value):
                return self.value(value, names)
            case ast.If(body=body, orelse=orelse):
                return self.branches((body, orelse), names)
            case ast.For(target=target, iter=iterated, body=body, orelse=orelse):
                returned: Value = None
                items = self.value(iterated, names)
                for item in tuple(_items(items)) or (None,):
                    if self.steps > _MOST_STEPS:
                        break
                    self.assign(target, item, names)
                    returned = _either(returned, self.run(body, names))
                return _either(returned, self.run(orelse, names))
            case ast.With(items=opened, body=body):
                for each in opened:
                    if each.optional_vars is not None:
                        self.assign(each.optional_vars, self.value(each.context_expr, names), names)
                return self.run(body, names)
            case ast.While(body=body):
                return self.run(body, names)
            case ast.Try(body=body, handlers=handlers, orelse=orelse, finalbody=final):
                found = self.run((*body, *orelse), names)
                for handler in handlers:
                    found = _either(found, self.run(handler.body, names))
                return _either(found, self.run(final, names))
            case _:
                pass
        return None

    def branches(self, bodies: Iterable[Sequence[ast.stmt]], names: _Names) -> Value:
        """Run all branches of a condition; what they assign differently is all of it."""
        before = dict(names)
        returned: Value = None
        for body in bodies:
            inner = dict(before)
            returned = _either(returned, self.run(body, inner))
            for name, value in inner.items():
                if value is not before.get(name):
                    first = None if names.get(name) is before.get(name) else names[name]
                    names[name] = _either(first, value)
        return returned

    def assign(self, target: ast.expr, value: Value, names: _Names) -> None:
        """Give a value to a name, or its parts to several."""
        match target:
            case ast.Name(id=name):
                names[name] = value
            case ast.Tuple(elts=targets) | ast.List(elts=targets):
                items = _items(value)
                for index, each in enumerate(targets):
                    part = items[index] if index < len(items) else None
                    self.assign(each, part, names)
            case ast.Subscript(value=ast.Name(id=name), slice=key):
                before = names.get(name)
                if isinstance(before, Mapped):
                    at = self.value(key, names)
                    names[name] = Mapped((*before.pairs, (at, value)))
            case _:
                pass

    # ---- Expressions

    def value(  # noqa: C901 -- one case for each sort of expression
        self, node: ast.expr, names: _Names, depth: int = 0
    ) -> Value:
        """Return what an expression stands for, `None` where only a run would know."""
        self.steps += 1
        if self.steps > _MOST_STEPS or depth > _DEEPEST:
            return None
        match node:
            case ast.Constant(value=bool() | int() | float() as value):
                return Plain((str(value),), self.span(node))
            case ast.Constant(value=str() as value):
                return Plain(text_of(value), self.span(node))
            case ast.Name(id="__file__"):
                return Plain((Here(), "/."), self.span(node))
            case ast.Name(id=name):
                return names.get(name, self.globals.get(name))
            case ast.List(elts=items) | ast.Tuple(elts=items) | ast.Set(elts=items):
                return Listed(list(self.elements(items, names, depth)), self.span(node))
            case ast.Dict(keys=keys, values=values):
                return self.mapped(keys, values, names, depth)
            case ast.JoinedStr(values=values):
                parts = [self.formatted(value, names, depth) for value in values]
                return Plain(text_of(*parts), self.span(node))
            case ast.BinOp(left=left, op=ast.Add() | ast.Div() as sign, right=right):
                return self.binary(node, left, sign, right, names)
            case ast.BoolOp(values=values):
                found: Value = None
                for each in values:
                    found = found or self.value(each, names, depth + 1)
                return found
            case ast.IfExp(body=body, orelse=orelse):
                return _either(
                    self.value(body, names, depth + 1), self.value(orelse, names, depth + 1)
                )
            case ast.ListComp(elt=element, generators=[generator]):
                found = Listed([], self.span(node))
                inner = dict(names)
                for item in _items(self.value(generator.iter, names, depth + 1)):
                    self.assign(generator.target, item, inner)
                    found.items.append(self.value(element, inner, depth + 1))
                return found
            case ast.Subscript(value=value, slice=key):
                return _picked(
                    self.value(value, names, depth + 1), self.value(key, names, depth + 1)
                )
            case ast.Attribute(value=value, attr=attribute):
                owner = self.value(value, names, depth + 1)
                if attribute == "parent" and isinstance(owner, Plain):
                    return Plain(_folder(owner.text), owner.span)
                return None
            case ast.Call():
                return self.call(node, names, depth)
            case ast.Starred(value=value):
                return self.value(value, names, depth + 1)
            case _:
                return None

    def elements(self, items: Sequence[ast.expr], names: _Names, depth: int) -> Iterator[Value]:
        """Yield the elements of a list, those of starred ones among them."""
        for item in items:
            found = self.value(item, names, depth + 1)
            if isinstance(item, ast.Starred):
                yield from _items(found)
            elif found is None:
                yield Plain(UNKNOWN, self.span(item))
            else:
                yield found

    def mapped(
        self,
        keys: Sequence[ast.expr | None],
        values: Sequence[ast.expr],
        names: _Names,
        depth: int,
    ) -> Mapped:
        """Return a dictionary with those that are unpacked in it."""
        pairs: list[tuple[Value, Value]] = []
        for key, value in zip(keys, values, strict=True):
            found = self.value(value, names, depth + 1)
            if key is None:
                pairs += found.pairs if isinstance(found, Mapped) else ()
            else:
                pairs.append((self.value(key, names, depth + 1), found))
        return Mapped(tuple(pairs))

    def formatted(self, node: ast.expr, names: _Names, depth: int) -> Text:
        """Return a part of a formatted string."""
        inner = node.value if isinstance(node, ast.FormattedValue) else node
        return _text(self.value(inner, names, depth + 1))

    def binary(
        self, node: ast.BinOp, left: ast.expr, sign: ast.operator, right: ast.expr, names: _Names
    ) -> Value:
        """Return a sum, or a path that is joined by `/`; long chains lean to the left."""
        chain = [(sign, right)]
        while isinstance(left, ast.BinOp) and isinstance(left.op, ast.Add | ast.Div):
            chain.append((left.op, left.right))
            left = left.left
        found = self.value(left, names, 1)
        for operator, operand in reversed(chain):
            added = self.value(operand, names, 1)
            if isinstance(operator, ast.Div):
                found = Plain(text_of(_text(found), "/", _text(added)), self.span(node))
            else:
                found = _sum(found, added)
        return found

    def call(self, node: ast.Call, names: _Names, depth: int) -> Value:
        """Return what a call stands for."""
        arguments = tuple(self.elements(node.args, names, depth + 1))
        named: dict[str, Value] = {}
        for keyword in node.keywords:
            found = self.value(keyword.value, names, depth + 1)
            if keyword.arg is not None:
                named[keyword.arg] = found
            elif isinstance(found, Mapped):
                for key, value in found.pairs:
                    named["".join(p for p in _text(key) if isinstance(p, str))] = value
        span = self.span(node)
        if isinstance(node.func, ast.Attribute):
            done = self.method(node.func, arguments, names, depth)
            if not isinstance(done, _NotDone):
                return done
            name = node.func.attr
        elif isinstance(node.func, ast.Name):
            name = node.func.id
            function = names.get(name, self.globals.get(name))
            if isinstance(function, Local):
                return self.call_local(function, arguments, named)
            name = self.called.get(name, name)
        else:
            return None
        return self.known(Call(name, arguments, named, span))

    def method(
        self, func: ast.Attribute, arguments: Sequence[Value], names: _Names, depth: int
    ) -> "Value | _NotDone":
        """Carry out a method of a list, dictionary or text."""
        owner = self.value(func.value, names, depth + 1)
        first = arguments[0] if arguments else None
        if isinstance(owner, Call) and owner.name == "LaunchDescription":
            inner = owner.get("initial_entities", 0)
            if func.attr in ("add_action", "add_entity") and isinstance(inner, Listed):
                inner.items.append(first)
            return None
        match owner, func.attr:
            case Listed(), "append":
                owner.items += [first][: _MOST_ITEMS - len(owner.items)]
                return None
            case Listed(), "extend":
                owner.items += _items(first)[: _MOST_ITEMS - len(owner.items)]
                return None
            case Listed(), "insert":
                owner.items += arguments[1:2]
                return None
            case Mapped(pairs), "items":
                return Listed([Listed([key, value]) for key, value in pairs])
            case Mapped(pairs), "get":
                return _picked(owner, first)
            case Plain(), "perform" | "as_posix" | "resolve" | "strip" | "format" | "absolute":
                return Plain(UNKNOWN, owner.span) if func.attr == "format" else owner
            case Plain(text, span), "joinpath":
                return Plain(_path(text, *map(_text, arguments)), span)
            case _:
                return _NOT_DONE

    def call_local(
        self, function: Local, arguments: Sequence[Value], named: Mapping[str, Value]
    ) -> Value:
        """Return what a function of the file returns."""
        if self.calls >= _DEEPEST_CALL:
            return None
        parameters = function.of.args
        names: _Names = {}
        every = [*parameters.posonlyargs, *parameters.args]
        for parameter, default in zip(reversed(every), reversed(parameters.defaults), strict=False):
            names[parameter.arg] = self.value(default, self.globals)
        names.update(
            (parameter.arg, value) for parameter, value in zip(every, arguments, strict=False)
        )
        for parameter, given in zip(parameters.kwonlyargs, parameters.kw_defaults, strict=True):
            if given is not None:
                names[parameter.arg] = self.value(given, self.globals)
        if parameters.vararg is not None:
            names[parameters.vararg.arg] = Listed(list(arguments[len(every) :]))
        own = {parameter.arg for parameter in (*every, *parameters.kwonlyargs)}
        names.update((name, value) for name, value in named.items() if name in own)
        if parameters.kwarg is not None:
            span = self.span(function.of)
            names[parameters.kwarg.arg] = Mapped(
                tuple((Plain((key,), span), v) for key, v in named.items() if key not in own)
            )
        self.calls += 1
        try:
            return self.run(function.of.body, names)
        finally:
            self.calls -= 1

    def known(self, call: Call) -> Value:  # noqa: C901 -- one case for each function
        """Return the text that a call makes, where it makes one; else the call itself."""
        first = call.arguments[0] if call.arguments else None
        match call.name:
            case "LaunchDescription":
                entities = call.get("initial_entities", 0)
                copy = Listed(list(_items(entities)), call.span)
                return Call(call.name, (copy,), {}, call.span)
            case "LaunchConfiguration" | "LaunchConfigAsBool":
                name = _plain(_text(call.get("variable_name", 0)))
                default = call.named.get("default")
                if name is None:
                    return Plain(UNKNOWN, call.span)
                text = None if default is None else _text(default)
                return Plain((Argument(name, text),), call.span)
            case "DeclareLaunchArgument":
                self.declarations += _declared(call)
                return call
            case "ThisLaunchFileDir":
                return Plain((Here(),), call.span)
            case "EnvironmentVariable" | "getenv":
                value = call.get("default_value", 1)
                return Plain(_text(value), call.span)
            case "PathJoinSubstitution" | "PathJoin":
                parts = _items(first) if isinstance(first, Listed) else call.arguments
                return Plain(_path(*map(_text, parts)), call.span)
            case "join":
                return Plain(_path(*map(_text, call.arguments)), call.span)
            case "dirname":
                return Plain(_folder(_text(first)), call.span)
            case "open" | "safe_load" | "full_load" | "load":
                # Of a file of parameters it is enough to know which.
                return File(_text(first), call.span)
            case "ParameterFile" | "RewrittenYaml" | "ReplaceString":
                at = "param_file" if call.name == "ParameterFile" else "source_file"
                return Plain(_text(call.get(at, 0)), call.span)
            case "ParameterValue":
                return call.get("value", 0)
            case "list" | "tuple" | "sorted" | "reversed":
                return first
            case "range" | "enumerate" | "zip":
                return _counted(call)
            case "dict":
                pairs = tuple(
                    (Plain((key,), call.span), value) for key, value in call.named.items()
                )
                return Mapped((*(first.pairs if isinstance(first, Mapped) else ()), *pairs))
            case name if name in _SHARES:
                return Plain((Share(_text(call.get("package", 0))),), call.span)
            case name if name in _PATHS:
                return Plain(_path(*map(_text, call.arguments)), call.span)
            case _:
                return call

    # ---- Actions

    def interpret(self, value: Value, conditional: bool) -> Iterator[Action]:
        """Yield the actions that a value is or holds."""
        self.steps += 1
        if self.steps > 2 * _MOST_STEPS:
            return
        match value:
            case Listed(items):
                for item in tuple(items):
                    yield from self.interpret(item, conditional)
            case Call(name) if name in _NODES or name in _CONTAINERS:
                yield from self.started(value, conditional)
            case Call():
                yield from self.action(value, conditional)
            case _:
                return

    def action(self, call: Call, conditional: bool) -> Iterator[Action]:
        """Yield what an action that starts no node itself does."""
        conditional = conditional or "condition" in call.named
        match call.name:
            case "LaunchDescription":
                yield from self.interpret(call.get("initial_entities", 0), conditional)
            case "GroupAction":
                inner = tuple(self.interpret(call.get("actions", 0), conditional))
                scoped = call.get("scoped")
                is_scoped = not (isinstance(scoped, Plain) and scoped.text == ("False",))
                settings = call.named.get("launch_configurations")
                yield Group(
                    (*_forced(settings, call.span), *inner),
                    scoped=is_scoped,
                    conditional=conditional,
                )
            case "PushRosNamespace" | "PushROSNamespace":
                yield PushNamespace(_text(call.get("namespace", 0)), call.span)
            case "SetRemap":
                source, target = _text(call.get("src", 0)), _text(call.get("dst", 1))
                yield SetRemap(Remap(source, target, call.span))
            case "SetParameter":
                keys = ((call.get("name", 0), call.span),)
                yield SetParameters((), (_parameter(keys, call.get("value", 1), call.span),))
            case "SetParametersFromFile":
                yield SetParameters((_text(call.get("filename", 0)),), ())
            case "DeclareLaunchArgument":
                return
            case "SetLaunchConfiguration":
                name = _plain(_text(call.get("name", 0)))
                if name is not None:
                    yield Declare(name, _text(call.get("value", 1)), forced=True)
            case "IncludeLaunchDescription":
                described = call.get("launch_description_source", 0)
                if isinstance(described, Call):
                    described = described.get("launch_file_path", 0)
                path = _text(described)
                passed = tuple(_parameters(call.get("launch_arguments", 1), call.span))
                yield Include(path, call.span, passed, conditional)
            case "ExecuteProcess" | "ExecuteLocal":
                command = _items(call.get("cmd", 0))
                called = " ".join(filter(None, (_plain(_text(word)) for word in command[:4])))
                yield NotRead("programs that are not nodes", called or "?", call.span)
            case "OpaqueFunction":
                yield from self.opaque(call, conditional)
            case _:
                yield from self.handled(call, conditional)

    def opaque(self, call: Call, conditional: bool) -> Iterator[Action]:
        """Yield what a function of the file that launching would call returns."""
        function = call.get("function", 0)
        if not isinstance(function, Local):
            yield NotRead("functions that only a run calls", "OpaqueFunction", call.span)
            return
        named = call.get("kwargs")
        by_name = {
            _plain(_text(key)) or "": value
            for key, value in (named.pairs if isinstance(named, Mapped) else ())
        }
        found = self.call_local(function, (None, *_items(call.get("args"))), by_name)
        yield together(tuple(self.interpret(found, conditional)), conditional)

    def handled(self, call: Call, conditional: bool) -> Iterator[Action]:
        """Yield what timers and handlers of events hold, which is started some time."""
        held = [value for name, value in call.named.items() if name != "target_action"]
        for each in (*call.arguments, *held):
            # A handler may be a function that takes the event and the context.
            given = self.call_local(each, (), {}) if isinstance(each, Local) else each
            yield from self.interpret(given, conditional)

    def started(self, call: Call, conditional: bool) -> Iterator[Action]:
        """Yield the node that a call starts, or those that go into a container."""
        conditional = conditional or "condition" in call.named
        if call.name in _CONTAINERS:
            if call.name == "ComposableNodeContainer":
                called = _plain(_text(call.get("name"))) or "?"
                yield NotRead("containers of components", called, call.span)
            components = call.get("composable_node_descriptions")
            yield from self.interpret(components, conditional)
            return
        self.launched.add((call.span.line, call.span.column))
        plugin = _NODES[call.name]
        executable = call.get("plugin" if plugin else "executable")
        if executable is None and not plugin:
            executable = call.get("node_executable")
        files, parameters = _given(call.named.get("parameters"), call.span)
        remaps, unread = _remaps(call)
        name = call.named.get("name", call.named.get("node_name"))
        namespace = call.named.get("namespace", call.named.get("node_namespace"))
        yield Start(
            call.span,
            _text(call.get("package")),
            _text(executable),
            plugin,
            None if name is None and "name" not in call.named else _text(name),
            None if namespace is None and "namespace" not in call.named else _text(namespace),
            remaps,
            files,
            parameters,
            tuple(_text(each) for each in _items(call.named.get("arguments"))),
            conditional,
            unread,
        )

    def entered(self, entry: Local) -> _Names:
        """Return the names that the function that generates the description assigns."""
        names: _Names = {}
        for statement in entry.of.body:
            if isinstance(statement, ast.Assign):
                self.statement(statement, names)
        return names

    def declared(self, tree: ast.Module, names: _Names) -> Iterator[Declare]:
        """Yield the launch arguments that the file declares, wherever it does."""
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and self.name_of(node) == "DeclareLaunchArgument":
                yield from _declared(self.alone(node, names))

    def alone(self, node: ast.Call, names: _Names) -> Call:
        """Return a call with what is known of its arguments by names alone."""
        arguments = tuple(self.elements(node.args, names, 0))
        named = {
            keyword.arg: self.value(keyword.value, names)
            for keyword in node.keywords
            if keyword.arg is not None
        }
        return Call(self.name_of(node), arguments, named, self.span(node))

    def name_of(self, node: ast.Call) -> str:
        """Return the name of what is called, whatever the file imports it as."""
        return self.called.get(_called(node), _called(node))

    def left_out(self, tree: ast.Module, names: _Names) -> Iterator[NotRead]:
        """Yield the nodes that the file makes and that nothing of it launches."""
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call) or self.name_of(node) not in _NODES:
                continue
            span = self.span(node)
            if (span.line, span.column) not in self.launched:
                call = self.alone(node, names)
                at = "plugin" if _NODES[call.name] else "executable"
                name = _plain(_text(call.get(at))) or call.name
                yield NotRead("nodes that are made but not launched", name, span)


class _NotDone:
    """Stands for a method that is not carried out here."""


_NOT_DONE = _NotDone()


def _called(node: ast.Call) -> str:
    func = node.func
    if isinstance(func, ast.Attribute):
        return func.attr
    return func.id if isinstance(func, ast.Name) else ""


def _text(value: Value) -> Text:
    """Return the text that a value is; a list of texts is one, as substitutions are."""
    if isinstance(value, Plain | File):
        return value.text
    if not isinstance(value, Listed):
        return UNKNOWN
    found: list[Text] = []
    waiting: list[Value] = [value]
    for _ in range(_MOST_PARTS):
        if not waiting:
            return text_of(*found)
        each = waiting.pop()
        if isinstance(each, Listed):
            waiting += reversed(each.items[:_MOST_PARTS])
        else:
            found.append(_text(each))
    return UNKNOWN


def _plain(text: Text) -> str | None:
    """Return a text that has no open parts."""
    if not text:
        return ""
    return text[0] if len(text) == 1 and isinstance(text[0], str) else None


def _items(value: Value) -> "list[Value]":
    return value.items if isinstance(value, Listed) else []


def _either(first: Value, second: Value) -> Value:
    """Return what holds all that either of two branches gives; of two texts the first."""
    if first is None or second is None:
        return first if second is None else second
    if isinstance(first, Plain) and isinstance(second, Plain):
        return first
    if first is second:
        return first
    both = [each for one in (first, second) for each in _items(one) or [one]]
    return Listed(both[:_MOST_ITEMS])


def _sum(first: Value, second: Value) -> Value:
    match first, second:
        case Listed(items), Listed(more):
            return Listed([*items, *more][:_MOST_ITEMS], first.span)
        case Plain(text, span), _:
            return Plain(text_of(text, _text(second)), span)
        case _, Plain(text, span):
            return Plain(text_of(_text(first), text), span)
        case Listed(), _:
            return first
        case _, Listed():
            return second
        case _:
            return None


def _declared(call: Call) -> Iterator[Declare]:
    """Yield the launch argument that a call declares, if its name is known."""
    name = _plain(_text(call.get("name", 0)))
    if name is not None:
        default = call.get("default_value")
        yield Declare(name, None if default is None else _text(default))


def _counted(call: Call) -> Value:
    """Return what `range`, `enumerate` or `zip` gives, as far as that is written out."""
    if call.name == "range":
        texts = [_plain(_text(each)) for each in call.arguments]
        bounds = [int(text) for text in texts if text is not None and _WHOLE.fullmatch(text)]
        if not bounds or len(bounds) != len(texts) or bounds[2:] == [0]:
            return None
        return Listed([Plain((str(n),), call.span) for n in range(*bounds[:3])[:_MOST_PARTS]])
    lists = [_items(each) for each in call.arguments]
    if call.name == "enumerate":
        lists = (
            [[Plain((str(n),), call.span) for n in range(len(lists[0]))], *lists[:1]]
            if lists
            else []
        )
    return Listed([Listed(list(each)) for each in zip(*lists, strict=False)])


def _picked(owner: Value, key: Value) -> Value:
    if isinstance(owner, File):
        return owner
    at = _plain(_text(key)) if key is not None else None
    match owner:
        case Listed(items) if at is not None and at.lstrip("-").isdigit():
            index = int(at)
            return items[index] if -len(items) <= index < len(items) else None
        case Mapped(pairs):
            return next((v for k, v in pairs if k is not None and _plain(_text(k)) == at), None)
        case _:
            return None


def _folder(text: Text) -> Text:
    """Return the folder of a path."""
    if text and isinstance(text[-1], str) and "/" in text[-1]:
        return text_of(*text[:-1], text[-1].rpartition("/")[0])
    return text_of(*text, "/..")


def _path(*parts: Text) -> Text:
    joined: list[Text] = []
    for part in parts:
        if joined:
            joined.append(("/",))
        joined.append(part)
    return text_of(*joined)


def _parameters(value: Value, span: Span) -> Iterator[Parameter]:
    """Yield what a dictionary, or a list of pairs, gives; `span` is where it stands."""
    if isinstance(value, Mapped):
        yield from (_parameter(((key, span),), given, span) for key, given in value.pairs)
    for item in _items(value):
        if isinstance(item, Listed) and len(item.items) == 2:
            yield _parameter(((item.items[0], span),), item.items[1], span)


def _parameter(keys: Sequence[tuple[Value, Span]], value: Value, span: Span) -> Parameter:
    """Return a parameter by the steps of its name, with places for what has none of its own."""
    steps = tuple((_text(key), _place_of(key, place)) for key, place in keys)
    # Texts without open parts are a list; with substitutions they are one text.
    items = tuple(map(_text, value.items)) if isinstance(value, Listed) else ()
    is_list = len(items) > 0 and all(_plain(item) is not None for item in items)
    return Parameter(steps, _text(value), _place_of(value, span), items if is_list else None)


def _place_of(value: Value, otherwise: Span) -> Span:
    span = value.span if isinstance(value, Plain | File | Listed | Call) else None
    return otherwise if span is None else span


def _forced(value: Value, span: Span) -> Iterator[Declare]:
    for each in _parameters(value, span):
        name = _plain(each.name)
        if name is not None:
            yield Declare(name, each.value, forced=True)


def _given(value: Value, span: Span) -> tuple[tuple[Text, ...], tuple[Parameter, ...]]:
    """Return the files and the values of the parameters of a node."""
    files: list[Text] = []
    parameters: list[Parameter] = []
    for item in _items(value) or ([] if value is None else [value]):
        if isinstance(item, Mapped):
            parameters += _flat(item, span)
        elif isinstance(item, Plain | File | Listed):
            files.append(_text(item))
    return tuple(files), tuple(parameters)


def _flat(value: Mapped, span: Span) -> Iterator[Parameter]:
    """Yield the values of a dictionary and of those in it, in their order."""
    waiting: list[tuple[tuple[tuple[Value, Span], ...], Value]] = [((), value)]
    for _ in range(_MOST_ITEMS):
        if not waiting:
            return
        keys, held = waiting.pop()
        if isinstance(held, Mapped):
            waiting += [((*keys, (key, span)), inner) for key, inner in reversed(held.pairs)]
        else:
            yield _parameter(keys, held, span)


def _remaps(call: Call) -> tuple[tuple[Remap, ...], tuple[tuple[str, Span], ...]]:
    """Return the remappings that are written out, and the places of those that are not."""
    found: list[Remap] = []
    unread: list[tuple[str, Span]] = []
    value = call.named.get("remappings")
    if "remappings" in call.named and not isinstance(value, Listed):
        unread.append(("remappings", call.span))
    for item in _items(value):
        if isinstance(item, Listed) and len(item.items) == 2:
            source, target = map(_text, item.items)
            found.append(Remap(source, target, item.span or call.span))
        else:
            unread.append(("remappings", item.span if isinstance(item, Plain) else call.span))
    return tuple(found), tuple(unread)
