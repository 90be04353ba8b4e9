"""What the expressions and statements of a launch file in Python stand for; none of it is run.

Names are followed to the values that are assigned to them, through loops over lists that are
written out and through calls of the file's own functions. Of a condition both branches are read.
"""

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    Argument,
    Declare,
    Here,
    Share,
    Text,
    text_of,
)
from mars_asp.exchange.ros2.python_nodes import (
    declared_by,
)
from mars_asp.exchange.ros2.python_values import (
    MOST_ITEMS,
    Call,
    File,
    Listed,
    Local,
    Mapped,
    Names,
    Plain,
    Value,
    counted,
    either,
    folder_of,
    items_of,
    path_of,
    picked,
    plain,
    summed,
    text_from,
)

#: How deep functions may call each other and expressions nest, and how many are evaluated.
_DEEPEST_CALL = 16
_DEEPEST = 150
MOST_STEPS = 200_000
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


class Evaluator:
    """Evaluates what a launch file builds."""

    def __init__(self, path: str, text: str) -> None:
        self.path = path
        self.lines = text.split("\n")
        self.steps = 0
        self.calls = 0
        self.launched: set[tuple[int, int]] = set()
        self.globals: Names = {}
        self.called: dict[str, str] = {}
        self.declarations: list[Declare] = []

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

    def run(self, body: Iterable[ast.stmt], names: Names) -> Value:
        """Run statements; return what they return, of several the lists joined."""
        returned: Value = None
        for statement in body:
            found = self.statement(statement, names)
            if found is not None:
                returned = either(returned, found)
        return returned

    def statement(self, node: ast.stmt, names: Names) -> Value:  # noqa: C901 -- one case each
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
                    before.items += added.items[: MOST_ITEMS - len(before.items)]
                else:
                    names[name] = summed(before, added)
            case ast.Expr(value=value):
                self.value(value, names)
            case ast.Return(value=ast.expr() as value):
                return self.value(value, names)
            case ast.If(body=body, orelse=orelse):
                return self.branches((body, orelse), names)
            case ast.For(target=target, iter=iterated, body=body, orelse=orelse):
                returned: Value = None
                items = self.value(iterated, names)
                for item in tuple(items_of(items)) or (None,):
                    if self.steps > MOST_STEPS:
                        break
                    self.assign(target, item, names)
                    returned = either(returned, self.run(body, names))
                return either(returned, self.run(orelse, names))
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
                    found = either(found, self.run(handler.body, names))
                return either(found, self.run(final, names))
            case _:
                pass
        return None

    def branches(self, bodies: Iterable[Sequence[ast.stmt]], names: Names) -> Value:
        """Run all branches of a condition; what they assign differently is all of it."""
        before = dict(names)
        returned: Value = None
        for body in bodies:
            inner = dict(before)
            returned = either(returned, self.run(body, inner))
            for name, value in inner.items():
                if value is not before.get(name):
                    first = None if names.get(name) is before.get(name) else names[name]
                    names[name] = either(first, value)
        return returned

    def assign(self, target: ast.expr, value: Value, names: Names) -> None:
        """Give a value to a name, or its parts to several."""
        match target:
            case ast.Name(id=name):
                names[name] = value
            case ast.Tuple(elts=targets) | ast.List(elts=targets):
                items = items_of(value)
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
        self, node: ast.expr, names: Names, depth: int = 0
    ) -> Value:
        """Return what an expression stands for, `None` where only a run would know."""
        self.steps += 1
        if self.steps > MOST_STEPS or depth > _DEEPEST:
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
                return either(
                    self.value(body, names, depth + 1), self.value(orelse, names, depth + 1)
                )
            case ast.ListComp(elt=element, generators=[generator]):
                found = Listed([], self.span(node))
                inner = dict(names)
                for item in items_of(self.value(generator.iter, names, depth + 1)):
                    self.assign(generator.target, item, inner)
                    found.items.append(self.value(element, inner, depth + 1))
                return found
            case ast.Subscript(value=value, slice=key):
                return picked(
                    self.value(value, names, depth + 1), self.value(key, names, depth + 1)
                )
            case ast.Attribute(value=value, attr=attribute):
                owner = self.value(value, names, depth + 1)
                if attribute == "parent" and isinstance(owner, Plain):
                    return Plain(folder_of(owner.text), owner.span)
                return None
            case ast.Call():
                return self.call(node, names, depth)
            case ast.Starred(value=value):
                return self.value(value, names, depth + 1)
            case _:
                return None

    def elements(self, items: Sequence[ast.expr], names: Names, depth: int) -> Iterator[Value]:
        """Yield the elements of a list, those of starred ones among them."""
        for item in items:
            found = self.value(item, names, depth + 1)
            if isinstance(item, ast.Starred):
                yield from items_of(found)
            elif found is None:
                yield Plain(UNKNOWN, self.span(item))
            else:
                yield found

    def mapped(
        self,
        keys: Sequence[ast.expr | None],
        values: Sequence[ast.expr],
        names: Names,
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

    def formatted(self, node: ast.expr, names: Names, depth: int) -> Text:
        """Return a part of a formatted string."""
        inner = node.value if isinstance(node, ast.FormattedValue) else node
        return text_from(self.value(inner, names, depth + 1))

    def binary(
        self, node: ast.BinOp, left: ast.expr, sign: ast.operator, right: ast.expr, names: Names
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
                found = Plain(text_of(text_from(found), "/", text_from(added)), self.span(node))
            else:
                found = summed(found, added)
        return found

    def call(self, node: ast.Call, names: Names, depth: int) -> Value:
        """Return what a call stands for."""
        arguments = tuple(self.elements(node.args, names, depth + 1))
        named: dict[str, Value] = {}
        for keyword in node.keywords:
            found = self.value(keyword.value, names, depth + 1)
            if keyword.arg is not None:
                named[keyword.arg] = found
            elif isinstance(found, Mapped):
                for key, value in found.pairs:
                    named["".join(p for p in text_from(key) if isinstance(p, str))] = value
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
        self, func: ast.Attribute, arguments: Sequence[Value], names: Names, depth: int
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
                owner.items += [first][: MOST_ITEMS - len(owner.items)]
                return None
            case Listed(), "extend":
                owner.items += items_of(first)[: MOST_ITEMS - len(owner.items)]
                return None
            case Listed(), "insert":
                owner.items += arguments[1:2]
                return None
            case Mapped(pairs), "items":
                return Listed([Listed([key, value]) for key, value in pairs])
            case Mapped(pairs), "get":
                return picked(owner, first)
            case Plain(), "perform" | "as_posix" | "resolve" | "strip" | "format" | "absolute":
                return Plain(UNKNOWN, owner.span) if func.attr == "format" else owner
            case Plain(text, span), "joinpath":
                return Plain(path_of(text, *map(text_from, arguments)), span)
            case _:
                return _NOT_DONE

    def call_local(
        self, function: Local, arguments: Sequence[Value], named: Mapping[str, Value]
    ) -> Value:
        """Return what a function of the file returns."""
        if self.calls >= _DEEPEST_CALL:
            return None
        parameters = function.of.args
        names: Names = {}
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
                copy = Listed(list(items_of(entities)), call.span)
                return Call(call.name, (copy,), {}, call.span)
            case "LaunchConfiguration" | "LaunchConfigAsBool":
                name = plain(text_from(call.get("variable_name", 0)))
                default = call.named.get("default")
                if name is None:
                    return Plain(UNKNOWN, call.span)
                text = None if default is None else text_from(default)
                return Plain((Argument(name, text),), call.span)
            case "DeclareLaunchArgument":
                self.declarations += declared_by(call)
                return call
            case "ThisLaunchFileDir":
                return Plain((Here(),), call.span)
            case "EnvironmentVariable" | "getenv":
                value = call.get("default_value", 1)
                return Plain(text_from(value), call.span)
            case "PathJoinSubstitution" | "PathJoin":
                parts = items_of(first) if isinstance(first, Listed) else call.arguments
                return Plain(path_of(*map(text_from, parts)), call.span)
            case "join":
                return Plain(path_of(*map(text_from, call.arguments)), call.span)
            case "dirname":
                return Plain(folder_of(text_from(first)), call.span)
            case "open" | "safe_load" | "full_load" | "load":
                # Of a file of parameters it is enough to know which.
                return File(text_from(first), call.span)
            case "ParameterFile" | "RewrittenYaml" | "ReplaceString":
                at = "param_file" if call.name == "ParameterFile" else "source_file"
                return Plain(text_from(call.get(at, 0)), call.span)
            case "ParameterValue":
                return call.get("value", 0)
            case "list" | "tuple" | "sorted" | "reversed":
                return first
            case "range" | "enumerate" | "zip":
                return counted(call)
            case "dict":
                pairs = tuple(
                    (Plain((key,), call.span), value) for key, value in call.named.items()
                )
                return Mapped((*(first.pairs if isinstance(first, Mapped) else ()), *pairs))
            case name if name in _SHARES:
                return Plain((Share(text_from(call.get("package", 0))),), call.span)
            case name if name in _PATHS:
                return Plain(path_of(*map(text_from, call.arguments)), call.span)
            case _:
                return call


class _NotDone:
    """Stands for a method that is not carried out here."""


_NOT_DONE = _NotDone()
