"""Launch files in Python as actions, by their syntax trees; nothing of them ever runs."""

import ast
import builtins
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from itertools import chain

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point, whole_file
from mars_asp.exchange.ros2.actions import (
    Action,
    Declare,
    IncludeAction,
    LaunchGroup,
    NodeParameter,
    PushNamespace,
    Readings,
    Remap,
    SetParameters,
    Start,
    Test,
    Tests,
    Text,
    plain,
    together,
)
from mars_asp.exchange.ros2.commands import of_command
from mars_asp.exchange.ros2.conditions import tests_of
from mars_asp.exchange.ros2.python_evaluate import (
    MOST_STEPS,
    Evaluator,
    LoopLeft,
    Refused,
    Returned,
)
from mars_asp.exchange.ros2.python_files import called_name, is_newer
from mars_asp.exchange.ros2.python_nodes import (
    forced,
    given_to,
    parameter_of,
    parameters_of,
    remaps_of,
)
from mars_asp.exchange.ros2.python_tests import branch_tests
from mars_asp.exchange.ros2.python_values import (
    Listed,
    Local,
    MappedValue,
    Plain,
    PythonCall,
    PythonFile,
    Rewritten,
    Value,
    items_of,
    text_from,
)
from mars_asp.exchange.unread import CONTAINERS, IMPORTED, Unread
from mars_asp.model.graph import OPEN_BRANCH, OPEN_CONDITION

_NODES = {
    "Node": False,
    "LifecycleNode": False,
    "ComposableNode": True,
    "ComposableLifecycleNode": True,
}
_CONTAINERS = frozenset({"ComposableNodeContainer", "LoadComposableNodes"})
#: Packages whose classes are read as actions, or start nothing.
_LAUNCH_PACKAGES = sys.stdlib_module_names | {
    *("launch", "launch_ros", "launch_testing", "launch_testing_ros", "tracetools_launch")
}
#: Classes of actions that hold no other action.
_SINGLE = frozenset({"DeclareLaunchArgument", "LogInfo", "SetEnvironmentVariable"})
#: Functions and errors with which code looks for names itself.
_LOOKING = frozenset({"globals", "locals", "vars", "exec", "eval", "NameError"})
#: The code of an error that a newer Python may not have.
NEWER = "newer-python"
_ENTRY = "generate_launch_description"
#: How often a file is read, each time by other branches of its conditions.
_MOST_READINGS = 64
#: To find an action counts as so many steps of evaluation.
_STEPS_OF_ACTION = 8


def read_python(text: str, path: str) -> tuple[Action, ...]:
    """Return the actions of a launch file in Python, which is not run.

    Raises:
        MarsError: the file is not Python.
    """
    try:
        tree = ast.parse(text)
    except SyntaxError as error:
        place = point(path, error.lineno or 1, error.offset or 1)
        message = f"this is not Python: {error.msg}"
        raise _launch_error(place, message, NEWER if is_newer(error) else "launch") from None
    except (ValueError, RecursionError, MemoryError):
        raise _launch_error(
            whole_file(path), "this Python is nested too deeply, or not text"
        ) from None
    reader = _LaunchReader(path, text)
    try:
        return reader.actions(tree)
    except RecursionError:
        raise _launch_error(whole_file(path), "this Python is nested too deeply") from None


def _launch_error(place: Span, message: str, code: str = "launch") -> MarsError:
    help_text = "is this a launch file? `ros2 launch` would also refuse it"
    return MarsError((Diagnostic(code, "error", message, place, help=help_text),))


def _root_name(node: ast.expr) -> str | None:
    """Return the first name of `a.b.c`, or None if it does not begin with a name."""
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None


