"""Sources in Python: their syntax trees, imports and top-level definitions."""

import ast
import re
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from mars_asp.diagnostic import Span, point

#: A function from the name of a module to its text and shown path, None if not in the workspace.
Find = Callable[[str], "tuple[str, str] | None"]
T = TypeVar("T")
_MOST_FILES = 1000
#: A text with values, which from 3.12 on may have lines and quotes within its braces.
_TEXT_WITH_VALUES = re.compile(r"""\b(?:[rR]?[fF]|[fF][rR])["'].*\{""")
#: One that has its own quote within its braces.
_NESTED_QUOTE = re.compile(r"""\b(?:[rR]?[fF]|[fF][rR])(["'])(?:(?!\1).)*(?<!\{)\{[^{}]*\1""")
_NEWER = re.compile(r"\s*(?:type\s+\w+.*=|(?:async\s+)?def\s+\w+\s*\[|class\s+\w+\s*\[)")


@dataclass(slots=True)
class SourceFile:
    """A file: its syntax tree, its imports and its top-level names.

    `relative` are the names that it imports from its own package; `stars` are the modules of
    `from MODULE import *`.
    """

    path: str
    lines: list[str]
    tree: ast.Module
    imports: dict[str, str] = field(default_factory=dict)
    outer: dict[str, ast.AST] = field(default_factory=dict)
    constants: dict[str, ast.expr] = field(default_factory=dict)
    relative: set[str] = field(default_factory=set)
    stars: list[str] = field(default_factory=list)


class PythonFiles:
    """Reads Python files by the names of their modules, each once."""

    def __init__(self, find: Find) -> None:
        """Take the function that finds the text and shown path of a module."""
        self._find = find
        self._read: dict[str, SourceFile | None] = {}
        self._left = _MOST_FILES
        self._found: dict[tuple[object, ast.AST], Any] = {}
        #: The files that are not Python, each with the place of its error.
        self.broken: dict[tuple[Span, str], None] = {}

    def file(self, module: str) -> SourceFile | None:
        """Return the file of a module, or None if it is not found or not Python."""
        if module not in self._read:
            found = self._find(module) if self._left else None
            self._left -= found is not None
            try:
                self._read[module] = None if found is None else parse_source(*found, module)
            except SyntaxError as error:
                self._read[module] = None
                if found is not None and not is_newer(error):
                    place = point(found[1], error.lineno or 1, error.offset or 1)
                    self.broken[place, error.msg] = None
        return self._read[module]

    def once(self, find: Callable[[ast.AST], T], part: ast.AST) -> T:
        """Return `find(part)`, memoized, as many programs may share a part of a file."""
        key = find, part
        if key not in self._found:
            self._found[key] = find(part)
        found: T = self._found[key]
        return found


def is_newer(error: SyntaxError) -> bool:
    """Whether a syntax error may be due to syntax of a newer Python than the running one.

    From 3.12 on texts with values nest quotes and go over several lines, types have names, and
    functions and classes have types as parameters (PEP 695, 701).
    """
    line = error.text or ""
    is_text = "string" in error.msg and _TEXT_WITH_VALUES.search(line) is not None
    is_nested = "f-string" in error.msg or _NESTED_QUOTE.search(line) is not None
    return is_text or is_nested or _NEWER.match(line) is not None


def mentioned_names(part: ast.AST) -> tuple[str, ...]:
    """Return the names in a part of a file, without duplicates; dotted ones are kept whole."""
    names = (
        dotted_name(node) for node in ast.walk(part) if isinstance(node, ast.Name | ast.Attribute)
    )
    return tuple(dict.fromkeys(filter(None, names)))


def words_in(part: ast.AST) -> frozenset[str]:
    """Return the names that occur in a part of a file, dotted names split."""
    return frozenset(word for name in mentioned_names(part) for word in name.split("."))


def calls_of(part: ast.AST) -> tuple[ast.Call, ...]:
    """Return the calls in a part of a file."""
    return tuple(node for node in ast.walk(part) if isinstance(node, ast.Call))


