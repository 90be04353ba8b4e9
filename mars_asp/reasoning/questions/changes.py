"""Changes of the values of a configuration, as the rules of `rules/absence` propose them.

A change is a term such as `control("Base",new(1))`; `docs/how-to/what-if.md` lists them. Changes
only serve to see their effects: they leave modules open, so they are not written to a file.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from clingo import Symbol, SymbolType

from mars_asp.model.declarations import (
    SERVICE_KINDS,
    Control,
    Data,
    Function,
    Gating,
    Limit,
    Lock,
    Mode,
    Module,
    Mount,
    Name,
    Relationship,
    Reset,
    Service,
    ServiceKind,
    Sign,
    ends_of,
)
from mars_asp.reasoning.facts.identifiers import PERIODIC, hold_of, mode_of, numbered
from mars_asp.reasoning.project import Project, port_names

_READY = Mode("NotifyWhenReady", text="NotifyWhenReady")
_PERIODIC = Mode(PERIODIC, text=PERIODIC)


def changed(project: Project, change: Symbol) -> Project:
    """Return a project with one change of its values; identifiers stay as they were.

    Raises:
        KeyError: there is no such change.
    """
    values = _Values(project)
    values.apply(change)
    return values.finished()


class _Values:
    """The values of a project while they are changed."""

    def __init__(self, project: Project) -> None:
        self._project = project
        self._configuration = project.configuration
        self._span = project.configuration.span
        self._relationships: dict[int, Relationship] = dict(
            numbered(self._configuration.relationships)
        )
        self._names = [name.text for name in self._configuration.modules]
        self._described = self._configuration.with_declared(project.modules)
        self._renewed: set[str] = set()
        ends = (ends_of(each) for each in self._configuration.relationships)
        self._taken = {*self._names, *self._described, *(name for two in ends for name in two)}

    def finished(self) -> Project:
        known = {name.text: name for name in self._configuration.modules}
        kept = (m for m in self._configuration.declared if m.name not in self._renewed)
        # A description that differs from the sources goes into the file, which comes first.
        modules = {n: m for n, m in self._project.modules.items() if n not in self._renewed}
        configuration = replace(
            self._configuration,
            modules=tuple(known.get(n, Name(n, self._span)) for n in self._names),
            relationships=tuple(self._relationships.values()),
            declared=(*kept, *(self._described[name] for name in sorted(self._renewed))),
        )
        return replace(self._project, configuration=configuration, modules=modules)

    def apply(self, change: Symbol) -> None:
        _CHANGES[change.name](self, *change.arguments)

    def both(self, *changes: Symbol) -> None:
        for change in changes:
            self.apply(change)

    def data(self, client: Symbol, source: Symbol, *required: Symbol) -> None:
        mode, hz = (mode_of(required[0]), self._hertz(required[1])) if required else (None, None)
        output, port = self._end(source)
        entry, into = self._end(client)
        self._add(Data(entry, output, self._span, mode, hz, into, port))

    def control(self, controlled: Symbol, controller: Symbol, *rank: Symbol) -> None:
        priority = rank[0].number if rank else None
        hold = hold_of(rank[1]) if len(rank) > 1 else None
        ends = self._module(controlled), self._module(controller)
        self._add(Control(*ends, self._span, priority, hold))

    def mount(self, mounting: Symbol, mounted: Symbol) -> None:
        self._add(Mount(self._module(mounting), self._module(mounted), self._span))

    def gate(self, sign: Sign, gated: Symbol, trigger: Symbol) -> None:
        (left, port), (right, trigger_port) = self._end(gated), self._end(trigger)
        self._add(Gating(left, right, self._span, sign, 1, port, trigger_port))

    def bound(self, sort: type[Reset | Lock | Limit], module: Symbol, source: Symbol) -> None:
        output, port = self._end(source)
        self._add(sort(self._module(module), output, self._span, source_port=port))

    def close(self, number: Symbol, duration: Symbol) -> None:
        self._revise(number, ms=duration.number)

    def drop(self, number: Symbol) -> None:
        del self._relationships[number.number]

    def forget(self, name: Symbol) -> None:
        kept = self._relationships.items()
        self._relationships = {n: r for n, r in kept if name.string not in ends_of(r)}

    def again(self, number: Symbol) -> None:
        self._add(self._relationships[number.number])

    def rank(self, number: Symbol, priority: Symbol) -> None:
        self._revise(number, priority=priority.number, listed=False)

    def hold(self, number: Symbol, duration: Symbol) -> None:
        self._revise(number, hold_ms=hold_of(duration))

    def require(self, number: Symbol, mode: Symbol, rate: Symbol) -> None:
        self._revise(number, mode=mode_of(mode), hz=self._hertz(rate))

    def architecture(self, kind: Symbol) -> None:
        hierarchical = kind.name == "hierarchical"
        self._configuration = replace(
            self._configuration, architecture="hierarchical" if hierarchical else "flat"
        )

    def unname(self, name: Symbol) -> None:
        self._names.remove(name.string)

    def annotate(self, module: Symbol, word: Symbol) -> None:
        kind = next((each for each in SERVICE_KINDS if each == word.string), None)
        self._annotate(
            module, Function(word.string, self._span) if kind is None else self._service(kind)
        )

    def guard(self, module: Symbol) -> None:
        self._renew(replace(self._description(module), guard=self._span))

    def commands(self, controller: Symbol, function: Symbol) -> None:
        self._annotate(
            controller, replace(self._service("ControlOut"), commands=(function.string,))
        )

    def sends(self, sender: Symbol, rate: Symbol) -> None:
        service = replace(self._service("DataOut"), modes=(_PERIODIC,), hz=self._hertz(rate))
        self._annotate(sender, service)

    def outputs(self, source: Symbol, representation: Symbol) -> None:
        module, output = self._description(source), representation.string
        services = tuple(
            replace(each, output=output) if each.kind in ("Sense", "DataOut") else each
            for each in module.services
        )
        if not any(each.kind in ("Sense", "DataOut") for each in services):
            services += (replace(self._service("DataOut"), output=output),)
        self._renew(replace(module, services=services))

    def inputs(self, client: Symbol, representation: Symbol) -> None:
        module, accepted = self._description(client), representation.string
        known = (
            replace(each, inputs=tuple(i or accepted for i in each.inputs))
            for each in module.services
        )
        added = replace(self._service("DataIn"), inputs=(accepted,))
        self._renew(replace(module, services=(*known, added)))

    def _module(self, term: Symbol) -> str:
        """Return the name of the module in a term; `new(N)` gets an unused name."""
        if term.type == SymbolType.String:
            return term.string
        name = f"New{term.arguments[0].number}"
        while name in self._taken:
            name += "_"
        if name not in self._names:
            self._names.append(name)
        return name

    def _end(self, term: Symbol) -> tuple[str, str | None]:
        """Return module and port of an output or input; `new(N)` is a new module without port."""
        if term.type == SymbolType.String and term.string not in self._names:
            port = self._ports.get(term.string)
            if port is not None:
                return port
        return self._module(term), None

    @cached_property
    def _ports(self) -> Mapping[str, tuple[str, str]]:
        return port_names(self._project)

    def _add(self, relationship: Relationship) -> None:
        self._relationships[max(self._relationships, default=0) + 1] = relationship

    def _revise(self, number: Symbol, **values: Any) -> None:
        """Replace fields, named by the keywords, of the relationship with an identifier."""
        declared = self._relationships[number.number]
        self._relationships[number.number] = replace(declared, **values)

    def _renew(self, module: Module) -> None:
        self._described[module.name] = module
        self._renewed.add(module.name)

    def _description(self, term: Symbol) -> Module:
        name = self._module(term)
        return self._described.get(name) or Module(name, self._span)

    def _annotate(self, term: Symbol, annotation: Service | Function) -> None:
        module = self._description(term)
        if isinstance(annotation, Service):
            self._renew(replace(module, services=(*module.services, annotation)))
        else:
            self._renew(replace(module, functions=(*module.functions, annotation)))

    def _service(self, kind: ServiceKind) -> Service:
        modes = (_READY,) if kind in ("Sense", "DataOut") else ()
        return Service(kind, self._span, "f", modes=modes)

    def _hertz(self, rate: Symbol) -> Fraction | None:
        is_rate = rate.type == SymbolType.Number
        return self._project.rates.hertz(rate.number) if is_rate else None


_CHANGES: Mapping[str, Callable[..., None]] = {
    "both": _Values.both,
    "data": _Values.data,
    "control": _Values.control,
    "mount": _Values.mount,
    "suppress": lambda values, *ends: values.gate("suppress", *ends),
    "inhibit": lambda values, *ends: values.gate("inhibit", *ends),
    "reset": lambda values, *ends: values.bound(Reset, *ends),
    "lock": lambda values, *ends: values.bound(Lock, *ends),
    "limit": lambda values, *ends: values.bound(Limit, *ends),
    "close": _Values.close,
    "drop": _Values.drop,
    "forget": _Values.forget,
    "again": _Values.again,
    "rank": _Values.rank,
    "hold": _Values.hold,
    "require": _Values.require,
    "architecture": _Values.architecture,
    "unname": _Values.unname,
    "annotate": _Values.annotate,
    "guard": _Values.guard,
    "commands": _Values.commands,
    "sends": _Values.sends,
    "outputs": _Values.outputs,
    "inputs": _Values.inputs,
}
