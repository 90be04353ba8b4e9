"""Function declarations of C and C++, found without knowing any type or macro."""

from collections.abc import Sequence

from mars_asp.annotations.declarations.c_parameters import (
    are_parameters,
    declarators,
    read_old_style,
    read_parameter,
)
from mars_asp.annotations.declarations.c_types import (
    ATTRIBUTES,
    after_attribute,
    is_macro,
    type_text,
    units,
)
from mars_asp.annotations.declarations.declaration import (
    CALLBACK,
    DeclaredParameter,
    NoFunction,
    SourceDeclaration,
)
from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    after_angle,
    angle,
    closing,
    is_word,
    joined,
    text_at,
    texts,
)

_STATEMENTS = frozenset(
    (
        "return if else while for switch case throw new delete goto co_return co_await co_yield "
        "using typedef do break continue try catch namespace static_assert _Static_assert "
        "sizeof default asm concept import module export"
    ).split()
)
_ACCESS = frozenset(("public", "private", "protected", "signals", "Q_SIGNALS"))
#: Words that can follow the parameters.
_AFTER = frozenset(
    "const noexcept override final volatile throw requires try mutable asm __asm__".split()
)
#: Words that can follow the parameters and cannot begin a type.
_AFTER_ALL = _AFTER - {"const", "volatile"}
_AFTER_TRAILING = _AFTER_ALL | {";", "{", "=", "}"}
_SIGNS = frozenset(("::", "*", "&", "&&", "^"))


def read_c(tokens: Sequence[SourceToken], code: str) -> SourceDeclaration | NoFunction:
    """Return the function declaration at the begin of C or C++ tokens, or the first other token."""
    first = min(_after_prefix(tokens), len(tokens) - 1)
    none = NoFunction(tokens[first].offset, tokens[first].text)
    head: list[SourceToken] = []
    at = first
    while at < len(tokens):
        text = tokens[at].text
        after = after_attribute(tokens, at)
        if after > at:
            at = after
        elif text in _STATEMENTS:
            return none
        elif text == "extern" and text_at(tokens, at + 1).startswith('"'):
            at += 2
        elif text == "explicit" and text_at(tokens, at + 1) == "(":
            at = closing(tokens, at + 1)
        elif text in ("decltype", "typeof", "__typeof__", "noexcept"):
            head.append(SourceToken("auto", tokens[at].offset))
            at = closing(tokens, at + 1)
        elif text == "operator":
            return _operator(tokens, head, at) or none
        elif text == "<" and head and is_word(head[-1].text):
            end = angle(tokens, at)
            if end is None:
                return none
            head += tokens[at:end]
            at = end
        elif text == "(":
            end = closing(tokens, at)
            if not _is_macro_call(tokens, head, end):
                return _bracketed(tokens, head, at, tokens[first].offset) or none
            head = head[:-1]
            at = end
        elif is_word(text) or text in _SIGNS:
            head.append(tokens[at])
            at += 1
        else:
            return none
    return none


def _after_prefix(tokens: Sequence[SourceToken]) -> int:
    """Return the index after attributes, `template <...>` and access labels."""
    at = 0
    while at < len(tokens):
        text, following = text_at(tokens, at), text_at(tokens, at + 1)
        after = after_attribute(tokens, at)
        if after > at:
            at = after
        elif text == "template" and following == "<":
            at = after_angle(tokens, at + 1)
        elif text == "requires":
            at = _after_requires(tokens, at + 1)
        elif text in _ACCESS and following == ":":
            at += 2
        elif text in _ACCESS and text_at(tokens, at + 2) == ":":
            at += 3
        elif text == "extern" and following.startswith('"'):
            at += 2
        else:
            break
    return at


