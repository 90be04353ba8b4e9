"""What expressions in sources in Python are, where that is written out: texts and numbers."""

import ast
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from typing import TypeVar

from mars_asp.exchange.ros2.python_files import (
    PythonFiles,
    SourceFile,
    called_name,
    dotted_name,
    keeper_of,
)
from mars_asp.exchange.ros2.python_scopes import OF_LOOP, UNKNOWN, CodePlace, scopes_of
from mars_asp.exchange.ros2.python_written import constants_of, declared, rounds

T = TypeVar("T")

#: Functions that hand on the value of a parameter.
_PASSED_ON = frozenset({"get_parameter_value", "as_string", "str", "bool"})
#: The sign around the name of a parameter within a text.
_MARK = "\0"
#: How many expressions are looked into for a name.
_MOST_STEPS = 1000
_DEEPEST = 60
_MOST_TEXT = 1000
#: So many values of one expression count.
_MOST_CHOICES = 64
_EMPTY = frozenset({ast.dump(ast.Constant(None)), ast.dump(ast.Constant(""))})
#: Over so many files a constant is followed.
_FARTHEST = 8
#: Where texts have holes: those of `%`, and those of `format` that are plain.
_PERCENT, _BRACES = re.compile(r"%()[sd]"), re.compile(r"\{(\d{0,2})\}")
_HOLE = re.compile(r"[%{}]")


