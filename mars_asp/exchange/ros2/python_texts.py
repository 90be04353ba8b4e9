"""Values of expressions in sources of nodes in Python: texts, numbers and names of types."""

import ast
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import NamedTuple

from mars_asp.diagnostic import Span, point
from mars_asp.exchange.ros2.actions import UNKNOWN, OwnParameter, plain
from mars_asp.exchange.ros2.python_expressions import ExpressionEvaluator, bind
from mars_asp.exchange.ros2.python_files import (
    PythonFiles,
    SourceFile,
    called_name,
    defaults_of,
    dotted_name,
    passed_by,
)
from mars_asp.exchange.ros2.python_scopes import (
    OF_LOOP,
    UNKNOWN_VALUE,
    CodePlace,
    Scopes,
    SourceLoop,
)
from mars_asp.exchange.ros2.python_values import (
    Listed,
    MappedValue,
    Names,
    NotKnown,
    Plain,
    PythonCall,
    PythonName,
    Value,
    each_of,
    known,
    known_method,
)
from mars_asp.exchange.ros2.python_written import constants_of, declared

#: Functions that return the value of a parameter, and attributes of its object that are the value.
_GETS = frozenset({"get_parameter", "declare_parameter", "get_param", "get_parameter_or"})
_PASSED_ON = frozenset({"get_parameter_value", "as_string", "bool"})
_VALUES = frozenset({"value", "string_value", "bool_value"})
#: Functions that return a quantity of a number.
_QUANTITIES = frozenset({"Duration", "float", "from_sec"})
#: So many values of one expression count, and so many rounds of the loops around one.
_MOST_CHOICES = _MOST_ROUNDS = 64
_EMPTY = frozenset({ast.dump(ast.Constant(None)), ast.dump(ast.Constant(""))})
#: Over so many files a constant is followed.
_FARTHEST = 8


#: A part of a program without statements.
NO_CODE = ast.Module([], [])


class SourceScope(NamedTuple):
    """The place of an expression, and the values of the loop variables around it."""

    place: CodePlace = CodePlace()
    bound: Mapping[str, Value] = {}


