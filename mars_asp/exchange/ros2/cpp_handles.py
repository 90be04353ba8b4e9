"""Handles through which C++ makes topics: node handles of ROS 1 and sub-nodes of ROS 2.

A handle puts a prefix before names: `~` if it is private to the node, else a namespace or nothing.
Handles are followed from their constructors through variables, members and arguments of functions.
"""

from collections.abc import Callable, Collection, Iterator, Sequence, Set
from typing import NamedTuple

from mars_asp.annotations.declarations.tokens import (
    SourceToken,
    angle,
    is_word,
    split,
    text_at,
)
from mars_asp.exchange.ros2.cpp_code import CppBody
from mars_asp.exchange.ros2.cpp_scopes import ScopedCode

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
_MOST_ROUNDS = 20
_MOST_PREFIXES = 4
_MOST_OVERLOADS = 16

#: A variable: the class or function that it belongs to, and its name.
_Key = tuple[str, str]
#: The text of an expression, or None if it is unknown.
Evaluate = Callable[[ScopedCode, Sequence[SourceToken]], str | None]


class _Source(NamedTuple):
    """A possible prefix of a handle: that of the variable `key` (or none), then `suffix`."""

    key: _Key | None
    suffix: str | None


class _Function(NamedTuple):
    """A function with handles as parameters: its identifier, and the names of its handles."""

    scope: str
    handles: tuple[str | None, ...]


