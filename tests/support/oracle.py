"""Function declarations as tree-sitter reads them, in the terms of the built-in scanners."""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass

import tree_sitter_c
import tree_sitter_cpp
import tree_sitter_go
import tree_sitter_java
import tree_sitter_matlab
import tree_sitter_python
import tree_sitter_rust
from tree_sitter import Language, Node, Parser

_GRAMMARS = {
    "c": tree_sitter_c,
    "cpp": tree_sitter_cpp,
    "go": tree_sitter_go,
    "java": tree_sitter_java,
    "matlab": tree_sitter_matlab,
    "python": tree_sitter_python,
    "rust": tree_sitter_rust,
}
_FALLS_AWAY = re.compile(
    r"\b(?:const|volatile|struct|class|enum|union|typename|final|register|restrict|static|inline"
    r"|extern|constexpr|virtual|explicit|friend)\b"
)


@dataclass(frozen=True, slots=True)
class Reading:
    """A function's name, its parameters' names and types, its return type; blanks removed."""

    name: str
    parameters: tuple[tuple[str | None, str | None], ...]
    output: str | None


def normalised(text: str | None) -> str | None:
    """Return a type without blanks and without words that do not affect its data."""
    if text is None:
        return None
    return re.sub(r"\s+", "", _FALLS_AWAY.sub(" ", text.replace("'", '"')))


def ask(language: str, text: str) -> Reading | None:
    """Return the declaration in a text as tree-sitter reads it, or None if it reports an error."""
    parser = Parser(Language(_GRAMMARS[language].language()))
    root = parser.parse(text.encode()).root_node
    if root.has_error:
        return None
    reader = {
        "c": _c,
        "cpp": _c,
        "go": _go,
        "java": _java,
        "matlab": _matlab,
        "python": _python,
        "rust": _rust,
    }[language]
    return reader(root)


def _text(node: Node | None) -> str | None:
    return None if node is None or node.text is None else node.text.decode()


def _walk(node: Node) -> Iterator[Node]:
    yield node
    for child in node.named_children:
        yield from _walk(child)


def _first(root: Node, *kinds: str) -> Node | None:
    return next((node for node in _walk(root) if node.type in kinds), None)


def _field(node: Node | None, name: str) -> Node | None:
    return None if node is None else node.child_by_field_name(name)


_C_DECLARATORS = ("pointer_declarator", "reference_declarator", "array_declarator")


def _declarator(node: Node | None, kind: str) -> tuple[str | None, str]:
    """Follow a declarator down to its name; return the name and the type with its signs."""
    signs = arrays = ""
    while node is not None:
        if node.type in ("pointer_declarator", "abstract_pointer_declarator"):
            signs += "*"
        elif node.type in ("reference_declarator", "abstract_reference_declarator"):
            signs += "&&" if (_text(node) or "").startswith("&&") else "&"
        elif node.type in ("array_declarator", "abstract_array_declarator"):
            arrays += "[]"
        elif node.type in ("function_declarator", "abstract_function_declarator"):
            below = node
            names = [_text(n) for n in _walk(below) if n.type == "identifier"]
            return names[0] if names else None, "function"
        elif node.type == "variadic_declarator":
            signs += "..."
        elif node.type in ("identifier", "field_identifier"):
            return _text(node), kind + signs + arrays
        following = _field(node, "declarator")
        if following is None:
            inner = [
                c for c in node.named_children if "declarator" in c.type or c.type == "identifier"
            ]
            following = inner[0] if inner else None
        node = following
    return None, kind + signs + arrays


def _c(root: Node) -> Reading | None:
    declarator = _first(root, "function_declarator")
    cast = _first(root, "operator_cast")
    if declarator is None and cast is None:
        return None
    holder = declarator if declarator is not None else cast
    assert holder is not None
    kind, signs = "", ""
    if cast is not None:
        name = "operator" + (_text(_field(cast, "type")) or "")
        kind = _text(_field(cast, "type")) or ""
        inner = _field(cast, "declarator")
        while inner is not None and inner.type != "abstract_function_declarator":
            signs += "*" if "pointer" in inner.type else "&"
            inner = _field(inner, "declarator") or next(
                (c for c in inner.named_children if "declarator" in c.type), None
            )
        parameters = _field(inner, "parameters")
        name += signs
    else:
        assert declarator is not None
        name = _text(_field(declarator, "declarator")) or ""
        parameters = _field(declarator, "parameters")
        above = declarator.parent
        while above is not None and above.type in _C_DECLARATORS:
            text = _text(above) or ""
            signs = ("*" if text[0] == "*" else "&&" if text[:2] == "&&" else "&") + signs
            above = above.parent
        kind = _text(_field(above, "type")) or ""
        trailing = _first(declarator, "trailing_return_type")
        if trailing is not None:
            kind, signs = (_text(trailing) or "").removeprefix("->"), ""
    found: list[tuple[str | None, str | None]] = []
    for node in parameters.named_children if parameters is not None else ():
        if node.type not in (
            "parameter_declaration",
            "optional_parameter_declaration",
            "variadic_parameter_declaration",
        ):
            continue
        written = _text(_field(node, "type")) or ""
        if _text(node) == "void":
            continue
        label, typed = _declarator(_field(node, "declarator"), written)
        found.append((label, normalised(typed)))
    name = re.sub(r"\s+", "", re.sub(r"<[^<>=]*>(?=$|::)", "", name))
    return Reading(name, tuple(found), normalised(kind + signs))


