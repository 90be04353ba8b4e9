"""Handles through which C++ makes topics: node handles of ROS 1 and sub-nodes of ROS 2.

A handle puts a prefix before names: `~` if it is private to the node, else a namespace or nothing.
Handles are followed from their constructors through variables, members and arguments of functions.
"""

from collections.abc import Collection, Iterator, Sequence, Set
from functools import cache
from itertools import islice
from typing import NamedTuple

from mars_asp.annotations.declarations.tokens import after_angle, before, is_word, text_at
from mars_asp.exchange.ros2.cpp_code import CppBody
from mars_asp.exchange.ros2.cpp_scopes import ScopedCode
from mars_asp.exchange.ros2.cpp_texts import CppTexts, CppVariable

#: Functions of nodelets that return handles, and the prefixes of these.
_GETTERS = {
    "getPrivateNodeHandle": "~",
    "getMTPrivateNodeHandle": "~",
    "getNodeHandle": "",
    "getMTNodeHandle": "",
}
#: Classes whose objects are handles; the last is made from another handle.
_CLASSES = frozenset({"NodeHandle", "NodeHandlePtr", "ImageTransport"})
_SUB_NODE = "create_sub_node"
#: Types of parameters that may take a sub-node.
_NODES = frozenset({"Node", "LifecycleNode"})
_MAKERS = frozenset({"make_shared", "make_unique"})
_NODELETS = frozenset({"Nodelet", "NodeletLazy"})
#: Classes of libraries that are given a node or its handle, and whose names are read or not topics.
_READ = frozenset({
    "NodeHandle", "ImageTransport", "SimpleActionServer", "SimpleActionClient", "ActionServer",
    "ActionClient", "Subscriber", "RealtimePublisher", "Buffer", "TransformListener",
    "TransformBroadcaster", "StaticTransformBroadcaster", "MessageFilter", "Updater",
    "CameraInfoManager", "Server", "CreateTimerROS", "CreateTimerInterface",
    # Functions that are given an object for other ends.
    "bind", "connect", "if", "switch", "while", "return", "dynamic_cast", "static_cast",
})  # fmt: skip
#: Classes of libraries that have topics of their own, whatever they are given.
_OWN_TOPICS = frozenset({
    "Costmap2DROS", "MoveGroupInterface", "MoveGroup", "MoveItCpp", "PlanningSceneMonitor",
    "PlanningSceneInterface", "ControllerManager", "RvizVisualTools", "MoveItVisualTools",
    "InteractiveMarkerServer",
})  # fmt: skip
_BETWEEN = frozenset({">", "&", "*", "&&", "const"})
#: What is after the name of an object that is declared, or at the end of the file.
_AFTER_OBJECT = frozenset({";", "(", "{", ")", "=", ""})
_MOST_WORDS = 50
_MOST_PREFIXES = 4
_MOST_FOLLOWED = 200


class _Source(NamedTuple):
    """A handle: the one that the token `at` of a file names, if any, with `suffix` added."""

    file: ScopedCode
    at: int | None
    suffix: str | None


