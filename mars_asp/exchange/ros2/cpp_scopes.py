"""Scopes of the names in a file in C++: where each is declared, and where it gets a value."""

from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from itertools import islice
from operator import attrgetter
from typing import NamedTuple

from mars_asp.annotations.declarations.tokens import SourceToken, is_word, text_at
from mars_asp.exchange.ros2.cpp_code import CppBody, CppCall, CppCode, Nested

#: Calls that declare a parameter, that return its value, and that also write it to a variable.
DECLARING = frozenset({"declare_parameter", "declare_parameter_if_not_declared"})
_RETURNING = frozenset({"declare_or_get_parameter", "get_parameter_or", "param"})
PARAMETERS = DECLARING | _RETURNING | {"get_parameter", "getParam"}
_MOST_WORDS = 50
#: No program has scopes in so many others.
_DEEPEST_SCOPE = 100
#: Signs after the name of a variable that is declared: in a block, among parameters or in a header.
_IN_BLOCK = frozenset({"=", ";", ",", "{", "(", "["})
_IN_PARAMETERS = frozenset({",", ")", "=", "["})
_HEADERS = {
    "for": frozenset({"=", ":", ",", "{", "("}),
    "if": frozenset({"=", "{"}),
    "while": frozenset({"=", "{"}),
    "switch": frozenset({"=", "{"}),
    "catch": frozenset({")"}),
}
_NOT_TYPES = frozenset(
    "return new throw else case goto delete co_return using namespace class struct enum"
    " operator define do and or not public private protected typename".split()
)
#: Methods that change a text.
_CHANGING = frozenset(
    "append assign insert replace erase push_back pop_back clear resize swap".split()
)
_SIGNS = frozenset({"*", "&", "&&", "const"})
_STARTS = frozenset({";", "{", "}", "(", ",", ":", "#", ""})


class Assigned(NamedTuple):
    """A value that a name gets: an expression by its range, which is empty if unknown.

    `is_first` is whether the variable has it before any statement that assigns another. If there is
    a `parameter`, its value is written to the variable; a `function` may write any. Of an object
    that is made without arguments, `function` is its own name.
    """

    at: int
    begin: int
    end: int
    is_first: bool
    parameter: str | None = None
    function: str = ""


class Named(NamedTuple):
    """A name in a file: its declarations and values.

    `scopes` are the brackets of functions and blocks that declare it, each with the token of the
    first declaration; `owners` are the classes and namespaces that declare it. `values` are by
    scope; the key -1 has those of members and constants.
    """

    scopes: Mapping[int, int]
    owners: frozenset[str]
    values: Mapping[int, Sequence[Assigned]]


