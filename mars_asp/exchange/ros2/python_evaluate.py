"""Values of the expressions and statements of a launch file in Python, which is not run.

Names are followed to the values that are assigned to them, through loops over lists that are
written out and through calls of the file's own functions. Of a condition one reading takes one
branch, the first unless another is forced; the caller sees to it that each is taken once.
"""

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.actions import (
    UNKNOWN,
    Declare,
    LaunchDirectory,
    Reads,
)
from mars_asp.exchange.ros2.python_expressions import ITEMS_A_STEP, ExpressionEvaluator, bind
from mars_asp.exchange.ros2.python_files import column_at, defaults_of, members_of
from mars_asp.exchange.ros2.python_nodes import (
    declared_by,
    read_by,
)
from mars_asp.exchange.ros2.python_tests import (
    Tested,
    decision,
    is_configurations,
    tested,
    truth,
)
from mars_asp.exchange.ros2.python_values import (
    MOST_ITEMS,
    LaunchClass,
    LaunchObject,
    Listed,
    Local,
    MappedValue,
    Names,
    NoneValue,
    NotKnown,
    Plain,
    PythonCall,
    Value,
    combined,
    each_of,
    folder_of,
    items_of,
    known,
    known_method,
    picked,
)

#: How deep functions may call each other, how many are called and expressions evaluated.
_DEEPEST_CALL = 16
_MOST_CALLS = 5000
MOST_STEPS = 200_000