class Handles:
    """The variables of a program that are node handles, with their possible prefixes."""

    def __init__(self, files: Sequence[ScopedCode], texts: CppTexts) -> None:
        """Take all files of a program, and the texts of its expressions."""
        self._files, self._texts = files, texts
        self._calls_of = cache(_calls_of)
        words = "NodeHandle", _SUB_NODE
        self.is_empty = not any(word in file.text for file in files for word in words)
        has_sub_nodes = any(_SUB_NODE in file.text for file in files)
        classes = _CLASSES | (_NODES if has_sub_nodes else frozenset())
        self._names: set[str] = set()
        for file in () if self.is_empty else files:
            self._names.update(_names_of_handles(file, classes))

    def prefixes(self, file: ScopedCode, begin: int, end: int) -> Sequence[str | None]:
        """Return the possible prefixes of the handle in a range of tokens; None is unknown."""
        if self.is_empty:
            return ("",)
        found: dict[str | None, None] = {}
        waiting = list(self._handle_sources(file, begin, end))
        direct, seen = len(waiting), set[tuple[CppVariable, str]]()
        for number, (place, at, suffix) in islice(enumerate(waiting), _MOST_FOLLOWED):
            variables = [] if at is None else self._texts.variables_at(place, at)
            if at is None or suffix is None:
                found[suffix] = None
            elif len(variables) == 1 and (variables[0], suffix) not in seen:
                seen.add((variables[0], suffix))
                body = place.parameter_of(variables[0].scope)
                sources = list(self._values_of(place, variables[0], body))
                if not sources:
                    # A parameter has one by a call that is not read, but mostly a public one.
                    is_public = body is None or number < direct
                    found[suffix if is_public else None] = None
                waiting += (
                    source._replace(suffix=prefixed_name(source.suffix, suffix))
                    for source in sources
                    # One that is made of itself has the prefix of its other values.
                    if source.at is None
                    or self._texts.variables_at(source.file, source.at) != variables
                )
            if len(found) == _MOST_PREFIXES:
                break
        return list(found) or ("",)

    def leave_topics_unread(self, files: Sequence[ScopedCode], called: Collection[str]) -> bool:
        """Whether the program may have topics that were not read.

        They are those of base classes, of unknown objects that get a node or handle, and of
        functions other than `called`.
        """
        if not all(_OWN_TOPICS.isdisjoint(file.token_texts) for file in files):
            return True
        bodies = {body.name for file in files for body in file.bodies}
        known = _READ | self._names | bodies
        # A node may have the topics of its base class, to which it passes its name.
        bases = {base for file in files for base in file.base_classes}
        if any(bases & file.given_texts - bodies - _NODES - _NODELETS for file in files):
            return True
        if any(
            known.union(called).isdisjoint(_callee_words(file, opening))
            for file in files
            for opening in _calls_with_nodes(file)
        ):
            return True
        if self.is_empty:
            return False
        for file in files:
            known |= set(_objects_of_classes(file, known))
        return any(
            known.isdisjoint(_callee_words(file, opening))
            for file in files
            for opening in self._calls_with_handles(file)
        )

    def _calls_with_handles(self, file: ScopedCode) -> Iterator[int]:
        """Yield the opening brackets of calls with a handle among the arguments."""
        tokens = file.tokens
        for at in file.places_of(self._names):
            opening = file.bracket_at(at)
            if (
                text_at(tokens, opening) in ("(", "{")
                and text_at(tokens, at - 1) in ("(", "{", ",", "*", "&")
                and text_at(tokens, at + 1) in (",", ")", "}")
                and not _is_defined(file, opening)
            ):
                yield opening

    # ---- Values

    def _values_of(
        self, file: ScopedCode, variable: CppVariable, body: CppBody | None
    ) -> Iterator[_Source]:
        """Yield the handles assigned to a variable, and those that calls pass to a parameter.

        `body` is that of the function of which the variable is a parameter, or None.
        """
        for place, value in self._texts.places_of(file, variable):
            before = text_at(place.tokens, value.begin - 2), text_at(place.tokens, value.begin - 1)
            if value.function == variable.name:
                yield _Source(place, None, "")
            if value.begin == value.end or _is_defined(place, value.begin - 1):
                continue
            is_made = before[1] in ("(", "{") and before[0] != "reset"
            read = self._made if is_made else self._handle_sources
            yield from read(place, value.begin, value.end)
        parameters = [] if body is None else [*_arguments(file, body.opening)]
        names = [_name_of(file, *group) for group in parameters]
        if body is not None and variable.name in names:
            number = names.index(variable.name)
            for place in self._files:
                for opening in self._calls_of(place, body.name):
                    arguments = list(_arguments(place, opening))
                    if number < len(arguments) <= len(names):
                        yield from self._handle_sources(place, *arguments[number])

    def _handle_sources(self, file: ScopedCode, begin: int, end: int) -> Iterator[_Source]:
        """Yield the possible prefixes of the handle that an expression in a range returns."""
        tokens = file.tokens
        words = [token.text for token in tokens[begin : min(end, begin + _MOST_WORDS)]]
        getter = next((word for word in words if word in _GETTERS), None)
        made = next((i for i, word in enumerate(words) if word in _CLASSES), None)
        if _SUB_NODE in words:
            at = begin + words.index(_SUB_NODE)
            opening = at + 1
            parents = list(self._handle_sources(file, begin, at - 1)) or [_Source(file, None, "")]
            suffix = None
            for first, last in list(_arguments(file, opening))[:1]:
                suffix = self._literal(file, first, last)
            yield from (p._replace(suffix=prefixed_name(p.suffix, suffix)) for p in parents)
        elif made is not None:
            opening = begin + made + 1
            while opening < end and text_at(tokens, opening) not in ("(", "{"):
                opening += 1
            if opening < end:
                yield from self._made(file, opening + 1, file.closed[opening] - 1)
        elif getter is not None:
            yield _Source(file, None, _GETTERS[getter])
        else:
            named = [begin + number for number, word in enumerate(words) if is_word(word)]
            if named and tokens[named[-1]].text in self._names:
                yield _Source(file, named[-1], "")

    def _made(self, file: ScopedCode, begin: int, end: int) -> Iterator[_Source]:
        """Yield the handles that a constructor makes from its arguments, which are given."""
        groups = list(_arguments(file, begin - 1)) if begin < end else []
        if not groups:
            yield _Source(file, None, "")
            return
        parents = list(self._handle_sources(file, *groups[0]))
        first = None if parents else self._literal(file, *groups[0])
        if first is not None:
            yield _Source(file, None, first)
            return
        if not parents:
            yield _Source(file, None, None)
        suffix = self._literal(file, *groups[1]) if len(groups) > 1 else ""
        yield from (p._replace(suffix=prefixed_name(p.suffix, suffix)) for p in parents)

    def _literal(self, file: ScopedCode, begin: int, end: int) -> str | None:
        """Return the text of an expression that reads no parameter, or None for others."""
        found = self._texts.text_of(file, file.tokens[begin:end])
        return found.text if found.parameter is None else None