class Handles:
    """The variables of a program that are node handles, with their possible prefixes."""

    def __init__(self, files: Sequence[ScopedCode], evaluate: Evaluate) -> None:
        """Follow the handles of all files; `evaluate` gives the text of an expression."""
        self._evaluate = evaluate
        self._prefixes: dict[_Key, list[str | None]] = {}
        self._locals: dict[str, set[str]] = {}
        self._members: dict[str, set[str]] = {}
        self._names: set[str] = set()
        self._edges: dict[_Key, list[tuple[_Key, str | None]]] = {}
        words = "NodeHandle", _SUB_NODE
        used = [file for file in files if any(word in file.text for word in words)]
        self.is_empty = not used
        if self.is_empty:
            return
        every = list(files)
        has_sub_nodes = any(_SUB_NODE in file.text for file in used)
        for file in every:
            self._declared(file, has_sub_nodes)
        functions = self._functions(every)
        for file in every:
            self._assigned(file)
            self._passed(file, functions)
        self._settle(
            {
                (function.scope, name)
                for same in functions.values()
                for function in same
                for name in function.handles
                if name is not None
            }
        )

    def prefixes(self, file: ScopedCode, begin: int, end: int) -> Sequence[str | None]:
        """Return the possible prefixes of the handle in a range of tokens; None is unknown."""
        if self.is_empty:
            return ("",)
        found: list[str | None] = []
        for source in self._handle_sources(file, begin, end):
            if source.key is None:
                found.append(source.suffix)
            else:
                found += (
                    prefixed_name(prefix, source.suffix)
                    for prefix in self._prefixes.get(source.key, ())
                )
        return list(dict.fromkeys(found)) or ("",)

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

    # ---- Names

    def _variable(self, file: ScopedCode, at: int, name: str) -> _Key:
        """Return the variable that `name` means at a token: a local one, else a member."""
        around = list(file.bodies_at(at))
        for body in around:
            scope = _scope_of(file, body)
            if name in self._locals.get(scope, ()):
                return scope, name
        classes = self._members.get(name, set())
        # Macros look like functions, so the outermost decides.
        owner = file.class_of(around[-1]) if around else file.class_at(at)
        if owner in classes:
            return owner, name
        return min(classes) if len(classes) == 1 else "", name

    def _declared(self, file: ScopedCode, has_sub_nodes: bool) -> None:
        """Collect the variables and members of a file that are handles."""
        tokens = file.tokens
        classes = _CLASSES | (_NODES if has_sub_nodes else frozenset())
        for at in file.places_of(classes | _GETTERS.keys() | {_SUB_NODE}):
            if tokens[at].text in classes:
                after = at + 1
                if text_at(tokens, after) == "::" and text_at(tokens, after + 1).endswith("Ptr"):
                    after += 2
                while text_at(tokens, after) in _BETWEEN:
                    after += 1
                name = text_at(tokens, after)
                if is_word(name):
                    self._declare(file, after, name)
            else:
                back = at - 1
                while back > at - 10 and text_at(tokens, back) not in ("=", ";", "{", "}", "("):
                    back -= 1
                name = text_at(tokens, back - 1)
                if text_at(tokens, back) == "=" and is_word(name):
                    if text_at(tokens, back - 2) in ("auto", "&", "*"):
                        self._declare(file, back - 1, name)
                    else:
                        self._names.add(name)

    def _declare(self, file: ScopedCode, at: int, name: str) -> None:
        self._names.add(name)
        body = next(file.bodies_at(at), None)
        if body is None:
            self._members.setdefault(name, set()).add(file.class_at(at))
        else:
            self._locals.setdefault(_scope_of(file, body), set()).add(name)

    def _functions(self, files: Sequence[ScopedCode]) -> dict[str, list[_Function]]:
        """Return the functions with handles as parameters, by name."""
        found: dict[str, list[_Function]] = {}
        for file in files:
            for body in file.bodies:
                scope = _scope_of(file, body)
                own = self._locals.get(scope, set())
                names = [_name_of(group) for group in split(body.parameters)]
                handles = tuple(name if name in own else None for name in names)
                if any(handles):
                    found.setdefault(body.name, []).append(_Function(scope, handles))
        return found

    # ---- Values

    def _assigned(self, file: ScopedCode) -> None:
        """Collect the values of handles in declarations, assignments and initialisers."""
        tokens = file.tokens
        for at in file.places_of(self._names):
            sign = text_at(tokens, at + 1)
            begin = at + 2
            if sign == "=" and text_at(tokens, at + 2) != "=":
                end = _end_of(file, begin)
            elif sign in ("(", "{"):
                end = min(file.closed[at + 1] - 1, at + _MOST_WORDS)
                if _is_defined(file, at + 1):
                    continue
            elif sign in (".", "->") and text_at(tokens, at + 2) == "reset":
                begin, end = at + 4, min(file.closed.get(at + 3, at + 4) - 1, at + _MOST_WORDS)
            else:
                continue
            is_init = sign in ("(", "{")
            key = self._variable(file, at, tokens[at].text)
            sources = (
                self._made(file, begin, end) if is_init else self._handle_sources(file, begin, end)
            )
            for source in sources:
                self._flow(source, key)

    def _passed(self, file: ScopedCode, functions: dict[str, list[_Function]]) -> None:
        """Collect the handles that are passed to parameters of functions and constructors."""
        if file.token_texts.isdisjoint(functions):
            return
        tokens = file.tokens
        objects: dict[str, str] = {}
        for at, token in enumerate(tokens):
            after = at + 1
            name = objects.get(token.text, token.text)
            if name not in functions or text_at(tokens, at - 1) in ("class", "struct"):
                continue
            if text_at(tokens, after) == "<":
                after = angle(tokens, after) or after
            while text_at(tokens, after) in (">", "&", "*"):
                after += 1
            if is_word(text_at(tokens, after)) and token.text == name:
                # `Class object(handle)`, or a member that a constructor initialises.
                objects[text_at(tokens, after)] = name
                after += 1
            if text_at(tokens, after) not in ("(", "{"):
                continue
            if _is_defined(file, after):
                continue
            arguments = list(_arguments(file, after))
            for function in functions[name][:_MOST_OVERLOADS]:
                if len(arguments) > len(function.handles):
                    continue
                for (begin, end), parameter in zip(arguments, function.handles, strict=False):
                    if parameter is not None:
                        for source in self._handle_sources(file, begin, end):
                            self._flow(source, (function.scope, parameter))

    def _handle_sources(self, file: ScopedCode, begin: int, end: int) -> Iterator[_Source]:
        """Yield the possible prefixes of the handle that an expression in a range returns."""
        tokens = file.tokens
        words = [token.text for token in tokens[begin : min(end, begin + _MOST_WORDS)]]
        getter = next((word for word in words if word in _GETTERS), None)
        made = next((i for i, word in enumerate(words) if word in _CLASSES), None)
        if _SUB_NODE in words:
            at = begin + words.index(_SUB_NODE)
            opening = at + 1
            parents = list(self._handle_sources(file, begin, at - 1)) or [_Source(None, "")]
            suffix = None
            for first, last in list(_arguments(file, opening))[:1]:
                suffix = self._evaluate(file, tokens[first:last])
            for parent in parents:
                yield _Source(parent.key, prefixed_name(parent.suffix, suffix))
        elif made is not None:
            opening = begin + made + 1
            while opening < end and text_at(tokens, opening) not in ("(", "{"):
                opening += 1
            if opening < end:
                yield from self._made(file, opening + 1, file.closed[opening] - 1)
        elif getter is not None:
            yield _Source(None, _GETTERS[getter])
        else:
            if words[-2:] == ["(", ")"]:
                words = words[:-2]
            names = [word for word in words if is_word(word)]
            if names and names[-1] in self._names:
                yield _Source(self._variable(file, begin, names[-1]), "")

    def _made(self, file: ScopedCode, begin: int, end: int) -> Iterator[_Source]:
        """Yield the possible prefixes of a handle constructed from the arguments in a range."""
        tokens = file.tokens
        groups = list(_arguments(file, begin - 1)) if begin < end else []
        if not groups:
            yield _Source(None, "")
            return
        parents = list(self._handle_sources(file, *groups[0]))
        first = None if parents else self._evaluate(file, tokens[slice(*groups[0])])
        if first is not None:
            yield _Source(None, first)
            return
        if not parents:
            yield _Source(None, None)
        suffix: str | None = ""
        if len(groups) > 1:
            suffix = self._evaluate(file, tokens[slice(*groups[1])])
        for parent in parents:
            yield _Source(parent.key, prefixed_name(parent.suffix, suffix))

    def _flow(self, source: _Source, key: _Key) -> None:
        if source.key is None:
            self._add(key, source.suffix)
        elif source.key != key:
            self._edges.setdefault(source.key, []).append((key, source.suffix))

    def _add(self, key: _Key, prefix: str | None) -> bool:
        known = self._prefixes.setdefault(key, [])
        if prefix in known or len(known) >= _MOST_PREFIXES:
            return False
        known.append(prefix)
        return True

    def _settle(self, parameters: Collection[_Key]) -> None:
        """Propagate prefixes between variables; a handle without any value has no prefix.

        A parameter without any value is unknown, as its call was not read.
        """
        self._spread()
        targets = {target for edges in self._edges.values() for target, _ in edges}
        for key in self._edges:
            if key not in targets and not self._prefixes.get(key):
                self._add(key, None if key in parameters else "")
        self._spread()

    def _spread(self) -> None:
        for _ in range(_MOST_ROUNDS):
            added = False
            for key, edges in self._edges.items():
                for prefix in tuple(self._prefixes.get(key, ())):
                    for target, suffix in edges:
                        added |= self._add(target, prefixed_name(prefix, suffix))
            if not added:
                return


