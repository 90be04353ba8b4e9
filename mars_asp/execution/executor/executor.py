"""The executor: builds and connects all modules and nodes, and steps in simulated time."""

from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import partial
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.execution.executor.arbitration import FlatArbitration, HierarchicalArbitration
from mars_asp.execution.executor.behaviour import Behaviour
from mars_asp.execution.executor.channel import Channel, Draws, LinkFault
from mars_asp.execution.executor.delivery import (
    AT_FREQUENCY,
    ON_REQUEST,
    Offer,
    lacks_value,
    open_link,
)
from mars_asp.execution.executor.gate import Gate, Trigger
from mars_asp.execution.executor.link import Failures, Link, Message, Observer
from mars_asp.execution.executor.modules import (
    COMMAND_TIMEOUT,
    Algorithm,
    Completion,
    Effector,
    Resetting,
    Sensor,
)
from mars_asp.execution.executor.nodes import (
    ControlSplitter,
    DataSplitter,
    DataTransformer,
    InheritanceNode,
)
from mars_asp.execution.executor.plan import FORWARDING, Plan
from mars_asp.execution.executor.schedule import DATA, MILLISECOND, SECOND, EndlessError, Schedule
from mars_asp.model.cycles import knots
from mars_asp.model.declarations import Configuration, Module
from mars_asp.model.names import end
from mars_asp.output import listing

DEFAULT_PERIOD = 100 * MILLISECOND