class ScopedCode(CppCode):
    """The tokens of a C++ file, with the scopes of its names."""

    def index_of(self, token: SourceToken) -> int:
        """Return the index of a token of the file."""
        return bisect_left(self.tokens, token.offset, key=attrgetter("offset"))

    def scope_at(self, at: int, named: Named) -> int:
        """Return the opening bracket of the scope that declares a name; -1 if it is not local."""
        if text_at(self.tokens, at - 1) in (".", "->", "::") or self._is_initialised(at):
            return -1
        for opening in islice(self._brackets.around(at), _DEEPEST_SCOPE):
            if named.scopes.get(opening, at + 1) <= at:
                return opening
            if self.owner_brackets.get(opening) in named.owners:
                break
        return -1

    @cached_property
    def parameter_defaults(self) -> Mapping[str, Sequence[tuple[SourceToken, ...]]]:
        """The expressions that are defaults of parameters, by the names of these."""
        found: dict[str, list[tuple[SourceToken, ...]]] = {}
        for call in self.calls:
            name, others = self.parameter_in(call.name, call.arguments)
            if name is not None:
                found.setdefault(name, []).extend(others[self._is_read_into(call, others) :])
        return found

    def parameter_in(
        self, called: str, arguments: Sequence[Sequence[SourceToken]]
    ) -> tuple[str | None, Sequence[tuple[SourceToken, ...]]]:
        """Return the name of the ROS parameter that a call reads, and the later arguments.

        They are None and empty if the call of `called` reads none.
        """
        for at, argument in enumerate(arguments[:2] if called in PARAMETERS else ()):
            name = self.string(argument[0]) if len(argument) == 1 else None
            if name is not None:
                return name.lstrip("~"), [*map(tuple, arguments[at + 1 :])]
        return None, ()

    @cached_property
    def _parameters_read(self) -> Mapping[int, str]:
        """The names of ROS parameters read into variables, by the variable's offset."""
        found: dict[int, str] = {}
        for call in self.calls:
            name, others = self.parameter_in(call.name, call.arguments)
            if name is not None and self._is_read_into(call, others):
                found[others[0][-1].offset] = name
        return found

    def _is_read_into(self, call: CppCall, others: Sequence[Sequence[SourceToken]]) -> bool:
        is_read = len(others) > (call.name in _RETURNING) and call.name not in DECLARING
        return is_read and is_word(others[0][-1].text)

    def parameter_of(self, opening: int) -> CppBody | None:
        """Return the function whose parameters an opening bracket begins, or None."""
        return self._bodies_by_opening.get(opening)

    def owners_at(self, at: int) -> Iterator[str]:
        """Yield the classes and namespaces around a token, the innermost first."""
        return (
            self.owner_brackets[each]
            for each in islice(self._brackets.around(at), _DEEPEST_SCOPE)
            if each in self.owner_brackets
        )

    def is_typed(self, at: int) -> bool:
        """Whether the name at a token is preceded by a type, as in a declaration."""
        back = self._before_signs(at)
        has_signs = back < at - 1
        back = self._before_angles(back)
        if not is_word(text_at(self.tokens, back)) or text_at(self.tokens, back) in _NOT_TYPES:
            return False
        if not has_signs:
            return True
        last = back - _MOST_WORDS
        while back > last and (
            text_at(self.tokens, back) == "::" or is_word(text_at(self.tokens, back))
        ):
            if text_at(self.tokens, back) in _NOT_TYPES:
                return False
            back = self._before_angles(back - 1)
        return text_at(self.tokens, back) in _STARTS or not self._is_local(self.bracket_at(at))

    # ---- Places

    @cached_property
    def declarations_of(self) -> Callable[[str], Named]:
        """The function that returns the declarations and values of a name."""
        return cache(self._names_of)

    @cached_property
    def _bodies_by_opening(self) -> Mapping[int, CppBody]:
        return {body.opening: body for body in self.bodies}

    @cached_property
    def owner_brackets(self) -> Mapping[int, str]:
        """The classes and namespaces that have names, by their brackets."""
        found = {head.opening: head.name for head in self.class_heads}
        for at in self.token_places("namespace"):
            end = at + 1
            while is_word(text_at(self.tokens, end)) or text_at(self.tokens, end) == "::":
                end += 1
            if text_at(self.tokens, end) == "{":
                found[end] = text_at(self.tokens, end - 1) if end > at + 1 else ""
        return found

    @cached_property
    def _header_scopes(self) -> Mapping[int, tuple[int, frozenset[str]]]:
        """The brackets of parameters, loops and conditions, in which names are declared.

        Each has the end of its scope, and the signs that may follow a declared name.
        """
        found = {body.opening: (body.end, _IN_PARAMETERS) for body in self.bodies}
        for at in self.token_places("("):
            before = text_at(self.tokens, at - 1)
            before = text_at(self.tokens, at - 2) if before == "constexpr" else before
            if before in _HEADERS:
                found[at] = self._end_of_statement(self.closed[at]), _HEADERS[before]
            elif before == "]":
                end = self.closed[at]
                last = end + _MOST_WORDS
                while end < last and text_at(self.tokens, end) not in ("{", ";", ",", ")", ""):
                    end += 1
                if text_at(self.tokens, end) == "{":
                    found[at] = self.closed[end], _IN_PARAMETERS
        return found

    @cached_property
    def _brackets(self) -> "Nested[int]":
        ends = self.closed | {at: end for at, (end, _) in self._header_scopes.items()}
        return Nested([(at, ends[at], at) for at in sorted(ends)])

    @cached_property
    def _opened(self) -> Mapping[int, int]:
        return {end - 1: at for at, end in self.closed.items()}

    def bracket_at(self, at: int) -> int:
        """Return the innermost bracket around a token, or -1 if there is none.

        A bracket of parameters or of a statement is also around the block after it.
        """
        return next(self._brackets.around(at), -1)

    def _is_local(self, opening: int) -> bool:
        return opening >= 0 and opening not in self.owner_brackets

    def _end_of_statement(self, at: int) -> int:
        """Return the index after a statement and the branches of `else` after it."""
        last = min(len(self.tokens), at + 2000)
        while at < last:
            text = text_at(self.tokens, at)
            if text in _HEADERS and text_at(self.tokens, at + 1) == "(":
                at = self.closed[at + 1]
                continue
            while at < last and text_at(self.tokens, at) not in (";", "{", "}"):
                at = self.closed.get(at, at + 1)
            at = self.closed[at] if text_at(self.tokens, at) == "{" else at + 1
            if text_at(self.tokens, at) != "else":
                break
            at += 1
        return min(at, len(self.tokens))

    # ---- Declarations

    def _before_signs(self, at: int) -> int:
        back = at - 1
        while text_at(self.tokens, back) in _SIGNS and text_at(self.tokens, back) != "":
            back -= 1
        return back + 1 if text_at(self.tokens, back + 1) == "const" else back

    def _before_angles(self, back: int) -> int:
        """Return the index before template arguments that end at a token, else the index."""
        depth, at = 0, back
        while text_at(self.tokens, at) and at > back - _MOST_WORDS:
            text = self.tokens[at].text
            depth += (text == ">") - (text == "<")
            if depth <= 0:
                return at - 1 if at < back else back
            at = self._opened.get(at, at) - 1
        return -1

    def _declared_in(self, at: int) -> int | None:
        """Return the bracket of the scope in which the token declares a name, or None."""
        tokens = self.tokens
        opening = self.bracket_at(at)
        if text_at(tokens, opening) == "[":
            is_bound = text_at(tokens, opening - 1) in ("auto", "&", "&&")
            return self.bracket_at(opening) if is_bound else None
        if opening in self._header_scopes:
            if at >= self.closed[opening]:
                return None
            signs = self._header_scopes[opening][1]
        elif text_at(tokens, opening) in ("{", ""):
            signs = _IN_BLOCK
        else:
            return None
        sign = text_at(tokens, at + 1)
        if sign not in signs or (sign == "=" and text_at(tokens, at + 2) == "="):
            return None
        is_further = text_at(tokens, self._before_signs(at)) == "," and signs is not _IN_PARAMETERS
        typed = self._first_declared(at, opening) if is_further else at
        return opening if self.is_typed(typed) else None

    def _first_declared(self, at: int, opening: int) -> int:
        """Return the index of the first name declared in the declaration of the name at `at`."""
        begin = at - 1
        last = max(opening, at - 4 * _MOST_WORDS)
        while begin > last and text_at(self.tokens, begin) not in (";", "{"):
            # After a bracket of a value there is a comma, after one of a block none.
            if self.tokens[begin].text == "}" and self.tokens[begin + 1].text != ",":
                break
            begin = self._opened.get(begin, begin) - 1
        begin += 1
        while begin < at and text_at(self.tokens, begin + 1) not in _IN_BLOCK:
            begin += 1
        return begin

    def _is_initialised(self, at: int) -> bool:
        """Whether a token is a member in the initialisers of a constructor."""
        opening = self.bracket_at(at)
        body = self._bodies_by_opening.get(opening)
        return (
            body is not None
            and self.closed[opening] <= at < body.begin
            and text_at(self.tokens, at - 1) in (":", ",")
        )

    # ---- Values

    def _names_of(self, word: str) -> Named:
        scopes: dict[int, int] = {}
        owners: set[str] = set()
        declared: set[int] = set()
        places = self.token_places(word)
        for at in places:
            opening = self._declared_in(at)
            if opening is not None:
                declared.add(at)
                if self._is_local(opening):
                    scopes.setdefault(opening, at)
                else:
                    owners.add(next(filter(None, self.owners_at(at)), ""))
        if any(text_at(self.tokens, at - 1) == "define" for at in places):
            owners.add("")
        values: dict[int, list[Assigned]] = {}
        named = Named(scopes, frozenset(owners), values)
        for at in places:
            value = self._value_assigned(at, at in declared)
            if value is not None:
                values.setdefault(self.scope_at(at, named), []).append(value)
        return named

    def _value_assigned(self, at: int, is_declared: bool) -> Assigned | None:
        """Return the value that the name at a token gets there, or None if it gets none."""
        tokens = self.tokens
        before, after_name = text_at(tokens, at - 1), at + 1
        opening = self.bracket_at(at)
        parameter = self._parameters_read.get(tokens[at].offset)
        if parameter is not None:
            return Assigned(at, at, at, False, parameter)
        if before == "define":
            is_text = text_at(tokens, after_name).startswith('"')
            return Assigned(at, after_name, after_name + is_text, True)
        is_bound = text_at(tokens, opening) == "["
        if is_declared and (opening in self._header_scopes or is_bound):
            if self._header_scopes.get(opening, (0, _IN_PARAMETERS))[1] is _IN_PARAMETERS:
                # The arguments of all calls are values of a parameter.
                is_known = not is_bound and opening in self._bodies_by_opening
                return None if is_known else Assigned(at, at, at, False)
            if text_at(tokens, after_name) in (":", ")"):
                return Assigned(at, at, at, False)
        while text_at(tokens, after_name) == "[":
            after_name = self.closed[after_name]
        sign, after = text_at(tokens, after_name), text_at(tokens, after_name + 1)
        if sign == "=" and after != "=":
            # A declaration of a function may have defaults.
            if not is_declared and text_at(tokens, opening) == "(" and self.is_typed(at):
                return None
            end = self._end_of_value(after_name + 1)
            return Assigned(at, after_name + 1, end, is_declared or before == "::")
        is_made = is_declared or self._is_initialised(at)
        if is_made and sign in ("(", "{"):
            begin, end = after_name + 1, self.closed[after_name] - 1
            if end <= begin:
                return Assigned(at, begin, begin, True, function=tokens[at].text)
            return Assigned(at, begin, end if end < begin + _MOST_WORDS else begin, True)
        if sign in (".", "->") and after == "reset":
            end = self.closed.get(after_name + 2, 0) - 1
            return Assigned(at, after_name + 3, end, False) if end > after_name + 3 else None
        is_changed = sign == "." and after in _CHANGING
        is_streamed = before == ">" and text_at(tokens, at - 2) == ">" and not is_declared
        is_given = before == "&" and text_at(tokens, at - 2) in ("(", ",") and not is_declared
        if (sign == "+" and after == "=") or is_changed or is_streamed or is_given:
            return Assigned(at, at, at, False)
        is_argument = before in ("(", ",") and sign in (",", ")") and not is_declared
        if is_argument and text_at(tokens, opening) == "(" and opening not in self._header_scopes:
            return Assigned(at, at, at, False, function=text_at(tokens, opening - 1))
        return None

    def _end_of_value(self, begin: int) -> int:
        """Return the index after an expression; `begin` itself if it is too long."""
        end, last = begin, begin + _MOST_WORDS
        while end < len(self.tokens) and text_at(self.tokens, end) not in (";", ",", ")", "}"):
            end = self.closed.get(end, end + 1)
            if end > last:
                return begin
        return end
