"""The one function declaration that follows an annotation."""

import ast
import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

_TOKEN = re.compile(r"::|->|\.\.\.|&&|\|\||\[\[|\]\]|[A-Za-z_$~]\w*|@|\d[\w.']*|\"[^\"]*\"|\S")
_STATEMENTS = frozenset(
    (
        "return if else while for switch case throw new delete goto co_return co_await "
        "using typedef do break continue try catch import package namespace break "
        "static_assert"
    ).split()
)
_LABELS = frozenset(["public", "private", "protected", "signals", "slots"])
_AFTER = frozenset(
    (
        "const noexcept override final volatile throw throws requires try default & && -> "
        "= ; { : __attribute__ ,"
    ).split()
)
_SPECIFIERS = frozenset(
    (
        "static inline virtual explicit constexpr consteval constinit friend extern "
        "register thread_local mutable typename const volatile struct class enum public "
        "protected private abstract final synchronized native default strictfp restrict "
        "__restrict _Noreturn __inline __forceinline"
    ).split()
)
_BUILTIN_WORDS = frozenset(
    ("unsigned signed long short int char double float bool void auto").split()
)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter's name and type as written; `out` where it can be written to."""

    name: str | None
    type: str | None
    out: bool = False


@dataclass(frozen=True, slots=True)
class Declaration:
    """A function's declaration; `conditional` is the offset of an `#if` within, if any."""

    name: str
    output: str | None
    parameters: tuple[Parameter, ...]
    offset: int
    conditional: int | None = None


@dataclass(frozen=True, slots=True)
class NoFunction:
    """What follows is no function: where its first token is and what that is."""

    offset: int
    found: str


@dataclass(frozen=True, slots=True)
class _Token:
    text: str
    offset: int


def read_declaration(
    language: str, text: str, code: str, begin: int, end: int
) -> Declaration | NoFunction | None:
    """Read the declaration that begins in a stretch of code; `None` where nothing stands there."""
    first = re.compile(r"\S").search(code, begin, end)
    if first is None:
        return None
    if language == "python":
        return _python(text, code, first.start(), end)
    conditional = None
    stretch = code[begin:end]
    if language == "c":
        stretch = re.sub(r"(?m)^[ \t]*#(?:\\\n|[^\n])*", lambda m: " " * len(m[0]), stretch)
    tokens = [_Token(m[0], begin + m.start()) for m in _TOKEN.finditer(stretch[:20000])]
    if not tokens:
        return None
    reader = {"c": _c, "java": _c, "go": _go, "rust": _rust, "matlab": _matlab}[language]
    found = reader(tokens)
    if found is None:
        start = _skip_prefix(tokens, 0)
        token = tokens[min(start, len(tokens) - 1)]
        return NoFunction(token.offset, token.text)
    declaration, last = found
    if language == "c":
        match = re.compile(r"(?m)^[ \t]*(#)[ \t]*if").search(code, declaration.offset, last)
        conditional = match.start(1) if match else None
    return Declaration(
        declaration.name,
        declaration.output,
        declaration.parameters,
        declaration.offset,
        conditional,
    )


def _closing(tokens: Sequence[_Token], at: int, pairs: str = "([{") -> int:
    """Return the index behind the bracket that closes the one at `at`."""
    depth = 0
    for index in range(at, len(tokens)):
        text = tokens[index].text
        if text in ("(", "[", "{", "[["):
            depth += 2 if text == "[[" else 1
        elif text in (")", "]", "}", "]]"):
            depth -= 2 if text == "]]" else 1
            if depth <= 0:
                return index + 1
    return len(tokens)


def _angle(tokens: Sequence[_Token], at: int) -> int:
    """Return the index behind the `>` that closes the `<` at `at`."""
    depth, index = 0, at
    while index < len(tokens):
        text = tokens[index].text
        if text in ("(", "[", "{"):
            index = _closing(tokens, index)
            continue
        if text in (";",):
            return index
        depth += (text == "<") - (text == ">")
        index += 1
        if not depth:
            return index
    return index


