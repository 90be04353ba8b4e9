"""Canonical text of configurations and specifications, as the figures of the paper print them."""

from collections.abc import Iterable, Iterator
from decimal import Decimal

from mars_asp.language.parse import ABSTRACT, IMPORTED, NOT_ALL_READ, OF_MUX, OF_PACK
from mars_asp.model.attributes import Attribute
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Function,
    Gating,
    Hold,
    Limit,
    Lock,
    Mode,
    Module,
    Mount,
    Relationship,
    Service,
    Strategy,
    Transformation,
    ends_of,
    ports_of,
    verb_of,
)
from mars_asp.model.names import end, quoted, written
from mars_asp.model.ports import parameter_names
from mars_asp.model.rates import as_written

WIDTH = 72
#: Words of C++ types, which are never names of parameters.
_TYPE_WORDS = frozenset(
    "auto bool char class const double enum float inline int long mutable register short signed"
    " static struct this typename union unsigned void volatile self".split()
)


def print_configuration(configuration: Configuration) -> str:
    """Return a configuration or specification as text, with its module blocks at the end."""
    return "".join(f"{line}\n" for line in _configuration_lines(configuration))


def print_module(module: Module) -> str:
    """Return the block of a module, without a final line end."""
    return "\n".join(_block(module))


def print_relationship(relationship: Relationship) -> str:
    """Return the line of a relationship."""
    left, right = map(end, ends_of(relationship), ports_of(relationship))
    words = [left, verb_of(relationship), right]
    match relationship:
        case Data(_, _, _, mode, hz):
            words += () if mode is None else (print_mode(mode),)
            words += () if hz is None else (as_written(hz),)
        case Control(_, _, _, priority, hold, allocation):
            words += [*_number_words(priority), *_after("hold", hold)]
            words += _after("allocation", allocation)
        case Mount(_, _, _, at, on, transformation):
            words = [left, *_number_words(at), verb_of(relationship), right, *_number_words(on)]
            if transformation is not None:
                words.append(transformation.text or print_transformation(transformation))
        case Gating(ms=ms):
            words.append(str(ms))
        case Lock(_, _, _, priority, hold):
            words += [*_number_words(priority), *_after("hold", hold)]
        case Limit(hold_ms=hold):
            words += _after("hold", hold)
        case Strategy(_, _, strategy, period):
            words = [left, verb_of(relationship), strategy, *_after("period", period)]
    return " ".join(words)


def print_attribute(attribute: Attribute) -> str:
    """Return the annotation of an attribute."""
    after = "" if attribute.value is None else f" {attribute.value}"
    return f"@{attribute.word} {attribute.name}{after}"


def print_mode(mode: Mode) -> str:
    """Return a delivery mode in its original spelling, else in the canonical one."""
    arguments = [print_number(argument) for argument in mode.arguments]
    if mode.of is not None:
        arguments.append(f"of={mode.of}")
    return mode.text or (f"{mode.name}({', '.join(arguments)})" if arguments else mode.name)


def print_transformation(transformation: Transformation) -> str:
    """Return a tuple of seven slots, with `_` for each rotation or shift of zero."""
    turns = [slot for axis, turn in transformation.rotations for slot in (axis, print_number(turn))]
    shift = [print_number(length) if length else "_" for length in transformation.translation]
    return f"({','.join([*turns, *'____'[len(turns) :], *shift])})"


def print_number(number: Decimal) -> str:
    """Return a number without exponent and trailing zeros; zero has no sign."""
    text = format(number or abs(number), "f")
    return text.rstrip("0").rstrip(".") if "." in text else text


def fill(head: str, parts: Iterable[str]) -> Iterator[str]:
    """Yield the lines of a list that begins with `head`, broken between `parts`.

    No further line begins with `@`, as an annotation would.
    """
    line = head
    for part in parts:
        if len(line) + 1 + len(part) > WIDTH and line != head and not part.startswith("@"):
            yield line
            line = part
        else:
            line = f"{line} {part}"
    yield line


