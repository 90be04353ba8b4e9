"""The tokens of a file in C++: the calls in it, and the functions that it defines."""

import re
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Generic, NamedTuple, TypeVar

from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    angle,
    closing,
    is_word,
    joined,
    split,
    text_at,
    tokenise,
)
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Span

T = TypeVar("T")
_MOST_TOKENS = 400_000
#: Limits of what is copied or searched more than once; no program comes near them.
_MOST_COPIED = 1_000_000
_MOST_PARAMETERS = 200
_MOST_INITIALISERS = 4000
_MOST_BASES = 60
_MOST_STATEMENT = 500
_STRING = re.compile(
    r'(?:u8|[uUL])?(?:R"(?P<tag>[^(]*)\((?P<raw>.*)\)(?P=tag)"|"(?P<plain>.*)")', re.DOTALL
)
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_BRACKETS, _OPENING = frozenset("()[]{}"), frozenset("([{")
_KEYWORDS = frozenset({"if", "for", "while", "switch", "catch", "return", "sizeof"})


class CppCall(NamedTuple):
    """A call of a function: its name, its token's index, its template arguments and arguments.

    `end` is the index of the token after it.
    """

    name: str
    at: int
    types: tuple[str, ...]
    arguments: tuple[tuple[SourceToken, ...], ...]
    end: int


@dataclass(slots=True)
class CppBody:
    """The definition of a function: the tokens at which its body begins and ends.

    `begin` is the index of its `{`, `end` the one after its last token, `opening` that of the
    bracket of its parameters.
    """

    name: str
    begin: int
    end: int
    parameters: tuple[SourceToken, ...]
    opening: int


class ClassHead(NamedTuple):
    """A class by the bracket of its body, its name, and the words that name its base classes."""

    opening: int
    name: str
    bases: frozenset[str]


class Nested(Generic[T]):
    """Ranges of token indices, nested or disjoint, each with a value."""

    def __init__(self, ranges: Sequence[tuple[int, int, T]]) -> None:
        """Index sorted ranges: (token before the first, index after the last, value)."""
        self._ranges = ranges
        self._begins = [begin for begin, _, _ in ranges]
        self._outer: list[int] = []
        waiting: list[int] = []
        for number, (begin, _, _) in enumerate(ranges):
            while waiting and ranges[waiting[-1]][1] <= begin:
                waiting.pop()
            self._outer.append(waiting[-1] if waiting else -1)
            waiting.append(number)

    def around(self, at: int) -> Iterator[T]:
        """Yield the values of the ranges that contain a token, the innermost first."""
        number = bisect_left(self._begins, at) - 1
        while number >= 0:
            _, end, value = self._ranges[number]
            if at < end:
                yield value
            number = self._outer[number]