def _skip_prefix(tokens: Sequence[_Token], at: int) -> int:
    """Skip attributes, decorators, templates, labels and the like."""
    while at < len(tokens):
        text = tokens[at].text
        following = tokens[at + 1].text if at + 1 < len(tokens) else ""
        if text == "[[":
            at = _closing(tokens, at)
        elif text == "#" and following in ("[", "!"):
            at = _closing(tokens, at + (1 if following == "[" else 2))
        elif text == "template" and following == "<":
            at = _angle(tokens, at + 1)
        elif text == "requires":
            at = _skip_requires(tokens, at + 1)
        elif text in ("__attribute__", "__declspec", "alignas") and following == "(":
            at = _closing(tokens, at + 1)
        elif (text == "extern" and following.startswith('"')) or (
            text in _LABELS and following == ":"
        ):
            at += 2
        elif text == "@" and following != "interface":
            at += 2
            while at + 1 < len(tokens) and tokens[at].text == ".":
                at += 2
            if at < len(tokens) and tokens[at].text == "(":
                at = _closing(tokens, at)
        else:
            return at
    return at


def _skip_requires(tokens: Sequence[_Token], at: int) -> int:
    while at < len(tokens):
        if tokens[at].text == "(":
            at = _closing(tokens, at)
        elif tokens[at].text == "requires":
            at = _closing(tokens, at + 1)
            if at < len(tokens) and tokens[at].text == "{":
                at = _closing(tokens, at)
        else:
            at += 1
            while at < len(tokens) and tokens[at].text in ("::", "<"):
                at = _angle(tokens, at) if tokens[at].text == "<" else at + 2
        if at < len(tokens) and tokens[at].text in ("&&", "||"):
            at += 1
        else:
            return at
    return at


def _c(tokens: Sequence[_Token]) -> tuple[Declaration, int] | None:
    """C, C++ and Java: type, name, parameters."""
    at = _skip_prefix(tokens, 0)
    first = at
    if at >= len(tokens) or tokens[at].text in _STATEMENTS:
        return None
    head: list[_Token] = []
    while at < len(tokens):
        text = tokens[at].text
        if text in (";", "{", "}", "=", ")", ",", "?", "!", "+", "-", "/", "."):
            if text == "." and head:
                head.append(tokens[at])
                at += 1
                continue
            return None
        if text == "operator":
            return _operator(tokens, head, at)
        if text == "<" and head:
            end = _angle(tokens, at)
            head += tokens[at:end]
            at = end
        elif text == "[[" or (text in ("__attribute__", "__declspec", "alignas", "decltype")):
            end = _closing(tokens, at if text == "[[" else at + 1)
            if text == "decltype":
                head.append(_Token("auto", tokens[at].offset))
            at = end
        elif text == "@":
            at = _skip_prefix(tokens, at)
        elif text == "(":
            end = _closing(tokens, at)
            following = tokens[end].text if end < len(tokens) else ";"
            if len(head) <= 1 or head[-2].text == "::":
                plain = re.match(r"[A-Za-z_\"]", following) and following not in _AFTER
                if plain and head:
                    # A macro with arguments before the declaration.
                    head = []
                    at = end
                    continue
            break
        else:
            head.append(tokens[at])
            at += 1
    else:
        return None
    return _function(tokens, head, at, tokens[first].offset)


def _operator(
    tokens: Sequence[_Token], head: Sequence[_Token], at: int
) -> tuple[Declaration, int] | None:
    index = at + 1
    while index < len(tokens) and (tokens[index].text != "(" or index == at + 1):
        index += 1
        if tokens[index - 1].text == "(" and index == at + 2:
            index += 1
    if index >= len(tokens):
        return None
    name = "operator" + "".join(token.text for token in tokens[at + 1 : index])
    named = [*head, _Token(name, tokens[at].offset)]
    return _function(tokens, named, index, named[0].offset)


