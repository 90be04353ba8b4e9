"""The nodes of a dora dataflow, each with its inputs and outputs and their locations.

https://github.com/dora-rs/dora/blob/main/docs/yaml-spec.md; a node of older files has its inputs
and outputs below `custom:`. An operator is a node of its own, `NODE/OPERATOR`, and one that is
alone (`operator:`) is the node itself.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from mars_asp.annotations.types import representation
from mars_asp.diagnostic import Diagnostic, MarsError, Span, beginning
from mars_asp.exchange import ports
from mars_asp.exchange.unread import Unread
from mars_asp.exchange.yaml_document import Items, Node, Pairs, Scalar, read_dump
from mars_asp.model.declarations import Data, MissingFile, Mode, Module
from mars_asp.model.ranges import MOST
from mars_asp.model.rates import Rate, every, read_frequency

PERIODIC = Mode("NotifyAtFrequency", text="NotifyAtFrequency")
#: The part of a file that a single operator is in a source: `webcam/op/image`.
_ALONE = "op"
#: Inputs that dora itself feeds: timers, logs, and the inputs of a module in its own file.
_VIRTUAL = re.compile(r"(?:a?dora|_mod)/.+")
_TIMER = re.compile(r"a?dora/timer(?:/(?P<unit>[^/]*))?(?:/(?P<number>.*))?")
#: A number as Rust reads it into a float.
_FLOAT = re.compile(r"\+?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?")
#: Nanoseconds of the units of timers.
_UNITS = {"secs": 10**9, "millis": 10**6, "micros": 10**3, "nanos": 1}
_MOST_COUNT = 2**64 - 1
_WIRING = frozenset(
    "id inputs outputs input_types output_types send_stdout_as send_logs_as".split()
)
_PARTS = ("custom", "operator", "operators")
#: Keys for describing, building, starting, logging and restarting. They do not wire a node.
_RUNNING = frozenset(
    "name description path path_sha256 source args env envs build git hub branch tag rev python"
    " shared-library wasm conda_env cpu_affinity deploy _unstable_deploy min_log_level max_log_size"
    " max_rotated_files restart_policy max_restarts restart_delay max_restart_delay restart_window"
    " health_check_timeout finish_grace_secs shared_memory_pool_size params"
    " output_metadata output_framing pattern".split()
)
_RUNNING_ALL = frozenset(
    "communication daemon_config deploy _unstable_deploy debug _unstable_debug env"
    " health_check_interval exit_when_nodes_finish module".split()
)
_SETTLED = _WIRING | _RUNNING
#: An output may carry what a node prints or logs.
_PRINTED = ("send_stdout_as", "send_logs_as")
#: Keys of an input beside its source, with their names in notes.
_SETTINGS = {"queue_size": "queue sizes", "input_timeout": "timeouts of inputs"}
#: Nodes whose files are elsewhere, or that have none.
_ELSEWHERE = frozenset("git hub module ros2 deploy _unstable_deploy".split())
_INTERPRETERS = ("python", "python3")
#: A path that begins in the folder of the dataflow or is a Python file, without variables.
_IN_REPOSITORY = re.compile(r"\.{1,2}/[^\s$~{}:\\]+|(?![/~])[^\s$~{}:\\]+\.py")
#: Folders of built files, also those of files that are not Python.
_BUILT = frozenset("build target dist out install venv .venv node_modules".split())
_COMPILED = frozenset(("bin", "lib"))
#: A build command that makes no file in the folder.
_INSTALL = re.compile(r"\s*(?:(?:uv|python3?)\s+(?:-m\s+)?)?pip3?\s+install\b[^;&|]*")
#: `[sample_type=f32]` after a type.
_PARAMETERS = re.compile(r"\[[^\]]*\]")


@dataclass(frozen=True, slots=True)
class Worker:
    """A node, or one operator of a node, with the relationships of its inputs and its program file.

    It is not `complete` if its contents are in another file, named by the key `module`.
    """

    module: Module
    inputs: tuple[Data, ...]
    complete: bool
    program: MissingFile | None


@dataclass(frozen=True, slots=True)
class Dataflow:
    """The workers (nodes and operators) of a dataflow file, and its contents that were not read.

    `virtual` are the first relationships of the inputs that dora itself feeds, by their sources.
    """

    workers: tuple[Worker, ...]
    virtual: Mapping[str, Data]
    unread: tuple[Unread, ...]


def read_dataflow(text: str, path: str) -> Dataflow:
    """Return the dataflow of a file.

    Raises:
        MarsError: the text is not YAML, or nodes have errors (all of them are listed).
    """
    reader = _DataflowReader()
    reader.read(read_dump(text, path))
    if reader.problems:
        raise MarsError(reader.problems)
    return Dataflow(tuple(reader.workers.values()), reader.virtual, tuple(reader.unread))


class _DataflowReader:
    """A reader that collects the workers, skipped contents and errors of a dataflow file."""

    def __init__(self) -> None:
        self.workers: dict[str, Worker] = {}
        self.virtual: dict[str, Data] = {}
        self.unread: list[Unread] = []
        self.problems: list[Diagnostic] = []
        self.ports = 0
        #: Nodes that are one operator.
        self.alone: set[str] = set()

    def wrong(self, span: Span, message: str, help_text: str, *labels: tuple[Span, str]) -> None:
        """Add an error with a message and help to `problems`."""
        self.problems.append(Diagnostic("dora", "error", message, span, labels, help_text))

    def read(self, root: Node) -> None:
        """Read a whole file into `workers`, `unread` and `problems`."""
        pairs = _by_key(root)
        _, nodes = pairs.get("nodes", (None, None))
        if not isinstance(nodes, Items) or not nodes.nodes:
            self.wrong(beginning(root.span), "the dataflow has no list of nodes", "write `nodes:`")
            return
        self.skip(pairs, _RUNNING_ALL | {"nodes"}, "settings of the dataflow")
        for node in nodes.nodes:
            if isinstance(node, Pairs):
                self.node(node)
            else:
                self.wrong(beginning(node.span), "a node is not a map", "write `- id: NAME`")
        for name, worker in self.workers.items():
            self.workers[name] = replace(worker, inputs=tuple(map(self.resolved, worker.inputs)))
        _, module = pairs.get("module", (None, None))
        if isinstance(module, Pairs):
            _, outputs = _by_key(module).get("outputs", (None, None))
            self.hand_out(outputs)

    def hand_out(self, outputs: Node | None) -> None:
        """Remove unused outputs that the dataflow, as a module, gives to a dataflow around it."""
        listed = outputs.nodes if isinstance(outputs, Items) else ()
        given: set[str | None] = {each.text for each in listed if isinstance(each, Scalar)}
        for worker in self.workers.values():
            given -= {line.source_port for line in worker.inputs}
        for name, worker in self.workers.items():
            kept = tuple(port for port in worker.module.services if port.port not in given)
            self.workers[name] = replace(worker, module=replace(worker.module, services=kept))

    def node(self, node: Pairs) -> None:
        """Add a node, or each of its operators, to `workers`."""
        pairs = _by_key(node)
        named = self.identifier(node, pairs, "a node")
        if named is None:
            return
        if "/" in named.text:
            self.wrong(named.span, f"the id `{named.text}` holds a `/`", "join words by `-`")
        inside = [part for part in _PARTS if part in pairs]
        self.skip(pairs, _SETTLED.union(_PARTS), "settings of nodes")
        if not inside:
            self.worker(named.text, named.span, pairs, pairs)
        elif inside == ["operators"]:
            _, operators = pairs["operators"]
            for each in operators.nodes if isinstance(operators, Items) else ():
                if isinstance(each, Pairs):
                    own = _by_key(each)
                    called = self.identifier(each, own, "an operator")
                    if called is not None:
                        name = f"{named.text}/{called.text}"
                        self.skip(own, _SETTLED, "settings of nodes")
                        self.worker(name, called.span, own, {**pairs, **own})
                else:
                    self.wrong(
                        beginning(each.span), "an operator is not a map", "write `- id: NAME`"
                    )
        else:
            key, part = pairs[inside[0]]
            if len(inside) > 1 or not isinstance(part, Pairs):
                message = f"`{named.text}` is not one of `custom`, `operator` and `operators`"
                self.wrong(key.span, message, "write one of them, with a map below it")
                return
            own = {**pairs, **_by_key(part)}
            self.skip(_by_key(part), _SETTLED, "settings of nodes")
            if inside == ["operator"]:
                self.alone.add(named.text)
            self.worker(named.text, named.span, own, own)

    def identifier(
        self, node: Pairs, pairs: Mapping[str, tuple[Scalar, Node]], what: str
    ) -> Scalar | None:
        """Return the id of a node or operator; add an error and return None if it has none."""
        _, named = pairs.get("id", (None, None))
        if isinstance(named, Scalar) and not _is_empty(named):
            self.check_name(named)
            return named
        self.wrong(beginning(node.span), f"{what} has no id", "add `id: NAME`")
        return None

    def check_name(self, name: Scalar) -> None:
        """Add an error if a configuration cannot contain a name."""
        if not ports.is_writable(name.text):
            message = f"`{name.text[:40]}` cannot be a name"
            self.wrong(name.span, message, "write a name of one visible line")

    def port(self, name: Scalar) -> None:
        """Count a port and check its name.

        Raises:
            MarsError: the file has too many ports.
        """
        self.check_name(name)
        self.ports += 1
        if self.ports > ports.MOST:
            raise ports.too_many(name.span)

    def skip(
        self,
        pairs: Mapping[str, tuple[Scalar, Node]],
        read: frozenset[str],
        sort: str,
    ) -> None:
        """Add to `unread` the keys of a map that are not in `read`; `sort` is their sort."""
        self.unread += (
            Unread(sort, key, at.span) for key, (at, _) in pairs.items() if key not in read
        )

    def worker(
        self,
        name: str,
        span: Span,
        pairs: Mapping[str, tuple[Scalar, Node]],
        settings: Mapping[str, tuple[Scalar, Node]],
    ) -> None:
        """Add a node or operator with its ports, connections and program to `workers`.

        A repeated id is an error. `pairs` are its own keys, `settings` these and the keys of its
        node.
        """
        if name in self.workers:
            first = self.workers[name].module.span, "the first one"
            help_text = "give each an id of its own"
            self.wrong(span, f"two nodes have the id `{name}`", help_text, first)
            return
        taken, given = (self.types(pairs, key) for key in ("input_types", "output_types"))
        services = [
            ports.output(each.text, given.get(each.text), each.span, None)
            for each in self.outputs(name, pairs)
        ]
        lines: list[Data] = []
        for key, source in self.inputs(name, pairs):
            services.append(ports.taken(key.text, taken.get(key.text), key.span))
            lines += self.wired(name, key, source)
        module = Module(name, span, tuple(services), named=span)
        self.workers[name] = Worker(
            module, tuple(lines), "module" not in pairs, _program(name, settings)
        )

    def outputs(self, name: str, pairs: Mapping[str, tuple[Scalar, Node]]) -> Iterator[Scalar]:
        """Yield the outputs of a node, also those with its standard output or its logs."""
        listed = list(self.listed_outputs(name, pairs))
        yield from listed
        for key in _PRINTED:
            _, named = pairs.get(key, (None, None))
            if isinstance(named, Scalar) and named.text not in ("", *(o.text for o in listed)):
                self.port(named)
                yield named

    def listed_outputs(
        self, name: str, pairs: Mapping[str, tuple[Scalar, Node]]
    ) -> Iterator[Scalar]:
        """Yield the outputs that a node lists."""
        _, listed = pairs.get("outputs", (None, None))
        if listed is None or _is_empty(listed):
            return
        if not isinstance(listed, Items):
            message = f"the outputs of `{name}` are not a list"
            self.wrong(beginning(listed.span), message, "write `- OUTPUT`")
            return
        seen: dict[str, Span] = {}
        for each in listed.nodes:
            if not isinstance(each, Scalar) or not each.text:
                message = f"an output of `{name}` is not a name"
                self.wrong(beginning(each.span), message, "write `- OUTPUT`")
            elif each.text in seen:
                message = f"`{name}` has two outputs `{each.text}`"
                first = seen[each.text], "the first one"
                self.wrong(each.span, message, "name it once", first)
            else:
                seen[each.text] = each.span
                self.port(each)
                yield each

    def inputs(
        self, name: str, pairs: Mapping[str, tuple[Scalar, Node]]
    ) -> Iterator[tuple[Scalar, Scalar]]:
        """Yield the name and the source of each input; add an error for one without a source."""
        _, mapped = pairs.get("inputs", (None, None))
        if mapped is None or _is_empty(mapped):
            return
        if not isinstance(mapped, Pairs):
            message = f"the inputs of `{name}` are not a map"
            self.wrong(beginning(mapped.span), message, "write `INPUT: NODE/OUTPUT`")
            return
        for key, value in mapped.pairs:
            source: Node | None = value
            if isinstance(value, Pairs):
                settings = _by_key(value)
                _, source = settings.get("source", (None, None))
                for setting, (at, _) in settings.items():
                    if setting != "source":
                        sort = _SETTINGS.get(setting, "settings of inputs")
                        self.unread.append(Unread(sort, f"{name}.{key.text}", at.span))
            self.port(key)
            if isinstance(source, Scalar) and source.text:
                yield key, source
            else:
                message = f"input `{key.text}` of `{name}` has no source"
                self.wrong(key.span, message, "write `INPUT: NODE/OUTPUT`")

    def types(self, pairs: Mapping[str, tuple[Scalar, Node]], key: str) -> dict[str, str | None]:
        """Return the stated type of each port; `key` is `input_types` or `output_types`."""
        _, declared = pairs.get(key, (None, None))
        return {
            port.text: representation(_PARAMETERS.sub("", type_.text)) or None
            for port, type_ in (declared.pairs if isinstance(declared, Pairs) else ())
            if isinstance(type_, Scalar)
        }

    def wired(self, name: str, key: Scalar, source: Scalar) -> Iterator[Data]:
        """Yield the relationship of an input (`key`) of a node; add an error for a wrong source."""
        timer = _TIMER.fullmatch(source.text)
        node, _, output = source.text.rpartition("/")
        unit, number = ("", "") if timer is None else (each or "" for each in timer.groups())
        is_timer = _ticks(unit, number)
        if is_timer or (timer is None and _VIRTUAL.fullmatch(source.text)):
            rate = _timer_rate(unit, number) if is_timer else None
            mode, output = None if rate is None else PERIODIC, "tick" if is_timer else "out"
            line = Data(name, source.text, source.span, mode, rate, key.text, output)
            self.virtual.setdefault(source.text, line)
            yield line
        elif timer is not None or not node or not output:
            message = (
                f"input `{key.text}` of `{name}` must take an output, not `{source.text[:60]}`"
            )
            help_text = "write `NODE/OUTPUT`, or a timer: `dora/timer/millis/20`"
            self.wrong(source.span, message, help_text)
        else:
            yield Data(name, node, source.span, client_port=key.text, source_port=output)

    def resolved(self, line: Data) -> Data:
        """Return a relationship in which `NODE/op`, the only operator of a node, is `NODE`."""
        node, _, operator = line.source.rpartition("/")
        is_alone = operator == _ALONE and node in self.alone
        return replace(line, source=node) if is_alone else line


def _ticks(unit: str, number: str) -> bool:
    """Whether a timer of dora may have this number of a unit: a period, or a rate in `hz`."""
    if unit == "hz":
        # Above 2 GHz the period is rounded to nothing.
        return _FLOAT.fullmatch(number) is not None and 1e-19 < float(number) < 2e9
    is_whole = number.isascii() and number.isdecimal() and len(number) <= len(str(_MOST_COUNT))
    return is_whole and unit in _UNITS and 0 < int(number) <= _MOST_COUNT


def _timer_rate(unit: str, number: str) -> Rate | None:
    """Return the rate of a timer, or None if a configuration cannot express it."""
    if unit == "hz":
        read = read_frequency(number)
        return read if isinstance(read, Rate) else None
    count = int(number)
    if unit == "secs" and count <= MOST // 1000:
        return every(count, "s")
    nanos = count * _UNITS[unit]
    if nanos % 10**6 == 0 and nanos // 10**6 <= MOST:
        return every(nanos // 10**6, "ms")
    is_rate = 10**9 % nanos == 0 and 10**9 // nanos <= MOST // 1000
    return Rate(10**9 // nanos) if is_rate else None


def _program(name: str, settings: Mapping[str, tuple[Scalar, Node]]) -> MissingFile | None:
    """Return the program file that a node needs, or None if it need not be in the repository."""
    if settings.keys() & _ELSEWHERE:
        return None
    key = next((each for each in ("path", "source", "python") if each in settings), "")
    _, value = settings.get(key, (None, None))
    if isinstance(value, Pairs):
        _, value = _by_key(value).get("source", (None, None))
    if isinstance(value, Scalar) and value.text in _INTERPRETERS:
        key = "args"
        _, value = settings.get(key, (None, None))
    if not isinstance(value, Scalar) or not _IN_REPOSITORY.fullmatch(value.text):
        return None
    is_python = value.text.endswith(".py")
    if not (_BUILT if is_python else _BUILT | _COMPILED).isdisjoint(value.text.split("/")):
        return None
    _, build = settings.get("build", (None, None))
    lines = build.text.splitlines() if isinstance(build, Scalar) else []
    builds = not all(_INSTALL.fullmatch(line) for line in lines)
    return MissingFile(name, key, value.text, value.span, builds)


def _by_key(node: Node) -> dict[str, tuple[Scalar, Node]]:
    pairs: Sequence[tuple[Scalar, Node]] = node.pairs if isinstance(node, Pairs) else ()
    return {key.text: (key, value) for key, value in pairs}


def _is_empty(node: Node) -> bool:
    """Whether the value of a key is empty or null."""
    return isinstance(node, Scalar) and not node.quoted and node.text in ("", "~", "null")
