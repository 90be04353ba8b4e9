"""Representation names of types, as they are written in seven languages.

The thirteen rules of the language reference, section 9: qualifiers, references and wrappers are
dropped, sequences become `T[]`, callbacks are `function`; unknown types are None.
"""

import re
from functools import lru_cache

from mars_asp.annotations.type_words import (
    CALLBACKS,
    FALLS_AWAY,
    INTEGER_WORDS,
    MAPS,
    NOTHING,
    POINTERS,
    ROS_FOLDERS,
    SEQUENCES,
    STREAMS,
    UNKNOWN,
    WRAPPERS,
)

#: A `$` begins a name, or separates two as `::` does.
_TOKEN = re.compile(
    r"'[a-z_]\w*|\.\.\.|::|->|<-|&&|(?:[^\W\d]|~|(?<!\w)\$)\w*|\d[\w.]*|\"[^\"]*\"|\S"
)
_NAME = re.compile(r"[^\W\d]|[$~]")
#: The representation of callbacks, which are never data.
CALLBACK = "function"
_MOST_TOKENS = 2000
_MOST_DEPTH = 40


class _UnreadableError(Exception):
    """The text cannot be read as a type."""


@lru_cache(maxsize=1024)
def representation(text: str) -> str | None:
    """Return a type's representation name, None if it is unknown, or "" for void types."""
    tokens = _TOKEN.findall(re.sub(r"\[\[.*?\]\]", " ", text))
    if not tokens or len(tokens) > _MOST_TOKENS:
        return None
    try:
        reader = _TypeReader(tokens)
        name = reader.union()
        if reader.peek():
            return None
    except _UnreadableError:
        return None
    return name