def _function(
    tokens: Sequence[_Token], head: Sequence[_Token], at: int, offset: int
) -> tuple[Declaration, int] | None:
    """Read from the bracket that opens the parameters; `head` are the tokens before it."""
    pieces = list(head)
    name: list[str] = []
    if pieces and pieces[-1].text == ">":
        # A specialisation's arguments belong to its name.
        depth = 0
        while pieces:
            token = pieces.pop()
            depth += (token.text == ">") - (token.text == "<")
            if not depth:
                break
    while pieces and re.match(r"[A-Za-z_$~]|operator", pieces[-1].text):
        name.insert(0, pieces.pop().text)
        if pieces and pieces[-1].text == "~":
            pieces.pop()
        if len(pieces) > 1 and pieces[-1].text == "::":
            pieces.pop()
            name.insert(0, "::")
            if pieces and pieces[-1].text == ">":
                depth = 0
                while pieces:
                    token = pieces.pop()
                    depth += (token.text == ">") - (token.text == "<")
                    if not depth:
                        break
        else:
            break
    written = [token.text for token in pieces]
    if not name or not [word for word in written if word not in _SPECIFIERS]:
        return None
    end = _closing(tokens, at)
    groups = _split(tokens[at + 1 : end - 1])
    if any(not any(re.match(r"[A-Za-z_.]", t.text) for t in group) for group in groups):
        return None
    parameters = [_parameter([token.text for token in group]) for group in groups]
    parameters = [p for p in parameters if p is not None]
    index = end
    output = _type_text(written)
    while index < len(tokens) and tokens[index].text not in (";", "{", "=", ":"):
        if tokens[index].text == "->":
            stop = index + 1
            while stop < len(tokens) and tokens[stop].text not in (";", "{", "=", "requires"):
                stop = _angle(tokens, stop) if tokens[stop].text == "<" else stop + 1
            output = _type_text([token.text for token in tokens[index + 1 : stop]])
            index = stop
            continue
        if tokens[index].text == "(":
            index = _closing(tokens, index)
        elif tokens[index].text not in _AFTER and groups and index == end:
            return _old_style(tokens, index, "".join(name), output, groups, offset)
        else:
            index += 1
    last = tokens[min(end, len(tokens)) - 1].offset
    return Declaration("".join(name), output, tuple(p for p in parameters if p), offset), last


def _old_style(
    tokens: Sequence[_Token],
    at: int,
    name: str,
    output: str | None,
    groups: Sequence[Sequence[_Token]],
    offset: int,
) -> tuple[Declaration, int] | None:
    """Kernighan and Ritchie's form: types of the parameters follow the bracket."""
    types: dict[str, Parameter] = {}
    start = at
    while at < len(tokens) and tokens[at].text != "{":
        if tokens[at].text == ";":
            parameter = _parameter([token.text for token in tokens[start:at]])
            if parameter is not None and parameter.name:
                types[parameter.name] = parameter
            start = at + 1
        at += 1
    found = [types.get(group[-1].text, Parameter(group[-1].text, "int")) for group in groups]
    return Declaration(name, output, tuple(found), offset), tokens[min(at, len(tokens) - 1)].offset


def _split(tokens: Sequence[_Token]) -> list[list[_Token]]:
    """Split at the commas outside of all brackets."""
    groups: list[list[_Token]] = [[]]
    depth = angle = 0
    equals = False
    for token in tokens:
        text = token.text
        depth += (text in ("(", "[", "{", "[[")) - (text in (")", "]", "}", "]]"))
        if not equals:
            angle += (text == "<") - (text == ">")
        if text == "," and not depth and angle <= 0:
            groups.append([])
            equals = False
            angle = 0
            continue
        if text == "=" and not depth and angle <= 0:
            equals = True
        groups[-1].append(token)
    return [group for group in groups if group]


def _parameter(words: list[str]) -> Parameter | None:
    depth = 0
    for index, word in enumerate(words):
        depth += (word in ("(", "<", "[", "{")) - (word in (")", ">", "]", "}"))
        if word == "=" and not depth:
            words = words[:index]
            break
    while words[:1] == ["[["]:
        words = words[words.index("]]") + 1 :] if "]]" in words else []
    while words[:1] == ["@"]:
        words = words[2:]
        if words[:1] == ["("]:
            words = words[words.index(")") + 1 :] if ")" in words else []
    if words in (["void"], ["..."]) or not words:
        return None
    if "(" in words and words[words.index("(") + 1 : words.index("(") + 2] in (["*"], ["&"], ["^"]):
        at = words.index("(")
        close = words.index(")", at) if ")" in words[at:] else len(words) - 1
        if "(" in words[close:]:
            return Parameter(words[close - 1], "std::function<void()>")
        return Parameter(words[close - 1], _type_text([*words[:at], *words[close + 1 :]]), True)
    arrays: list[str] = []
    while words and words[-1] == "]":
        at = len(words) - 1 - words[::-1].index("[")
        arrays = ["[", "]", *arrays]
        words = words[:at]
    real = [word for word in words if word not in _SPECIFIERS]
    name = None
    if len(real) > 1 and re.fullmatch(r"[A-Za-z_$]\w*", real[-1]) and real[-2] not in ("::", "."):
        if real[-1] not in _BUILTIN_WORDS:
            name = words[-1]
            words = words[:-1]
    out = ("&" in words or "*" in words) and "const" not in words
    return Parameter(name, _type_text([*words, *arrays]), out)


