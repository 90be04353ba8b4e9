"""What programs in Python publish and hear, by their syntax trees: rclpy and rospy.

From the function that starts a program the classes and functions that it names are followed,
also into other files of the workspace. A rate is that of the timer whose callback publishes.
"""

import ast
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import islice
from typing import NamedTuple

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.interface import AT_RUN_TIME, Interface, Topic, rate_of
from mars_asp.exchange.ros2.python_written import (
    Loop,
    calls_in,
    constants_of,
    declared,
    defaults_of,
    distinct,
    given_by,
    rounds,
)
from mars_asp.exchange.unread import Unread

#: What opens a file of the workspace by the name of its module.
Find = Callable[[str], "tuple[str, str] | None"]
_MOST_FILES = 200
_MOST_TIMERS = 200
_MOST_FOLLOWED = 100
_MOST_SHOWN = 60
#: How many expressions are looked into for a name, and how many calls of a class or function.
_MOST_STEPS = 1000
_MOST_CALLS = 5000
_DEEPEST = 60
_MOST_TEXT = 1000
#: So many objects of a class are told apart.
_MOST_MADE = 16
#: Over so many files a constant is followed.
_FARTHEST = 8
#: Where texts have holes: those of `%`, and those of `format` that are plain.
_PERCENT, _BRACES = re.compile(r"%()[sd]"), re.compile(r"\{(\d{0,2})\}")
_HOLE = re.compile(r"[%{}]")
_CALLS = frozenset(
    {"create_service", "create_client", "ActionServer", "ActionClient", "Service", "ServiceProxy"}
    | {"SimpleActionServer", "SimpleActionClient"}
)


class _Found(NamedTuple):
    """A topic that a call makes, the name that keeps what it returns, and its direction."""

    topic: Topic
    keeper: str | None
    published: bool


@dataclass(slots=True)
class _File:
    """A file: its tree, what it imports and what stands at its outer level."""

    path: str
    lines: list[str]
    tree: ast.Module
    imports: dict[str, str] = field(default_factory=dict)
    outer: dict[str, ast.AST] = field(default_factory=dict)
    constants: dict[str, ast.expr] = field(default_factory=dict)


class PythonPrograms:
    """Reads programs, each file once."""

    def __init__(self, find: Find) -> None:
        """Take what finds the text and shown path of a module."""
        self._find = find
        self._files: dict[str, _File | None] = {}

    def interface(self, module: str, function: str | None) -> Interface | None:
        """Return what a function of a module, or else the module as a program, does.

        `None` where the module is not found or not Python.
        """
        file = self._file(module)
        if file is None:
            return None
        return _Program(self, file, function).interface()

    def _file(self, module: str) -> _File | None:
        if module not in self._files and len(self._files) < _MOST_FILES:
            found = self._find(module)
            self._files[module] = None if found is None else _parsed(*found, module)
        return self._files.get(module)


def _parsed(text: str, path: str, module: str) -> _File | None:
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    file = _File(path, text.split("\n"), tree)
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                for name in names:
                    # `import a.b` binds `a`.
                    bound = name.asname or name.name.partition(".")[0]
                    file.imports[bound] = name.name if name.asname else bound
            case ast.ImportFrom(module=origin, names=names, level=level):
                above = module.split(".")[: -level or None] if level else []
                base = ".".join((*above, *filter(None, (origin,))))
                file.imports.update((n.asname or n.name, f"{base}.{n.name}") for n in names)
    for statement in _flat(tree.body):
        match statement:
            case ast.FunctionDef(name=defined) | ast.ClassDef(name=defined):
                file.outer[defined] = statement
            case ast.Assign(targets=[ast.Name(id=assigned)], value=value):
                file.constants.setdefault(assigned, value)
    return file