def _java(root: Node) -> Reading | None:
    method = _first(root, "method_declaration")
    if method is None:
        return None
    found: list[tuple[str | None, str | None]] = []
    parameters = _field(method, "parameters")
    for node in parameters.named_children if parameters is not None else ():
        if node.type == "formal_parameter":
            dimensions = _text(_field(node, "dimensions")) or ""
            found.append((_text(_field(node, "name")), _plain(_field(node, "type"), dimensions)))
        elif node.type == "spread_parameter":
            kind = next(n for n in node.named_children if n.type != "modifiers")
            label = _text(_field(_first(node, "variable_declarator"), "name"))
            found.append((label, _plain(kind, "[]")))
    output = _plain(_field(method, "type"), _text(_field(method, "dimensions")) or "")
    return Reading(_text(_field(method, "name")) or "", tuple(found), output)


def _plain(node: Node | None, arrays: str = "") -> str | None:
    """Return a type of Java without the annotations in it."""
    text = re.sub(r"@\w+(?:\.\w+)*(?:\([^()]*\))?", " ", _text(node) or "")
    return normalised(text + arrays)


def _go(root: Node) -> Reading | None:
    function = _first(root, "function_declaration", "method_declaration")
    if function is None:
        return None
    result = _field(function, "result")
    if result is not None and result.type == "parameter_list":
        types = [kind or "" for _, kind in _go_list(result)]
        types = [kind for kind in types if kind != "error"]
        output = "void" if not types else types[0] if len(types) == 1 else f"({','.join(types)})"
    else:
        output = normalised(_text(result)) or "void"
    output = "void" if output == "error" else output
    found = tuple(_go_list(_field(function, "parameters")))
    return Reading(_text(_field(function, "name")) or "", found, output)


def _go_list(node: Node | None) -> Iterator[tuple[str | None, str | None]]:
    for child in node.named_children if node is not None else ():
        if child.type not in ("parameter_declaration", "variadic_parameter_declaration"):
            continue
        kind = normalised(_text(_field(child, "type")))
        if child.type.startswith("variadic"):
            kind = f"[]{kind}"
        names = [_text(name) for name in child.children_by_field_name("name")]
        yield from ((name, kind) for name in names or [None])


def _rust(root: Node) -> Reading | None:
    function = _first(root, "function_item", "function_signature_item")
    if function is None:
        return None
    found: list[tuple[str | None, str | None]] = []
    parameters = _field(function, "parameters")
    for node in parameters.named_children if parameters is not None else ():
        if node.type != "parameter" or _text(_field(node, "pattern")) == "self":
            continue
        pattern = _field(node, "pattern")
        name = _text(pattern) if pattern is not None and pattern.type == "identifier" else None
        found.append((name, normalised(_text(_field(node, "type")))))
    output = normalised(_text(_field(function, "return_type"))) or "void"
    return Reading((_text(_field(function, "name")) or "").removeprefix("r#"), tuple(found), output)


def _python(root: Node) -> Reading | None:
    function = _first(root, "function_definition")
    if function is None:
        return None
    found: list[tuple[str | None, str | None]] = []
    parameters = _field(function, "parameters")
    for index, node in enumerate(parameters.named_children if parameters is not None else ()):
        kind = _python_type(_field(node, "type"))
        if node.type in ("identifier", "default_parameter"):
            name = _text(node if node.type == "identifier" else _field(node, "name"))
            if index or name not in ("self", "cls"):
                found.append((name, None))
        elif node.type == "typed_default_parameter":
            found.append((_text(_field(node, "name")), kind))
        elif node.type == "typed_parameter":
            inner = node.named_children[0]
            if inner.type == "list_splat_pattern":
                found.append((_text(inner.named_children[0]), f"list[{kind}]"))
            elif inner.type == "dictionary_splat_pattern":
                found.append((_text(inner.named_children[0]), f"dict[str,{kind}]"))
            else:
                found.append((_text(inner), kind))
    output = _python_type(_field(function, "return_type"))
    return Reading(_text(_field(function, "name")) or "", tuple(found), output)


def _python_type(node: Node | None) -> str | None:
    text = _text(node)
    if text is not None and text[0] in "'\"":
        text = ast.literal_eval(text)
    return normalised(text)


def _matlab(root: Node) -> Reading | None:
    function = _first(root, "function_definition")
    if function is None:
        return None
    arguments = _first(function, "function_arguments")
    names = [_text(node) for node in arguments.named_children] if arguments is not None else []
    outputs = _first(function, "function_output")
    some = outputs is not None and _first(outputs, "identifier") is not None
    found = tuple((name, None) for name in names)
    return Reading(_text(_field(function, "name")) or "", found, None if some else "void")
