"""Topics that programs in Python (rclpy and rospy) publish and subscribe to, by syntax trees.

From the function that starts a program the classes and functions that it names are followed,
also into other files of the workspace. A rate is that of the timer whose callback publishes.
"""

import ast
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import chain, islice
from typing import NamedTuple

from mars_asp.diagnostic import Span, point
from mars_asp.exchange.ros2.interface import (
    AT_RUN_TIME,
    FURTHER_NODES,
    NOT_FOLLOWED,
    OF_ACTION,
    SERVICES,
    Interface,
    InterfaceTopic,
    agreed,
    rate_of,
)
from mars_asp.exchange.ros2.python_files import (
    PythonFiles,
    SourceFile,
    argument_of,
    called_name,
    calls_of,
    column_at,
    defaults_of,
    dotted_name,
    mentioned_names,
    words_in,
)
from mars_asp.exchange.ros2.python_texts import NO_CODE, PythonTexts, parameter_of
from mars_asp.exchange.ros2.python_written import (
    alternatives,
    distinct,
    given_by,
    made_alike,
    parameters_of,
)
from mars_asp.exchange.unread import Unread

_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_DEFINITIONS = (*_FUNCTIONS, ast.ClassDef)
#: Modules of a package that are generated from its interfaces.
_GENERATED = frozenset({"msg", "srv", "action", "cfg"})
#: Through so many files a name is followed that each imports from the next.
_FARTHEST = 8
_MOST_TIMERS = 200
#: In place of the name of a node that only a run knows.
_ANY_NAME = "?"
_MOST_FOLLOWED = 100
_MOST_SHOWN = 60
#: How many calls of a class or function are looked into.
_MOST_CALLS = 5000
#: How many objects of a class are followed separately.
_MOST_MADE = 16
#: Calls that make services and actions: the position of the name, and its keyword.
_CALLS = {
    "create_service": (1, "srv_name"),
    "create_client": (1, "srv_name"),
    "ActionServer": (2, "action_name"),
    "ActionClient": (2, "action_name"),
    "Service": (0, "name"),
    "ServiceProxy": (0, "name"),
    "SimpleActionServer": (0, "name"),
    "SimpleActionClient": (0, "ns"),
}
#: Functions of rospy for parameters, which a launch file may rename.
_PARAMETERS = frozenset({"get_param", "get_param_cached", "set_param", "has_param", "delete_param"})


#: Functions that run as a program ends, and those that register others as such.
_ENDINGS = frozenset({"shutdown", "on_shutdown", "cleanup", "close", "destroy_node", "__del__"})
_REGISTERING = frozenset({"on_shutdown", "signal", "register"})


class _Found(NamedTuple):
    """A topic that a call creates; `keeper` is the variable with the result, if any."""

    topic: InterfaceTopic
    keeper: str | None
    published: bool


class PythonPrograms(PythonFiles):
    """Reads programs, each file once."""

    def interface(self, module: str, function: str | None) -> Interface | None:
        """Return the interface of a module whose program is `function`; None without module.

        Without a function, or if it is not found, the statements of the module are the program.
        """
        file = self.file(module)
        return None if file is None else _Program(self, file, function).interface()

    def defines(self, module: str, name: str) -> bool:
        """Whether a module has (or may have) a name at its outer level."""
        file = self.file(module)
        if file is None or file.stars:
            return True
        return name in file.outer or name in file.imports or name in file.constants