def _flat(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield the statements of a module, those in its conditions among them."""
    for statement in body:
        yield statement
        if isinstance(statement, ast.If | ast.Try | ast.With | ast.For | ast.While):
            yield from _flat(s for s in ast.iter_child_nodes(statement) if isinstance(s, ast.stmt))


class _Program:
    """Follows a program from where it starts, and collects what it does."""

    def __init__(self, programs: PythonPrograms, file: _File, function: str | None) -> None:
        self.programs = programs
        self.start = file, function
        self.reached: dict[tuple[str, int], tuple[_File, ast.AST]] = {}
        self.mentioned: dict[tuple[str, int], frozenset[str]] = {}

    def interface(self) -> Interface:
        """Return what the program publishes and hears."""
        file, function = self.start
        entry = None if function is None else file.outer.get(function)
        if entry is None:
            for statement in file.tree.body:
                if not isinstance(statement, ast.FunctionDef | ast.ClassDef):
                    self.reach(file, statement)
        else:
            self.reach(file, entry)
        if not any(isinstance(node, ast.ClassDef) for _, node in self.reached.values()):
            # What starts a program need not name it: a loader may.
            for node in file.outer.values():
                self.reach(file, node)
        parts = [
            _Unit(self.programs, of, node, given=given)
            for of, node in self.reached.values()
            for given in self.made_with(of, node)
        ]
        found = [each for part in parts for each in part.topics()]
        rates = {
            keeper: hz for part in parts for keeper, hz in part.rates().items() if hz is not None
        }
        published = (
            _at_rate(each.topic, rates.get(each.keeper or "")) for each in found if each.published
        )
        nodes = [each for part in parts if part.is_node() for each in part.node_names()]
        # Other classes, too, hand a name to the class that they are made from.
        nodes = nodes or [each for part in parts for each in part.node_names()][:1]
        names = list(dict.fromkeys(each.name for each in nodes))
        further = (each for each in nodes if each.name != names[0])
        return Interface(
            tuple(published),
            tuple(each.topic for each in found if not each.published),
            next(iter(names), None),
            unread=(*(note for part in parts for note in part.unread), *further),
        )

    def made_with(self, file: _File, node: ast.AST) -> list[dict[str, ast.expr]]:
        """Return what the parameters of a class stand for, in each object that is made of it."""
        if not isinstance(node, ast.ClassDef):
            return [{}]
        made = [defaults_of(node)]
        for of, part in islice(self.reached.values(), _MOST_FOLLOWED):
            for call in ast.walk(part) if self.mentions(of, part, node.name) else ():
                if isinstance(call, ast.Call) and len(made) <= _MOST_MADE:
                    found = self.target(of, _dotted(call.func))
                    if found is not None and found[1] is node:
                        unit = _Unit(self.programs, of, ast.Module([], []))
                        made.append({**made[0], **given_by(node, call, unit.text)})
        return distinct(made[1:] or made)

    def mentions(self, file: _File, part: ast.AST, name: str) -> bool:
        """Whether a part of a program names something."""
        key = file.path, getattr(part, "lineno", 0)
        if key not in self.mentioned:
            words = {word for each in _mentioned(part) for word in each.split(".")}
            self.mentioned[key] = frozenset(words)
        return name in self.mentioned[key]

    def reach(self, file: _File, node: ast.AST) -> None:
        """Take up a part of a program and what it names."""
        waiting = [(file, node)]
        while waiting:
            of, part = waiting.pop()
            key = of.path, getattr(part, "lineno", 0)
            if key in self.reached:
                continue
            self.reached[key] = of, part
            targets = (self.target(of, name) for name in _mentioned(part))
            # What is named first is followed first.
            waiting += reversed([target for target in targets if target is not None])

    def target(self, file: _File, name: str) -> tuple[_File, ast.AST] | None:
        """Return the function or class of the workspace that a name stands for."""
        first, _, rest = name.partition(".")
        if first in file.outer:
            return file, file.outer[first]
        if first in file.imports:
            full = f"{file.imports[first]}.{rest}" if rest else file.imports[first]
            module, _, last = full.rpartition(".")
            found = self.programs._file(module) if module else None
            if found is not None and last in found.outer:
                return found, found.outer[last]
        return None


def _at_rate(topic: Topic, hz: Fraction | None) -> Topic:
    return Topic(topic.name, topic.type, topic.span, topic.parameter, hz)


def _mentioned(part: ast.AST) -> Iterator[str]:
    """Yield the names, dotted ones whole, that a part of a program mentions."""
    for node in ast.walk(part):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.Attribute):
            dotted = _dotted(node)
            if dotted:
                yield dotted


def _dotted(node: ast.expr) -> str:
    names: list[str] = []
    while isinstance(node, ast.Attribute):
        names.append(node.attr)
        node = node.value
    return ".".join((node.id, *reversed(names))) if isinstance(node, ast.Name) else ""


class _Unit:
    """A class or function of a program, with the names that hold within it."""

    def __init__(
        self,
        programs: PythonPrograms,
        file: _File,
        node: ast.AST,
        far: int = 0,
        given: Mapping[str, ast.expr] | None = None,
    ) -> None:
        self.programs = programs
        self.far = far
        self.file = file
        self.node = node
        self.unread: list[Unread] = []
        self.steps = 0
        self._done: dict[int, tuple[frozenset[str], frozenset[str]]] = {}
        self.values: dict[str, ast.expr] = {**file.constants, **(given or {})}
        # What stands in the class itself is an attribute of each object.
        self.values |= {f"self.{name}": value for name, value in constants_of(node)}
        self.parameters: dict[str, ast.expr] = {}
        self.calls: list[tuple[ast.Call, str | None]] = []
        for each in ast.walk(node):
            match each:
                case ast.Assign(targets=[target], value=value):
                    name = _keeper(target)
                    if name:
                        self.values[name] = value
                    if isinstance(value, ast.Call):
                        self.calls.append((value, name))
                case ast.AnnAssign(target=target, value=ast.expr() as value):
                    name = _keeper(target)
                    if name:
                        self.values[name] = value
                    if isinstance(value, ast.Call):
                        self.calls.append((value, name))
        known = {id(call) for call, _ in self.calls}
        self.loops: dict[int, tuple[Loop, ...]] = {}
        for each, loops in calls_in(node):
            if id(each) not in known:
                self.calls.append((each, None))
            if loops:
                self.loops[id(each)] = loops
            for stated, default in declared(each, _called(each)):
                name = self.text(stated)
                if name is not None:
                    self.parameters[name] = default
        self.calls.sort(key=lambda pair: (pair[0].lineno, pair[0].col_offset))

    def span(self, node: ast.expr) -> Span:
        """Return where a topic is named."""
        line = node.lineno
        text = self.file.lines[line - 1] if line <= len(self.file.lines) else ""
        column = len(text.encode()[: node.col_offset].decode(errors="ignore")) + 1
        end = column + 1
        if node.end_lineno == line and node.end_col_offset is not None:
            end = len(text.encode()[: node.end_col_offset].decode(errors="ignore")) + 1
        return Span(self.file.path, line, column, line, end)

    def shown(self, node: ast.expr) -> str:
        """Return an expression as it is written, of a long one its beginning."""
        span = self.span(node)
        line = self.file.lines[span.line - 1] if span.line <= len(self.file.lines) else ""
        return line[span.column - 1 : span.end_column - 1][:_MOST_SHOWN]

    def topics(self) -> Iterator[_Found]:
        """Yield the topics that calls make."""
        for call, keeper in self.calls[:_MOST_CALLS]:
            self.steps = 0
            name = _called(call)
            owner = _dotted(call.func).rpartition(".")[0]
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
                    self.note("services and actions", call, name)

    def topic(
        self, call: ast.Call, keeper: str | None, type_at: int, name_at: int, published: bool
    ) -> Iterator[_Found]:
        """Yield the topic that a call makes, if its name is written somewhere."""
        named = {k.arg: k.value for k in call.keywords if k.arg}
        kind = named.get("msg_type") or named.get("data_class")
        name = named.get("topic") or named.get("name")
        if kind is None and type_at < len(call.args):
            kind = call.args[type_at]
        if name is None and name_at < len(call.args):
            name = call.args[name_at]
        if name is None or kind is None:
            return
        before = self.values
        named_so: set[str] = set()
        for bound in rounds(self.loops.get(id(call), ()), self.gone_over):
            self.values = {**before, **bound}
            self.steps = 0
            parameter = self.parameter(name)
            text = self.text(name)
            if text is None and parameter is None:
                self.note(AT_RUN_TIME, name, self.shown(name))
                break
            if (parameter or text or "") not in named_so:
                named_so.add(parameter or text or "")
                topic = Topic(text or "", self.type(kind), self.span(name), parameter)
                yield _Found(topic, keeper, published)
        self.values = before

    def note(self, sort: str, node: ast.expr, name: str) -> None:
        """Note something that is not read."""
        self.unread.append(Unread(sort, name, self.span(node)))

    def type(self, node: ast.expr) -> str | None:
        """Return the message type that an expression names."""
        dotted = _dotted(node)
        first, _, rest = dotted.partition(".")
        if not dotted:
            return None
        full = self.file.imports.get(first, first) + (f".{rest}" if rest else "")
        return full.replace(".", "/")

    def parameter(self, node: ast.expr, depth: int = 0) -> str | None:
        """Return the parameter whose value an expression is."""
        self.steps += 1
        if depth > _DEEPEST or self.steps > _MOST_STEPS:
            return None
        match node:
            case ast.Attribute(value=inner, attr="value" | "string_value"):
                return self.parameter(inner, depth + 1)
            case ast.Call() if _called(node) in ("get_parameter_value", "as_string", "str"):
                if isinstance(node.func, ast.Attribute):
                    return self.parameter(node.func.value, depth + 1)
                return self.parameter(node.args[0], depth + 1) if node.args else None
            case ast.Call() if _called(node) in (
                "get_parameter",
                "declare_parameter",
                "get_param",
                "get_parameter_or",
            ):
                name = self.text(node.args[0]) if node.args else None
                if name is not None and len(node.args) > 1:
                    self.parameters.setdefault(name, node.args[1])
                return None if name is None else name.lstrip("~")
            case ast.Name() | ast.Attribute():
                held = self.values.get(_keeper(node) or "")
                return None if held is None else self.parameter(held, depth + 1)
            case _:
                return None

    def written(self, node: ast.expr) -> ast.expr | None:
        """Return what a name stands for in this part of the program."""
        name = _keeper(node) or ""
        if name.startswith("cls."):
            name = f"self.{name[4:]}"
        return self.values.get(name)

    def constant(self, node: ast.expr) -> tuple[_File, ast.expr] | None:
        """Return what a constant of another class or file is, and the file of the workspace."""
        names = (_keeper(node) or "").removesuffix(".value").split(".")
        full = [*self.file.imports.get(names[0], names[0]).split("."), *names[1:]]
        for file, inner in (
            (self.file, names),
            (self.programs._file(".".join(full[:-1])), full[-1:]),
            (self.programs._file(".".join(full[:-2])), full[-2:]),
        ):
            if file is not None and 1 <= len(inner) <= 2:
                of_class = dict(constants_of(file.outer.get(inner[0])))
                held = of_class.get(inner[1]) if inner[1:] else file.constants.get(inner[0])
                if held is not None:
                    return file, held
        return None

    def imported(self, node: ast.expr) -> str | None:
        """Return the text of a constant of another class or file."""
        found = self.constant(node) if self.far < _FARTHEST else None
        if found is None:
            return None
        file, held = found
        return _Unit(self.programs, file, ast.Module([], []), self.far + 1).text(held)

    def gone_over(self, node: ast.expr) -> ast.expr | None:
        """Return what a loop over a name goes over."""
        held = self.written(node)
        found = self.constant(node) if held is None else None
        return held if found is None else found[1]

    def text(self, node: ast.expr, depth: int = 0) -> str | None:
        """Return the text that an expression is, if it is written somewhere."""
        self.steps += 1
        if depth > _DEEPEST or self.steps > _MOST_STEPS:
            return None
        match node:
            case ast.Constant(value=str() as value):
                return value
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                first, second = self.text(left, depth + 1), self.text(right, depth + 1)
                return None if first is None or second is None else first + second
            case ast.BinOp(left=left, op=ast.Mod(), right=right):
                given = right.elts if isinstance(right, ast.Tuple) else [right]
                return self.filled(_PERCENT, left, given, depth)
            case ast.JoinedStr(values=values):
                parts = [
                    self.part(v.value if isinstance(v, ast.FormattedValue) else v, depth + 1)
                    for v in values
                    if not isinstance(v, ast.FormattedValue) or v.format_spec is None
                ]
                known = None not in parts and len(parts) == len(values)
                return "".join(filter(None, parts)) if known else None
            case ast.Call(func=ast.Name(id="str"), args=[inner]) if not self.parameter(node):
                return self.part(inner, depth + 1)
            case ast.Call(func=ast.Attribute(value=form, attr="format"), args=given, keywords=[]):
                return self.filled(_BRACES, form, given, depth)
            case ast.Call(
                func=ast.Attribute(value=ast.Constant(value=str() as between), attr="join"),
                args=[ast.List(elts=given) | ast.Tuple(elts=given)],
            ):
                parts = [self.part(each, depth + 1) for each in given]
                return None if None in parts else between.join(filter(None, parts))
            case ast.Name() | ast.Attribute():
                parameter = self.parameter(node)
                if parameter is not None:
                    default = self.parameters.get(parameter, self.parameters.get(f"~{parameter}"))
                    return None if default is None else self.text(default, depth + 1)
                held = self.written(node)
                return self.imported(node) if held is None else self.text(held, depth + 1)
            case ast.Call():
                parameter = self.parameter(node)
                default = self.parameters.get(parameter or "")
                if default is None and parameter is not None:
                    default = self.parameters.get(f"~{parameter}")
                return None if default is None else self.text(default, depth + 1)
            case _:
                return None

    def part(self, node: ast.expr, depth: int) -> str | None:
        """Return what an expression, a text or a whole number, is within a text."""
        if isinstance(node, ast.Name | ast.Attribute):
            node = self.written(node) or node
        match node:
            case ast.Constant(value=bool()):
                return None
            case ast.Constant(value=int() as value) if abs(value) < _MOST_TEXT:
                return str(value)
            case _:
                return self.text(node, depth)

    def filled(
        self, holes: re.Pattern[str], form: ast.expr, given: Sequence[ast.expr], depth: int
    ) -> str | None:
        """Return a text with its holes filled, each by its number or else in order."""
        text = self.text(form, depth + 1)
        parts = [self.part(each, depth + 1) for each in given]
        if text is None or None in parts:
            return None
        order = iter(range(len(parts)))
        pieces = holes.split(text)
        for at in range(1, len(pieces), 2):
            number = int(pieces[at]) if pieces[at] else next(order, len(parts))
            if number >= len(parts):
                return None
            pieces[at] = parts[number] or ""
        filled = "".join(pieces)
        return filled if len(filled) < _MOST_TEXT and not _HOLE.search(filled) else None

    def number(self, node: ast.expr, depth: int = 0) -> Fraction | None:
        """Return the number that an expression is, if it is written somewhere."""
        self.steps += 1
        if depth > _DEEPEST or self.steps > _MOST_STEPS:
            return None
        match node:
            case ast.Constant(value=bool()):
                return None
            case ast.Constant(value=int() | float() as value):
                text = repr(value)
                return Fraction(text) if text not in ("inf", "nan") else None
            case ast.BinOp(left=left, op=ast.Div() | ast.Mult() as sign, right=right):
                first, second = self.number(left, depth + 1), self.number(right, depth + 1)
                if first is None or second is None:
                    return None
                if isinstance(sign, ast.Mult):
                    return first * second
                return first / second if second else None
            case ast.Name() | ast.Attribute():
                held = self.values.get(_keeper(node) or "")
                return None if held is None else self.number(held, depth + 1)
            case ast.Call() if _called(node) in ("Duration", "float", "from_sec") and node.args:
                return self.number(node.args[0], depth + 1)
            case ast.Call(keywords=[ast.keyword(arg="seconds", value=value)]):
                return self.number(value, depth + 1)
            case _:
                return None

    def rates(self) -> Mapping[str, Fraction | None]:
        """Return how often each publisher publishes: `None` where two timers differ."""
        found: dict[str, Fraction | None] = {}
        for hz, functions in islice(self.timers(), _MOST_TIMERS):
            for keeper in self.publishing(functions):
                found[keeper] = hz if found.get(keeper, hz) == hz else None
        return found

    def timers(self) -> Iterator[tuple[Fraction, list[ast.AST]]]:
        """Yield the rate of each timer, and what it calls."""
        for call, _ in self.calls[:_MOST_CALLS]:
            self.steps = 0
            name = _called(call)
            named = {k.arg: k.value for k in call.keywords if k.arg}
            if name in ("create_timer", "Timer", "create_wall_timer"):
                period = named.get("timer_period_sec") or (call.args[0] if call.args else None)
                callback = named.get("callback") or (call.args[1] if len(call.args) > 1 else None)
                seconds = None if period is None else self.number(period)
                if seconds and seconds > 0 and callback is not None:
                    hz = rate_of(seconds)
                    if hz is not None:
                        yield hz, self.functions(callback)
            elif name in ("Rate", "create_rate") and call.args:
                number = self.number(call.args[0])
                if number and number > 0:
                    yield number, [each for each in self.bodies if _encloses(each, call)]

    @cached_property
    def bodies(self) -> tuple[ast.AST, ...]:
        """The functions in this part of the program, or all of it."""
        every = list(ast.walk(self.node))
        return tuple(each for each in every if isinstance(each, ast.FunctionDef)) or (self.node,)

    def functions(self, callback: ast.expr) -> list[ast.AST]:
        """Return what a callback is."""
        if isinstance(callback, ast.Lambda):
            return [callback]
        name = _keeper(callback)
        last = (name or "").rpartition(".")[2]
        return [each for each in self.bodies if getattr(each, "name", None) == last]

    def publishing(self, functions: Iterable[ast.AST]) -> Iterator[str]:
        """Yield what keeps the publishers on which functions, and those that they call, publish."""
        waiting, seen = list(functions), set[int]()
        by_name = {getattr(each, "name", ""): each for each in self.bodies}
        while waiting and len(seen) < _MOST_FOLLOWED:
            function = waiting.pop()
            if id(function) not in seen:
                seen.add(id(function))
                keepers, called = self.doing(function)
                yield from keepers
                waiting += (by_name[name] for name in called if name in by_name)

    def doing(self, function: ast.AST) -> tuple[frozenset[str], frozenset[str]]:
        """Return what keeps the publishers on which a function publishes, and what it calls."""
        if id(function) not in self._done:
            keepers, called = set[str](), set[str]()
            for each in ast.walk(function):
                if isinstance(each, ast.Call) and isinstance(each.func, ast.Attribute):
                    owner = _dotted(each.func.value)
                    if each.func.attr == "publish" and owner:
                        keepers.add(owner)
                    elif owner == "self":
                        called.add(each.func.attr)
            self._done[id(function)] = frozenset(keepers), frozenset(called)
        return self._done[id(function)]

    def is_node(self) -> bool:
        """Whether this is a class of nodes, by the name of what it is made from."""
        bases = self.node.bases if isinstance(self.node, ast.ClassDef) else []
        return any((self.type(base) or "").endswith("Node") for base in bases)

    def node_names(self) -> Iterator[Unread]:
        """Yield the names that the program gives its node, or several nodes."""
        for call, _ in self.calls[:_MOST_CALLS]:
            self.steps = 0
            name = _called(call)
            is_super = isinstance(call.func, ast.Attribute) and (
                isinstance(call.func.value, ast.Call) and _called(call.func.value) == "super"
            )
            named = {k.arg: k.value for k in call.keywords if k.arg}
            given = named.get("node_name") or (call.args[0] if call.args else None)
            is_init = name == "__init__" and _dotted(call.func) in ("Node.__init__",)
            if is_init:
                given = call.args[1] if len(call.args) > 1 else given
            if (name == "__init__" and is_super) or is_init or name in ("init_node", "create_node"):
                text = None if given is None else self.text(given)
                if text and given is not None:
                    yield Unread("further nodes of one program", text, self.span(given))


def _encloses(outer: ast.AST, inner: ast.AST) -> bool:
    return any(each is inner for each in ast.walk(outer))


def _called(call: ast.Call) -> str:
    if isinstance(call.func, ast.Attribute):
        return call.func.attr
    return call.func.id if isinstance(call.func, ast.Name) else ""


def _keeper(target: ast.expr) -> str | None:
    """Return the name of a variable, or of one of `self`."""
    return _dotted(target) or None