def _names_of_handles(file: ScopedCode, classes: Set[str]) -> Iterator[str]:
    """Yield the names that are declared with a class of handles, or get what a function returns."""
    tokens = file.tokens
    for at in file.places_of(classes | _GETTERS.keys() | {_SUB_NODE}):
        if tokens[at].text in classes:
            after = at + 1
            if text_at(tokens, after) == "::" and text_at(tokens, after + 1).endswith("Ptr"):
                after += 2
            while text_at(tokens, after) in _BETWEEN:
                after += 1
            if is_word(text_at(tokens, after)):
                yield text_at(tokens, after)
        else:
            back = at - 1
            while back > at - 10 and text_at(tokens, back) not in ("=", ";", "{", "}", "("):
                back -= 1
            if text_at(tokens, back) == "=" and is_word(text_at(tokens, back - 1)):
                yield text_at(tokens, back - 1)


def _calls_of(file: ScopedCode, name: str) -> Sequence[int]:
    """Return the brackets of the calls of a function, or of the constructor of a class.

    Those are after `Class object` and after the object as a member that is initialised as well.
    """
    objects: set[str] = set()
    found: set[int] = set()
    for at in file.token_places(name):
        after = _after_type(file, at)
        if is_word(text_at(file.tokens, after)):
            objects.add(text_at(file.tokens, after))
            after += 1
        if text_at(file.tokens, at - 1) not in ("class", "struct"):
            found.add(after)
    found.update(_after_type(file, at) for at in file.token_places(*objects))
    is_opening = (text_at(file.tokens, each) in ("(", "{") for each in sorted(found))
    return [
        each
        for each, opens in zip(sorted(found), is_opening, strict=True)
        if opens and not _is_defined(file, each)
    ]