class _LaunchReader(Evaluator):
    """Reads the actions that a launch file builds."""

    def actions(self, tree: ast.Module) -> tuple[Action, ...]:
        """Return the actions of the description that the launch file generates."""
        self.handling: set[ast.AST] = set()
        self.nodes = tuple(ast.walk(tree))
        self.imported: set[str] = set()
        modules: set[str] = set()
        for node in self.nodes:
            if isinstance(node, ast.ImportFrom):
                self.called.update((n.asname, n.name) for n in node.names if n.asname)
                if (node.module or "").partition(".")[0] not in _LAUNCH_PACKAGES:
                    self.imported.update(n.name for n in node.names)
            elif isinstance(node, ast.Import):
                roots = ((n.asname, n.name.partition(".")[0]) for n in node.names)
                modules |= {alias or root for alias, root in roots if root not in _LAUNCH_PACKAGES}
        calls = (node.func for node in self.nodes if isinstance(node, ast.Call))
        self.imported |= {
            each.attr
            for each in calls
            if isinstance(each, ast.Attribute) and _root_name(each) in modules
        }
        readings = tuple(self.readings(tree))
        found, *others = dict.fromkeys(actions for actions, _ in readings)
        if others:
            # What some branches declare is an argument of the file, whichever is taken.
            every = chain.from_iterable(actions for actions, _ in readings)
            declared = dict.fromkeys(each for each in every if isinstance(each, Declare))
            found = (*declared, Readings(readings))
        return (*found, *self.left_out(), *self.undefined(tree))

    def readings(self, tree: ast.Module) -> Iterator[tuple[tuple[Action, ...], Tests]]:
        """Yield alternative lists of actions, each with the tests of the branches it takes.

        Each branch of each condition occurs in some list; the other conditions stay as they were.
        """
        self.assigned = frozenset(
            node.id
            for node in self.nodes
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
        )
        waiting: list[dict[ast.AST, int]] = [{}]
        planned: set[tuple[ast.AST, int]] = set()
        found: list[tuple[tuple[Action, ...], Tests]] = []
        self.strict = True
        for _ in range(_MOST_READINGS):
            if not waiting or self.steps > MOST_STEPS:
                break
            with suppress(Refused):
                actions = self.reading(tree, waiting.pop(0))
                found.append((actions, tuple(self.taken())))
            before: dict[ast.AST, int] = {}
            for node, (choice, options) in self.decisions.items():
                planned.add((node, choice))
                others = [each for each in range(options) if (node, each) not in planned]
                planned.update((node, each) for each in others)
                waiting += ({**before, node: each} for each in others)
                before[node] = choice
        self.strict = False
        yield from found or ((self.reading(tree, {}), ()),)
        if waiting:
            place = point(self.path, 1, 1)
            yield (Unread("branches of conditions", str(len(waiting)), place),), ()

    def taken(self) -> Iterator[Test]:
        """Yield the tests of the branches that the present reading took."""
        for node, (choice, _) in self.decisions.items():
            if isinstance(node, ast.expr | ast.stmt):
                at = self.span(node)
                place = f"{at.path}:{at.line}:{at.column}"
                if node in self.tested:
                    name = f"{OPEN_CONDITION}{place}"
                    yield from branch_tests(self.tested[node], name, choice, at)
                else:
                    value = (str(choice + 1),)
                    yield Test((f"{OPEN_BRANCH}{place}",), value, True, at, branch=True)

    def reading(self, tree: ast.Module, forced: Mapping[ast.AST, int]) -> tuple[Action, ...]:
        """Return the actions if conditions take the branches in `forced`, by node, else the first.

        Raises:
            MarsError: the file has no description.
            Refused: these branches raise an exception.
        """
        self.forced, self.decisions, self.declarations = forced, {}, []
        self.tested = {}
        self.globals.clear()
        with suppress(Returned, LoopLeft):
            self.run(tree.body, self.globals)
        entry = self.globals.get(_ENTRY)
        if not isinstance(entry, Local):
            place = whole_file(self.path)
            raise _launch_error(place, f"the file has no function `{_ENTRY}` at its outer level")
        found = tuple(self.interpret(self.call_local(entry, (), {}), ()))
        return (*self.declarations, *found)

    def interpret(self, value: Value, tests: Tests) -> Iterator[Action]:
        """Yield the actions in a value: of a list, or of a call of a launch class."""
        self.steps += _STEPS_OF_ACTION
        if self.steps > 2 * MOST_STEPS:
            return
        match value:
            case Listed(items):
                for item in tuple(items):
                    yield from self.interpret(item, tests)
            case PythonCall(name) if name in _NODES or name in _CONTAINERS:
                yield from self.started(value, tests)
            case PythonCall():
                yield from self.action(value, tests)
            case _:
                return

    def action(self, call: PythonCall, tests: Tests) -> Iterator[Action]:
        """Yield the actions of a call of a launch class that starts no node itself."""
        if call.name in _SINGLE:
            return
        tests = (*tests, *tests_of(call.named.get("condition"), call.span))
        match call.name:
            case "LaunchDescription":
                yield from self.interpret(call.get("initial_entities", 0), tests)
            case "GroupAction":
                inner = tuple(self.interpret(call.get("actions", 0), tests))
                scoped = call.get("scoped")
                is_scoped = not (isinstance(scoped, Plain) and scoped.text == ("False",))
                settings = call.named.get("launch_configurations")
                yield LaunchGroup(
                    (*forced(settings, call.span), *inner),
                    scoped=is_scoped,
                    tests=tests,
                )
            case "PushRosNamespace" | "PushROSNamespace":
                yield PushNamespace(text_from(call.get("namespace", 0)), call.span)
            case "SetRemap":
                source, target = text_from(call.get("src", 0)), text_from(call.get("dst", 1))
                yield Remap(source, target, call.span)
            case "SetParameter":
                keys = ((call.get("name", 0), call.span),)
                yield SetParameters((), (parameter_of(keys, call.get("value", 1), call.span),))
            case "SetParametersFromFile":
                yield SetParameters((text_from(call.get("filename", 0)),), ())
            case "SetLaunchConfiguration":
                name = plain(text_from(call.get("name", 0)))
                if name is not None:
                    yield Declare(name, text_from(call.get("value", 1)), call.span, forced=True)
            case "IncludeLaunchDescription":
                described = call.get("launch_description_source", 0)
                if isinstance(described, PythonCall):
                    described = described.get("launch_file_path", 0)
                path = text_from(described)
                passed = tuple(parameters_of(call.get("launch_arguments", 1), call.span))
                yield IncludeAction(path, call.span, passed, tests)
            case "ExecuteProcess" | "ExecuteLocal":
                command = items_of(call.get("cmd", 0))
                yield of_command(tuple(map(text_from, command)), call.span, tests)
            case "OpaqueFunction":
                yield from self.opaque(call, tests)
            case "RosGzBridge" | "GzServer":
                yield self.of_gazebo(call, tests)
            case _:
                yield from self.handled(call, tests)

    def of_gazebo(self, call: PythonCall, tests: Tests) -> Action:
        """Return the simulator or bridge that an action of ros_gz starts."""
        if call.name == "GzServer":
            return Unread("programs of the simulator that a bridge joins", call.name, call.span)
        file = text_from(call.get("config_file", 1))
        return Start(
            call.span,
            ("ros_gz_bridge",),
            ("parameter_bridge",),
            name=text_from(call.get("bridge_name", 0)),
            parameters=(NodeParameter(((("config_file",), call.span),), file, call.span),),
            tests=tests,
        )

    def opaque(self, call: PythonCall, tests: Tests) -> Iterator[Action]:
        """Yield the actions that the function of an `OpaqueFunction` returns."""
        function = call.get("function", 0)
        if not isinstance(function, Local):
            yield Unread("functions that only a run calls", "OpaqueFunction", call.span)
            return
        named = call.get("kwargs")
        by_name = {
            plain(text_from(key)) or "": value
            for key, value in (named.pairs if isinstance(named, MappedValue) else ())
        }
        found = self.call_local(function, (None, *items_of(call.get("args"))), by_name)
        yield together(tuple(self.interpret(found, tests)), tests)

    def handled(self, call: PythonCall, tests: Tests) -> Iterator[Action]:
        """Yield the actions of timers and event handlers, which may start later."""
        is_imported = call.name in self.imported
        if is_imported:
            yield Unread(IMPORTED, call.name, call.span)
        held = [value for name, value in call.named.items() if name != "target_action"]
        for each in (*call.arguments, *held):
            # A handler may be a function that takes the event and the context, and that
            # handles the end of the process that it starts again.
            if is_imported and isinstance(each, PythonCall) and each.name in self.imported:
                continue  # a value that one imported function gives another
            if not isinstance(each, Local):
                yield from self.interpret(each, tests)
            elif each.of not in self.handling:
                self.handling.add(each.of)
                yield from self.interpret(self.call_local(each, (), {}), tests)
                self.handling.discard(each.of)

    def started(self, call: PythonCall, tests: Tests) -> Iterator[Action]:
        """Yield the node that a call starts, or the components in a container."""
        tests = (*tests, *tests_of(call.named.get("condition"), call.span))
        if call.name in _CONTAINERS:
            if call.name == "ComposableNodeContainer":
                called = plain(text_from(call.get("name"))) or "?"
                yield Unread(CONTAINERS, called, call.span)
            components = call.get("composable_node_descriptions")
            yield from self.interpret(components, tests)
            return
        self.launched.add((call.span.line, call.span.column))
        plugin = _NODES[call.name]
        executable = call.get("plugin" if plugin else "executable")
        if executable is None and not plugin:
            executable = call.get("node_executable")
        given = call.named.get("parameters")
        files, parameters = given_to(given, call.span)
        remaps, unread = remaps_of(call)
        name = call.named.get("name", call.named.get("node_name"))
        namespace = call.named.get("namespace", call.named.get("node_namespace"))
        yield Start(
            call.span,
            text_from(call.get("package")),
            text_from(executable),
            plugin,
            None if name is None and "name" not in call.named else text_from(name),
            None if namespace is None and "namespace" not in call.named else text_from(namespace),
            remaps,
            files,
            parameters,
            _arguments_of(call),
            tests,
            unread,
            any(isinstance(each, Rewritten | PythonFile) for each in items_of(given)),
        )

    def name_of(self, node: ast.Call) -> str:
        """Return the imported name of the function that a call calls."""
        return self.called.get(called_name(node), called_name(node))

    def left_out(self) -> Iterator[Unread]:
        """Yield the nodes that the file constructs but never launches."""
        for node in self.nodes:
            called = self.name_of(node) if isinstance(node, ast.Call) else ""
            if not isinstance(node, ast.Call) or called not in _NODES:
                continue
            span = self.span(node)
            if (span.line, span.column) not in self.launched:
                call = self.made.get(node) or PythonCall(called, *self.given(node, {}, 0), span)
                name = plain(text_from(call.get("plugin" if _NODES[called] else "executable")))
                yield Unread("nodes that are made but not launched", name or called, span)

    def undefined(self, tree: ast.Module) -> Iterator[Unread]:
        """Yield an error for each undefined name that launching would use."""
        bound = {*dir(builtins), "__file__"}
        used = [node for node in _launched_names(tree) if isinstance(node.ctx, ast.Load)]
        for node in self.nodes:
            match node:
                case (
                    ast.Name(id=name, ctx=ast.Store() | ast.Del())
                    | ast.arg(arg=name)
                    | ast.FunctionDef(name=name)
                    | ast.ClassDef(name=name)
                    | ast.ExceptHandler(name=str(name))
                    | ast.MatchAs(name=str(name))
                    | ast.MatchStar(name=str(name))
                    | ast.MatchMapping(rest=str(name))
                ):
                    bound.add(name)
                case ast.Import(names=names) | ast.ImportFrom(names=names):
                    bound.update((each.asname or each.name).partition(".")[0] for each in names)
        # Names may come from elsewhere, or be looked for in vain on purpose.
        if bound & {"*", "annotations"} or any(each.id in _LOOKING for each in used):
            return
        first = {each.id: each for each in reversed(used) if each.id not in bound}
        if first:
            *others, last = (f"`{each}`" for each in sorted(first))
            listed = f"{', '.join(others)} and {last} are" if others else f"{last} is"
            message = f"{self.path}: {listed} not defined"
            place = min(first.values(), key=lambda each: (each.lineno, each.col_offset))
            yield Unread("launch files with errors", message, self.span(place))