def _type_text(words: Sequence[str]) -> str | None:
    """Join a type's words, without specifiers and without macros before it."""
    kept = [word for word in words if word not in _SPECIFIERS]
    names: list[int] = []
    depth = 0
    for index, word in enumerate(kept):
        if not depth and re.match(r"[A-Za-z_]", word) and word not in _BUILTIN_WORDS:
            if index == 0 or kept[index - 1] not in ("::", "."):
                names.append(index)
        depth += (word == "<") - (word == ">")
    if len(names) > 1:
        kept = kept[names[-1] :]
    elif names and any(word in _BUILTIN_WORDS for word in kept[names[0] + 1 :] if names[0] == 0):
        inside = [word for word in kept if word in _BUILTIN_WORDS]
        if kept[1:2] != ["<"] and kept[1:2] != ["::"]:
            kept = kept[1:] if inside else kept
    return " ".join(kept) if kept else None


def _go(tokens: Sequence[_Token]) -> tuple[Declaration, int] | None:
    if tokens[0].text != "func":
        return None
    at = 1
    if at < len(tokens) and tokens[at].text == "(":
        at = _closing(tokens, at)
    if at >= len(tokens) or not re.match(r"[A-Za-z_]", tokens[at].text):
        return None
    name = tokens[at].text
    at += 1
    if at < len(tokens) and tokens[at].text == "[":
        at = _closing(tokens, at)
    if at >= len(tokens) or tokens[at].text != "(":
        return None
    end = _closing(tokens, at)
    parameters = _go_parameters(_split(tokens[at + 1 : end - 1]))
    results: tuple[Parameter, ...] = ()
    if end < len(tokens) and tokens[end].text == "(":
        close = _closing(tokens, end)
        results = _go_parameters(_split(tokens[end + 1 : close - 1]))
    else:
        stop = end
        while stop < len(tokens) and tokens[stop].text != "{":
            if stop > end and _line_break_before(tokens, stop):
                break
            stop = _closing(tokens, stop) if tokens[stop].text in ("(", "[") else stop + 1
        if stop > end:
            results = (Parameter(None, " ".join(t.text for t in tokens[end:stop])),)
    types = [result.type or "" for result in results if result.type != "error"]
    output = "void" if not types else types[0] if len(types) == 1 else f"({', '.join(types)})"
    return Declaration(name, output, parameters, tokens[0].offset), tokens[end - 1].offset


def _line_break_before(tokens: Sequence[_Token], index: int) -> bool:
    """Say whether a declaration without a body ends before a token that begins another one."""
    return tokens[index].text in ("func", "type", "var", "const", "import")


def _go_parameters(groups: Sequence[Sequence[_Token]]) -> tuple[Parameter, ...]:
    """Give each parameter its type; in `a, b T` the last type holds for all before it."""
    named = any(_go_is_named(group) for group in groups)
    found: list[Parameter] = []
    following: str | None = None
    for group in reversed(groups):
        words = [token.text for token in group]
        if not named:
            found.append(Parameter(None, _go_type(words)))
        elif len(words) == 1:
            found.append(Parameter(words[0], following))
        else:
            following = _go_type(words[1:])
            found.append(Parameter(words[0], following))
    return tuple(reversed(found))


def _go_is_named(group: Sequence[_Token]) -> bool:
    if len(group) < 2 or not re.match(r"[A-Za-z_]", group[0].text):
        return False
    if group[0].text in ("func", "map", "chan", "interface", "struct"):
        return False
    return group[1].text not in (".", "::", "[") or (
        group[1].text == "[" and len(group) > 3 and group[2].text in ("]",)
    )


def _go_type(words: Sequence[str]) -> str:
    return f"[]{' '.join(words[1:])}" if words[:1] == ["..."] else " ".join(words)