def prefixed_name(prefix: str | None, name: str | None) -> str | None:
    """Return a name below a prefix, or None if either is unknown."""
    if prefix is None or name is None:
        return None
    if not prefix or name.startswith(("/", "~")):
        return name
    return f"{prefix}/{name}" if name else prefix


def _scope_of(file: ScopedCode, body: CppBody) -> str:
    return f"{file.source.path}:{body.opening}"


def _is_defined(file: ScopedCode, opening: int) -> bool:
    """Whether a bracket opens the parameters of a function definition."""
    body = next(file.bodies_at(opening + 1), None)
    return body is not None and body.opening == opening


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


def _name_of(parameter: Sequence[SourceToken]) -> str | None:
    """Return the name in the declaration of a parameter, or None without a name."""
    words = [token.text for token in parameter]
    if "=" in words:
        words = words[: words.index("=")]
    return words[-1] if len(words) > 1 and is_word(words[-1]) else None


def _end_of(file: ScopedCode, at: int) -> int:
    """Return the index after an expression: of the comma or closing bracket that ends it."""
    last = min(len(file.tokens), at + _MOST_WORDS)
    while at < last and text_at(file.tokens, at) not in (";", ",", ")", "}"):
        at = file.closed.get(at, at + 1)
    return min(at, last)


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