class _Program:
    """A program, with all classes and functions that are reached from its start."""

    def __init__(self, files: PythonFiles, file: SourceFile, function: str | None) -> None:
        self.files = files
        self.start = file, function
        self.reached: dict[tuple[str, int], tuple[SourceFile, ast.AST]] = {}
        #: Full names of functions and classes that should be in the workspace and were not found.
        self.missing: set[str] = set()

    def interface(self) -> Interface:
        """Return the topics that the program publishes and subscribes to."""
        file, function = self.start
        entry = None if function is None else file.outer.get(function)
        if entry is None:
            for statement in file.tree.body:
                if not isinstance(statement, _DEFINITIONS):
                    self.reach(file, statement)
        else:
            self.reach(file, entry)
        if not any(isinstance(node, ast.ClassDef) for _, node in self.reached.values()):
            # A program need not name its class of nodes: a loader may start that.
            for node in file.outer.values():
                self.reach(file, node)
        parts = [
            _Unit(self.files, of, node, given=given)
            for of, node in self.reached.values()
            for given in self.made_with(of, node)
        ]
        found = [each for part in parts for each in part.topics()]
        rates = {
            keeper: hz for part in parts for keeper, hz in part.rates().items() if hz is not None
        }
        published = (
            replace(each.topic, hz=rates.get(each.keeper or "")) for each in found if each.published
        )
        nodes = [each for part in parts if part.is_node() for each in part.node_names()]
        # A class that is not known as a node may pass a name to its base class.
        nodes = nodes or [each for part in parts for each in part.node_names()][:1]
        names = list(dict.fromkeys(each.name for each in nodes if each.name != _ANY_NAME))
        further = (each for each in nodes if names and each.name != names[0])
        place = point(file.path, 1, 1)
        missing = (Unread(NOT_FOLLOWED, name, place) for name in sorted(self.missing))
        return Interface(
            tuple(published),
            tuple(each.topic for each in found if not each.published),
            next(iter(names), None),
            unread=(*(note for part in parts for note in part.unread), *further, *missing),
            names=tuple(name for part in parts for name in part.names),
            unnamed=any(part.unnamed for part in parts),
            namespace=next((part.namespace for part in parts if part.namespace), ""),
        )

    def made_with(self, file: SourceFile, node: ast.AST) -> list[dict[str, ast.expr]]:
        """Return the possible arguments of a class by name, one entry for each distinct object."""
        if not isinstance(node, ast.ClassDef):
            return [{}]
        parameters = parameters_of(node)
        made = [defaults_of(parameters)]
        for of, part in islice(self.reached.values(), _MOST_FOLLOWED):
            if node.name not in self.files.once(words_in, part):
                continue
            unit = PythonTexts(self.files, of, NO_CODE)
            calls = [
                call
                for call in self.files.once(calls_of, part)
                if (found := self.target(of, dotted_name(call.func))) is not None
                and found[1] is node
            ]
            for either in alternatives(part, calls[:_MOST_MADE]):
                each = [{**made[0], **given_by(parameters, call, unit.text)} for call in either]
                made.append(made_alike(each))
        return distinct(made[1 : _MOST_MADE + 1] or made)

    def reach(self, file: SourceFile, node: ast.AST) -> None:
        """Add a function, class or statement, and all definitions that are reached from it."""
        waiting = [(file, node)]
        while waiting:
            of, part = waiting.pop()
            key = of.path, getattr(part, "lineno", 0)
            if key in self.reached:
                continue
            self.reached[key] = of, part
            targets = (self.target(of, name) for name in self.files.once(mentioned_names, part))
            # The stack returns the last item first; names are followed in their order in the text.
            waiting += reversed([target for target in targets if target is not None])

    def target(self, file: SourceFile, name: str) -> tuple[SourceFile, ast.AST] | None:
        """Return the definition that a name in a file refers to, with its file, or None."""
        first, *rest = name.split(".")
        if first in file.outer:
            return file, file.outer[first]
        if first in file.imports:
            return self.imported([*file.imports[first].split("."), *rest], first in file.relative)
        for base in file.stars:
            starred = self.files.file(base)
            if starred is not None and first in starred.outer:
                return starred, starred.outer[first]
        return None

    def imported(
        self, full: Sequence[str], is_relative: bool, depth: int = 0
    ) -> tuple[SourceFile, ast.AST] | None:
        """Return the definition of a full name, with its file, or None if not in the workspace.

        The name is noted if its module should be in the workspace and is not.
        """
        for size in range(len(full), 0, -1):
            found = self.files.file(".".join(full[:size]))
            if found is None:
                continue
            is_here = is_relative or size > 1 or found.path.endswith("__init__.py")
            if size == len(full):
                return None
            inner = full[size]
            if inner in found.outer:
                return found, found.outer[inner]
            if inner in found.imports and depth < _FARTHEST:
                origin = [*found.imports[inner].split("."), *full[size + 1 :]]
                return self.imported(origin, inner in found.relative, depth + 1)
            is_missing = found.path.endswith("__init__.py") and len(full) > size + 1
            if is_here and is_missing and inner not in _GENERATED | found.constants.keys():
                self.missing.add(".".join(full))
            return None
        if is_relative:
            self.missing.add(".".join(full))
        return None