def _configuration_lines(configuration: Configuration) -> Iterator[str]:
    header = f"@{configuration.kind}"
    if configuration.declares_architecture:
        header += f" {configuration.architecture}"
    if configuration.period_ms is not None:
        header += f" period {configuration.period_ms}"
    yield header
    if configuration.sources:
        paths = [name.text for name in configuration.sources]
        yield from fill("@sources", [*(f"{path}," for path in paths[:-1]), *paths[-1:]])
    for include in configuration.includes:
        after = "" if include.name is None else f" as {written(include.name)}"
        yield f"@include {include.path}{after}"
    names = [
        written(name.text) + ("" if name.described is None else f": {written(name.described)}")
        for name in configuration.modules
    ]
    if names or not configuration.includes:
        yield from fill("@modules", [*(f"{name}," for name in names[:-1]), *names[-1:]])
    yield from _origins(configuration)
    conversions = {c.transformer: c for c in configuration.conversions}
    modules = {each.node: each.module for each in configuration.stand_ins if not each.evident}
    brought = _packs(configuration)
    for relationship in configuration.relationships:
        fed = ends_of(relationship)[0]
        if not isinstance(relationship, Mount) and fed in brought:
            yield f"// {written(fed)}: {OF_PACK} {brought.pop(fed)}"
        if isinstance(relationship, Data) and relationship.client in conversions:
            made = conversions[relationship.client]
            converter = ABSTRACT if made.converter is None else written(made.converter)
            yield f"// {made.transformer}: {converter} ({made.source} -> {made.target})"
        if isinstance(relationship, Control) and relationship.controlled in modules:
            node = relationship.controlled
            yield f"// {node}: {written(modules.pop(node))}"
        yield print_relationship(relationship)
    for each in configuration.attributed:
        yield f"{written(each.module)} {print_attribute(each.attribute)}"
    for module in configuration.declared:
        yield ""
        yield print_module(module)


def _origins(configuration: Configuration) -> Iterator[str]:
    """Yield comments about the foreign files of an imported configuration, which `parse` reads."""
    if configuration.origin is None:
        return
    yield f"// {IMPORTED} {configuration.origin}"
    for name in configuration.opaque:
        yield f"// {written(name.text)}: {NOT_ALL_READ}"
    for mux in configuration.muxes:
        own = "" if not mux.name or mux.name == mux.engine else f", {written(mux.name)}"
        yield f"// {written(mux.module)}: {OF_MUX} {mux.engine}{own}"


def _packs(configuration: Configuration) -> dict[str, str]:
    """Return the rule packs that provide the nodes of a specification, by node."""
    if configuration.kind != "specification":
        return {}
    kinds = {name.text: configuration.pack_kind(name.text) for name in configuration.modules}
    return {name: kind.pack for name, kind in kinds.items() if kind is not None}


def _number_words(number: int | None) -> tuple[str, ...]:
    return () if number is None else (str(number),)


def _after(word: str, value: Hold | str | None) -> tuple[str, ...]:
    return () if value is None else (word, str(value))


def _block(module: Module) -> Iterator[str]:
    yield "@module_start"
    yield f"@module_name {written(module.name)}"
    if module.guard is not None:
        yield "@Guard"
    yield from map(print_attribute, module.attributes)
    for function in module.functions:
        yield _function_line(function)
    for vertex in module.vertices:
        yield f"@Vertex {vertex.number} {print_transformation(vertex.transformation)}"
    for service in module.services:
        yield from _service(service)
    yield "@module_end"


def _function_line(function: Function) -> str:
    words = [
        "_" if value is None else print_number(value)
        for value in (function.min, function.max, function.rate)
    ]
    while words and words[-1] == "_":
        words.pop()
    return " ".join([f"@{function.name}", *words, *(["_"] if len(words) == 1 else ())])


def _service(service: Service) -> Iterator[str]:
    """Yield the lines of a service: its annotations and a declaration."""
    modes = [print_mode(mode) for mode in service.modes]
    if service.hz is not None:
        periodic = [mode.name for mode in service.modes].index("NotifyAtFrequency")
        modes[periodic] += f" {as_written(service.hz)}"
    text = ", ".join((*modes, *service.commands))
    if service.kind == "Done":
        text = ""
    if service.kind == "Converts":
        text = str(service.cost)
    yield f"@{service.kind} {text}".rstrip()
    if service.port is not None:
        yield f"@Port {written(service.port)}"
    if service.window_ms is not None:
        yield f"@Window {service.window_ms}"
    yield f"@Output {service.output or 'none'}"
    inputs = [representation or "auto" for representation in service.inputs]
    names = service.parameters
    if any(name is not None and not _is_parameter(name) for name in names):
        for name, representation in zip(parameter_names(service), inputs, strict=True):
            yield f"@Input {quoted(name)}: {representation}"
        names = ()
    else:
        yield f"@Input {', '.join(inputs) or 'none'}"
    parameters = [f"auto {name or ''}".rstrip() for name in names] if any(names) else []
    yield f"void {service.function}({', '.join(parameters)});"


def _is_parameter(name: str) -> bool:
    """Whether a declaration can have a parameter of this name."""
    return name.isascii() and name.isidentifier() and name not in _TYPE_WORDS