def _rust(tokens: Sequence[_Token]) -> tuple[Declaration, int] | None:
    at = _skip_prefix(tokens, 0)
    first = at
    while at < len(tokens) and tokens[at].text != "fn":
        if tokens[at].text == "(" and at > first and tokens[at - 1].text == "pub":
            at = _closing(tokens, at)
        elif tokens[at].text in ("pub", "async", "unsafe", "const", "extern", "default") or tokens[
            at
        ].text.startswith('"'):
            at += 1
        else:
            return None
    if at + 1 >= len(tokens):
        return None
    name = tokens[at + 1].text
    at += 2
    if at < len(tokens) and tokens[at].text == "<":
        at = _angle(tokens, at)
    if at >= len(tokens) or tokens[at].text != "(":
        return None
    end = _closing(tokens, at)
    parameters: list[Parameter] = []
    for group in _split(tokens[at + 1 : end - 1]):
        words = [token.text for token in group]
        if "self" in words and ":" not in words:
            continue
        if ":" in words:
            colon = words.index(":")
            if words[colon - 1] != "self":
                kind = words[colon + 1 :]
                out = kind[:1] == ["&"] and "mut" in kind[:4]
                parameters.append(Parameter(words[colon - 1], _rust_type(kind), out))
    output: str | None = "void"
    if end < len(tokens) and tokens[end].text == "->":
        stop = end + 1
        while stop < len(tokens) and tokens[stop].text not in ("{", ";", "where"):
            stop = _angle(tokens, stop) if tokens[stop].text == "<" else stop + 1
        output = _rust_type([token.text for token in tokens[end + 1 : stop]])
    return Declaration(name, output, tuple(parameters), tokens[first].offset), tokens[
        end - 1
    ].offset


def _rust_type(words: Sequence[str]) -> str:
    return re.sub(r"' (\w)", r"'\1", " ".join(words))


def _matlab(tokens: Sequence[_Token]) -> tuple[Declaration, int] | None:
    if tokens[0].text != "function":
        return None
    words = [token.text for token in tokens[:400]]
    at = 1
    has_output = False
    if words[1:2] == ["["]:
        at = words.index("]") + 1 if "]" in words else 1
        has_output = at > 3
    elif words[2:3] == ["="]:
        at, has_output = 2, True
    if words[at : at + 1] == ["="]:
        at += 1
    if at >= len(words) or not re.match(r"[A-Za-z]", words[at]):
        return None
    name = words[at]
    while words[at + 1 : at + 2] == ["."]:
        at += 2
        name += f".{words[at]}"
    at += 1
    parameters: list[Parameter] = []
    if words[at : at + 1] == ["("]:
        end = _closing(tokens, at)
        for group in _split(tokens[at + 1 : end - 1]):
            parameters.append(Parameter(group[0].text, None))
    declaration = Declaration(
        name, None if has_output else "void", tuple(parameters), tokens[0].offset
    )
    return declaration, tokens[min(at, len(tokens) - 1)].offset


def _python(text: str, code: str, begin: int, end: int) -> Declaration | NoFunction:
    """Cut the `def ...:` and read it with Python's own parser."""
    at = begin
    while at < end and code[at] == "@":
        at = _python_line_end(code, at, end)
        match = re.compile(r"\S").search(code, at, end)
        if match is None:
            return NoFunction(begin, "@")
        at = match.start()
    word = re.compile(r"(?:async[ \t]+)?def\b").match(code, at, end)
    found = re.compile(r"\w+|\S").match(code, at, end)
    if word is None:
        return NoFunction(at, found[0] if found else "")
    depth = 0
    stop = at
    while stop < end:
        character = code[stop]
        depth += (character in "([{") - (character in ")]}")
        if character == ":" and not depth:
            break
        stop += 1
    snippet = text[at:stop] + ": pass"
    try:
        function = ast.parse(textwrap.dedent(snippet)).body[0]
    except (SyntaxError, ValueError, RecursionError, MemoryError, IndexError):
        return NoFunction(at, "def")
    if not isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
        return NoFunction(at, "def")
    arguments = function.args
    listed = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    parameters = [
        Parameter(a.arg, None if a.annotation is None else _python_type(a.annotation))
        for index, a in enumerate(listed)
        if not (index == 0 and a.arg in ("self", "cls"))
    ]
    output = None if function.returns is None else _python_type(function.returns)
    return Declaration(function.name, output, tuple(parameters), at)


def _python_type(node: ast.expr) -> str:
    return (
        node.value
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
        else (ast.unparse(node).replace("'", '"'))
    )


def _python_line_end(code: str, at: int, end: int) -> int:
    depth = 0
    while at < end:
        character = code[at]
        depth += (character in "([{") - (character in ")]}")
        if character == "\n" and depth <= 0:
            return at
        at += 1
    return end