class _Unit(PythonTexts):
    """A class or function of a program: the topics, timers and nodes that it makes."""

    def __init__(
        self,
        files: PythonFiles,
        file: SourceFile,
        node: ast.AST,
        given: Mapping[str, ast.expr] | None = None,
    ) -> None:
        super().__init__(files, file, node, given=given)
        self.unread: list[Unread] = []
        self.names: list[InterfaceTopic] = []
        self.unnamed = False
        #: The namespace that the program gives its node, after `node_names`.
        self.namespace = ""

    def location(self, node: ast.expr) -> Span:
        """Return the location of an expression."""
        line = node.lineno
        column = column_at(self.file.lines, line, node.col_offset)
        end = column + 1
        if node.end_lineno == line and node.end_col_offset is not None:
            end = column_at(self.file.lines, line, node.end_col_offset)
        return Span(self.file.path, line, column, line, end)

    def shown(self, node: ast.expr) -> str:
        """Return the source of an expression for messages, shortened."""
        span = self.location(node)
        line = self.file.lines[span.line - 1] if span.line <= len(self.file.lines) else ""
        return line[span.column - 1 : span.end_column - 1][:_MOST_SHOWN]

    def topics(self) -> Iterator[_Found]:
        """Yield the topics that calls make."""
        for call, keeper in self.calls[:_MOST_CALLS]:
            name = called_name(call)
            owner = dotted_name(call.func).rpartition(".")[0]
            match name:
                case "create_publisher" | "create_lifecycle_publisher":
                    yield from self.topic(call, keeper, 0, 1, True)
                case "create_subscription":
                    yield from self.topic(call, keeper, 0, 1, False)
                case "Publisher" if owner in ("rospy", ""):
                    yield from self.topic(call, keeper, 1, 0, True)
                case "Subscriber" if owner == "rospy":
                    yield from self.topic(call, keeper, 1, 0, False)
                case "Subscriber" if owner == "message_filters" or len(call.args) >= 2:
                    # With rclpy the node comes first, with rospy the topic.
                    first = call.args[0] if call.args else None
                    is_named = isinstance(first, ast.Constant)
                    yield from self.topic(call, keeper, 1, 0 if is_named else 2, False)
                case _ if name in _CALLS:
                    self.note(SERVICES, call, name)
                    self.further(call, *_CALLS[name])
                case _ if name in _PARAMETERS and owner == "rospy":
                    self.further(call, 0, None)

    def topic(
        self, call: ast.Call, keeper: str | None, type_at: int, name_at: int, published: bool
    ) -> Iterator[_Found]:
        """Yield the topics that a call creates, one for each name that it may have.

        `type_at` and `name_at` are positions of arguments, `keeper` the variable of the result.
        """
        kind = argument_of(call, type_at, "msg_type", "data_class")
        name = argument_of(call, name_at, "topic", "name")
        if name is None or kind is None:
            return
        switches = self.switches(call)
        if published and keeper:
            switches |= self.used_if(keeper)
        named_so: set[object] = set()
        for _ in self.rounds_of(call):
            for _ in self.choices():
                value = self.value(name, self.scope)
                parameter, text = parameter_of(value), self.text_of(value)
                parts = () if parameter else self.name_parts(value)
                key = parameter or parts or text
                if key in named_so:
                    continue
                named_so.add(key)
                if key is None:
                    self.note(AT_RUN_TIME, name, self.shown(name))
                    continue
                topic = InterfaceTopic(text or "", self.type(kind), self.location(name), parameter)
                last = published and self.is_last(keeper)
                topic = replace(topic, switches=tuple(sorted(switches)), parts=parts, last=last)
                yield _Found(topic, keeper, published)
            if self.has_more:
                self.note(AT_RUN_TIME, name, self.shown(name))

    def used_if(self, keeper: str) -> frozenset[tuple[str, bool]]:
        """Return the ROS parameters, with their values, on which all its publish calls depend."""
        calls = self.publications.get(keeper, [])
        used = [self.switches(call) for call in calls[:_MOST_FOLLOWED]]
        is_known = 0 < len(calls) <= _MOST_FOLLOWED
        return frozenset.intersection(*used) if is_known else frozenset()

    def is_last(self, keeper: str | None) -> bool:
        """Whether the publisher in the variable `keeper` is used only as the program ends."""
        name = (keeper or "").rpartition(".")[2]
        return name in self.files.once(_used_at_the_end, self.file.tree)

    @cached_property
    def publications(self) -> dict[str, list[ast.Call]]:
        """The publish calls, by the variable of the publisher."""
        found: dict[str, list[ast.Call]] = {}
        for call, _ in self.calls[:_MOST_CALLS]:
            if called_name(call) == "publish":
                keeper = dotted_name(call.func).rpartition(".")[0]
                found.setdefault(keeper, []).append(call)
        return found

    def further(self, call: ast.Call, name_at: int, keyword: str | None) -> None:
        """Collect the name (argument `name_at` or `keyword`) of a service, action or parameter."""
        name = argument_of(call, name_at, *([keyword] if keyword else ()))
        for _ in self.rounds_of(call):
            for _ in self.choices():
                value = None if name is None else self.value(name, self.scope)
                text, parameter = self.text_of(value), parameter_of(value)
                if text is not None:
                    ends = OF_ACTION if called_name(call).startswith("Simple") else ("",)
                    self.names += (
                        InterfaceTopic(text + end, None, None, parameter) for end in ends
                    )
                elif keyword is not None:
                    self.unnamed = True

    def note(self, sort: str, node: ast.expr, name: str) -> None:
        """Add an entry of this sort to `unread`, at an expression."""
        self.unread.append(Unread(sort, name, self.location(node)))

    def rates(self) -> Mapping[str, Fraction | None]:
        """Return the rate of each publisher's variable, None if two timers differ."""
        timers = islice(self.timers(), _MOST_TIMERS)
        return agreed((keeper, hz) for hz, used in timers for keeper in self.publishing(used))

    def timers(self) -> Iterator[tuple[Fraction, list[ast.AST]]]:
        """Yield the rate of each timer or `Rate`, with its callbacks or the functions around it."""
        for call, _ in self.calls[:_MOST_CALLS]:
            self.go_to(call)
            name = called_name(call)
            if name in ("create_timer", "Timer", "create_wall_timer"):
                period = argument_of(call, 0, "timer_period_sec")
                callback = argument_of(call, 1, "callback")
                seconds = None if period is None else self.number(period)
                if seconds and seconds > 0 and callback is not None:
                    hz = rate_of(seconds)
                    if hz is not None:
                        yield hz, self.functions(callback)
            elif name in ("Rate", "create_rate") and call.args:
                number = self.number(call.args[0])
                if number and number > 0:
                    yield number, [each for each in self.bodies if call in ast.walk(each)]

    @cached_property
    def bodies(self) -> tuple[ast.AST, ...]:
        """The functions in this part of the program, or the part itself if it has none."""
        return (*self.scopes.functions,) or (self.node,)

    def functions(self, callback: ast.expr) -> list[ast.AST]:
        """Return the definitions of a callback: a lambda, or functions of its name."""
        if isinstance(callback, ast.Lambda):
            return [callback]
        last = dotted_name(callback).rpartition(".")[2]
        return [each for each in self.bodies if getattr(each, "name", None) == last]

    def publishing(self, functions: Iterable[ast.AST]) -> Iterator[str]:
        """Yield the variables of publishers on which functions, or methods they call, publish."""
        waiting, seen = list(functions), set[int]()
        by_name = {getattr(each, "name", ""): each for each in self.bodies}
        while waiting and len(seen) < _MOST_FOLLOWED:
            function = waiting.pop()
            if id(function) not in seen:
                seen.add(id(function))
                keepers, called = self.files.once(_done_by, function)
                yield from keepers
                waiting += (by_name[name] for name in called if name in by_name)

    def is_node(self) -> bool:
        """Whether this is a class of nodes: the name of a base class ends with `Node`."""
        bases = self.node.bases if isinstance(self.node, ast.ClassDef) else []
        return any((self.type(base) or "").endswith("Node") for base in bases)

    def node_names(self) -> Iterator[Unread]:
        """Yield the names of nodes that the program creates, as entries of `unread`."""
        for call, _ in self.calls[:_MOST_CALLS]:
            self.go_to(call)
            name = called_name(call)
            is_super = isinstance(call.func, ast.Attribute) and (
                isinstance(call.func.value, ast.Call) and called_name(call.func.value) == "super"
            )
            is_init = dotted_name(call.func) == "Node.__init__"
            given = argument_of(call, 1 if is_init and len(call.args) > 1 else 0, "node_name")
            is_made = name in ("init_node", "create_node") or (
                name == "Node" and (self.type(call.func) or "").startswith("rclpy/")
            )
            if (name == "__init__" and is_super) or is_init or is_made:
                text = None if given is None else self.text(given)
                namespace = argument_of(call, len(call.args), "namespace")
                if namespace is not None and not self.namespace:
                    space = self.text(namespace)
                    self.namespace = space or ""
                    if space is None:
                        self.note(AT_RUN_TIME, namespace, "namespace")
                if given is not None and text != "":
                    yield Unread(FURTHER_NODES, text or _ANY_NAME, self.location(given))


