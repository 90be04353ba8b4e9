"""Values that sources in Python give to parameters, to attributes of classes and to objects."""

import ast
from collections.abc import Callable, Iterable, Iterator, Sequence

from mars_asp.exchange.ros2.python_files import argument_of, members_of, passed_by

#: The parameters of a class without a constructor.
NO_PARAMETERS = ast.arguments([], [], None, [], [], None, [])


def declared(call: ast.Call, name: str) -> Iterator[tuple[ast.expr, ast.expr]]:
    """Yield name and default of each parameter that a call of the function `name` declares."""
    if name == "declare_parameter":
        given = argument_of(call, 0, "name")
        value = argument_of(call, 1, "value")
        if given is not None and value is not None:
            yield given, value
    elif name == "declare_parameters":
        listed = argument_of(call, 1, "parameters")
        space = argument_of(call, 0, "namespace")
        prefix = space.value if isinstance(space, ast.Constant) else ""
        for each in listed.elts if isinstance(listed, ast.List | ast.Tuple) else ():
            match each:
                case ast.Tuple(elts=[ast.Constant(value=str() as key), default, *_]):
                    yield ast.Constant(f"{prefix!s}.{key}" if prefix else key), default


def given_by(
    parameters: ast.arguments, call: ast.Call, text: Callable[[ast.expr], str | None]
) -> dict[str, ast.expr]:
    """Return the arguments of a call of a class by name: their texts, or None if unknown."""
    given = passed_by(call, [each.arg for each in parameters.args[1:]])
    return {name: ast.Constant(text(value)) for name, value in given.items()}


def alternatives(part: ast.AST, calls: Sequence[ast.Call]) -> Iterator[list[ast.Call]]:
    """Yield groups of calls: those in branches of one `if` together, every other one alone."""
    left = {id(call): call for call in calls}
    for test in ast.walk(part) if len(calls) > 1 else ():
        if isinstance(test, ast.If) and test.orelse:
            within = range(test.lineno, (test.end_lineno or 0) + 1)
            if sum(call.lineno in within for call in calls) < 2:
                continue
            sides = [
                [each for of in side for each in ast.walk(of) if id(each) in left]
                for side in (test.body, test.orelse)
            ]
            if all(sides):
                yield [left.pop(id(each)) for side in sides for each in side]
    yield from ([call] for call in left.values())


def made_alike(made: Sequence[dict[str, ast.expr]]) -> dict[str, ast.expr]:
    """Return the arguments that several objects have in common, None where they differ."""
    first, *others = made
    return {
        name: value
        if all(ast.dump(each[name]) == ast.dump(value) for each in others if name in each)
        else ast.Constant(None)
        for name, value in first.items()
    }


def parameters_of(node: ast.ClassDef) -> ast.arguments:
    """Return the parameters of a class's `__init__`, or of none."""
    made = next((each for name, each in members_of(node) if name == "__init__"), None)
    return made.args if isinstance(made, ast.FunctionDef) else NO_PARAMETERS


def distinct(made: Iterable[dict[str, ast.expr]]) -> list[dict[str, ast.expr]]:
    """Return the arguments of objects without duplicates."""
    found = {tuple((name, ast.dump(value)) for name, value in each.items()): each for each in made}
    return list(found.values())


def constants_of(node: ast.AST | None) -> dict[str, ast.expr]:
    """Return the values that the body of a class assigns, by name."""
    return {name: value for name, value in members_of(node) if isinstance(value, ast.expr)}