class _TypeReader:
    """Reads one type by recursive descent, at most `_MOST_DEPTH` deep."""

    def __init__(self, tokens: list[str]) -> None:
        self.tokens = tokens
        self.at = 0
        self.depth = 0

    def peek(self, ahead: int = 0) -> str:
        index = self.at + ahead
        return self.tokens[index] if index < len(self.tokens) else ""

    def take(self) -> str:
        token = self.peek()
        self.at += 1
        return token

    def accept(self, *words: str) -> bool:
        if self.peek() in words:
            self.at += 1
            return True
        return False

    def union(self) -> str | None:
        """Return the type of `A | None`, which is A; None for other unions."""
        self.depth += 1
        if self.depth > _MOST_DEPTH:
            raise _UnreadableError
        parts = [self.term()]
        while self.accept("|"):
            parts.append(self.term())
        self.depth -= 1
        real = [part for part in parts if part != ""]
        if len(real) > 1:
            return None
        return real[0] if real else ""

    def term(self) -> str | None:
        self.skip_qualifiers()
        if self.peek().startswith('"'):
            return representation(self.take().strip('"'))
        self.accept("::")
        if self.peek() == "[":
            return self.bracketed()
        if self.peek() == "(":
            return self.parenthesised()
        if self.accept("<-"):
            return self.term()
        if self.peek() == "!":
            self.take()
            return ""
        name = self.named()
        return self.suffixes(name)

    def skip_qualifiers(self) -> None:
        while True:
            token = self.peek()
            if (
                token in ("&", "&&", "*", "mut")
                or token.startswith("'")
                or (token in FALLS_AWAY and self.peek(1))
                or (token in ("impl", "chan") and self.peek(1))
            ):
                self.at += 1
            else:
                return

    def bracketed(self) -> str | None:
        """Read `[]T`, `[N]T` (Go), `[T]` or `[T; N]` (Rust): an array, or None."""
        self.take()
        if self.accept("]"):
            return _sequence(self.term())
        start = self.at
        inner = self.union() if not self.peek()[:1].isdigit() else (self.take(), None)[1]
        if self.accept(";"):
            while self.peek() and self.peek() != "]":
                self.take()
        if not self.accept("]"):
            raise _UnreadableError
        following = self.peek()
        if following and (following[0].isalpha() or following[0] in "_*[") and start != self.at:
            return _sequence(self.term())
        return _sequence(inner)

    def parenthesised(self) -> str | None:
        self.take()
        parts: list[str | None] = []
        while self.peek() and self.peek() != ")":
            parts.append(self.union())
            self.accept(",")
        if not self.accept(")"):
            raise _UnreadableError
        real = [part for part in parts if part != ""]
        if not real:
            return ""
        if len(real) == 1:
            return self.suffixes(real[0])
        listed = None if None in real else f"({','.join(str(part) for part in real)})"
        return self.suffixes(listed)

    def named(self) -> str | None:
        words: list[str] = []
        arguments: list[str | None] | None = None
        while True:
            token = self.take()
            if not _NAME.match(token):
                raise _UnreadableError
            if token in INTEGER_WORDS and not words:
                return self.integer(token)
            words.append(token)
            if token in ("func", "fn", "Fn", "FnMut", "FnOnce") and self.peek() == "(":
                self.skip_group("(", ")")
                if self.accept("->") or (token == "func" and self.peek() not in ("", ",", ")")):
                    self.union()
                return CALLBACK
            if token == "map" and self.peek() == "[":
                return self.go_map()
            if token == "interface" and self.peek() == "{":
                self.skip_group("{", "}")
                return None
            opening = self.peek()
            if opening == "::" and self.peek(1) == "<":
                self.take()
                opening = "<"
            if opening == "<" or (opening == "[" and self.generic_bracket()):
                arguments = self.arguments(">" if opening == "<" else "]")
            if self.peek() in ("::", ".", "/", "$") and self.peek(1):
                self.take()
                if self.peek() in POINTERS and self.peek(1) not in ("::", ".", "<"):
                    self.take()
                    break
                if arguments is not None:
                    words[-1] += _type_arguments(arguments)
                    arguments = None
                continue
            break
        return _applied(words, arguments)

    def generic_bracket(self) -> bool:
        """Whether the current `[` opens type arguments and not an array."""
        following = self.peek(1)
        return bool(following) and following != "]" and not following[0].isdigit()

    def integer(self, first: str) -> str:
        words = [first]
        while self.peek() in INTEGER_WORDS or self.peek() in ("const", "volatile"):
            word = self.take()
            if word in INTEGER_WORDS:
                words.append(word)
        kept = [word for word in words if word != "signed"]
        if not {"char", "double"} & set(kept) and (len(kept) > 1 or "unsigned" not in kept):
            sized = [word for word in kept if word in ("long", "short")]
            kept = (["unsigned"] if "unsigned" in kept else []) + (sized or ["int"])
        elif kept == ["unsigned"]:
            kept = ["unsigned", "int"]
        if "char" in kept or "double" in kept:
            order = {"unsigned": 0, "long": 1}
            kept.sort(key=lambda word: order.get(word, 2))
        return " ".join(kept) or "int"

    def go_map(self) -> str | None:
        self.take()
        key = self.union()
        if not self.accept("]"):
            raise _UnreadableError
        value = self.term()
        return None if key is None or value is None else f"map<{key},{value}>"

    def arguments(self, closing: str) -> list[str | None]:
        self.take()
        found: list[str | None] = []
        while self.peek() and self.peek() != closing:
            if self.peek() == "[" and not self.is_array(closing):
                # The parameters of a callable.
                self.skip_group("[", "]")
                found.append("")
            elif self.peek() == "...":
                found.append(self.take())
            elif self.peek() == "?":
                self.take()
                # A supertype can be any type; a type that extends a bound is an instance of it.
                above = self.peek() == "super"
                bound = self.union() if self.accept("extends", "super") else None
                found.append(None if above else bound)
            elif self.peek(1) == "=":
                # Output=T of a Rust trait.
                self.at += 2
                found.append(self.union())
            elif self.peek()[0] in "'\"" and found:
                self.take()
            else:
                found.append(self.argument(closing))
            self.accept(",")
        if not self.accept(closing):
            raise _UnreadableError
        return found

    def is_array(self, closing: str) -> bool:
        """Whether a `[` among arguments begins an array in Rust or Go."""
        return closing == ">" or (self.peek(1) == "]" and self.peek(2) not in (",", "]"))

    def argument(self, closing: str) -> str | None:
        """Read one argument: a type, a function's signature, or an expression, kept as text."""
        start, depth = self.at, self.depth
        try:
            found = self.union()
            if self.peek() == "(":
                self.skip_group("(", ")")
                found = CALLBACK
            if self.accept("="):
                found = self.union()
        except _UnreadableError:
            self.at = start
        if self.at > start and self.peek() in (",", closing):
            return found
        self.at, self.depth = start, depth
        brackets = 0
        while self.peek() and (brackets or self.peek() not in (",", closing)):
            token = self.take()
            brackets += (token in "([{<") - (token in ")]}>")
        return "".join(self.tokens[start : self.at])

    def skip_group(self, opening: str, closing: str) -> None:
        depth = 0
        while self.peek():
            token = self.take()
            depth += (token == opening) - (token == closing)
            if not depth:
                return
        raise _UnreadableError

    def suffixes(self, name: str | None) -> str | None:
        pointer = False
        while True:
            token = self.peek()
            if token in ("&", "&&", "*", "?", "!") or token.startswith("'"):
                pointer = pointer or token == "*"
                self.take()
            elif token in FALLS_AWAY or token in ("mut",):
                self.take()
            elif token == "+":
                # Bounds of a Rust trait object do not change its type.
                self.take()
                if self.peek().startswith("'"):
                    self.take()
                else:
                    self.term()
            elif token == "...":
                self.take()
                name = _sequence(name)
            elif token == "[":
                self.skip_group("[", "]")
                name = _sequence(name)
            else:
                break
        return None if pointer and name == "" else name


def _sequence(name: str | None) -> str | None:
    return None if name is None else f"{name}[]" if name else ""


def _type_arguments(arguments: list[str | None]) -> str:
    return f"<{','.join(argument or '?' for argument in arguments)}>"


def _applied(words: list[str], arguments: list[str | None] | None) -> str | None:
    """Return a type with its arguments, wrappers such as `shared_ptr` omitted; None if unknown."""
    last = words[-1]
    name = "::".join([*(word for word in words[:-1] if word not in ROS_FOLDERS), last])
    first = arguments[0] if arguments else None
    if last in CALLBACKS and (arguments is not None or len(words) > 1 or last != "function"):
        return CALLBACK
    if name in UNKNOWN:
        return None
    if name in NOTHING:
        return ""
    if arguments is None:
        return name
    if last == "Union":
        real = [argument for argument in arguments if argument != ""]
        return None if len(real) > 1 else real[0] if real else ""
    if last == "Coroutine" and len(arguments) == 3:
        return arguments[2]
    if last in WRAPPERS or last in STREAMS:
        return first
    if last in MAPS and len(arguments) >= 2:
        key, value = arguments[:2]
        return None if key is None or value is None else f"map<{key},{value}>"
    if last in {"tuple", "Tuple"}:
        if arguments[1:] == ["..."]:
            return _sequence(first)
        return None if None in arguments else f"({','.join(str(a) for a in arguments)})"
    if last in SEQUENCES:
        return _sequence(first)
    kept = [argument for argument in arguments if argument != "..."]
    return None if None in kept else name + _type_arguments(kept)