def _after_requires(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index after the constraint of a `requires`."""
    while at < len(tokens):
        if text_at(tokens, at) == "!":
            at += 1
        if text_at(tokens, at) == "(":
            at = closing(tokens, at)
        elif text_at(tokens, at) == "requires":
            at = closing(tokens, at + 1) if text_at(tokens, at + 1) == "(" else at + 1
            at = closing(tokens, at) if text_at(tokens, at) == "{" else at
        else:
            at += 1
            while text_at(tokens, at) in ("::", "<"):
                at = after_angle(tokens, at) if tokens[at].text == "<" else at + 2
            at = closing(tokens, at) if text_at(tokens, at) == "(" else at
        if text_at(tokens, at) not in ("&&", "||"):
            break
        at += 1
    return at


def _is_macro_call(tokens: Sequence[SourceToken], head: Sequence[SourceToken], end: int) -> bool:
    """Whether the brackets before `end` are those of a macro before a declaration."""
    following = text_at(tokens, end)
    goes_on = (is_word(following) and following not in _AFTER) or following == "::"
    if not head or not goes_on:
        return False
    return len(head) == 1 or is_macro(head[-1].text)


def _bracketed(
    tokens: Sequence[SourceToken], head: Sequence[SourceToken], at: int, offset: int
) -> SourceDeclaration | None:
    """Return the function whose first bracket is at `at`: of its parameters or its declarator.

    `head` are the tokens before it, `offset` is the begin. The result is None if this is other
    code.
    """
    end = closing(tokens, at)
    inside = tokens[at + 1 : end - 1]
    signs = set(texts(inside[:1])) & {"*", "&", "&&", "^"}
    if text_at(tokens, end) == "(" and len(inside) == 1 and head and not is_macro(head[-1].text):
        # A name in its own brackets, which prevent the use of a macro of this name.
        return _read_function(tokens, [*head, *inside], end, offset)
    inner = next((index for index, token in enumerate(inside) if token.text == "("), None)
    if not signs or inner is None:
        return None if signs else _read_function(tokens, head, at, offset)
    # A function that returns a pointer to a function or to an array.
    kind = type_text(units(head))
    function = _read_function(tokens, [*head, *inside[:inner]], at + 1 + inner, offset)
    if function is None or kind is None or text_at(tokens, end) not in ("(", "["):
        return None
    output = CALLBACK if text_at(tokens, end) == "(" else f"{kind}[]"
    return SourceDeclaration(function.name, output, function.parameters, offset, function.end)


def _operator(
    tokens: Sequence[SourceToken], head: Sequence[SourceToken], at: int
) -> SourceDeclaration | None:
    """Return the function whose `operator` is token `at`, or None; `head` precedes it."""
    stop = at + 1
    if text_at(tokens, stop) == "(":
        stop += 2
    while stop < len(tokens) and tokens[stop].text != "(":
        stop = after_angle(tokens, stop) if _opens_arguments(tokens, stop) else stop + 1
    named = tokens[at + 1 : stop]
    if not named or stop >= len(tokens):
        return None
    offset = head[0].offset if head else tokens[at].offset
    converts = is_word(named[0].text) and named[0].text not in ("new", "delete", "co_await")
    name = f"operator{' ' * is_word(named[0].text)}{joined(named)}"
    while len(head) > 1 and head[-1].text == "::" and is_word(head[-2].text):
        name = f"{head[-2].text}::{name}"
        head = head[:-2]
    output = type_text(units(named if converts else head))
    if output is None:
        return None
    return _with_parameters(tokens, stop, name, output, offset)


def _opens_arguments(tokens: Sequence[SourceToken], at: int) -> bool:
    return (
        tokens[at].text == "<"
        and is_word(text_at(tokens, at - 1))
        and (text_at(tokens, at - 1) != "operator")
    )


def _read_function(
    tokens: Sequence[SourceToken], head: Sequence[SourceToken], at: int, offset: int
) -> SourceDeclaration | None:
    """Return the function whose parameters begin at `at`, or None if this is other code.

    `head` are the tokens before, its type and name; `offset` is where these begin.
    """
    parts = units(head)
    # After a type, `auto` is the name of a function in a declared block.
    is_named = bool(parts) and parts[-1].kind == "name"
    if not is_named and [part.kind for part in parts] != ["name", "placeholder"]:
        return None
    name = _plain_name(parts[-1].tokens)
    output = type_text(parts[:-1])
    if output is None or not name or name in ATTRIBUTES:
        return None
    return _with_parameters(tokens, at, name, output, offset)


def _plain_name(tokens: Sequence[SourceToken]) -> str:
    """Return a qualified name without template arguments."""
    name, at = "", 0
    while at < len(tokens):
        if tokens[at].text == "<":
            at = after_angle(tokens, at)
        else:
            name += tokens[at].text
            at += 1
    return name.removeprefix("::")


def _with_parameters(
    tokens: Sequence[SourceToken], at: int, name: str, output: str, offset: int
) -> SourceDeclaration | None:
    end = closing(tokens, at)
    found = declarators(tokens[at + 1 : end - 1])
    if not are_parameters(found):
        return None
    parameters = _old_style(tokens, found, end)
    if parameters is None:
        read = map(read_parameter, found)
        parameters = tuple(parameter for parameter in read if parameter is not None)
        output = _trailing(tokens, end) or output
    return SourceDeclaration(name, output, parameters, offset, tokens[end - 1].offset)


def _trailing(tokens: Sequence[SourceToken], at: int) -> str | None:
    """Return the type after `->` that follows the parameters, or None without such a type."""
    while at < len(tokens) and tokens[at].text not in (";", "{", "=", ":", "}", "->"):
        at = closing(tokens, at) if tokens[at].text in ("(", "[") else at + 1
    if text_at(tokens, at) != "->":
        return None
    start = at = at + 1
    while at < len(tokens):
        text = tokens[at].text
        if text in _AFTER_TRAILING:
            break
        if text in ("(", "["):
            at = closing(tokens, at)
        elif text == "<":
            end = angle(tokens, at)
            if end is None:
                return None
            at = end
        else:
            at += 1
    return type_text(units(tokens[start:at]))


def _old_style(
    tokens: Sequence[SourceToken], found: Sequence[Sequence[SourceToken]], end: int
) -> tuple[DeclaredParameter, ...] | None:
    """Return the parameters `found` in K&R style, whose types begin at token `end`, or None."""
    names = [declarator[0].text for declarator in found if len(declarator) == 1]
    following = text_at(tokens, end)
    if not names or len(names) < len(found) or not is_word(following):
        return None
    if following in _AFTER_ALL:
        return None
    stop = end
    while stop < len(tokens) and tokens[stop].text not in ("{", "}", "="):
        stop = closing(tokens, stop) if tokens[stop].text == "(" else stop + 1
    if text_at(tokens, stop) != "{":
        return None
    return read_old_style(names, tokens[end:stop])