class PythonTexts:
    """The expressions of a class or function, with the names that hold within it."""

    def __init__(
        self,
        files: PythonFiles,
        file: SourceFile,
        node: ast.AST,
        far: int = 0,
        given: Mapping[str, ast.expr] | None = None,
    ) -> None:
        """Take a part of a file, and the values of `given` parameters of its class.

        `far` is over how many files a constant was followed to here.
        """
        self.files = files
        self.far = far
        self.file = file
        self.node = node
        self.steps = 0
        #: Whether parameters within a text are marked, instead of replaced by their defaults.
        self.is_marking = False
        [self.scopes] = files.once(scopes_of, node)
        #: Where an expression is, and the names that a loop has there.
        self.place, self.bound = CodePlace(), dict[str, ast.expr]()
        #: Which of several values is taken, by their places; None where there must be one.
        self.taken: dict[tuple[int, ...], int] | None = None
        self._met: dict[tuple[int, ...], int] = {}
        #: Whether the last expression has more values than were taken.
        self.has_more = False
        self._given = dict(given or {})
        # A name of the class itself is an attribute of each object.
        of_class = {f"self.{name}": value for name, value in constants_of(node)}
        self._constants = {**file.constants, **of_class}
        self.parameters: dict[str, ast.expr] = {}
        keepers = self.scopes.keepers
        self.calls = [(call, keepers.get(call)) for call, _ in self.scopes.calls]
        self.places = {id(call): place for call, place in self.scopes.calls}
        for each, place in self.scopes.calls:
            for written, default in declared(each, called_name(each)):
                self.place = place
                name = self.text(written)
                if name is not None:
                    self.parameters[name] = default
        self.calls.sort(key=lambda pair: (pair[0].lineno, pair[0].col_offset))

    def rounds_of(self, call: ast.Call) -> Iterator[None]:
        """Go through the rounds of the loops around a call; names are then those of each."""
        self.place, self.bound, self.steps = self.places[id(call)], {}, 0
        for bound in rounds(self.place.loops, self.gone_over):
            self.bound, self.steps = bound, 0
            yield

    def choices(self) -> Iterator[None]:
        """Go through the ways to take one of several values, the first of each to begin with.

        Each time the expression is to be looked into, to find those that it has.
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
        """Return which of several values is taken; None if there should be one."""
        if len(values) == 1:
            return 0
        if self.taken is None:
            return None
        key = tuple(map(id, values))
        self._met[key] = len(values)
        return self.taken.get(key, 0)

    def follow(
        self, node: ast.expr, look: "Callable[[ast.expr, int], T | None]", depth: int
    ) -> "T | None":
        """Return the result of looking into the value of a name, where it is assigned."""
        held = self.held(node)
        if held is None:
            return None
        value, place = held
        before = self.place, self.bound
        if place is not None and place.functions != self.place.functions:
            self.bound = {}
        self.place = place or self.place
        found = look(value, depth + 1)
        self.place, self.bound = before
        return found

    def held(self, node: ast.expr) -> tuple[ast.expr, CodePlace | None] | None:
        """Return the value of a name at this place, and the place of that value."""
        name = keeper_of(node) or ""
        if name.startswith("cls."):
            name = f"self.{name[4:]}"
        several = self.scopes.values(name, self.place)
        # A variable may be empty at first.
        filled = [each for each in several if ast.dump(each.value) not in _EMPTY]
        distinct = list({_identity(each.value): each for each in filled or several}.values())
        if not distinct:
            constant = self._constants.get(name)
            return None if constant is None else (constant, None)
        at = self._one_of([each.value for each in distinct])
        if at is None:
            return UNKNOWN, None
        value, place, function = distinct[at]
        if value is OF_LOOP and name in self.bound:
            return self.bound[name], None
        if function is not None:
            return self._passed(function, name)
        start = getattr(value, "lineno", place.at[0]), getattr(value, "col_offset", place.at[1])
        return value, place._replace(at=start)

    def _passed(self, function: ast.AST, name: str) -> tuple[ast.expr, CodePlace | None]:
        """Return the value that a call in this part gives for a parameter of a function."""
        if not isinstance(function, ast.FunctionDef) or function.name == "__init__":
            return self._given.get(name, UNKNOWN), None
        calls = self._calls_by_name.get(function.name, [])
        at = self._one_of(calls) if calls else None
        if at is None:
            return UNKNOWN, None
        call, given = calls[at], dict[str, ast.expr]()
        arguments = function.args
        names = [each.arg for each in (*arguments.posonlyargs, *arguments.args)]
        last = names[len(names) - len(arguments.defaults) :]
        given |= zip(last, arguments.defaults, strict=True)
        is_method = isinstance(call.func, ast.Attribute) and names[:1] in (["self"], ["cls"])
        given |= zip(names[is_method:], call.args, strict=False)
        given |= {each.arg: each.value for each in call.keywords if each.arg}
        return given.get(name, UNKNOWN), self.places[id(call)]

    @cached_property
    def _calls_by_name(self) -> dict[str, list[ast.Call]]:
        """The calls of functions and of the methods of this class, by name."""
        found: dict[str, list[ast.Call]] = {}
        for call, _ in self.calls:
            if dotted_name(call.func).rpartition(".")[0] in ("", "self", "cls"):
                found.setdefault(called_name(call), []).append(call)
        return found

    def parameter(self, node: ast.expr, depth: int = 0) -> str | None:
        """Return the parameter whose value an expression is."""
        self.steps += 1
        if depth > _DEEPEST or self.steps > _MOST_STEPS:
            return None
        match node:
            case ast.Attribute(value=inner, attr="value" | "string_value" | "bool_value"):
                return self.parameter(inner, depth + 1)
            case ast.Call() if called_name(node) in _PASSED_ON:
                if isinstance(node.func, ast.Attribute):
                    return self.parameter(node.func.value, depth + 1)
                return self.parameter(node.args[0], depth + 1) if node.args else None
            case ast.Call() if called_name(node) in (
                "get_parameter",
                "declare_parameter",
                "get_param",
                "get_parameter_or",
            ):
                name = self.text(node.args[0]) if node.args else None
                if name is not None and len(node.args) > 1:
                    self.parameters.setdefault(name, node.args[1])
                return None if name is None else name.lstrip("~")
            case ast.Name() | ast.Attribute():
                return self.follow(node, self.parameter, depth)
            case ast.IfExp(body=body, orelse=orelse):
                at = self._one_of((body, orelse))
                return None if at is None else self.parameter((body, orelse)[at], depth + 1)
            case _:
                return None

    def switches(self, call: ast.Call) -> frozenset[tuple[str, bool]]:
        """Return the parameters that decide whether a call is reached, each with its value."""
        found: set[tuple[str, bool]] = set()
        self.place, self.bound = self.places[id(call)], {}
        for test, holds in self.place.tests:
            is_all = isinstance(test, ast.BoolOp) and isinstance(test.op, ast.And)
            parts = test.values if isinstance(test, ast.BoolOp) and is_all and holds else [test]
            for part in parts:
                negated = isinstance(part, ast.UnaryOp) and isinstance(part.op, ast.Not)
                inner = part.operand if isinstance(part, ast.UnaryOp) and negated else part
                self.steps = 0
                parameter = self.parameter(inner)
                if parameter is not None:
                    found.add((parameter, holds != negated))
        return frozenset(found)

    def constant(self, node: ast.expr) -> tuple[SourceFile, ast.expr] | None:
        """Return what a constant of another class or file is, and the file of the workspace."""
        names = (keeper_of(node) or "").removesuffix(".value").split(".")
        full = [*self.file.imports.get(names[0], names[0]).split("."), *names[1:]]
        for file, inner in (
            (self.file, names),
            (self.files.file(".".join(full[:-1])), full[-1:]),
            (self.files.file(".".join(full[:-2])), full[-2:]),
        ):
            if file is not None and 1 <= len(inner) <= 2:
                of_class = dict(constants_of(file.outer.get(inner[0])))
                held = of_class.get(inner[1]) if inner[1:] else file.constants.get(inner[0])
                if held is not None:
                    return file, held
        return None

    def imported(self, node: ast.expr) -> str | None:
        """Return the text of a constant of another class or file."""
        found = self.constant(node) if self.far < _FARTHEST else None
        if found is None:
            return None
        file, held = found
        return PythonTexts(self.files, file, ast.Module([], []), self.far + 1).text(held)

    def gone_over(self, node: ast.expr) -> ast.expr | None:
        """Return the values of a loop over a name."""
        held = self.held(node)
        if held is not None:
            return held[0]
        found = self.constant(node)
        return None if found is None else found[1]

    def text(self, node: ast.expr, depth: int = 0) -> str | None:
        """Return the text that an expression is, if it is written somewhere."""
        self.steps += 1
        if depth > _DEEPEST or self.steps > _MOST_STEPS:
            return None
        match node:
            case ast.Constant(value=str() as value):
                return value
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                first, second = self.text(left, depth + 1), self.text(right, depth + 1)
                return None if first is None or second is None else first + second
            case ast.BinOp(left=left, op=ast.Mod(), right=right):
                given = right.elts if isinstance(right, ast.Tuple) else [right]
                return self.filled(_PERCENT, left, given, depth)
            case ast.JoinedStr(values=values):
                parts = [
                    self.part(v.value if isinstance(v, ast.FormattedValue) else v, depth + 1)
                    for v in values
                    if not isinstance(v, ast.FormattedValue) or v.format_spec is None
                ]
                known = None not in parts and len(parts) == len(values)
                return "".join(filter(None, parts)) if known else None
            case ast.Call(func=ast.Name(id="str"), args=[inner]) if not self.parameter(node):
                return self.part(inner, depth + 1)
            case ast.Call(func=ast.Attribute(value=form, attr="format"), args=given, keywords=[]):
                return self.filled(_BRACES, form, given, depth)
            case ast.Call(
                func=ast.Attribute(value=ast.Constant(value=str() as between), attr="join"),
                args=[ast.List(elts=given) | ast.Tuple(elts=given)],
            ):
                parts = [self.part(each, depth + 1) for each in given]
                return None if None in parts else between.join(filter(None, parts))
            case ast.Name() | ast.Attribute():
                parameter = self.parameter(node)
                if parameter is not None:
                    return self.default_of(parameter, depth)
                is_known = self.held(node) is not None
                return self.follow(node, self.text, depth) if is_known else self.imported(node)
            case ast.IfExp(body=body, orelse=orelse):
                at = self._one_of((body, orelse))
                return None if at is None else self.text((body, orelse)[at], depth + 1)
            case ast.Call():
                parameter = self.parameter(node)
                return None if parameter is None else self.default_of(parameter, depth)
            case _:
                return None

    def default_of(self, parameter: str, depth: int = 0) -> str | None:
        """Return the default of a parameter, or its mark."""
        if self.is_marking:
            return f"{_MARK}{parameter}{_MARK}"
        default = self.parameters.get(parameter, self.parameters.get(f"~{parameter}"))
        return None if default is None else self.part(default, depth + 1)

    def name_parts(self, node: ast.expr) -> tuple[tuple[str | None, str | None], ...]:
        """Return the parts of a text with parameters in it, each default with its parameter."""
        self.steps, self.is_marking = 0, True
        marked = self.text(node)
        self.steps, self.is_marking = 0, False
        pieces = (marked or "").split(_MARK)
        if len(pieces) < 2:
            return ()
        return tuple(
            (self.default_of(piece), piece) if at % 2 else (piece, None)
            for at, piece in enumerate(pieces)
        )

    def part(self, node: ast.expr, depth: int) -> str | None:
        """Return what an expression, a text or a whole number, is within a text."""
        self.steps += 1
        match node:
            case ast.Name() | ast.Attribute() if depth < _DEEPEST and self.held(node) is not None:
                return self.follow(node, self.part, depth)
            case ast.Constant(value=bool()):
                return None
            case ast.Constant(value=int() as value) if abs(value) < _MOST_TEXT:
                return str(value)
            case _:
                return self.text(node, depth)

    def filled(
        self, holes: re.Pattern[str], form: ast.expr, given: Sequence[ast.expr], depth: int
    ) -> str | None:
        """Return a text with its holes filled, each by its number or else in order."""
        text = self.text(form, depth + 1)
        parts = [self.part(each, depth + 1) for each in given]
        if text is None or None in parts:
            return None
        order = iter(range(len(parts)))
        pieces = holes.split(text)
        for at in range(1, len(pieces), 2):
            number = int(pieces[at]) if pieces[at] else next(order, len(parts))
            if number >= len(parts):
                return None
            pieces[at] = parts[number] or ""
        filled = "".join(pieces)
        return filled if len(filled) < _MOST_TEXT and not _HOLE.search(filled) else None

    def number(self, node: ast.expr, depth: int = 0) -> Fraction | None:
        """Return the number that an expression is, if it is written somewhere."""
        self.steps += 1
        if depth > _DEEPEST or self.steps > _MOST_STEPS:
            return None
        match node:
            case ast.Constant(value=bool()):
                return None
            case ast.Constant(value=int() | float() as value):
                text = repr(value)
                return Fraction(text) if text not in ("inf", "nan") else None
            case ast.BinOp(left=left, op=ast.Div() | ast.Mult() as sign, right=right):
                first, second = self.number(left, depth + 1), self.number(right, depth + 1)
                if first is None or second is None:
                    return None
                if isinstance(sign, ast.Mult):
                    return first * second
                return first / second if second else None
            case ast.Name() | ast.Attribute():
                return self.follow(node, self.number, depth)
            case ast.Call() if called_name(node) in ("Duration", "float", "from_sec") and node.args:
                return self.number(node.args[0], depth + 1)
            case ast.Call(keywords=[ast.keyword(arg="seconds", value=value)]):
                return self.number(value, depth + 1)
            case _:
                return None


def _identity(value: ast.expr) -> str | int:
    """Return a text for a value that is the same at any place, else a number of its own."""
    names = {each.id for each in ast.walk(value) if isinstance(each, ast.Name)}
    return ast.dump(value) if names <= {"self"} else id(value)
