"""Sources in Python: their trees, what they import and what stands at their outer level."""

import ast
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

#: What opens a file of the workspace by the name of its module.
Find = Callable[[str], "tuple[str, str] | None"]
_MOST_FILES = 1000


@dataclass(slots=True)
class SourceFile:
    """A file: its tree, its imports and the names at its outer level.

    `relative` are the imported names that are of its own package; `stars` are the modules of which
    it imports all names.
    """

    path: str
    lines: list[str]
    tree: ast.Module
    imports: dict[str, str] = field(default_factory=dict)
    outer: dict[str, ast.AST] = field(default_factory=dict)
    constants: dict[str, ast.expr] = field(default_factory=dict)
    relative: set[str] = field(default_factory=set)
    stars: list[str] = field(default_factory=list)


class Files:
    """Reads files by the names of their modules, each once."""

    def __init__(self, find: Find) -> None:
        """Take what finds the text and shown path of a module."""
        self._find = find
        self._read: dict[str, SourceFile | None] = {}
        self._left = _MOST_FILES
        self._mentioned: dict[ast.AST, tuple[str, ...]] = {}
        self._words: dict[ast.AST, frozenset[str]] = {}

    def file(self, module: str) -> SourceFile | None:
        """Return a file, `None` where it is not found or not Python."""
        if module not in self._read:
            found = self._find(module) if self._left else None
            self._left -= found is not None
            self._read[module] = None if found is None else _parsed(*found, module)
        return self._read[module]

    def mentioned(self, part: ast.AST) -> tuple[str, ...]:
        """Return the names, dotted ones whole, that a part of a file mentions, each once."""
        if part not in self._mentioned:
            self._mentioned[part] = tuple(dict.fromkeys(_mentioned(part)))
        return self._mentioned[part]

    def words(self, part: ast.AST) -> frozenset[str]:
        """Return the names, dotted ones split, that a part of a file mentions."""
        if part not in self._words:
            names = self.mentioned(part)
            self._words[part] = frozenset(word for name in names for word in name.split("."))
        return self._words[part]


def _mentioned(part: ast.AST) -> Iterator[str]:
    for node in ast.walk(part):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            dotted = dotted_name(node)
            if dotted:
                yield dotted


def _parsed(text: str, path: str, module: str) -> SourceFile | None:
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    file = SourceFile(path, text.split("\n"), tree)
    for node in ast.walk(tree):
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
    for statement in _flat(tree.body):
        match statement:
            case (
                ast.FunctionDef(name=defined)
                | ast.AsyncFunctionDef(name=defined)
                | ast.ClassDef(name=defined)
            ):
                file.outer[defined] = statement
            case ast.Assign(targets=[ast.Name(id=assigned)], value=value):
                file.constants.setdefault(assigned, value)
    return file


def _flat(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield the statements of a module, those in its conditions among them."""
    for statement in body:
        yield statement
        if isinstance(statement, ast.If | ast.Try | ast.With | ast.For | ast.While):
            yield from _flat(s for s in ast.iter_child_nodes(statement) if isinstance(s, ast.stmt))


def dotted_name(node: ast.expr) -> str:
    """Return a name with its attributes as it is written, empty where it is no such thing."""
    names: list[str] = []
    while isinstance(node, ast.Attribute):
        names.append(node.attr)
        node = node.value
    return ".".join((node.id, *reversed(names))) if isinstance(node, ast.Name) else ""


def called_name(call: ast.Call) -> str:
    """Return the last name of what is called."""
    if isinstance(call.func, ast.Attribute):
        return call.func.attr
    return call.func.id if isinstance(call.func, ast.Name) else ""


def keeper_of(target: ast.expr) -> str | None:
    """Return the name of a variable, or of one of `self`."""
    return dotted_name(target) or None
