"""Edits of a project, as the rules of `rules/repair` propose them, applied to its values.

An edit is a term such as `drop(3)` or `rename("Sonr","Sonar")`; `docs/what-if.md` lists them.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from decimal import Decimal

from clingo import Symbol, SymbolType

from mars_asp.facts import PERIODIC, described_modules, mode_of, numbered, numbered_annotations
from mars_asp.language.print import print_number, print_relationship
from mars_asp.model import (
    Configuration,
    Control,
    Data,
    Function,
    Mode,
    Module,
    Mount,
    Name,
    Relationship,
    Service,
    ends_of,
)
from mars_asp.project import Project
from mars_asp.source import Span


@dataclass(frozen=True, slots=True)
class Line:
    """A line that an edit changes: how it reads and how it is to read, `None` for not at all."""

    span: Span
    old: str | None
    new: str | None


class UnknownEditError(Exception):
    """A rule proposes an edit that is none of those listed."""


def apply_edits(project: Project, edits: Iterable[Symbol]) -> tuple[Project, tuple[Line, ...]]:
    """Return the edited project and the lines that change.

    Identifiers in all edits are those of `project`.

    Raises:
        UnknownEditError: an edit is none of those listed.
    """
    draft = _Draft(project)
    for edit in edits:
        apply = _EDITS.get((edit.name, len(edit.arguments)))
        if apply is None:
            raise UnknownEditError(str(edit))
        apply(draft, *edit.arguments)
    return draft.project(), tuple(draft.lines)


class _Draft:
    """A project while it is edited; relationships and annotations are known by identifier."""

    def __init__(self, project: Project) -> None:
        self.before = project
        self.configuration = project.configuration
        self.relationships: dict[int, Relationship] = dict(
            numbered(project.configuration.relationships)
        )
        described = described_modules(project.configuration, project.modules)
        self.annotations = {
            number: (module.name, annotation)
            for number, module, annotation in numbered_annotations(project.configuration, described)
        }
        self.modules = {**project.modules, **{m.name: m for m in self.configuration.declared}}
        self.lines: list[Line] = []

    def project(self) -> Project:
        declared = {module.name for module in self.configuration.declared}
        configuration = replace(
            self.configuration,
            relationships=tuple(self.relationships.values()),
            declared=tuple(m for m in self.modules.values() if m.name in declared),
        )
        found = {name: m for name, m in self.modules.items() if name not in declared}
        return replace(self.before, configuration=configuration, modules=found)

    def relationship(self, number: Symbol, changed: Relationship | None) -> None:
        """Put another relationship in the place of one, or none."""
        old = self.relationships[number.number]
        new = None if changed is None else print_relationship(changed)
        self.lines.append(Line(old.span, print_relationship(old), new))
        if changed is None:
            del self.relationships[number.number]
        else:
            self.relationships[number.number] = changed

    def names(self, names: Iterable[Name], name: str, added: bool) -> None:
        """Put other names into `@modules`."""
        old, new = (None, f"@modules {name}") if added else (f"@modules {name}", None)
        spans = {n.text: n.span for n in self.configuration.modules}
        last = self.configuration.modules[-1:]
        span = spans.get(name) or (last[0].span if last else self.configuration.span)
        self.lines.append(Line(span, old, new))
        self.configuration = replace(self.configuration, modules=tuple(names))

    def annotation(
        self, name: str, old: Service | Function | None, new: Service | Function | None
    ) -> None:
        """Put another annotation of a module in the place of one, or none; or add one."""
        module = self.modules[name]
        services = [s for s in module.services if s is not old]
        functions = [f for f in module.functions if f is not old]
        if isinstance(new, Service):
            services.append(new)
        elif new is not None:
            functions.append(new)
        self.modules[name] = replace(module, services=tuple(services), functions=tuple(functions))
        span = module.span if old is None else old.span
        texts = [None if a is None else _annotation_text(a) for a in (old, new)]
        self.lines.append(Line(span, texts[0], texts[1]))


def _require(draft: _Draft, number: Symbol, mode: Symbol, rate: Symbol) -> None:
    stated = draft.relationships[number.number]
    assert isinstance(stated, Data)
    wanted = mode_of(mode)
    text = wanted.text or wanted.name
    changed = replace(stated, mode=replace(wanted, text=text), hz=_hertz(rate))
    draft.relationship(number, changed)


def _offer(draft: _Draft, number: Symbol, mode: Symbol, rate: Symbol) -> None:
    name, annotation = draft.annotations[number.number]
    assert isinstance(annotation, Service)
    wanted = mode_of(mode)
    modes: tuple[Mode, ...] = annotation.modes
    if wanted not in modes:
        modes += (wanted,)
    hz = _hertz(rate) or annotation.hz if wanted.name == PERIODIC else annotation.hz
    draft.annotation(name, annotation, replace(annotation, modes=modes, hz=hz))


def _redirect(draft: _Draft, number: Symbol, end: Symbol, module: Symbol) -> None:
    first, second = ends_of(draft.relationships[number.number])
    if end.name == "first":
        first = module.string
    else:
        second = module.string
    draft.relationship(number, _between(draft.relationships[number.number], first, second))


def _swap(draft: _Draft, number: Symbol) -> None:
    first, second = ends_of(draft.relationships[number.number])
    draft.relationship(number, _between(draft.relationships[number.number], second, first))


def _drop(draft: _Draft, number: Symbol) -> None:
    if number.number in draft.relationships:
        draft.relationship(number, None)


def _relate(draft: _Draft, client: Symbol, source: Symbol) -> None:
    added = Data(client.string, source.string, draft.configuration.span)
    draft.relationships[max(draft.relationships, default=0) + 1] = added
    draft.lines.append(Line(added.span, None, print_relationship(added)))


def _rank(draft: _Draft, number: Symbol, priority: Symbol) -> None:
    stated = draft.relationships[number.number]
    assert isinstance(stated, Control)
    draft.relationship(number, replace(stated, priority=priority.number))


def _vertex(draft: _Draft, number: Symbol, vertex: Symbol) -> None:
    stated = draft.relationships[number.number]
    assert isinstance(stated, Mount)
    at = stated.mounting_vertex or 0
    changed = replace(stated, mounting_vertex=at, mounted_vertex=vertex.number)
    draft.relationship(number, changed)


def _architecture(draft: _Draft, kind: Symbol) -> None:
    old = draft.configuration
    chosen = "hierarchical" if kind.name == "hierarchical" else "flat"
    changed: Configuration = replace(
        old,
        architecture="hierarchical" if chosen == "hierarchical" else "flat",
        stated=True,
        period_ms=None,
    )
    written = f"@{old.kind} {old.architecture}" if old.stated else f"@{old.kind}"
    draft.lines.append(Line(old.span, written, f"@{old.kind} {chosen}"))
    draft.configuration = changed


def _name(draft: _Draft, module: Symbol) -> None:
    known = draft.configuration.modules
    added = Name(module.string, draft.configuration.span)
    draft.names((*known, added), module.string, added=True)


def _unname(draft: _Draft, module: Symbol) -> None:
    kept = [name for name in draft.configuration.modules if name.text != module.string]
    draft.names(kept, module.string, added=False)


def _rename(draft: _Draft, old: Symbol, new: Symbol) -> None:
    from clingo import Number  # noqa: PLC0415 -- the name means another thing above

    for number, stated in list(draft.relationships.items()):
        ends = ends_of(stated)
        if old.string in ends:
            first, second = (new.string if end == old.string else end for end in ends)
            draft.relationship(Number(number), _between(stated, first, second))


def _annotate(draft: _Draft, module: Symbol, word: Symbol) -> None:
    span = draft.modules[module.string].span
    match word.string:
        case "DataOut":
            mode = Mode("NotifyWhenReady", text="NotifyWhenReady")
            draft.annotation(module.string, None, Service("DataOut", span, modes=(mode,)))
        case "ControlOut":
            draft.annotation(module.string, None, Service("ControlOut", span))
        case function:
            draft.annotation(module.string, None, Function(function, span))


def _remove(draft: _Draft, number: Symbol) -> None:
    name, annotation = draft.annotations[number.number]
    draft.annotation(name, annotation, None)


def _declare(draft: _Draft, source: Symbol, target: Symbol) -> None:
    span = draft.configuration.span
    name = _free_name(draft.modules)
    converter = Service("Converts", span, "convert", target.string, (source.string,))
    module = Module(name, span, (converter,))
    draft.modules[name] = module
    draft.configuration = replace(
        draft.configuration, declared=(*draft.configuration.declared, module)
    )
    draft.lines.append(Line(span, None, f"@Converts {target.string} f({source.string} x);"))


_EDITS: dict[tuple[str, int], Callable[..., None]] = {
    ("require", 3): _require,
    ("offer", 3): _offer,
    ("redirect", 3): _redirect,
    ("swap", 1): _swap,
    ("drop", 1): _drop,
    ("relate", 2): _relate,
    ("rank", 2): _rank,
    ("vertex", 2): _vertex,
    ("architecture", 1): _architecture,
    ("name", 1): _name,
    ("unname", 1): _unname,
    ("rename", 2): _rename,
    ("annotate", 2): _annotate,
    ("remove", 1): _remove,
    ("declare", 2): _declare,
}


def _between(relationship: Relationship, first: str, second: str) -> Relationship:
    match relationship:
        case Data():
            return replace(relationship, client=first, source=second)
        case Control():
            return replace(relationship, controlled=first, controller=second)
        case Mount():
            return replace(relationship, mounting=first, mounted=second)


def _hertz(rate: Symbol) -> Decimal | None:
    return Decimal(rate.number) / 1000 if rate.type == SymbolType.Number else None


def _annotation_text(annotation: Service | Function) -> str:
    if isinstance(annotation, Function):
        return f"@{annotation.name}"
    words = [f"@{annotation.kind}", ", ".join(mode.text or mode.name for mode in annotation.modes)]
    if annotation.hz is not None:
        words.append(print_number(annotation.hz))
    return " ".join(word for word in (*words, *annotation.commands) if word)


def _free_name(taken: Iterable[str]) -> str:
    known = set(taken)
    return next(name for name in _names("Converter") if name not in known)


def _names(stem: str) -> Iterator[str]:
    number = 1
    while True:
        yield f"{stem}{number}"
        number += 1