class Executor:
    """Runs a specification, or a configuration without nodes, in simulated time.

    `behaviours` has one entry for each module, converters included; only sinks may lack one.
    `command_timeout` is in ns. `observe` is called with every event. `faults` are those of links,
    drawn from `seed`.

    Raises:
        MarsError: with all modules that have no behaviour or would never run, and all ambiguities.
    """

    def __init__(
        self,
        configuration: Configuration,
        modules: Mapping[str, Module],
        behaviours: Mapping[str, Behaviour],
        command_timeout: int = COMMAND_TIMEOUT,
        observe: Observer | None = None,
        faults: Sequence[LinkFault] = (),
        seed: int = 0,
    ) -> None:
        self.plan = Plan(configuration, modules, behaviours)
        self.command_timeout, self.observe = command_timeout, observe
        self._refuse_incomplete()
        depth = max((self.plan.depth(name) for name in self.plan.names), default=0)
        clocks = self._data_ranks()
        self._ranks = {key: DATA + 1 + k for k, key in enumerate(clocks)}
        self.schedule = Schedule(len(clocks), max(depth, 1))
        self.schedule.most_events += 100 * len(self.plan.links)
        self.arbiters: dict[str, FlatArbitration | HierarchicalArbitration] = {}
        self.effectors: dict[str, Effector] = {}
        self.elements: dict[str, Any] = {}
        self._demands: dict[str, Callable[[], None]] = {}
        self._left = self.plan.left_to_providers()
        for link in self.plan.links:
            link.schedule, link.observe = self.schedule, observe
        draws = {fault.ends: Draws(seed, *fault.ends) for fault in faults}
        channels = [
            self._channel(link, [fault for fault in faults if fault.ends == ends], draws[ends])
            for link in self.plan.links
            if (ends := (link.source, link.client)) in draws
        ]
        # In the order of cascades, so that timers of one instant are in this order as well.
        for name in sorted(self.plan.names, key=self.plan.depth):
            self.elements[name] = self._build(name)
        for name in self.plan.names:
            self._join(name)
        for name in self.plan.names:
            self._join_resets(name)
        for channel in channels:
            channel.delay_withdrawal()

    @property
    def links(self) -> tuple[Link, ...]:
        """Return every link, in the order of the relationships, with its counts."""
        return tuple(self.plan.links)

    @property
    def failures(self) -> dict[str, Failures]:
        """Return the exceptions that no scenario injected, by module, converter or link."""
        found = {
            self.plan.converter_of(name) or name: getattr(each, "failures", Failures())
            for name, each in self.elements.items()
        }
        found |= {
            self.plan.link_title(link): link.failures for link in self.links if link.failures.count
        }
        return {name: failures for name, failures in found.items() if failures.count}

    @property
    def run_counts(self) -> dict[str, int]:
        """Return the number of runs of each module, or of received commands of an effector."""
        counts = ((name, getattr(each, "runs", None)) for name, each in self.elements.items())
        return {name: runs for name, runs in counts if runs is not None}

    def step_until(self, time: int) -> None:
        """Run all events up to and including `time` (ns).

        Raises:
            MarsError: messages go round without end within one instant.
        """
        try:
            self.schedule.step_until(time)
        except EndlessError:
            raise MarsError([_endless(self.plan, self.schedule.now)]) from None

    def finish(self) -> None:
        """Count the messages that the end of the run leaves unused."""
        for element in self.elements.values():
            if isinstance(element, Algorithm):
                element.finish()

    def _data_ranks(self) -> list[tuple[int, bool]]:
        """Return the keys (depth, is output) of the ranks of joins and clocks, in order."""
        plan = self.plan
        waiting = (
            name
            for name in plan.names
            if plan.side_in[name]
            or plan.inner.get(name)
            or self._clock(name)
            or len(plan.data_in[name]) > 1
        )
        ranks = {(plan.data_depth[name], False) for name in waiting}
        for link in plan.links:
            if link.stream == "data" and plan.carried(link)[0].name == AT_FREQUENCY:
                ranks.add((plan.data_depth[link.source], True))
        return sorted(ranks)

    def _clock(self, name: str) -> Fraction | None:
        """Return the rate in Hertz of an algorithm's or sink's own clock, None without one."""
        mode, hz = self.plan.made(name)
        if self.plan.kind(name) == "data_out" and mode.name == ON_REQUEST:
            return None
        behaviour = self.plan.behaviours.get(name)
        if hz is None and behaviour is not None and behaviour.period is not None:
            return Fraction(SECOND, behaviour.period)
        return hz

    def _refuse_incomplete(self) -> None:
        """Raise MarsError with all unbound modules, ambiguities and modules that never run."""
        plan = self.plan
        spans = {name.text: name.span for name in plan.configuration.modules}
        problems = [*incomplete(plan, plan.behaviours)]
        for name in filter(plan.behaviours.__contains__, plan.names):
            problems += self._never_runs(name, spans.get(name, plan.configuration.span))
        if problems:
            raise MarsError(problems)

    def _never_runs(self, name: str, span: Span) -> list[Diagnostic]:
        plan = self.plan
        if plan.kind(name) not in ("data_out", "control_out"):
            return []
        behaviour = plan.behaviours[name]
        pushed = [k for k in plan.data_in[name] if plan.carried(k)[0].name != ON_REQUEST]
        if pushed or plan.made(name)[0].name in (AT_FREQUENCY, ON_REQUEST) or behaviour.period:
            return []
        if plan.kind(name) == "control_out" and plan.control_in[name]:
            return []
        message = f"`{name}` would never run: no input is notified and it has no period"
        help_text = f"give `{name}` a period in the scenario"
        return [Diagnostic("never-runs", "error", message, span, (), help_text)]

    def _build(self, name: str) -> Any:
        kind, plan = self.plan.kind(name), self.plan
        behaviour = plan.behaviours.get(name, Behaviour(lambda *inputs: None))
        if kind == "sensor":
            _, hz = plan.made(name)
            sensor = Sensor(name, behaviour, hz, self.schedule)
            self._demands[name] = (lambda: None) if sensor.clocked else sensor.sample
            return sensor
        if kind in ("data_out", "control_out", "sink"):
            return self._algorithm(name, kind, behaviour)
        if kind == "effector":
            left = self._left.get(name, frozenset())
            effector = Effector(name, behaviour, self.command_timeout, self.schedule, left)
            self.effectors[name] = effector
            return effector
        if kind == "completion":
            return Completion(name, behaviour, self.schedule)
        if kind == "reset":
            return None
        if kind == "arbitration_node":
            self.arbiters[name] = self._arbiter(name)
            return self.arbiters[name]
        if kind == "gate_node":
            return Gate(name, self.schedule, self._gate_rank(name), self.observe)
        if kind == "data_splitter":
            return DataSplitter()
        if kind == "data_transformer":
            return DataTransformer(self._converter(name), plan.data_out[name], self.schedule)
        if kind == "inheritance_node":
            led = plan.led_by_both(name)
            own = frozenset() if led is None else plan.inheriting.functions(led)
            providers = plan.providers(name)
            functions = {provider: plan.inheriting.functions(provider) for provider in providers}
            effectors = self.effectors
            carrying = plan.carrying(
                name, lambda module: effectors[module].position() if module in effectors else {}
            )
            return InheritanceNode(
                providers, functions, carrying, plan.inheriting.allocation(name), own
            )
        return ControlSplitter(plan.control_out[name])

    def _algorithm(self, name: str, kind: str, behaviour: Behaviour) -> Algorithm:
        hz = self._clock(name)
        on_request = kind == "data_out" and self.plan.made(name)[0].name == ON_REQUEST
        rank = DATA
        resets = self.plan.is_reset(name) or any(self.plan.inner.get(name, ()))
        if hz is not None or len(self.plan.data_in[name]) > 1 or resets:
            rank = self._ranks[self.plan.data_depth[name], False]
        if kind == "control_out":
            rank = self.schedule.control + self.plan.depth(name)
        modes = (self.plan.carried(link)[0].name for link in self.plan.data_in[name])
        algorithm = Algorithm(
            name,
            behaviour,
            self.schedule,
            commands=kind == "control_out",
            triggered=hz is None and not on_request,
            pulls=ON_REQUEST in modes,
            rank=rank,
        )
        for service in self.plan.services(name):
            algorithm.functions = algorithm.functions or service.commands
            if service.window_ms is not None:
                algorithm.window = service.window_ms * MILLISECOND
                algorithm.delays = {
                    sender: each.delay
                    for sender, each in self.plan.behaviours.items()
                    if self.plan.kind(sender) != "completion"
                }
        if resets or algorithm.window is not None:
            algorithm.held = {}
        self._demands[name] = algorithm.run
        if hz is not None:
            self.schedule.every(hz, rank, algorithm.run)
        return algorithm

    def _gate_rank(self, name: str) -> int:
        """Return the rank at which nothing before it in an instant can reach a trigger."""
        depth = self.plan.depth(name)
        if depth > 0:
            return self.schedule.control + depth
        return self._ranks[self.plan.data_depth[name], False]

    def _arbiter(self, name: str) -> FlatArbitration | HierarchicalArbitration:
        plan = self.plan
        rank, outputs = self.schedule.control + plan.depth(name), plan.control_out[name]
        line = plan.strategies.get(name)
        strategy = plan.configuration.architecture if line is None else line.strategy
        # With a side line, the commands of one controller are not averaged.
        several = len(plan.control_in[name]) > 1 or (line is None and not plan.side_in[name])
        if strategy in ("flat", "weighted") and several:
            own = None if line is None else line.period_ms
            declared = plan.configuration.period_ms if own is None else own
            period = DEFAULT_PERIOD if declared is None else declared * MILLISECOND
            return FlatArbitration(
                name,
                period,
                self.schedule,
                rank,
                outputs,
                weighted=strategy == "weighted",
                timeout=self.command_timeout,
            )
        stops, equal = plan.reaches_effector(name), strategy != "hierarchical"
        return HierarchicalArbitration(
            name, self.schedule, rank, outputs, stops=stops, equal=equal, observe=self.observe
        )

    def _converter(self, name: str) -> Behaviour:
        if name in self.plan.conversions:
            return self.plan.behaviours[self.plan.conversions[name].converter or name]
        return self.plan.behaviours.get(name) or Behaviour(lambda value: value)

    def _join(self, name: str) -> None:
        plan, element = self.plan, self.elements[name]
        for link in plan.data_out[name]:
            element.offers.append(self._offer(name, link))
        if isinstance(element, Sensor | Algorithm | Completion):
            element.outputs += [*plan.data_out[name], *plan.control_out[name]]
        if isinstance(element, Algorithm):
            element.bounds_others = plan.bounds_others(name)
        if isinstance(element, Algorithm | Gate):
            element.offers += [link.send for link in plan.control_out[name]]
        if isinstance(element, Gate):
            element.outputs += plan.control_out[name]
        for link in plan.data_in[name]:
            link.receive = self._data_receiver(element, link)
        for link in plan.control_in[name]:
            link.receive = self._control_receiver(element, link)
        for link in plan.side_in[name]:
            link.receive = self._side_receiver(element, link)

    def _channel(self, link: Link, faults: Sequence[LinkFault], draws: Draws) -> Channel:
        is_answer = link.stream == "data" and self.plan.carried(link)[0].name == ON_REQUEST
        rank = DATA
        if link.stream == "control":
            rank = self.schedule.control + self.plan.depth(link.source)

        def cancel() -> None:
            if is_answer:
                self._cancel(link.client)

        return Channel(link, faults, draws, rank, cancel)

    def _cancel(self, name: str) -> None:
        """End the wait of a module or node for a lost answer, and of those that wait for it."""
        element = self.elements[name]
        if isinstance(element, Algorithm):
            if not element.waiting:
                return
            element.waiting = False
        for link in self.plan.data_out[name]:
            if link.forget():
                self._cancel(link.client)

    def _join_resets(self, name: str) -> None:
        """Join the parts of a module: its completions, and its resets if it has any."""
        plan = self.plan
        if plan.kind(name) == "completion":
            for part in plan.parts(name.rpartition(".")[0]):
                element, completion = self.elements[part], self.elements[name]
                if isinstance(element, Sensor | Algorithm | Effector):
                    if element.completion is None:
                        element.completion = completion
                    elif element.completion is not completion:
                        element.completion.following = completion
        resets = [link for link in plan.side_in[name] if link.kind == "reset"]
        if not resets:
            return
        parts = plan.parts(name)
        done = [self.elements[part] for part in parts if plan.kind(part) == "completion"]
        running = [self.elements[part] for part in parts]
        own = self.elements[name]
        resetting = Resetting(
            plan.behaviours.get(name),
            [each for each in running if isinstance(each, Sensor | Algorithm)],
            partial(self._renew, parts),
            done[0] if done else None,
            getattr(own, "failures", Failures()),
            self.schedule,
        )
        if own is None:
            self.elements[name] = resetting
        for link in resets:
            link.receive = resetting.receive

    def _renew(self, names: Sequence[str]) -> None:
        """Restart the conditional modes of the outputs of modules, also after nodes."""
        for link in (link for name in names for link in self.plan.data_out[name]):
            link.renew()
            if link.kind == "data" and self.plan.kind(link.client) in FORWARDING:
                self._renew([link.client])

    def _offer(self, name: str, link: Link) -> Offer:
        made, mode = self.plan.made(name), self.plan.carried(link)[0]
        if self.plan.kind(name) == "data_transformer" and made[0].name != ON_REQUEST:
            # The link to its input applies the conditions already.
            return link.send
        rank = self._ranks.get((self.plan.data_depth[name], True), DATA)
        return open_link(link, mode, made, self.schedule, rank, self._upstream(name))

    def _upstream(self, name: str) -> Callable[[], None] | None:
        if name in self._demands:
            return self._demands[name]
        inputs = self.plan.data_in[name]

        def ask() -> None:
            for link in inputs:
                if link.request is not None:
                    link.request()

        return ask

    def _data_receiver(self, element: Any, link: Link) -> Callable[[Message], None]:
        if isinstance(element, Algorithm):
            return element.input(link, self.plan.carried(link)[0].name == ON_REQUEST)
        if isinstance(element, Gate):
            return element.input(link)
        receive: Callable[[Message], None] = element.receive
        return receive

    def _side_receiver(self, element: Any, link: Link) -> Callable[[Message], None]:
        if isinstance(element, Gate):
            boolean, late = self.plan.is_boolean(link), self.plan.acts_late(link)
            in_circle, returns = self.plan.in_circle(link), self.plan.returns(link)
            return element.trigger(Trigger(link, boolean, late, in_circle, returns))
        if isinstance(element, FlatArbitration | HierarchicalArbitration):
            return element.bounds.input(link)
        return lambda message: None

    def _control_receiver(self, element: Any, link: Link) -> Callable[[Message], None]:
        if isinstance(element, HierarchicalArbitration):
            return element.input(link, self.plan.hold(link))
        if isinstance(element, Algorithm):
            return element.input(link, False)
        if isinstance(element, FlatArbitration | Effector | Gate):
            return element.input(link)
        if isinstance(element, ControlSplitter | InheritanceNode):
            link.withdrawn = element.withdraw
        receive: Callable[[Message], None] = element.receive
        return receive


