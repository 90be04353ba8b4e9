"""The occurrences of predicates in a text of rules, found by tokens as it may have errors.

The meaning of rules is not read here: clingo's parser does that.
"""

import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple

from mars_asp.asp.signature import Signature
from mars_asp.lsp.places import MOST_CHARACTERS, Position, Range, Text

_TOKEN = re.compile(
    r"(?P<comment>%\*.*?(?:\*%|\Z)|%[^\n]*+)"
    r'|(?P<string>"(?:\\.|[^"\\\n])*+"?)'
    r"|(?P<directive>\#[a-z]\w*+)"
    r"|(?P<name>'*_*[a-z][\w']*+)"
    r"|(?P<variable>'*_*[A-Z][\w']*+|_)"
    r"|(?P<dots>\.\.+)"
    r"|(?P<sign>:-|:~|<=|>=|!=|==|[-()\[\]{},;:.<>=/+*@|&?^~\\])"
    r"|(?P<number>[0-9]\w*+)",
    re.DOTALL,
)
_DOCSTRING = re.compile(r"%\*!\s*(-?[a-z_]\w*)")
_ARITY = re.compile(r"\s*/\s*([0-9]{1,4})")
#: After these operators a name is a value, not a predicate.
_COMPARING = frozenset({"=", "==", "!=", "<", ">", "<=", ">=", "+", "*", "/", "@", "\\", "^", "|"})
_DEPTHS = {"(": 1, ")": -1}


class PredicateMention(NamedTuple):
    """An occurrence of a predicate; `is_head` is whether it is in a head or a docstring."""

    name: str
    arity: int
    positive: bool
    range: Range
    is_head: bool

    @property
    def key(self) -> tuple[str, int]:
        """Return the name and arity, without the sign."""
        return self.name, self.arity

    @property
    def signature(self) -> Signature:
        """Return the name and arity with the sign of the predicate."""
        return Signature(self.name, self.arity, self.positive)


class RuleText(NamedTuple):
    """The occurrences of predicates in a text, in order, and `blank`: its comments and strings."""

    text: Text
    mentions: tuple[PredicateMention, ...]
    blank: tuple[Range, ...]

    def at(self, position: Position) -> PredicateMention | None:
        """Return the occurrence of a predicate at a position, or None."""
        return next((each for each in self.mentions if each.range.holds(position)), None)

    def is_blank(self, position: Position) -> bool:
        """Whether a position is in a comment or a string."""
        return any(each.start < position <= each.end for each in self.blank)


def is_rules(path: str) -> bool:
    """Whether a file is a logic program, by its suffix `.lp`."""
    return path.lower().endswith(".lp")


class _Token(NamedTuple):
    sort: str
    text: str
    begin: int
    end: int


@lru_cache(maxsize=128)
def rule_text(path: str, written: str) -> RuleText:
    """Return the occurrences of predicates in a text of rules; none if it is too large."""
    text = Text(path, written)
    if len(written) > MOST_CHARACTERS:
        return RuleText(text, (), ())
    tokens = [
        _Token(match.lastgroup or "", match[0], *match.span())
        for match in _TOKEN.finditer(text.plain)
    ]
    blank = tuple(
        text.between(each.begin, each.end) for each in tokens if each.sort in ("comment", "string")
    )
    mentions = tuple(_mentions(tokens, text))
    return RuleText(text, mentions, blank)


def _mentions(tokens: list[_Token], text: Text) -> Iterator[PredicateMention]:
    """Yield the predicates of rules, which are names outside of arguments, and of docstrings."""
    depth, in_body, is_condition, before = 0, False, False, ""
    closed = _arguments(tokens)
    for number, token in enumerate(tokens):
        if token.sort == "comment":
            yield from _documented(token, text)
            continue
        if token.sort == "sign":
            depth = max(depth + _DEPTHS.get(token.text, 0), 0)
            if token.text == "." and not depth:
                in_body = is_condition = False
            elif token.text in (":-", ":~"):
                depth, in_body = 0, True
            elif token.text in (":", ";", "}") and not depth:
                # `{ offered(X) : premise(X) }`
                is_condition = token.text == ":"
        elif token.sort == "directive":
            in_body = True
        elif token.sort == "name" and not depth and before not in _COMPARING:
            arity = _arity(tokens, number, text.plain, closed)
            is_negated = before == "-"
            if token.text != "not" and arity is not None:
                place = text.between(token.begin, token.end)
                yield PredicateMention(
                    token.text, arity, not is_negated, place, not (in_body or is_condition)
                )
        before = token.text


def _arity(tokens: list[_Token], number: int, text: str, closed: Mapping[int, int]) -> int | None:
    """Return the arity of the predicate at token `number`, or None if it is only a value."""
    token = tokens[number]
    declared = _ARITY.match(text, token.end)
    if declared is not None:
        return int(declared[1])
    following = tokens[number + 1] if number + 1 < len(tokens) else None
    if following is None or following.text != "(":
        # Before a comparison, the name is a value.
        return None if following is not None and following.text in _COMPARING else 0
    return closed[number + 1]


def _arguments(tokens: list[_Token]) -> dict[int, int]:
    """Return the number of arguments in each opening bracket, by token."""
    found: dict[int, int] = {}
    opened: list[int] = []
    for number, token in enumerate(tokens):
        if token.sort == "comment":
            continue
        if token.text in (".", ":-", ":~") and token.sort == "sign":
            opened.clear()
        elif token.text == ")":
            if opened:
                opened.pop()
        else:
            if opened and not found[opened[-1]]:
                found[opened[-1]] = 1
            if token.text == "(":
                opened.append(number)
                found[number] = 0
            elif token.text == "," and opened:
                found[opened[-1]] += 1
    return found


def _documented(token: _Token, text: Text) -> Iterator[PredicateMention]:
    match = _DOCSTRING.match(token.text)
    if match is None:
        return
    depth, commas, is_empty = 0, 0, True
    for sign in token.text[match.end() :]:
        depth += {"(": 1, "{": 1, ")": -1, "}": -1}.get(sign, 0)
        if depth <= 0:
            break
        commas += sign == "," and depth == 1
        is_empty = is_empty and (sign.isspace() or sign == "(")
    begin = token.begin + match.start(1)
    name = match[1].removeprefix("-")
    place = text.between(begin, begin + len(match[1]))
    yield PredicateMention(name, 0 if is_empty else commas + 1, name == match[1], place, True)