class Evaluator(ExpressionEvaluator[Names]):
    """Partial evaluation of a launch file in Python: the value of each expression, if known."""

    most_steps = MOST_STEPS
    deepest = 150

    def __init__(self, path: str, text: str) -> None:
        super().__init__()
        self.path = path
        self.lines = text.split("\n")
        self.depth = 0
        self.calls = 0
        self.launched: set[tuple[int, int]] = set()
        #: The calls that were evaluated, each as it last was.
        self.made: dict[ast.Call, PythonCall] = {}
        self.globals: Names = {}
        self.called: dict[str, str] = {}
        self.declarations: list[Declare | Reads] = []
        self.strict = False
        self.assigned: frozenset[str] = frozenset()
        self.forced: Mapping[ast.AST, int] = {}
        self.decisions: dict[ast.AST, tuple[int, int]] = {}
        self.tested: dict[ast.AST, Tested] = {}
        # Each reading, and each call of a function, needs it again.
        self._span = cache(self._node_span)

    def span(self, node: ast.expr | ast.stmt) -> Span:
        """Return the location of a node."""
        return self._span(node)

    def _node_span(self, node: ast.expr | ast.stmt) -> Span:
        """Return the location of a syntax node, whose columns count bytes."""
        # The name of a call is on its first line.
        whole = node.func if isinstance(node, ast.Call) else node
        last, end = whole.end_lineno or node.lineno, whole.end_col_offset or whole.col_offset
        column = column_at(self.lines, node.lineno, node.col_offset)
        return Span(self.path, node.lineno, column, last, column_at(self.lines, last, end))

    def branch(self, node: ast.AST, condition: ast.expr, names: Names) -> int:
        """Return 0 if a condition holds, 1 if not; if unknown, record it and return `decided`."""
        found = tested(condition, lambda each: self.value(each, names), self.span(condition))
        holds = decision(found)
        if holds is not None:
            return int(not holds)
        # One branch is taken for all rounds and calls, which may test different values.
        if self.tested.setdefault(node, found) != found:
            self.tested[node] = Tested()
        return self.decided(node, 2)

    def decided(self, node: ast.AST, options: int) -> int:
        """Return the number of the branch that this reading takes, of `options` branches."""
        choice = self.forced.get(node, 0)
        self.decisions.setdefault(node, (choice, options))
        return choice

    # ---- Statements

    def run(self, body: Iterable[ast.stmt], names: Names) -> None:
        """Execute statements, which may change the variables in `names`."""
        for statement in body:
            self.statement(statement, names)

    def statement(self, node: ast.stmt, names: Names) -> None:  # noqa: C901 -- one case each
        """Execute one statement.

        Raises:
            Leaving: it leaves the function, the loop or the launch file.
        """
        match node:
            case ast.FunctionDef(name=name):
                names[name] = Local(node, names)
            case ast.ClassDef(name=name):
                names[name] = LaunchClass(node)
            case ast.Assign(targets=targets, value=value):
                found = self.value(value, names)
                for target in targets:
                    self.assign(target, found, names)
            case ast.AnnAssign(target=target, value=ast.expr() as value):
                self.assign(target, self.value(value, names), names)
            case ast.AugAssign(target=target, op=ast.Add(), value=value):
                added = self.value(value, names)
                before = self.value(target, names)
                if isinstance(before, Listed) and isinstance(added, Listed):
                    before.items += added.items[: MOST_ITEMS - len(before.items)]
                else:
                    self.assign(target, combined(node.op, before, added, self.span(node)), names)
            case ast.Expr(value=value):
                self.value(value, names)
            case ast.Return(value=value):
                raise Returned(None if value is None else self.value(value, names))
            case ast.Raise() if self.strict:
                raise Refused
            case ast.Break() | ast.Continue():
                raise LoopLeft(isinstance(node, ast.Break))
            case ast.If(test=test, body=body, orelse=orelse):
                self.run((body, orelse)[self.branch(node, test, names)], names)
            case ast.Match(cases=cases):
                # None of the cases may fit.
                bodies = [*(case.body for case in cases), []]
                self.run(bodies[self.decided(node, len(bodies))], names)
            case ast.For(target=target, iter=iterated, body=body, orelse=orelse):
                for item in each_of(self.value(iterated, names)):
                    self.assign(target, item, names)
                    if self.steps > MOST_STEPS or self.leaves(body, names):
                        return
                self.run(orelse, names)
            case ast.With(items=opened, body=body):
                for each in opened:
                    if each.optional_vars is not None:
                        self.assign(each.optional_vars, self.value(each.context_expr, names), names)
                self.run(body, names)
            case ast.While(body=body):
                self.leaves(body, names)
            case ast.Try(body=body, handlers=handlers, orelse=orelse, finalbody=final):
                bodies = [[*body, *orelse], *(handler.body for handler in handlers)]
                self.run(bodies[self.decided(node, len(bodies))], names)
                self.run(final, names)
            case _:
                pass

    def leaves(self, body: Iterable[ast.stmt], names: Names) -> bool:
        """Execute the body of a loop once; return whether it leaves the loop (`break`)."""
        try:
            self.run(body, names)
        except LoopLeft as left:
            return left.ends
        return False

    def assign(self, target: ast.expr, value: Value, names: Names) -> None:
        """Assign a value to a target: a name, an item, or several names."""
        match target:
            case ast.Attribute(value=inner, attr=attribute):
                owner = self.value(inner, names)
                if isinstance(owner, LaunchObject):
                    owner.attributes[attribute] = value
            case ast.Subscript(value=ast.Name(id=name), slice=key):
                before = names.get(name)
                if isinstance(before, MappedValue):
                    at = self.value(key, names)
                    names[name] = before.updated((at, value))
            case _:
                bind(target, value, names)

    # ---- Expressions

    def other_value(self, node: ast.expr, names: Names, depth: int) -> Value:
        """Return the value of `:=`, `and`, `or`, a comprehension or lambda; None for others."""
        match node:
            case ast.NamedExpr(target=target, value=value):
                named = self.value(value, names, depth + 1)
                self.assign(target, named, names)
                return named
            case ast.BoolOp(op=ast.Or(), values=values):
                found: Value = None
                for each in values:
                    found = self.value(each, names, depth + 1)
                    # A text that only a run knows counts as true, so that it is followed.
                    if found is not None and truth(each, found) is not False:
                        return found
                return found
            case ast.BoolOp(values=[*before, last]):
                for each in before:
                    found = self.value(each, names, depth + 1)
                    holds = truth(each, found)
                    if holds is False:
                        return found
                    if holds is None and self.branch(each, each, names):
                        return NoneValue()
                return self.value(last, names, depth + 1)
            case (
                ast.ListComp(elt=element, generators=generators)
                | ast.GeneratorExp(elt=element, generators=generators)
                | ast.SetComp(elt=element, generators=generators)
            ):
                scopes = self.scopes(generators, names, depth + 1)
                made = [self.value(element, inner, depth + 1) for inner in scopes]
                return Listed(made, self.span(node))
            case ast.DictComp(key=key, value=value, generators=generators):
                scopes = self.scopes(generators, names, depth + 1)
                pairs: list[tuple[Value, Value]] = []
                for inner in scopes:
                    at = self.value(key, inner, depth + 1)
                    held = self.value(value, inner, depth + 1)
                    # A key and a value that are not known are the same in each round.
                    is_open = at is None and isinstance(held, Plain) and held.text == UNKNOWN
                    if not is_open or (at, held) not in pairs[-1:]:
                        pairs.append((at, held))
                return MappedValue(tuple(pairs))
            case ast.Lambda():
                return Local(node, names)
            case _:
                return None

    def item(self, node: ast.Subscript, names: Names, depth: int) -> Value:
        """Return an item of a list or dictionary, or a launch argument; None if unknown."""
        if is_configurations(node.value):
            found = self.value(node.slice, names, depth + 1)
            return known(PythonCall("LaunchConfiguration", (found,), {}, self.span(node)))
        return super().item(node, names, depth)

    def variable_value(self, node: ast.Name | ast.Attribute, names: Names, depth: int) -> Value:
        """Return the value of a name or an attribute.

        Raises:
            Refused: these branches leave the name without a value.
        """
        match node:
            case ast.Name(id="__file__"):
                return Plain((LaunchDirectory(), "/."), self.span(node))
            case ast.Name(id=name):
                if name in names or name in self.globals:
                    return names.get(name, self.globals.get(name))
                if self.strict and name in self.assigned:
                    raise Refused
                return None
        owner = self.value(node.value, names, depth + 1)
        if node.attr == "parent" and isinstance(owner, Plain):
            return Plain(folder_of(owner.text), owner.span)
        if isinstance(owner, LaunchObject | LaunchClass):
            return self.attribute(owner, node.attr)
        return None

    def alternative(self, node: ast.IfExp, names: Names) -> int:
        """Return the value of `a if c else b` that this reading takes: 0 or 1."""
        return self.branch(node, node.test, names)

    def scopes(
        self, generators: Sequence[ast.comprehension], names: Names, depth: int
    ) -> Iterator[Names]:
        """Yield the variables in each round of a comprehension."""
        if not generators:
            yield dict(names)
            return
        first, *others = generators
        inner = dict(names)
        for item in each_of(self.value(first.iter, names, depth)):
            self.steps += 1
            if self.steps > MOST_STEPS:
                return
            self.assign(first.target, item, inner)
            if not any(self.branch(condition, condition, inner) for condition in first.ifs):
                yield from self.scopes(others, inner, depth)

    def call_value(self, node: ast.Call, names: Names, depth: int) -> Value:
        """Return the value of a call; None if unknown, or the unevaluated call."""
        arguments, named = self.given(node, names, depth)
        span = self.span(node)
        if isinstance(node.func, ast.Attribute):
            if node.func.attr == "get" and is_configurations(node.func.value):
                default = {"default": arguments[1]} if len(arguments) > 1 else {}
                return known(PythonCall("LaunchConfiguration", arguments[:1], default, span))
            done = self.method(node.func, arguments, named, names, depth)
            if not isinstance(done, NotKnown):
                return done
            name = node.func.attr
        elif isinstance(node.func, ast.Name):
            name = node.func.id
            function = names.get(name, self.globals.get(name))
            if isinstance(function, Local):
                return self.call_local(function, arguments, named)
            if isinstance(function, LaunchClass):
                return self.instance(function, arguments, named)
            name = self.called.get(name, name)
        else:
            return None
        # An action that is given `None` is as if nothing were given.
        kept = {key: each for key, each in named.items() if not isinstance(each, NoneValue)}
        given = tuple(None if isinstance(each, NoneValue) else each for each in arguments)
        call = self.made[node] = PythonCall(name, given, kept, span)
        if name == "DeclareLaunchArgument":
            self.declarations += declared_by(call)
        self.declarations += read_by(call)
        result = known(call)
        # Each item of `zip` and of its kind is a new value.
        self.steps += len(items_of(result))
        return result

    def method(
        self,
        func: ast.Attribute,
        arguments: Sequence[Value],
        named: Mapping[str, Value],
        names: Names,
        depth: int,
    ) -> Value | NotKnown:
        """Return the result of a method call, or NOT_KNOWN if the method is not supported."""
        owner = self.value(func.value, names, depth + 1)
        first = arguments[0] if arguments else None
        if isinstance(owner, PythonCall) and owner.name == "LaunchDescription":
            inner = owner.get("initial_entities", 0)
            if func.attr in ("add_action", "add_entity") and isinstance(inner, Listed):
                inner.items.append(first)
            return None
        if isinstance(owner, LaunchObject | LaunchClass):
            found = self.member(owner if isinstance(owner, LaunchClass) else owner.of, func.attr)
            if not isinstance(found, ast.FunctionDef):
                return None
            marks = _decorators(found)
            is_bound = "classmethod" in marks or (
                isinstance(owner, LaunchObject) and "staticmethod" not in marks
            )
            bound: tuple[Value, ...] = (owner,) if is_bound else ()
            return self.call_local(Local(found, self.globals), (*bound, *arguments), named)
        if isinstance(owner, MappedValue) and isinstance(func.value, ast.Name):
            self.steps += len(owner.entries) // ITEMS_A_STEP
            match func.attr, first:
                case "pop", _:
                    names[func.value.id] = owner.without(first)
                    return picked(owner, first)
                case "update", MappedValue():
                    names[func.value.id] = owner.updated(*first.entries)
                    return None
        return known_method(owner, func.attr, arguments, named)

    def instance(
        self, of: LaunchClass, arguments: Sequence[Value], named: Mapping[str, Value]
    ) -> Value:
        """Return a new object of a class in the file, initialised with the arguments."""
        made = LaunchObject(of)
        entry = self.member(of, "__init__")
        if isinstance(entry, ast.FunctionDef):
            self.call_local(Local(entry, self.globals), (made, *arguments), named)
        else:
            fields = (each for each in of.of.body if isinstance(each, ast.AnnAssign))
            keys = [each.target.id for each in fields if isinstance(each.target, ast.Name)]
            made.attributes.update({**dict(zip(keys, arguments, strict=False)), **named})
        return made

    def attribute(self, owner: LaunchObject | LaunchClass, name: str) -> Value:
        """Return an attribute, constant or property of an object or class, None if unknown."""
        if isinstance(owner, LaunchObject) and name in owner.attributes:
            return owner.attributes[name]
        found = self.member(owner if isinstance(owner, LaunchClass) else owner.of, name)
        if isinstance(found, ast.FunctionDef):
            is_property = "property" in _decorators(found) and isinstance(owner, LaunchObject)
            return (
                self.call_local(Local(found, self.globals), (owner,), {}) if is_property else None
            )
        return None if found is None else self.value(found, self.globals)

    def member(self, of: LaunchClass, name: str) -> ast.FunctionDef | ast.expr | None:
        """Return the method or value `name` of a class or its bases in the file, or None."""
        waiting, seen = [of.of], set[str]()
        while waiting:
            node = waiting.pop(0)
            seen.add(node.name)
            self.steps += len(node.body) // ITEMS_A_STEP
            for defined, member in members_of(node):
                if defined == name:
                    return member
            bases = (self.globals.get(each.id) for each in node.bases if isinstance(each, ast.Name))
            waiting += (b.of for b in bases if isinstance(b, LaunchClass) and b.of.name not in seen)
        return None

    def call_local(
        self, function: Local, arguments: Sequence[Value], named: Mapping[str, Value]
    ) -> Value:
        """Return the result of executing a function of the file, None if unknown."""
        self.calls += 1
        if self.depth >= _DEEPEST_CALL or self.calls > _MOST_CALLS:
            return None
        parameters = function.of.args
        names: Names = {} if function.names is self.globals else dict(function.names)
        every = [*parameters.posonlyargs, *parameters.args]
        names |= dict.fromkeys(each.arg for each in (*every, *parameters.kwonlyargs))
        for parameter, default in defaults_of(parameters).items():
            names[parameter] = self.value(default, self.globals)
        names.update(zip((each.arg for each in every), arguments, strict=False))
        if parameters.vararg is not None:
            names[parameters.vararg.arg] = Listed(list(arguments[len(every) :]))
        own = {parameter.arg for parameter in (*every, *parameters.kwonlyargs)}
        names.update((name, value) for name, value in named.items() if name in own)
        if parameters.kwarg is not None:
            span = self.span(function.of)
            names[parameters.kwarg.arg] = MappedValue(
                tuple((Plain((key,), span), v) for key, v in named.items() if key not in own)
            )
        self.depth += 1
        try:
            if isinstance(function.of, ast.Lambda):
                return self.value(function.of.body, names)
            self.run(function.of.body, names)
        except Returned as returned:
            return returned.value
        finally:
            self.depth -= 1
        return None


def _decorators(function: ast.FunctionDef) -> set[str]:
    """Return the names of the decorators of a function."""
    return {each.id for each in function.decorator_list if isinstance(each, ast.Name)}


class Leaving(Exception):  # noqa: N818 -- control flow, not an error
    """The base of the exceptions for statements that leave a block of a launch file early."""


class Returned(Leaving):
    """A function returns."""

    def __init__(self, value: Value) -> None:
        """Keep the returned value."""
        super().__init__()
        self.value = value


class LoopLeft(Leaving):
    """The end of a round of a loop; with `ends` (`break`), of the whole loop."""

    def __init__(self, ends: bool) -> None:
        """Store whether the whole loop ends."""
        super().__init__()
        self.ends = ends


class Refused(Leaving):
    """An exception that the file raises, or a variable without a value in these branches."""