def _done_by(function: ast.AST) -> tuple[frozenset[str], frozenset[str]]:
    """Return the variables on which a function publishes, and the methods of `self` it calls."""
    keepers, called = set[str](), set[str]()
    for each in ast.walk(function):
        if isinstance(each, ast.Call) and isinstance(each.func, ast.Attribute):
            owner = dotted_name(each.func.value)
            if each.func.attr == "publish" and owner:
                keepers.add(owner)
            elif owner == "self":
                called.add(each.func.attr)
    return frozenset(keepers), frozenset(called)


def _used_at_the_end(tree: ast.AST) -> frozenset[str]:
    """Return the names that only functions use that run as the program ends."""
    nodes = tuple(ast.walk(tree))
    calls = [node for node in nodes if isinstance(node, ast.Call)]
    given = (each for call in calls if called_name(call) in _REGISTERING for each in call.args)
    registered = {dotted_name(each).rpartition(".")[2] for each in given}
    names = _ENDINGS | (registered - {called_name(call) for call in calls})
    ending = (each for each in nodes if isinstance(each, _FUNCTIONS) and each.name in names)
    within = set(chain.from_iterable(map(ast.walk, ending)))
    used: dict[bool, set[str]] = {True: set(), False: set()}
    for node in nodes:
        if isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Load):
            used[node in within].add(node.id if isinstance(node, ast.Name) else node.attr)
    return frozenset(used[True] - used[False])