def _no_side(plan: Plan, link: Link) -> Diagnostic:
    word, node = {
        "suppress": ("suppressed", "a Gate"),
        "inhibit": ("inhibited", "a Gate"),
        "lock": ("locked", "an ArbitrationNode"),
        "limit": ("limited", "an ArbitrationNode"),
    }[link.kind]
    message = f"`{link.client}` is {word} by `{link.source}`, and it is not {node}"
    help_text = "synthesise the configuration: its specification has the node"
    return Diagnostic("side-line", "error", message, link.span, (), help_text)


def _circles(plan: Plan) -> Iterator[Diagnostic]:
    """Yield the circles of nodes, around which a message would be forwarded without end."""
    edges = (
        (link.source, link.client, number)
        for number, link in enumerate(plan.links)
        if link.kind in ("data", "control")
        and plan.is_node(link.source)
        and plan.is_node(link.client)
    )
    for knot in knots(edges):
        first, *others = (plan.links[number] for number in sorted(edge[2] for edge in knot.walk))
        message = f"`{first.client}` would forward each message back to itself"
        labels = tuple((link.span, "through this line") for link in others)
        help_text = "let a module be between them, or delete a line of the circle"
        yield Diagnostic("circle", "error", message, first.span, labels, help_text)


def _endless(plan: Plan, now: int) -> Diagnostic:
    """Return the error for messages that go round without end in the instant `now` (ns)."""
    inner = [link for links in plan.inner.values() for link in links]
    busy = [k for k in plan.links if len(k.latest) == k.latest.maxlen and k.latest[0] == now]
    links = [*busy, *inner]
    edges = ((link.source, link.client, number) for number, link in enumerate(links))
    walk = [links[edge[2]] for knot in knots(edges)[:1] for edge in knot.walk]
    lines = [link for link in walk if link in busy and link.span != plan.configuration.span]
    names = listing([f"`{k.source}`" for k in walk if not plan.is_node(k.source)])
    message = (
        f"the messages of {names or 'the run'} never end within the instant {now / SECOND:g} s"
    )
    labels = tuple((link.span, "through this line") for link in lines[1:])
    span = lines[0].span if lines else plan.configuration.span
    help_text = "give a module or a link of the circle a `delay` in the scenario"
    return Diagnostic("endless", "error", message, span, labels, help_text)