def parse_source(text: str, path: str, module: str) -> SourceFile | None:
    """Return the parsed file, or None if it exceeds the limits of Python's parser.

    Raises:
        SyntaxError: it is not Python.
    """
    try:
        tree = ast.parse(text)
    except (ValueError, RecursionError, MemoryError):
        return None
    file = SourceFile(path, text.split("\n"), tree)
    for node in _nested_statements(tree):
        match node:
            case ast.Import(names=names):
                for name in names:
                    # `import a.b` binds `a`.
                    first = name.asname or name.name.partition(".")[0]
                    file.imports[first] = name.name if name.asname else first
            case ast.ImportFrom(module=origin, names=names, level=level):
                # The file of a package is in the package itself.
                up = level - path.endswith("__init__.py")
                above = module.split(".")[: -up or None] if level else []
                base = ".".join((*above, *filter(None, (origin,))))
                bound = {n.asname or n.name: f"{base}.{n.name}" for n in names if n.name != "*"}
                file.imports |= bound
                file.relative |= bound.keys() if level else set()
                file.stars += [base] * any(n.name == "*" for n in names)
    for statement in _all_statements(tree.body):
        match statement:
            case (
                ast.FunctionDef(name=defined)
                | ast.AsyncFunctionDef(name=defined)
                | ast.ClassDef(name=defined)
            ):
                file.outer[defined] = statement
            case ast.Assign(targets=[ast.Name(id=assigned)], value=value):
                known = file.constants.setdefault(assigned, value)
                if ast.dump(known) != ast.dump(value):
                    file.constants[assigned] = ast.Constant(...)
    return file


def _nested_statements(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield all statements of a module, breadth first."""
    waiting = deque[ast.AST](tree.body)
    while waiting:
        node = waiting.popleft()
        yield node
        for part in ("body", "orelse", "handlers", "finalbody", "cases"):
            waiting += getattr(node, part, ())


def _all_statements(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield statements with those in `if`, `try`, `with` and loops, but not in definitions."""
    for statement in body:
        yield statement
        if isinstance(statement, ast.If | ast.Try | ast.With | ast.For | ast.While):
            yield from _all_statements(
                s for s in ast.iter_child_nodes(statement) if isinstance(s, ast.stmt)
            )


def dotted_name(node: ast.expr) -> str:
    """Return a dotted name such as `a.b`, or "" for any other expression."""
    names: list[str] = []
    while isinstance(node, ast.Attribute):
        names.append(node.attr)
        node = node.value
    return ".".join((node.id, *reversed(names))) if isinstance(node, ast.Name) else ""


def called_name(call: ast.Call) -> str:
    """Return the last word of the called expression (`b` of `a.b()`), or "" without one."""
    if isinstance(call.func, ast.Attribute):
        return call.func.attr
    return call.func.id if isinstance(call.func, ast.Name) else ""


def argument_of(call: ast.Call, at: int, *names: str) -> ast.expr | None:
    """Return the argument with one of the names, else the one at position `at`, or None."""
    named = {each.arg: each.value for each in call.keywords}
    found = next((named[name] for name in names if name in named), None)
    return call.args[at] if found is None and at < len(call.args) else found


def passed_by(call: ast.Call, names: Iterable[str]) -> dict[str, ast.expr]:
    """Return the arguments of a call by name; `names` are the positional parameters in order."""
    named = {each.arg: each.value for each in call.keywords if each.arg}
    return dict(zip(names, call.args, strict=False)) | named


def defaults_of(parameters: ast.arguments) -> dict[str, ast.expr]:
    """Return the default of each parameter that has one."""
    every = [*parameters.posonlyargs, *parameters.args]
    last = every[len(every) - len(parameters.defaults) :]
    found = {each.arg: value for each, value in zip(last, parameters.defaults, strict=True)}
    pairs = zip(parameters.kwonlyargs, parameters.kw_defaults, strict=True)
    return found | {each.arg: value for each, value in pairs if value is not None}


def column_at(lines: Sequence[str], line: int, offset: int) -> int:
    """Return the column, from 1, of a byte offset in a line (from 1)."""
    text = lines[line - 1] if line <= len(lines) else ""
    if text.isascii():
        return offset + 1
    return len(text.encode()[:offset].decode(errors="ignore")) + 1


def members_of(node: ast.AST | None) -> Iterator[tuple[str, ast.expr | ast.FunctionDef]]:
    """Yield the methods and values in the body of a class, with their names."""
    for statement in node.body if isinstance(node, ast.ClassDef) else ():
        match statement:
            case ast.FunctionDef(name=name):
                yield name, statement
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                yield name, value
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
                yield name, value