def _launched_names(tree: ast.Module) -> Iterator[ast.Name]:
    """Yield the names in code that launching runs, and in functions that it mentions."""
    functions: dict[str, ast.stmt] = {}
    waiting: list[ast.stmt] = []
    for each in tree.body:
        if isinstance(each, ast.FunctionDef) and each.name != _ENTRY:
            functions[each.name] = each
        elif not (isinstance(each, ast.If) and "__name__" in ast.dump(each.test)):
            waiting.append(each)
    found: list[tuple[int, list[ast.Name]]] = []
    while waiting:
        statement = waiting.pop()
        names = [node for node in ast.walk(statement) if isinstance(node, ast.Name)]
        found.append((statement.lineno, names))
        words = {node.id for node in names}
        waiting += [functions.pop(name) for name in words & functions.keys()]
    return chain.from_iterable(names for _, names in sorted(found, key=lambda each: each[0]))


def _arguments_of(call: PythonCall) -> tuple[Text, ...]:
    """Return a program's `arguments`, then `--ros-args` and its `ros_arguments` if it has any."""
    own, for_ros = (
        tuple(map(text_from, items_of(call.named.get(name))))
        for name in ("arguments", "ros_arguments")
    )
    return (*own, ("--ros-args",), *for_ros) if for_ros else own