def _no_value(plan: Plan, link: Link) -> Diagnostic:
    clients = " and ".join(f"`{name}`" for name in plan.targets_of(link)) or f"`{link.client}`"
    message = f"{clients} gets `NotifyOnValue` from `{plan.origin_of(link)}` without a value"
    help_text = "state the value: `NotifyOnValue(30)`"
    return Diagnostic("condition", "error", message, link.span, (), help_text)


def _open_input(plan: Plan, link: Link) -> Diagnostic:
    ports = plan.left_open(link)
    listed = ", ".join(f"`{end(link.client, port)}`" for port in ports)
    message = f"the line leaves open which input of `{link.client}` it feeds: {listed}"
    help_text = f"name one, as in `{end(link.client, ports[0])} uses_data_from {link.source}`"
    return Diagnostic("ambiguous-input", "error", message, link.span, (), help_text)


def incomplete(plan: Plan, bound: Container[str]) -> Iterator[Diagnostic]:
    """Yield the errors that keep a plan from running, where the modules `bound` have behaviours."""
    whole = plan.configuration.span
    spans = {name.text: name.span for name in plan.configuration.modules}
    for name in plan.names:
        kind = plan.kind(name)
        if name not in bound and (
            kind in ("sensor", "data_out", "control_out", "completion")
            or (kind == "effector" and plan.control_in[name])
        ):
            inputs = bool(plan.data_in[name])
            yield _unbound(name, kind, spans.get(name, whole), has_inputs=inputs)
    for each in plan.configuration.conversions:
        converter = each.converter or each.transformer
        if converter not in bound:
            place = spans.get(each.transformer, whole)
            yield _unbound(converter, "converter", place, has_inputs=True)
    nodes = [name for name in plan.names if plan.kind(name) == "inheritance_node"]
    for node in nodes:
        for provider in plan.unknown_providers(node):
            yield _unknown_provider(node, provider, spans.get(provider, whole))
    for node in nodes:
        yield from _stands_for_none(plan, node, spans.get(node, whole))
    yield from (_open_input(plan, link) for link in plan.links if plan.left_open(link))
    yield from (_no_side(plan, link) for link in plan.links if plan.lacks_node(link))
    yield from _circles(plan)
    links = (link for link in plan.links if link.stream == "data")
    yield from (_no_value(plan, k) for k in links if lacks_value(plan.carried(k)[0]))