class PythonTexts(ExpressionEvaluator[SourceScope]):
    """Evaluates the expressions of a class or function by the variables within it."""

    most_steps = 1000
    deepest = 60

    def __init__(
        self,
        files: PythonFiles,
        file: SourceFile,
        node: ast.AST,
        far: int = 0,
        given: Mapping[str, ast.expr] | None = None,
    ) -> None:
        """Begin with a part `node` of a file, and with values of `given` parameters of its class.

        `far` is over how many files a constant was followed to here.
        """
        super().__init__()
        self.files = files
        self.far = far
        self.file = file
        self.node = node
        self.scopes = files.once(Scopes, node)
        self.scope = SourceScope()
        self._span = point(file.path, 1, 1)
        #: Which of several values is taken, by their places; None where there must be one.
        self.taken: dict[tuple[int, ...], int] | None = None
        self._met: dict[tuple[int, ...], int] = {}
        #: Whether the last expression has more values than were taken.
        self.has_more = False
        self._given = dict(given or {})
        # A name of the class itself is an attribute of each object.
        of_class = {f"self.{name}": value for name, value in constants_of(node).items()}
        self._constants = {**file.constants, **of_class}
        self.parameters: dict[str, ast.expr] = {}
        keepers = self.scopes.keepers
        self.calls = [(call, keepers.get(call)) for call, _ in self.scopes.calls]
        self.places = {id(call): place for call, place in self.scopes.calls}
        for each, place in self.scopes.calls:
            for written, default in declared(each, called_name(each)):
                self.scope = SourceScope(place)
                name = self.text(written)
                if name is not None:
                    self.parameters[name] = default
        self.calls.sort(key=lambda pair: (pair[0].lineno, pair[0].col_offset))

    def go_to(self, call: ast.Call) -> None:
        """Move later evaluations to the location of a call, with a new limit of steps."""
        self.scope, self.steps = SourceScope(self.places[id(call)]), 0

    def rounds_of(self, call: ast.Call) -> Iterator[None]:
        """Yield in each round of loops around a call, up to a limit, with loop variables set."""
        self.go_to(call)
        rounds = self._rounds(self.scope.place.loops, self.scope)
        for self.scope in islice(rounds, _MOST_ROUNDS):
            self.steps = 0
            yield

    def _rounds(self, loops: Sequence[SourceLoop], scope: SourceScope) -> Iterator[SourceScope]:
        """Yield the scope in each round of nested loops."""
        if not loops:
            yield scope
            return
        (target, over), *inner = loops
        for item in each_of(self.value(over, scope))[:_MOST_ROUNDS]:
            bound: Names = dict(scope.bound)
            bind(target, item, bound)
            yield from self._rounds(inner, scope._replace(bound=bound))

    def choices(self) -> Iterator[None]:
        """Yield once for each combination of values, where variables have several.

        The first round takes first values. In each round the expression has to be evaluated again,
        which finds further choices.
        """
        waiting: list[dict[tuple[int, ...], int]] = [{}]
        for _ in range(_MOST_CHOICES):
            if not waiting:
                break
            chosen = waiting.pop()
            self.taken, self._met, self.steps = chosen, {}, 0
            yield
            before = dict(chosen)
            for key, several in self._met.items():
                if key not in before:
                    waiting += ({**before, key: at} for at in range(1, several))
                    before[key] = 0
        self.taken, self.has_more = None, bool(waiting)

    def _one_of(self, values: Sequence[ast.expr]) -> int | None:
        """Return the index of the value to take; None if there are several outside `choices`."""
        if len(values) == 1:
            return 0
        if self.taken is None:
            return None
        key = tuple(map(id, values))
        self._met[key] = len(values)
        return self.taken.get(key, 0)

    def held(self, node: ast.expr, scope: SourceScope) -> tuple[ast.expr, SourceScope] | None:
        """Return the expression assigned to a variable, with its scope; None if there is none."""
        name = dotted_name(node)
        if name.startswith("cls."):
            name = f"self.{name[4:]}"
        several = self.scopes.values(name, scope.place)
        # A variable may be empty at first.
        filled = [each for each in several if ast.dump(each.value) not in _EMPTY]
        distinct = list({_identity(each.value): each for each in filled or several}.values())
        if not distinct:
            constant = self._constants.get(name)
            return None if constant is None else (constant, scope)
        at = self._one_of([each.value for each in distinct])
        if at is None:
            return UNKNOWN_VALUE, scope
        value, place, function = distinct[at]
        if value is OF_LOOP:
            return value, scope
        if function is not None:
            value, place = self._passed(function, name, scope.place)
        else:
            start = getattr(value, "lineno", place.at[0]), getattr(value, "col_offset", place.at[1])
            place = place._replace(at=start)
        is_here = place.functions == scope.place.functions
        return value, SourceScope(place, scope.bound if is_here else {})

    def _passed(self, function: ast.AST, name: str, place: CodePlace) -> tuple[ast.expr, CodePlace]:
        """Return the argument for a parameter `name` in a call of its function, with its place."""
        if not isinstance(function, ast.FunctionDef) or function.name == "__init__":
            return self._given.get(name, UNKNOWN_VALUE), place
        calls = self._calls_by_name.get(function.name, [])
        at = self._one_of(calls) if calls else None
        if at is None:
            return UNKNOWN_VALUE, place
        call = calls[at]
        names = [each.arg for each in (*function.args.posonlyargs, *function.args.args)]
        is_method = isinstance(call.func, ast.Attribute) and names[:1] in (["self"], ["cls"])
        given = defaults_of(function.args) | passed_by(call, names[is_method:])
        return given.get(name, UNKNOWN_VALUE), self.places[id(call)]

    @cached_property
    def _calls_by_name(self) -> dict[str, list[ast.Call]]:
        """The calls of functions and of the methods of this class, by name."""
        found: dict[str, list[ast.Call]] = {}
        for call, _ in self.calls:
            if dotted_name(call.func).rpartition(".")[0] in ("", "self", "cls"):
                found.setdefault(called_name(call), []).append(call)
        return found

    def span(self, node: ast.expr | ast.stmt) -> Span:
        """Return the location of the file, as no other locations are needed."""
        return self._span

    def alternative(self, node: ast.IfExp, scope: SourceScope) -> int | None:
        """Return the branch of `a if c else b` that this round takes, or None outside `choices`."""
        return self._one_of((node.body, node.orelse))

    def variable_value(
        self, node: ast.Name | ast.Attribute, scope: SourceScope, depth: int
    ) -> Value:
        """Return the value of a variable, of a constant of the workspace, or the imported name."""
        owner = None
        if isinstance(node, ast.Attribute) and node.attr in _VALUES:
            owner = self.value(node.value, scope, depth + 1)
            if parameter_of(owner) is not None:
                return owner
        held = self.held(node, scope)
        if held is not None:
            value, inner = held
            if value is OF_LOOP:
                return scope.bound.get(dotted_name(node))
            return self.value(value, inner, depth + 1)
        constant = self.constant_of(node) if self.far < _FARTHEST else None
        if constant is not None:
            file, value = constant
            other = PythonTexts(self.files, file, NO_CODE, self.far + 1)
            other.steps = self.steps
            result = other.value(value, SourceScope(), depth + 1)
            self.steps = other.steps
            return result
        first, dot, rest = dotted_name(node).partition(".")
        return PythonName(f"{self.file.imports.get(first, first)}{dot}{rest}") if first else None

    def call_value(self, node: ast.Call, scope: SourceScope, depth: int) -> Value:
        """Return the value of a call: a parameter, a quantity, or that of a known function."""
        name = called_name(node)
        if name in _GETS:
            first = self.value(node.args[0], scope, depth + 1) if node.args else None
            parameter = self.text_of(first, depth + 1)
            if parameter is None:
                return None
            if len(node.args) > 1:
                self.parameters.setdefault(parameter, node.args[1])
            return Plain((OwnParameter(parameter.lstrip("~")),), self._span)
        arguments, named = self.given(node, scope, depth)
        owner = next(iter(arguments), None)
        if isinstance(node.func, ast.Attribute):
            owner = self.value(node.func.value, scope, depth + 1)
        if name in _PASSED_ON:
            return None if parameter_of(owner) is None else owner
        quantity = named.get("seconds") if len(named) == 1 else None
        if name in _QUANTITIES and arguments:
            quantity = arguments[0]
        if isinstance(quantity, Plain) and quantity.number is not None:
            return Plain(UNKNOWN, self._span, quantity.number)
        if name == "enumerate" and not isinstance(owner, Listed | MappedValue):
            # Not even the number of the first round is that of all.
            return None
        done = known_method(owner, name, arguments, named)
        if isinstance(done, NotKnown):
            done = known(PythonCall(name, arguments, named, self._span))
        return done

    def literal_value(self, node: ast.Constant) -> Value:
        """Return the value of a literal, or None for a boolean, which names never contain."""
        return None if isinstance(node.value, bool) else super().literal_value(node)

    def switches(self, call: ast.Call) -> frozenset[tuple[str, bool]]:
        """Return the ROS parameters that decide whether a call is reached, with their values."""
        found: set[tuple[str, bool]] = set()
        self.go_to(call)
        for test, holds in self.scope.place.tests:
            is_all = isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And)
            parts = test.values if isinstance(test, ast.BoolOp) and is_all and holds else [test]
            for part in parts:
                negated = isinstance(part, ast.UnaryOp) and isinstance(part.op, ast.Not)
                inner = part.operand if isinstance(part, ast.UnaryOp) and negated else part
                self.steps = 0
                parameter = parameter_of(self.value(inner, self.scope))
                if parameter is not None:
                    found.add((parameter, holds != negated))
        return frozenset(found)

    def constant_of(self, node: ast.expr) -> tuple[SourceFile, ast.expr] | None:
        """Return a constant of another class or file, with its file; None if there is none."""
        names = dotted_name(node).removesuffix(".value").split(".")
        full = [*self.file.imports.get(names[0], names[0]).split("."), *names[1:]]
        for file, inner in (
            (self.file, names),
            (self.files.file(".".join(full[:-1])), full[-1:]),
            (self.files.file(".".join(full[:-2])), full[-2:]),
        ):
            if file is not None and 1 <= len(inner) <= 2:
                of_class = constants_of(file.outer.get(inner[0]))
                held = of_class.get(inner[1]) if inner[1:] else file.constants.get(inner[0])
                if held is not None:
                    return file, held
        return None

    def text(self, node: ast.expr) -> str | None:
        """Return an expression's string, with defaults of ROS parameters; None if unknown."""
        return self.text_of(self.value(node, self.scope))

    def text_of(self, value: Value, depth: int = 0) -> str | None:
        """Return a value's string, with the defaults of ROS parameters; None if unknown."""
        if not isinstance(value, Plain) or value.number is not None:
            return None
        parts = [
            self.default_of(part.name, depth) if isinstance(part, OwnParameter) else part
            for part in value.text
        ]
        known = [part for part in parts if isinstance(part, str)]
        return "".join(known) if len(known) == len(parts) else None

    def name_parts(self, value: Value) -> tuple[tuple[str | None, str | None], ...]:
        """Return pairs (text or default, ROS parameter or None) of a name with parameters.

        The result is empty without a parameter, or if a part is unknown.
        """
        text = value.text if isinstance(value, Plain) else ()
        is_known = all(isinstance(part, str | OwnParameter) for part in text)
        if not is_known or all(isinstance(part, str) for part in text):
            return ()
        return tuple(
            (part, None) if isinstance(part, str) else (self.default_of(part.name), part.name)
            for part in text
            if isinstance(part, str | OwnParameter)
        )

    def default_of(self, parameter: str, depth: int = 0) -> str | None:
        """Return the default of a ROS parameter; None if neither a text nor an integer."""
        default = self.parameters.get(parameter, self.parameters.get(f"~{parameter}"))
        value = None if default is None else self.value(default, self.scope, depth + 1)
        if isinstance(value, Plain) and value.number is not None:
            text = plain(value.text) or ""
            return text if text.isdigit() else None
        return self.text_of(value, depth + 1)

    def number(self, node: ast.expr) -> Fraction | None:
        """Return the number that an expression evaluates to, or None."""
        value = self.value(node, self.scope)
        return value.number if isinstance(value, Plain) else None

    def type(self, node: ast.expr) -> str | None:
        """Return the message type that an expression names, or None."""
        value = self.value(node, self.scope)
        return value.full.replace(".", "/") if isinstance(value, PythonName) else None


def parameter_of(value: Value) -> str | None:
    """Return the ROS parameter whose value this is, or None for another value."""
    match value:
        case Plain((OwnParameter(name),)):
            return name
        case _:
            return None


def _identity(value: ast.expr) -> str | int:
    """Return equal keys for equal values, as far as these do not depend on their location."""
    names = {each.id for each in ast.walk(value) if isinstance(each, ast.Name)}
    return ast.dump(value) if names <= {"self"} else id(value)
