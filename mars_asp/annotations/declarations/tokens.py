"""Tokens of a declaration, and the ends of their brackets.

Every search is bounded, so that the time is linear for any text.
"""

import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

_TOKEN = re.compile(r"::|->|\.\.\.|&&|\|\||(?:[^\W\d]|\$)[\w$]*|\d[\w.']*|\"[^\"]*\"|\S")
_OPENING = frozenset("([{")
_CLOSING = frozenset(")]}")
#: The maximal number of tokens in template arguments.
_MOST_ARGUMENTS = 1000
#: The maximal depth of nested template arguments.
_DEEPEST = 32
#: Signs in the arguments of a template that is used in an expression.
_OF_TYPES = frozenset(("::", ",", "*", "&", "&&", "...", "<", ">", "->", "?", "'", "+"))


class SourceToken(NamedTuple):
    """One token and its offset in the text."""

    text: str
    offset: int


def tokenise(code: str) -> list[SourceToken]:
    """Return the tokens of a text."""
    # The constructor of a named tuple is a function in Python, and there are many tokens.
    new = tuple.__new__
    return [new(SourceToken, (match[0], match.start())) for match in _TOKEN.finditer(code)]


def is_word(text: str) -> bool:
    """Whether a token is an identifier or a keyword."""
    return text[:1].isidentifier() or text[:1] == "$"


def text_at(tokens: Sequence[SourceToken], at: int) -> str:
    """Return the text of a token, or "" beyond the last one."""
    return tokens[at].text if 0 <= at < len(tokens) else ""


def texts(tokens: Sequence[SourceToken]) -> list[str]:
    """Return the texts of tokens."""
    return [token.text for token in tokens]


def joined(tokens: Sequence[SourceToken]) -> str:
    """Return the text of tokens, with blanks only between words."""
    pieces: list[str] = []
    after_word = False
    for text, _ in tokens:
        wordlike = text[0].isalnum() or text[0] in "_$"
        if after_word and wordlike:
            pieces.append(" ")
        pieces.append(text)
        after_word = wordlike
    return "".join(pieces)


def closing(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index after the bracket that closes the one at `at`."""
    depth = 0
    for index in range(at, len(tokens)):
        text = tokens[index].text
        depth += (text in _OPENING) - (text in _CLOSING)
        if depth <= 0:
            return index + 1
    return len(tokens)


def angle(tokens: Sequence[SourceToken], at: int, expression: bool = False) -> int | None:
    """Return the index after the `>` that closes the `<` at `at`, or None if there is none.

    In an expression `<` may also compare; there, the tokens between must look like types.
    """
    depth, index = 0, at
    last = min(len(tokens), at + _MOST_ARGUMENTS)
    while index < last:
        text = tokens[index].text
        if text in _OPENING:
            index = closing(tokens, index)
            continue
        if text == ";" or text in _CLOSING or depth > _DEEPEST:
            return None
        if expression and not (text in _OF_TYPES or is_word(text) or text[0].isdigit()):
            return None
        depth += (text == "<") - (text == ">")
        index += 1
        if not depth:
            return index
    return None


def after_angle(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index after template arguments that begin at `at`, else `at + 1`."""
    end = angle(tokens, at)
    return at + 1 if end is None else end


def split(
    tokens: Sequence[SourceToken], angles: bool = True, sign: str = ","
) -> list[list[SourceToken]]:
    """Return the tokens between signs outside of brackets; `angles` is whether `<` is a bracket."""
    groups: list[list[SourceToken]] = [[]]
    index, value, compares = 0, False, False
    while index < len(tokens):
        text = tokens[index].text
        end = index + 1
        if text == sign:
            groups.append([])
            value = compares = False
            index = end
            continue
        if text in _OPENING:
            end = closing(tokens, index)
        elif text == "<" and angles and not compares:
            found = angle(tokens, index, expression=value)
            compares = found is None
            end = end if found is None else found
        value = value or text == "="
        groups[-1] += tokens[index:end]
        index = end
    return [group for group in groups if group]


def before(tokens: Sequence[SourceToken], sign: str) -> Sequence[SourceToken]:
    """Return the tokens before a sign outside of all brackets."""
    return next((tokens[:at] for at, text in outside(tokens) if text == sign), tokens)


def outside(tokens: Sequence[SourceToken]) -> Iterator[tuple[int, str]]:
    """Yield index and text of each token outside of all brackets, opening brackets included."""
    index = 0
    while index < len(tokens):
        text = tokens[index].text
        yield index, text
        if text in _OPENING:
            index = closing(tokens, index)
        else:
            index = after_angle(tokens, index) if text == "<" else index + 1