class CppCode:
    """The tokens of a file, the calls in it and its functions."""

    def __init__(self, text: str, path: str, called: Set[str], made: Set[str]) -> None:
        """Find calls of the functions in `called`, and variables of the types in `made`."""
        self.source = Source(path, "c", text)
        stretch = self.source.stretch(0, len(text), len(text))
        self.text = stretch.text
        self.tokens = tokenise(stretch.code)[:_MOST_TOKENS]
        self.closed = self._closed_brackets()
        self.calls = tuple(self._calls(called, made))
        self.bodies = tuple(self._bodies())

    # ---- Places and texts

    def span(self, token: SourceToken, length: int | None = None) -> Span:
        """Return the location of a token, or of its first `length` characters."""
        line, column = self.source.position(token.offset)
        end = column + (len(token.text) if length is None else length)
        return Span(self.source.path, line, column, line, end)

    def string(self, token: SourceToken) -> str | None:
        """Return the text of a token, or None if it is not a string."""
        begin = token.offset
        match = _STRING.fullmatch(self.text[begin : begin + len(token.text)])
        if match is None:
            return None
        if match["raw"] is not None:
            return match["raw"]
        return _ESCAPE.sub(r"\1", match["plain"])

    # ---- What is in the file

    @cached_property
    def _places_by_text(self) -> Mapping[str, Sequence[int]]:
        found: defaultdict[str, list[int]] = defaultdict(list)
        for at, (text, _) in enumerate(self.tokens):
            found[text].append(at)
        return dict(found)

    @property
    def token_texts(self) -> Set[str]:
        """The texts of all tokens."""
        return self._places_by_text.keys()

    def token_places(self, *words: str) -> Sequence[int]:
        """Return the indices of tokens with one of some texts, in order."""
        return self.places_of(frozenset(words))

    def places_of(self, words: Set[str]) -> Sequence[int]:
        """Return the indices of tokens with one of some texts, in order."""
        used = self.token_texts & words
        return sorted(chain.from_iterable(self._places_by_text[each] for each in used))

    def _closed_brackets(self) -> dict[int, int]:
        """Return, for each opening bracket, the index after its closing bracket."""
        found: dict[int, int] = {}
        waiting: list[int] = []
        for at in self.places_of(_BRACKETS):
            if self.tokens[at].text in _OPENING:
                waiting.append(at)
            elif waiting:
                found[waiting.pop()] = at + 1
        return found | dict.fromkeys(waiting, len(self.tokens))

    def _calls(self, called: Set[str], made: Set[str]) -> Iterator[CppCall]:
        """Yield each call of a function in `called`, and each variable of a type in `made`."""
        tokens, copied = self.tokens, 0
        for at in self.places_of(called):
            name, after = tokens[at].text, at + 1
            types: tuple[str, ...] = ()
            if text_at(tokens, after) == "<":
                end = angle(tokens, after)
                if end is not None:
                    inner = tokens[after + 1 : end - 1]
                    types = tuple(joined(group) for group in split(inner))
                    after = end
            # `ros::Rate loop(10)` and `Subscriber<T> name(...)` name what they make.
            if is_word(text_at(tokens, after)) and (name in made or types):
                after += 1
            opening = text_at(tokens, after)
            if opening == "(" or (opening == "{" and (name in made or types)):
                end = self.closed[after]
                # Calls that are nested without end would be copied without end.
                copied += end - after
                if copied > _MOST_COPIED:
                    return
                arguments = split(tokens[after + 1 : end - 1])
                yield CppCall(name, at, types, tuple(map(tuple, arguments)), end)

    def _bodies(self) -> Iterator[CppBody]:
        """Yield the functions that are defined."""
        tokens = self.tokens
        last = -1
        for at in self.token_places("("):
            if at > last and is_word(text_at(tokens, at - 1)):
                end = after = self.closed[at]
                name = text_at(tokens, at - 1)
                while is_word(text_at(tokens, after)) or text_at(tokens, after) in ("->", "::"):
                    after += 1
                if text_at(tokens, after) == ":" and text_at(tokens, after + 1) != ":":
                    after = _after_initialisers(tokens, after + 1)
                if text_at(tokens, after) == "{" and name not in _KEYWORDS:
                    parameters = tuple(tokens[at + 1 : min(end - 1, at + _MOST_PARAMETERS)])
                    yield CppBody(name, after, self.closed[after], parameters, at)
                    # The last initialiser of a constructor looks like a function.
                    last = after

    @cached_property
    def base_classes(self) -> Set[str]:
        """The names of the base classes of classes in the file."""
        found: set[str] = set()
        for at in self.token_places("public", "protected", "private"):
            last = at + 1
            while text_at(self.tokens, last + 1) == "::":
                last += 2
            found.add(text_at(self.tokens, last))
        return found

    @cached_property
    def strings(self) -> Sequence[int]:
        """The indices of string literals."""
        return self.places_of({each for each in self.token_texts if each.startswith('"')})

    @cached_property
    def given_texts(self) -> Set[str]:
        """The names of functions and classes that get a string literal as first argument."""
        return {
            self.tokens[at - 2].text
            for at in self.strings
            if at >= 2 and self.tokens[at - 1].text in ("(", "{")
        }

    @cached_property
    def bodies_at(self) -> "Callable[[int], Iterator[CppBody]]":
        """The functions whose parameters or body contain a token, the innermost first."""
        return Nested([(body.opening, body.end, body) for body in self.bodies]).around

    def class_at(self, at: int) -> str:
        """Return the class around a token, or an empty text if there is none."""
        return next(self._classes.around(at), "")

    def class_of(self, body: CppBody) -> str:
        """Return the class of a function, or an empty text if it has none."""
        before = body.opening - 2
        before -= text_at(self.tokens, before) == "~"
        if text_at(self.tokens, before) == "::" and is_word(text_at(self.tokens, before - 1)):
            return text_at(self.tokens, before - 1)
        return self.class_at(body.opening)

    @cached_property
    def tests_at(self) -> "Callable[[int], Iterator[tuple[int, int, bool]]]":
        """The conditions around a token: (begin, end, whether it holds at the token)."""
        found: list[tuple[int, int, tuple[int, int, bool]]] = []
        for at in self.token_places("if"):
            if text_at(self.tokens, at + 1) != "(":
                continue
            last = self.closed[at + 1]
            end = self._statement_end(last)
            found.append((last - 1, end, (at + 2, last - 1, True)))
            if text_at(self.tokens, end) == "else":
                otherwise = self._statement_end(end + 1)
                found.append((end, otherwise, (at + 2, last - 1, False)))
        return Nested(sorted(found)).around

    def _statement_end(self, at: int) -> int:
        """Return the index after a statement, or of its first `if`."""
        if text_at(self.tokens, at) == "{":
            return self.closed[at]
        last = min(len(self.tokens), at + _MOST_STATEMENT)
        while at < last and text_at(self.tokens, at) not in (";", "}", "if"):
            at = self.closed.get(at, at + 1)
        return min(at + 1, last)

    @cached_property
    def class_heads(self) -> Sequence[ClassHead]:
        """The classes that are defined."""
        found: list[ClassHead] = []
        for at in self.token_places("class", "struct"):
            after, name = at + 1, ""
            while is_word(text_at(self.tokens, after)):
                word = text_at(self.tokens, after)
                name = name if word == "final" else word
                after += 1
            last, bases = after + _MOST_BASES, list[str]()
            if text_at(self.tokens, after) == ":":
                while after < last and text_at(self.tokens, after) not in ("{", ";", "(", ""):
                    bases.append(text_at(self.tokens, after))
                    after += 1
            if name and text_at(self.tokens, after) == "{":
                found.append(ClassHead(after, name, frozenset(filter(is_word, bases))))
        return found

    @cached_property
    def type_aliases(self) -> Sequence[tuple[str, str]]:
        """The names of types by `using A = B;` and `typedef B A;`, each with its type."""
        found: list[tuple[str, str]] = []
        for at in self.token_places("using", "typedef"):
            end = at + 1
            while end < at + _MOST_BASES and text_at(self.tokens, end) not in (";", "{", ""):
                end += 1
            words = self.tokens[at + 1 : end]
            is_using = self.tokens[at].text == "using"
            name = text_at(words, 0 if is_using else len(words) - 1)
            if is_word(name) and (text_at(words, 1) == "=" or not is_using):
                found.append((name, joined(words[2:] if is_using else words[:-1])))
        return found

    @cached_property
    def _classes(self) -> "Nested[str]":
        """The bodies of defined classes, each a range of tokens with the class's name."""
        heads = self.class_heads
        return Nested([(head.opening, self.closed[head.opening], head.name) for head in heads])


def _after_initialisers(tokens: Sequence[SourceToken], at: int) -> int:
    """Return the index of a constructor's body; `at` is the first of its initialisers."""
    most = min(len(tokens), at + _MOST_INITIALISERS)
    while at < most:
        while at < most and text_at(tokens, at) not in ("(", "{", ";"):
            end = angle(tokens, at) if text_at(tokens, at) == "<" else None
            at = at + 1 if end is None else end
        if text_at(tokens, at) in ("", ";"):
            return at
        at = closing(tokens, at)
        if text_at(tokens, at) != ",":
            return at
        at += 1
    return at
