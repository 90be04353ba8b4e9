"""Texts of expressions in C++, and the parameters that may give others.

A variable has a text only if all values that it gets in its scope agree.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cache, cached_property
from typing import NamedTuple, TypeAlias

from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    after_angle,
    before,
    closing,
    is_word,
    split,
    text_at,
)
from mars_asp.exchange.ros2.cpp_code import CppBody
from mars_asp.exchange.ros2.cpp_scopes import PARAMETERS, Assigned, ScopedCode

#: Methods that return the whole name of a topic.
RESOLVING = frozenset({"resolveName", "resolve_topic_name", "resolve_service_name"})
#: Limits of what is followed more than once; no program comes near them.
_MOST_WORDS = 50
_MOST_CHARACTERS = 1000
_MOST_VALUES = 200
_MOST_KEPT = 100_000
_DEEPEST = 50
#: Words and signs after the declaration of a function.
_AFTER_DECLARED = frozenset({";", "const", "override", "noexcept", "final", "="})
_OF_CALLS = frozenset({".", "->", "::", "<", ">", "(", ")"})


class CppText(NamedTuple):
    """The string value of an expression, None if unknown.

    `parameter` is the ROS parameter that may replace it, or None.
    """

    text: str | None
    parameter: str | None = None


_UNKNOWN = CppText(None)


class CppVariable(NamedTuple):
    """A variable by its file and scope if it is local, else by its class or namespace."""

    owner: str
    scope: int
    name: str


#: A value in a file.
_Place: TypeAlias = tuple[ScopedCode, Assigned]


class CppTexts:
    """Evaluates expressions of a program in C++ to strings."""

    def __init__(self, files: Sequence[ScopedCode]) -> None:
        """Set the files of the program, in which the values of names are looked up."""
        self._files = files
        self._values: dict[tuple[CppVariable, str], CppText] = {}
        self._defaults: dict[str, str | None] = {}
        self._shared_values = cache(self._find_shared)
        self._declaring = cache(self._find_declaring)
        self._open: set[tuple[CppVariable, str]] = set()
        #: The parameter whose default is evaluated.
        self._reading = ""

    def text_of(self, file: ScopedCode, tokens: Sequence[SourceToken]) -> CppText:
        """Return the string value of an expression, and the ROS parameter that it reads."""
        tokens = _unwrapped(tokens)
        words = [token.text for token in tokens[: _MOST_WORDS + 1]]
        strings = [file.string(token) for token in tokens if token.text.startswith('"')]
        if strings and len(strings) == len(tokens):
            # Literals in a row are one.
            return _limited("".join(each or "" for each in strings))
        if not words or len(words) > _MOST_WORDS:
            return _UNKNOWN
        groups = split(tokens, angles=False, sign="+") if "+" in words else ()
        if len(groups) > 1:
            parts = [self.text_of(file, group) for group in groups]
            is_known = all(part.text is not None and not part.parameter for part in parts)
            return _limited("".join(part.text or "" for part in parts) if is_known else None)
        if not PARAMETERS.isdisjoint(words):
            return self._value_of_parameter(file, tokens, words)
        resolved = resolved_name(tokens)
        if resolved is not None:
            value = self.text_of(file, resolved)
            return value if (value.text or "").startswith("/") else _UNKNOWN
        if len(words) == 1 and (words[0] in ("true", "false") or words[0][0].isdigit()):
            return CppText(words[0])
        is_member = words[:2] == ["this", "->"] or (len(words) == 3 and words[1] in (".", "->"))
        is_qualified = (
            len(words) % 2 and set(words[1::2]) <= {"::"} and all(map(is_word, words[::2]))
        )
        if is_word(words[-1]) and (is_member or is_qualified):
            return self._value_of_variable(file, file.index_of(tokens[-1]))
        return _UNKNOWN

    # ---- Parameters

    def _value_of_parameter(
        self, file: ScopedCode, tokens: Sequence[SourceToken], words: Sequence[str]
    ) -> CppText:
        """Return the default and name of the ROS parameter that an expression only reads."""
        at = next(at for at, word in enumerate(words) if word in PARAMETERS)
        opening = after_angle(tokens, at + 1) if text_at(tokens, at + 1) == "<" else at + 1
        if text_at(tokens, opening) != "(":
            return _UNKNOWN
        end = closing(tokens, opening)
        around = [*words[:at], *words[end:]]
        is_alone = all(word in _OF_CALLS or is_word(word) for word in around)
        if not is_alone or words[:at].count("(") != words[:at].count(")"):
            return _UNKNOWN
        name, others = file.parameter_in(words[at], split(tokens[opening + 1 : end - 1]))
        if name is None:
            return _UNKNOWN
        reads = words[at] in ("get_parameter", "getParam")
        text = None if reads else self._first_text(file, others)
        return CppText(self._parameter_default(name) if text is None else text, name)

    def _first_text(
        self, file: ScopedCode, expressions: Sequence[Sequence[SourceToken]]
    ) -> str | None:
        values = (self.text_of(file, each).text for each in expressions)
        return next((each for each in values if each is not None), None)

    def _parameter_default(self, name: str) -> str | None:
        """Return the default of a ROS parameter; None if unknown or if declarations differ."""
        if name not in self._defaults:
            self._defaults[name] = None
            reading, self._reading = self._reading, name
            texts = {
                self._first_text(file, [each])
                for file in self._files
                for each in file.parameter_defaults.get(name, ())[:_MOST_VALUES]
            } - {None}
            self._reading = reading
            self._defaults[name] = texts.pop() if len(texts) == 1 else None
        return self._defaults[name]

    # ---- Names

    def _value_of_variable(self, file: ScopedCode, at: int) -> CppText:
        """Return the value of the variable that a token names."""
        variables = self.variables_at(file, at)
        if len(variables) != 1:
            return _UNKNOWN
        [variable] = variables
        key = variable, self._reading
        if key not in self._values:
            is_deep = len(self._open) > _DEEPEST or len(self._values) > _MOST_KEPT
            if key in self._open or is_deep:
                return _UNKNOWN
            self._open.add(key)
            self._values[key] = _agreed_value(list(self._values_in_scope(file, variable)))
            self._open.discard(key)
        return self._values[key]

    def variables_at(self, file: ScopedCode, at: int) -> Sequence[CppVariable]:
        """Return the variables that a token may name: a local one, or those of several owners."""
        name = file.tokens[at].text
        scope = file.scope_at(at, file.declarations_of(name))
        if scope >= 0:
            return [CppVariable(file.source.path, scope, name)]
        return [CppVariable(owner, -1, name) for owner in self._owners_of(file, at, name)]

    def places_of(self, file: ScopedCode, variable: CppVariable) -> Sequence[_Place]:
        """Return the values that a variable gets in statements; `file` is that of a local one."""
        if variable.scope < 0:
            return self._shared_values(variable.name).get(variable.owner, [])
        values = file.declarations_of(variable.name).values
        return [(file, each) for each in values.get(variable.scope, ())]

    def _values_in_scope(
        self, file: ScopedCode, variable: CppVariable
    ) -> Iterator[tuple[CppText, bool]]:
        """Yield each value of a variable, with whether the variable is initialised with it."""
        if variable.scope >= 0:
            named = file.declarations_of(variable.name)
            body = file.parameter_of(variable.scope)
            if body is not None and named.scopes[variable.scope] < file.closed[variable.scope]:
                yield from self._values_passed(file, body, variable.name)
        places = self.places_of(file, variable)
        if len(places) > _MOST_VALUES:
            yield _UNKNOWN, False
            return
        for place, each in places:
            if each.parameter is not None:
                if each.parameter != self._reading:
                    yield CppText(self._parameter_default(each.parameter), each.parameter), False
            elif each.function and each.function not in self._writing:
                continue
            elif each.begin == each.end:
                yield _UNKNOWN, each.is_first
            else:
                yield self.text_of(place, place.tokens[each.begin : each.end]), each.is_first

    def _find_shared(self, name: str) -> Mapping[str, list[_Place]]:
        """Return the values of members and constants called `name`, by class or namespace."""
        found: dict[str, list[_Place]] = {}
        for file in self._files:
            for each in file.declarations_of(name).values.get(-1, ()):
                for owner in self._owners_of(file, each.at, name):
                    found.setdefault(owner, []).append((file, each))
        return found

    def _owners_of(self, file: ScopedCode, at: int, name: str) -> Collection[str]:
        """Return the class or namespace of a non-local name; several if its object is unknown.

        The class of an inherited member is the base class. A name that no file declares belongs to
        the class of the function.
        """
        declared = self._declaring(name)
        sign, owner = text_at(file.tokens, at - 1), text_at(file.tokens, at - 2)
        if sign == "::":
            return (owner,)
        if sign in (".", "->") and owner != "this":
            return declared & self._base_words.keys() or ("",)
        around = list(file.bodies_at(at))
        inner = file.class_at(at)
        own = file.class_of(around[-1]) if around else inner
        for each in (
            *self.with_base_classes(inner),
            *self.with_base_classes(own),
            *file.owners_at(at),
            "",
        ):
            if each in declared:
                return (each,)
        # Functions of no class may be in the place of methods.
        is_sure = len(declared) == 1 and (not own or declared.isdisjoint(self._base_words))
        return declared if is_sure else (own,)

    def _find_declaring(self, name: str) -> frozenset[str]:
        """Return the classes and namespaces that declare a name."""
        return frozenset().union(*(file.declarations_of(name).owners for file in self._files))

    @cached_property
    def _base_words(self) -> Mapping[str, Collection[str]]:
        """The words that name the base classes of each class."""
        found: dict[str, set[str]] = {}
        for file in self._files:
            for head in file.class_heads:
                found.setdefault(head.name, set()).update(head.bases)
        return found

    def with_base_classes(self, name: str) -> Sequence[str]:
        """Return a class and all its known base classes, nearest first."""
        found = [name] * bool(name)
        for each in found:
            others = sorted(self._base_words.get(each, ()))
            found += [base for base in others if base in self._base_words and base not in found]
            if len(found) > _MOST_WORDS:
                break
        return found

    # ---- Arguments

    @cached_property
    def _bodies_by_name(self) -> Mapping[str, Sequence[CppBody]]:
        found: dict[str, list[CppBody]] = {}
        for file in self._files:
            for body in file.bodies:
                found.setdefault(body.name, []).append(body)
        return found

    @cached_property
    def _writing(self) -> Collection[str]:
        """The functions with a `string &` parameter, to which they may write."""
        groups = (
            (body.name, {token.text for token in group})
            for same in self._bodies_by_name.values()
            for body in same
            for group in split(body.parameters)
        )
        return {name for name, words in groups if {"string", "&"} <= words and "const" not in words}

    def _values_passed(
        self, file: ScopedCode, body: CppBody, name: str
    ) -> Iterator[tuple[CppText, bool]]:
        """Yield the values that calls pass as parameter `name`, each with False: not initial."""
        groups = split(body.parameters)
        words = [[token.text for token in before(group, "=")] for group in groups]
        number = next((at for at, each in enumerate(words) if name in each[-1:]), None)
        places = [(f, at) for f in self._files for at in f.token_places(body.name)][
            : _MOST_VALUES + 1
        ]
        is_method = file.class_of(body) != body.name and len(self._bodies_by_name[body.name]) == 1
        if number is None or not is_method or len(places) > _MOST_VALUES:
            yield _UNKNOWN, False
            return
        defaults: list[tuple[ScopedCode, Sequence[SourceToken]]] = []
        given: list[tuple[ScopedCode, Sequence[SourceToken]]] = []
        is_left = False
        for place, at in places:
            opening = (
                after_angle(place.tokens, at + 1)
                if text_at(place.tokens, at + 1) == "<"
                else at + 1
            )
            end = place.closed.get(opening, 0)
            if text_at(place.tokens, opening) != "(" or end - opening > 4 * _MOST_WORDS:
                yield _UNKNOWN, False
                return
            arguments = split(place.tokens[opening + 1 : end - 1])
            argument: Sequence[SourceToken] = arguments[number] if number < len(arguments) else ()
            is_defined = place is file and opening == body.opening
            if is_defined or (place.is_typed(at) and text_at(place.tokens, end) in _AFTER_DECLARED):
                default = argument[len(before(argument, "=")) + 1 :]
                defaults += [(place, default)] * bool(default)
            elif argument:
                given.append((place, argument))
            else:
                is_left = True
        given += defaults * is_left
        for place, expression in given:
            yield self.text_of(place, expression), False
        if not given or (is_left and not defaults):
            yield _UNKNOWN, False


def resolved_name(tokens: Sequence[SourceToken]) -> Sequence[SourceToken] | None:
    """Return the argument of a call that resolves a topic name, or None for another expression."""
    at = len(tokens) - 4
    is_call = at > 0 and text_at(tokens, -1 + len(tokens)) == ")" and text_at(tokens, at + 1) == "("
    return tokens[at + 2 : -1] if is_call and tokens[at].text in RESOLVING else None


def _agreed_value(values: Sequence[tuple[CppText, bool]]) -> CppText:
    """Return the common value, unknown if values differ; a ROS parameter overrides others."""
    parameters = {value.parameter: value for value, _ in values if value.parameter}
    if len(parameters) == 1:
        is_known = all(v.text is not None or v.parameter or is_first for v, is_first in values)
        texts = {value.text for value, _ in values if value.parameter} - {None}
        [parameter] = parameters
        return (
            CppText(texts.pop() if len(texts) == 1 else None, parameter) if is_known else _UNKNOWN
        )
    distinct = {value for value, _ in values}
    return distinct.pop() if len(distinct) == 1 else _UNKNOWN


def _limited(text: str | None) -> CppText:
    return CppText(text if text is not None and len(text) <= _MOST_CHARACTERS else None)


def _unwrapped(tokens: Sequence[SourceToken]) -> Sequence[SourceToken]:
    """Return an expression without outer brackets, `std::string(...)` and `.c_str()`."""
    while len(tokens) <= _MOST_WORDS:
        words = [token.text for token in tokens]
        at = 2 if words[:2] in (["std", "::"], ["rclcpp", "::"]) else 0
        at += words[at : at + 1] in (["string"], ["string_view"], ["ParameterValue"])
        if words[-4:] in ([".", "c_str", "(", ")"], [".", "data", "(", ")"]):
            tokens = tokens[:-4]
        elif words[at : at + 1] in (["("], ["{"]) and closing(tokens, at) == len(tokens):
            tokens = tokens[at + 1 : -1]
        else:
            break
    return tokens
