"""Function declarations of Python: the `def ...:` is cut out and read by Python's own parser."""

import ast
import re
import warnings

from mars_asp.annotations.declarations.declaration import (
    DeclaredParameter,
    NoFunction,
    SourceDeclaration,
)

_DEF = re.compile(r"(?:async\s+)?def\b\s*\w+\s*")
_ANYTHING = re.compile(r"\w+|\S")
_SOLID = re.compile(r"\S")


def read_python(text: str, code: str, begin: int, end: int) -> SourceDeclaration | NoFunction:
    """Return the function after any decorators between two offsets, or the first other token."""
    at = begin
    while at < end and code[at] == "@":
        match = _SOLID.search(code, _find(code, "\n", at, end), end)
        if match is None:
            return NoFunction(begin, "@")
        at = match.start()
    found = _ANYTHING.match(code, at, end)
    none = NoFunction(at, found[0] if found else "")
    head = _DEF.match(code, at, end)
    if head is None:
        return none
    opening = head.end()
    if code.startswith("[", opening):
        # Parameters of a generic function, which Python before 3.12 does not know.
        opening = _after_bracket(code, opening, end)
    stop = _find(code, ":", opening, end)
    snippet = f"{text[at : head.end()]}{text[opening:stop]}: pass"
    try:
        with warnings.catch_warnings():
            # Python would print a warning for `"\\d"` in a default.
            warnings.simplefilter("ignore")
            function = ast.parse(snippet).body[0]
        if not isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            return none
        output = None if function.returns is None else _type(function.returns)
        return SourceDeclaration(function.name, output, _parameters(function.args), at, stop)
    except (SyntaxError, ValueError, RecursionError, MemoryError, IndexError):
        return none


def _parameters(arguments: ast.arguments) -> tuple[DeclaredParameter, ...]:
    """Return the parameters of a function; `*args` and `**kwargs` only if they have types."""
    listed = [*arguments.posonlyargs, *arguments.args]
    if listed and listed[0].arg in ("self", "cls"):
        listed = listed[1:]
    parameters = [DeclaredParameter(a.arg, _hint(a)) for a in listed]
    rest = arguments.vararg
    if rest is not None and rest.annotation is not None:
        parameters.append(DeclaredParameter(rest.arg, f"list[{_type(rest.annotation)}]"))
    parameters += [DeclaredParameter(a.arg, _hint(a)) for a in arguments.kwonlyargs]
    named = arguments.kwarg
    if named is not None and named.annotation is not None:
        parameters.append(DeclaredParameter(named.arg, f"dict[str, {_type(named.annotation)}]"))
    return tuple(parameters)


def _hint(argument: ast.arg) -> str | None:
    return None if argument.annotation is None else _type(argument.annotation)


def _type(node: ast.expr) -> str:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    return ast.unparse(node).replace("'", '"')


def _find(code: str, sign: str, at: int, end: int) -> int:
    """Return the offset of the first `sign` outside of all brackets, or `end` if there is none."""
    depth = 0
    for offset in range(at, end):
        character = code[offset]
        depth += (character in "([{") - (character in ")]}")
        if character == sign and depth <= 0:
            return offset
    return end


def _after_bracket(code: str, at: int, end: int) -> int:
    """Return the offset after the bracket that closes the one at `at`, at most `end`."""
    depth = 0
    while at < end:
        depth += (code[at] in "([{") - (code[at] in ")]}")
        at += 1
        if not depth:
            break
    return at