def _after_type(file: ScopedCode, at: int) -> int:
    """Return the index after the name of a type, its arguments and its signs."""
    after = after_angle(file.tokens, at + 1) if text_at(file.tokens, at + 1) == "<" else at + 1
    while text_at(file.tokens, after) in (">", "&", "*"):
        after += 1
    return after


def prefixed_name(prefix: str | None, name: str | None) -> str | None:
    """Return a name below a prefix, or None if either is unknown."""
    if prefix is None or name is None:
        return None
    if not prefix or name.startswith(("/", "~")):
        return name
    return f"{prefix}/{name}" if name else prefix


def _is_defined(file: ScopedCode, opening: int) -> bool:
    """Whether a bracket is that of a class, or of the parameters of a function, defined there."""
    return file.parameter_of(opening) is not None or opening in file.owner_brackets


def _calls_with_nodes(file: ScopedCode) -> Iterator[int]:
    """Yield the opening brackets of calls whose first argument is `this`."""
    tokens = file.tokens
    for at in file.token_places("this"):
        if text_at(tokens, at + 1) in (",", ")", "}"):
            opening = at - 2 if text_at(tokens, at - 1) == "*" else at - 1
            if text_at(tokens, opening) in ("(", "{") and opening in file.closed:
                yield opening


def _callee_words(file: ScopedCode, opening: int) -> set[str]:
    """Return the words before a call's bracket: the function, or the class and object."""
    begin, depth = opening, 0
    found: set[str] = set()
    types: set[str] = set()
    while begin > 0 and opening - begin < _MOST_WORDS:
        text = text_at(file.tokens, begin - 1)
        if text in (";", "{", "}", "(", ")", "=") or (text == "," and not depth):
            break
        depth += text.count(">") * (text != "->") - (text == "<")
        if is_word(text):
            (types if depth > 0 else found).add(text)
        begin -= 1
    # The types in angles are of messages, but for what makes objects.
    return (found | types) - _MAKERS if found & _MAKERS else found


def _objects_of_classes(file: ScopedCode, classes: Set[str]) -> Iterator[str]:
    """Yield the names of variables and members whose type is one of `classes`."""
    tokens = file.tokens
    for at in file.places_of(classes):
        end = at + 1
        while end < at + _MOST_WORDS and text_at(tokens, end) not in _AFTER_OBJECT:
            end += 1
        if is_word(text_at(tokens, end - 1)):
            yield tokens[end - 1].text


def _name_of(file: ScopedCode, begin: int, end: int) -> str | None:
    """Return the name of a parameter, which is before its default."""
    words = [token.text for token in before(file.tokens[begin:end], "=")]
    return words[-1] if len(words) > 1 and is_word(words[-1]) else None


def _arguments(file: ScopedCode, opening: int) -> Iterator[tuple[int, int]]:
    """Yield begin and end index of each argument of the call with an opening bracket."""
    end = min(file.closed.get(opening, opening + 1) - 1, opening + _MOST_WORDS * 4)
    begin = at = opening + 1
    while at < end:
        if file.tokens[at].text == ",":
            yield begin, at
            begin = at = at + 1
        else:
            at = file.closed.get(at, at + 1)
    if begin < end:
        yield begin, end


def handle_tokens(file: ScopedCode, at: int) -> tuple[int, int]:
    """Return the range of the expression on which the method at a token is called."""
    tokens = file.tokens
    if text_at(tokens, at - 1) not in (".", "->"):
        return at, at
    begin = end = at - 1
    while begin > 0:
        text = text_at(tokens, begin - 1)
        if text in (")", "]"):
            last = begin
            while begin > max(0, last - _MOST_WORDS) and file.closed.get(begin) != last:
                begin -= 1
        elif is_word(text) and text not in ("return", "new"):
            begin -= 1
            # Two words in a row are of two expressions.
            if text_at(tokens, begin - 1) not in (".", "->", "::"):
                break
        elif text in (".", "->", "::"):
            begin -= 1
        else:
            break
    return begin, end
