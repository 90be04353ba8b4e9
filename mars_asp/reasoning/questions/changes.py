"""Changes of a configuration, as the rules of `rules/absence` propose them, made to its values.

A change is a term such as `control("Base",new(1))`; `docs/how-to/what-if.md` lists them. They are
made to see what follows: nobody writes them into a file, as they leave open which module is meant.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

from clingo import Symbol, SymbolType

from mars_asp.model.declarations import (
    SERVICE_KINDS,
    Control,
    Data,
    Function,
    Mode,
    Module,
    Mount,
    Name,
    Relationship,
    Service,
    ServiceKind,
    ends_of,
)
from mars_asp.model.described import described_modules
from mars_asp.reasoning.facts.ends import ends_in
from mars_asp.reasoning.facts.identifiers import PERIODIC, hold_of, mode_of, numbered
from mars_asp.reasoning.facts.rates import rates_in
from mars_asp.reasoning.project import Project, port_names

_READY = Mode("NotifyWhenReady", text="NotifyWhenReady")
_PERIODIC = Mode(PERIODIC, text=PERIODIC)


def changed(project: Project, change: Symbol) -> Project:
    """Return a project with a change, whose identifiers are those of the project.

    Raises:
        KeyError: there is no such change.
    """
    made = _Changed(project)
    made.apply(change)
    return made.finished()


class _Changed:
    """A project while it is changed."""

    def __init__(self, project: Project) -> None:
        self.project = project
        self.configuration = project.configuration
        self.span = project.configuration.span
        self.relationships: dict[int, Relationship] = dict(
            numbered(self.configuration.relationships)
        )
        self.names = [name.text for name in self.configuration.modules]
        self.described = {
            **project.modules,
            **{module.name: module for module in self.configuration.declared},
        }
        self.renewed: set[str] = set()
        known = described_modules(self.configuration, project.modules)
        self.ends = ends_in(self.configuration, known)
        self.rates = rates_in(self.configuration, known)
        ends = (ends_of(each) for each in self.configuration.relationships)
        self.taken = {*self.names, *self.described, *(name for two in ends for name in two)}

    def finished(self) -> Project:
        known = {name.text: name for name in self.configuration.modules}
        kept = (m for m in self.configuration.declared if m.name not in self.renewed)
        # What sources describe otherwise is told first in the file.
        modules = {n: m for n, m in self.project.modules.items() if n not in self.renewed}
        configuration = replace(
            self.configuration,
            modules=tuple(known.get(n, Name(n, self.span)) for n in self.names),
            relationships=tuple(self.relationships.values()),
            declared=(*kept, *(self.described[name] for name in sorted(self.renewed))),
        )
        return replace(self.project, configuration=configuration, modules=modules)

    def apply(self, change: Symbol) -> None:
        _CHANGES[change.name](self, change.arguments)

    def module(self, term: Symbol) -> str:
        """Return the name of a module; one that is not there yet gets one."""
        if term.type == SymbolType.String:
            return term.string
        name = f"New{term.arguments[0].number}"
        while name in self.taken:
            name += "_"
        if name not in self.names:
            self.names.append(name)
        return name

    def output(self, term: Symbol) -> tuple[str, str | None]:
        """Return the module and the port of an output, or a new module."""
        if term.type == SymbolType.String and term.string in self.ends.outputs:
            return self.ends.written(term.string)
        return self.module(term), None

    def entry(self, term: Symbol) -> tuple[str, str | None]:
        """Return the module and the port of an input, or a new module."""
        if term.type == SymbolType.String and term.string not in self.names:
            port = self.ports.get(term.string)
            if port is not None:
                return port
        return self.module(term), None

    @cached_property
    def ports(self) -> Mapping[str, tuple[str, str]]:
        return port_names(self.project)

    def add(self, relationship: Relationship) -> None:
        self.relationships[max(self.relationships, default=0) + 1] = relationship

    def renew(self, module: Module) -> None:
        self.described[module.name] = module
        self.renewed.add(module.name)

    def description(self, term: Symbol) -> Module:
        name = self.module(term)
        return self.described.get(name) or Module(name, self.span)

    def annotate(self, term: Symbol, annotation: Service | Function) -> None:
        module = self.description(term)
        if isinstance(annotation, Service):
            self.renew(replace(module, services=(*module.services, annotation)))
        else:
            self.renew(replace(module, functions=(*module.functions, annotation)))


def _both(made: _Changed, terms: Iterable[Symbol]) -> None:
    for term in terms:
        made.apply(term)


def _data(made: _Changed, terms: list[Symbol]) -> None:
    client, source, *required = terms
    mode, hz = (mode_of(required[0]), _hertz(made, required[1])) if required else (None, None)
    output, port = made.output(source)
    entry, into = made.entry(client)
    made.add(Data(entry, output, made.span, mode, hz, into, port))


def _control(made: _Changed, terms: list[Symbol]) -> None:
    controlled, controller, *rank = terms
    priority = rank[0].number if rank else None
    hold = hold_of(rank[1]) if len(rank) > 1 else None
    ends = made.module(controlled), made.module(controller)
    made.add(Control(*ends, made.span, priority, hold))


def _mount(made: _Changed, terms: list[Symbol]) -> None:
    mounting, mounted = terms
    made.add(Mount(made.module(mounting), made.module(mounted), made.span))


def _drop(made: _Changed, terms: list[Symbol]) -> None:
    del made.relationships[terms[0].number]


def _forget(made: _Changed, terms: list[Symbol]) -> None:
    (name,) = terms
    kept = made.relationships.items()
    made.relationships = {n: r for n, r in kept if name.string not in ends_of(r)}


def _again(made: _Changed, terms: list[Symbol]) -> None:
    made.add(made.relationships[terms[0].number])


def _set_priority(made: _Changed, terms: list[Symbol]) -> None:
    number, priority = (term.number for term in terms)
    declared = made.relationships[number]
    assert isinstance(declared, Control)
    made.relationships[number] = replace(declared, priority=priority, listed=False)


def _hold(made: _Changed, terms: list[Symbol]) -> None:
    number, hold_ms = terms[0].number, hold_of(terms[1])
    declared = made.relationships[number]
    assert isinstance(declared, Control)
    made.relationships[number] = replace(declared, hold_ms=hold_ms)


def _require(made: _Changed, terms: list[Symbol]) -> None:
    number, mode, rate = terms
    declared = made.relationships[number.number]
    assert isinstance(declared, Data)
    made.relationships[number.number] = replace(declared, mode=mode_of(mode), hz=_hertz(made, rate))


def _architecture(made: _Changed, terms: list[Symbol]) -> None:
    hierarchical = terms[0].name == "hierarchical"
    made.configuration = replace(
        made.configuration, architecture="hierarchical" if hierarchical else "flat"
    )


def _unname(made: _Changed, terms: list[Symbol]) -> None:
    made.names.remove(terms[0].string)


def _annotate(made: _Changed, terms: list[Symbol]) -> None:
    module, word = terms
    kind = next((each for each in SERVICE_KINDS if each == word.string), None)
    if kind is None:
        made.annotate(module, Function(word.string, made.span))
    else:
        made.annotate(module, _service(made, kind))


def _guard(made: _Changed, terms: list[Symbol]) -> None:
    made.renew(replace(made.description(terms[0]), guard=made.span))


def _set_commands(made: _Changed, terms: list[Symbol]) -> None:
    controller, function = terms
    made.annotate(controller, replace(_service(made, "ControlOut"), commands=(function.string,)))


def _sends(made: _Changed, terms: list[Symbol]) -> None:
    sender, rate = terms
    service = replace(_service(made, "DataOut"), modes=(_PERIODIC,), hz=_hertz(made, rate))
    made.annotate(sender, service)


def _outputs(made: _Changed, terms: list[Symbol]) -> None:
    source, representation = made.description(terms[0]), terms[1].string
    services = tuple(
        replace(each, output=representation) if each.kind in ("Sense", "DataOut") else each
        for each in source.services
    )
    if not any(each.kind in ("Sense", "DataOut") for each in services):
        services += (replace(_service(made, "DataOut"), output=representation),)
    made.renew(replace(source, services=services))


def _add_inputs(made: _Changed, terms: list[Symbol]) -> None:
    client, representation = made.description(terms[0]), terms[1].string
    known = (
        replace(each, inputs=tuple(i or representation for i in each.inputs))
        for each in client.services
    )
    added = replace(_service(made, "DataIn"), inputs=(representation,))
    made.renew(replace(client, services=(*known, added)))


def _service(made: _Changed, kind: ServiceKind) -> Service:
    modes = (_READY,) if kind in ("Sense", "DataOut") else ()
    return Service(kind, made.span, "f", modes=modes)


def _hertz(made: _Changed, rate: Symbol) -> Fraction | None:
    return made.rates.hertz(rate.number) if rate.type == SymbolType.Number else None


_CHANGES: Mapping[str, Callable[[_Changed, list[Symbol]], None]] = {
    "both": _both,
    "data": _data,
    "control": _control,
    "mount": _mount,
    "drop": _drop,
    "forget": _forget,
    "again": _again,
    "rank": _set_priority,
    "hold": _hold,
    "require": _require,
    "architecture": _architecture,
    "unname": _unname,
    "annotate": _annotate,
    "guard": _guard,
    "commands": _set_commands,
    "sends": _sends,
    "outputs": _outputs,
    "inputs": _add_inputs,
}