def _unbound(name: str, kind: str, span: Span, *, has_inputs: bool) -> Diagnostic:
    """Return the error that nothing runs a module or converter; devices have no inputs."""
    message = f"`{name}` is not bound ({kind.replace('_', ' ')})"
    what = "a Python function" if has_inputs else "a device or a Python function"
    help_text = f"bind `{name}` to {what} in the scenario"
    return Diagnostic("unbound", "error", message, span, (), help_text)


def _unknown_provider(node: str, name: str, span: Span) -> Diagnostic:
    message = f"the functions that `{name}` provides to `{node}` are unknown"
    help_text = f"annotate `{name}`: name its source with `--sources`, or repeat its block"
    return Diagnostic("undescribed", "error", message, span, (), help_text)


def _stands_for_none(plan: Plan, node: str, span: Span) -> Iterator[Diagnostic]:
    """Yield errors if the InheritanceNode `node` does not represent exactly one module."""
    named = plan.inheriting.stands_for(node)
    if len(named) > 1:
        names = " or ".join(f"`{name}`" for name in sorted(named))
        message = f"`{node}` may serve {names}, which move in different ways"
        help_text = f"name one in a comment before its line: `// {node}: {min(named)}`"
        yield Diagnostic("stand-in", "error", message, span, (), help_text)
    for each in plan.configuration.stand_ins:
        if each.node == node and each.module not in plan.inheriting.riders(node):
            message = (
                f"`{node}` feeds modules that do not carry `{each.module}`, which its comment names"
            )
            help_text = "name the module whose commands the node passes on"
            yield Diagnostic("stand-in", "error", message, each.span, (), help_text)
