"""Specifications with random changes of lines and of blocks, harmless ones among them."""

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import TypeAlias

from mars_asp.model.declarations import (
    NODE_NAMES,
    Configuration,
    Control,
    Data,
    Function,
    Mode,
    Module,
    Name,
    NodeKind,
    Service,
    Transformation,
    Vertex,
    node_kind,
)
from mars_asp.model.modes import parse_mode
from tests.support.random_configurations import CONDITIONS

PRIORITIES = (None, 0, 1, 2, 3, 42000, 46340, 46341, 65536, 2147483646, 2147483647)
Change: TypeAlias = Callable[[Configuration, random.Random], Configuration | None]


def mutant(specification: Configuration, rng: random.Random) -> tuple[str, Configuration]:
    """Return a specification with one or two random changes, and the names of these.

    Half of the changes are to blocks, where there are any.
    """
    names = []
    changes = rng.choice([CHANGES, (*CHANGES_OF_BLOCKS,)])
    for change in (*rng.sample(changes, len(changes)), *CHANGES):
        changed = change(specification, rng)
        if changed is not None:
            names.append(change.__name__)
            specification = changed
        if names and rng.random() < 0.75:
            break
    return ", ".join(names), specification


def lines_of(specification: Configuration) -> list[Data | Control]:
    return [line for line in specification.relationships if isinstance(line, Data | Control)]


def with_lines(specification: Configuration, lines: Sequence[Data | Control]) -> Configuration:
    """Return a specification with other lines of data and control beside all others."""
    others = [r for r in specification.relationships if not isinstance(r, Data | Control)]
    named = {name.text for name in specification.modules}
    ends = [end for line in lines for end in _ends(line)]
    new = [Name(end, specification.span) for end in dict.fromkeys(ends) if end not in named]
    modules = (*specification.modules, *new)
    return replace(specification, modules=modules, relationships=(*others, *lines))


def _ends(line: Data | Control) -> tuple[str, str]:
    if isinstance(line, Data):
        return line.source, line.client
    return line.controller, line.controlled


def _joined(line: Data | Control, source: str, client: str) -> Data | Control:
    if isinstance(line, Data):
        return replace(line, source=source, client=client)
    return replace(line, controller=source, controlled=client)


def _new_node(specification: Configuration, kind: NodeKind) -> str:
    taken = {name.text for name in specification.modules}
    names = (f"{NODE_NAMES[kind]}{number}" for number in range(2, 100))
    return next(name for name in names if name not in taken)


def _some_line(
    specification: Configuration, rng: random.Random
) -> tuple[list[Data | Control], int] | None:
    lines = lines_of(specification)
    return (lines, rng.randrange(len(lines))) if lines else None


# ---- Changes: each returns nothing where there is nothing for it to change ----


def drop_a_line(specification: Configuration, rng: random.Random) -> Configuration | None:
    if (some := _some_line(specification, rng)) is None:
        return None
    lines, at = some
    return with_lines(specification, [*lines[:at], *lines[at + 1 :]])


def swap_ends(specification: Configuration, rng: random.Random) -> Configuration | None:
    if (some := _some_line(specification, rng)) is None:
        return None
    lines, at = some
    source, client = _ends(lines[at])
    lines[at] = _joined(lines[at], client, source)
    return with_lines(specification, lines)


def exchange(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Exchange the sources or the clients of two lines of one kind."""
    lines = lines_of(specification)
    pairs = [
        (a, b)
        for a in range(len(lines))
        for b in range(a)
        if type(lines[a]) is type(lines[b]) and _ends(lines[a]) != _ends(lines[b])
    ]
    if not pairs:
        return None
    a, b = rng.choice(pairs)
    (source, client), (other, beside) = _ends(lines[a]), _ends(lines[b])
    if rng.random() < 0.5:
        source, other = other, source
    else:
        client, beside = beside, client
    lines[a], lines[b] = _joined(lines[a], source, client), _joined(lines[b], other, beside)
    return with_lines(specification, lines)


def reroute(specification: Configuration, rng: random.Random) -> Configuration | None:
    if (some := _some_line(specification, rng)) is None:
        return None
    lines, at = some
    source, client = _ends(lines[at])
    name = rng.choice(specification.modules).text
    ends = (name, client) if rng.random() < 0.7 else (source, name)
    if ends == (source, client) or ends[0] == ends[1]:
        return None
    lines[at] = _joined(lines[at], *ends)
    return with_lines(specification, lines)


def add_a_line(specification: Configuration, rng: random.Random) -> Configuration | None:
    if (some := _some_line(specification, rng)) is None:
        return None
    lines, at = some
    source, client = _ends(lines[at])
    name = rng.choice(specification.modules).text
    ends = (source, name) if rng.random() < 0.5 else (name, client)
    if ends[0] == ends[1] or any(ends == _ends(line) for line in lines):
        return None
    return with_lines(specification, [*lines, _joined(lines[at], *ends)])


def change_a_priority(specification: Configuration, rng: random.Random) -> Configuration | None:
    lines = lines_of(specification)
    ranked = [k for k, line in enumerate(lines) if isinstance(line, Control)]
    into = [k for k in ranked if node_kind(_ends(lines[k])[1]) == "arbitration_node"]
    if not ranked:
        return None
    at = rng.choice(into or ranked)
    line = lines[at]
    assert isinstance(line, Control)
    rank = line.priority or 0
    near = (rank + 1, max(rank - 1, 0))
    lines[at] = replace(line, priority=rng.choice([*PRIORITIES, *near, *near]))
    return with_lines(specification, lines)


def change_an_order(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Reverse, level or stretch the priorities of an arbiter."""
    lines = lines_of(specification)
    arbiters = {
        line.controlled
        for line in lines
        if isinstance(line, Control) and node_kind(line.controlled) == "arbitration_node"
    }
    if not arbiters:
        return None
    arbiter = rng.choice(sorted(arbiters))
    into = [k for k, line in enumerate(lines) if _ends(line)[1] == arbiter]
    ranks = sorted({_priority(lines[k]) for k in into})
    how = rng.choice(["reverse", "level", "stretch"])
    far = sorted(rng.sample(range(2147483648), len(ranks) - 1))
    for k in into:
        place = ranks.index(_priority(lines[k]))
        rank = {
            "reverse": ranks[-1 - place],
            "level": ranks[0],
            "stretch": [0, *far][place],
        }[how]
        line = lines[k]
        assert isinstance(line, Control)
        lines[k] = replace(line, priority=rank)
    return with_lines(specification, lines)


def _priority(line: Data | Control) -> int:
    return (line.priority or 0) if isinstance(line, Control) else 0


def put_a_node_between(specification: Configuration, rng: random.Random) -> Configuration | None:
    if (some := _some_line(specification, rng)) is None:
        return None
    lines, at = some
    line = lines[at]
    source, client = _ends(line)
    data: tuple[NodeKind, ...] = ("data_splitter", "data_transformer")
    control: tuple[NodeKind, ...] = ("arbitration_node", "control_splitter", "inheritance_node")
    node = _new_node(specification, rng.choice(data if isinstance(line, Data) else control))
    before = _joined(line, source, node)
    if rng.random() < 0.7 and isinstance(before, Data):
        before = replace(before, mode=None, hz=None)
    lines[at] = _joined(line, node, client)
    return with_lines(specification, [*lines, before])


def leave_a_node_out(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Join the only input of a node with its outputs."""
    lines = lines_of(specification)
    clients = [_ends(line)[1] for line in lines]
    nodes = sorted(n for n in set(clients) if node_kind(n) and clients.count(n) == 1)
    if not nodes:
        return None
    node = rng.choice(nodes)
    (source,) = (_ends(line)[0] for line in lines if _ends(line)[1] == node)
    left = []
    for line in lines:
        here, client = _ends(line)
        if client != node:
            left.append(_joined(line, source, client) if here == node else line)
    return with_lines(specification, left)


def merge_nodes(specification: Configuration, rng: random.Random) -> Configuration | None:
    lines = lines_of(specification)
    nodes = sorted({end for line in lines for end in _ends(line) if node_kind(end)})
    pairs = [(a, b) for a in nodes for b in nodes if a < b and node_kind(a) == node_kind(b)]
    if not pairs:
        return None
    one, other = rng.choice(pairs)
    return with_lines(
        specification,
        [_joined(k, *(one if end == other else end for end in _ends(k))) for k in lines],
    )


def change_a_service(specification: Configuration, rng: random.Random) -> Configuration | None:
    lines = lines_of(specification)
    carried = [k for k, line in enumerate(lines) if isinstance(line, Data)]
    if not carried:
        return None
    at = rng.choice(carried)
    line = lines[at]
    assert isinstance(line, Data)
    words = rng.choice([*CONDITIONS, " NotifyAtFrequency 20", " NotifyAtFrequency 25"]).split()
    mode = parse_mode(words[0]) if words else None
    assert mode is None or isinstance(mode, Mode)
    hz = Fraction(words[1]) if len(words) > 1 else None
    if rng.random() < 0.3 and mode is not None:
        mode, hz = line.mode, Fraction(rng.choice(["0.1", "9", "10", "11", "1000"]))
        if mode is None or mode.name != "NotifyAtFrequency":
            return None
    if (mode, hz) == (line.mode, line.hz):
        return None
    lines[at] = replace(line, mode=mode, hz=hz)
    return with_lines(specification, lines)


def change_a_conversion(specification: Configuration, rng: random.Random) -> Configuration | None:
    result = list(specification.conversions)
    if not result:
        return None
    at = rng.randrange(len(result))
    how = rng.random()
    if how < 0.4:
        del result[at]
    elif how < 0.8 and len(result) > 1:
        other = rng.choice([k for k in range(len(result)) if k != at])
        one, two = result[at].transformer, result[other].transformer
        result[at] = replace(result[at], transformer=two)
        result[other] = replace(result[other], transformer=one)
    else:
        services = [
            (module.name, str(service.inputs[0]), str(service.output))
            for module in specification.declared
            for service in module.services
            if service.kind == "Converts"
        ]
        if not services:
            return None
        name, given, made = rng.choice(services)
        result[at] = replace(result[at], converter=name, source=given, target=made)
    return replace(specification, conversions=tuple(result))


def add_a_provider(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Let an InheritanceNode feed one module more, through an ArbitrationNode where need be."""
    lines = lines_of(specification)
    nodes = sorted(
        {line.controller for line in lines if isinstance(line, Control)}
        & {n.text for n in specification.modules if node_kind(n.text) == "inheritance_node"}
    )
    if not nodes:
        return None
    node = rng.choice(nodes)
    name = rng.choice([n.text for n in specification.modules if node_kind(n.text) is None])
    at = [
        k for k, line in enumerate(lines) if isinstance(line, Control) and line.controlled == name
    ]
    pattern = next(line for line in lines if isinstance(line, Control))
    rank = rng.randint(0, 3)
    into = name
    if at:
        before = _ends(lines[at[0]])[0]
        into = before if node_kind(before) == "arbitration_node" else ""
        if not into:
            into = _new_node(specification, "arbitration_node")
            lines[at[0]] = _joined(lines[at[0]], into, name)
            lines.append(replace(pattern, controlled=into, controller=before, priority=0))
    fed = replace(pattern, controlled=into, controller=node, priority=rank, hold_ms=None)
    return with_lines(specification, [*lines, fed])


def drop_a_provider(specification: Configuration, rng: random.Random) -> Configuration | None:
    lines = lines_of(specification)
    fed = [k for k, k_line in enumerate(lines) if node_kind(_ends(k_line)[0]) == "inheritance_node"]
    if not fed:
        return None
    at = rng.choice(fed)
    return with_lines(specification, [*lines[:at], *lines[at + 1 :]])


# ---- Changes of blocks ----


def _with_blocks(specification: Configuration, blocks: Sequence[Module]) -> Configuration:
    return replace(specification, declared=tuple(blocks))


def _change_block(
    specification: Configuration,
    rng: random.Random,
    fits: Callable[[Module], bool],
    change: Callable[[Module], Module],
) -> Configuration | None:
    """Change one of the blocks that fit."""
    blocks = list(specification.declared)
    some = [at for at, module in enumerate(blocks) if fits(module)]
    if not some:
        return None
    at = rng.choice(some)
    blocks[at] = change(blocks[at])
    return _with_blocks(specification, blocks)


def _change_service(
    specification: Configuration,
    rng: random.Random,
    fits: Callable[[Service], bool],
    change: Callable[[Service], Service],
) -> Configuration | None:
    """Change one service that fits, of one of the blocks that have any."""

    def changed(module: Module) -> Module:
        services = list(module.services)
        at = rng.choice([at for at, service in enumerate(services) if fits(service)])
        services[at] = change(services[at])
        return replace(module, services=tuple(services))

    return _change_block(specification, rng, lambda m: any(map(fits, m.services)), changed)


def _delivers(service: Service) -> bool:
    return service.kind in ("Sense", "DataOut")


def change_offered_modes(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Reverse the modes of an output, or replace them: by the same ones now and then."""

    def changed(service: Service) -> Service:
        if len(service.modes) > 1 and rng.random() < 0.5:
            return replace(service, modes=service.modes[::-1])
        mode = parse_mode(rng.choice(["NotifyWhenReady", "RequestWhenReady", "NotifyOnMax(80)"]))
        assert isinstance(mode, Mode)
        return replace(service, modes=(mode,), hz=None)

    return _change_service(specification, rng, _delivers, changed)


def change_an_offered_rate(
    specification: Configuration, rng: random.Random
) -> Configuration | None:
    rate = Fraction(rng.choice(["0.3", "5", "10", "20", "25", "1000/17"]))
    return _change_service(
        specification, rng, lambda s: s.hz is not None, lambda s: replace(s, hz=rate)
    )


def change_a_representation(
    specification: Configuration, rng: random.Random
) -> Configuration | None:
    name = rng.choice("PQR")

    def changed(service: Service) -> Service:
        if service.inputs and rng.random() < 0.7:
            at = rng.randrange(len(service.inputs))
            inputs = (*service.inputs[:at], name, *service.inputs[at + 1 :])
            return replace(service, inputs=inputs)
        return service if service.output is None else replace(service, output=name)

    return _change_service(specification, rng, lambda s: s.kind != "ControlOut", changed)


def rename_a_port(specification: Configuration, rng: random.Random) -> Configuration | None:
    def changed(service: Service) -> Service:
        if not _delivers(service) or (service.parameters and rng.random() < 0.5):
            return replace(service, parameters=("renamed", *service.parameters[1:]))
        return replace(service, port="renamed")

    return _change_service(specification, rng, _is_named, changed)


def _is_named(service: Service) -> bool:
    return _delivers(service) or bool(service.parameters)


def change_an_annotation(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Change the class of a module, the functions that it commands or the cost of a converter."""

    def changed(service: Service) -> Service:
        if service.kind == "Converts":
            return replace(service, cost=rng.choice([service.cost, 7]))
        if service.kind == "ControlOut":
            commands = tuple(rng.sample(["Rotn_Y", "Trans_Z", "Grasp"], rng.randint(0, 2)))
            return replace(service, commands=commands)
        other: dict[str, str] = {"Sense": "DataOut", "DataOut": "Sense", "DataIn": "ControlOut"}
        return replace(service, kind=other[service.kind])  # type: ignore[arg-type]

    return _change_service(specification, rng, lambda s: True, changed)


def drop_or_double_a_service(
    specification: Configuration, rng: random.Random
) -> Configuration | None:
    def changed(module: Module) -> Module:
        at = rng.randrange(len(module.services))
        twice = (replace(module.services[at], function="again", port=None),)
        own = module.services
        kept = own + twice if rng.random() < 0.5 else own[:at] + own[at + 1 :]
        return replace(module, services=kept)

    return _change_block(specification, rng, lambda m: bool(m.services), changed)


def change_the_guard(specification: Configuration, rng: random.Random) -> Configuration | None:
    return _change_block(
        specification,
        rng,
        lambda module: True,
        lambda module: replace(module, guard=module.span if module.guard is None else None),
    )


def change_a_motion(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Change the limits of a motion, or drop it."""

    def changed(module: Module) -> Module:
        first, *others = module.functions
        if rng.random() < 0.5:
            return replace(module, functions=tuple(others))
        limit = rng.choice([None, Decimal(90), Decimal("90.0")])
        return replace(module, functions=(replace(first, max=limit), *others))

    return _change_block(specification, rng, lambda m: bool(m.functions), changed)


def add_a_motion(specification: Configuration, rng: random.Random) -> Configuration | None:
    def changed(module: Module) -> Module:
        return replace(module, functions=(*module.functions, Function("Trans_Y", module.span)))

    return _change_block(
        specification, rng, lambda m: all(f.name != "Trans_Y" for f in m.functions), changed
    )


def move_a_vertex(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Move vertex 0, to where it is anyway now and then."""
    shift = Decimal(rng.choice([0, 0, 30]))
    pose = Transformation(translation=(Decimal(0), shift, Decimal(0)))
    return _change_block(
        specification,
        rng,
        lambda module: all(vertex.number for vertex in module.vertices),
        lambda m: replace(m, vertices=(*m.vertices, Vertex(0, pose, m.span))),
    )


def change_an_instance(specification: Configuration, rng: random.Random) -> Configuration | None:
    names = list(specification.modules)
    known = [module.name for module in specification.declared]
    if not known or not names:
        return None
    at = rng.randrange(len(names))
    names[at] = replace(names[at], described=rng.choice([names[at].text, *known]))
    return replace(specification, modules=tuple(names))


def order_blocks_otherwise(
    specification: Configuration, rng: random.Random
) -> Configuration | None:
    """Change the order of blocks and of their annotations, which means nothing."""
    blocks = [
        replace(m, services=m.services[::-1], functions=m.functions[::-1])
        for m in specification.declared[::-1]
    ]
    # The order of functions distinguishes those of one name.
    names = [[s.port or s.function for s in module.services] for module in blocks]
    if not blocks or any(len(set(each)) < len(each) for each in names):
        return None
    return _with_blocks(specification, blocks)


def drop_a_block(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Leave a module to the configuration to describe."""
    blocks = list(specification.declared)
    if blocks:
        blocks.pop(rng.randrange(len(blocks)))
    return _with_blocks(specification, blocks)


def describe_a_module(specification: Configuration, rng: random.Random) -> Configuration | None:
    """Describe a source that the configuration may not describe."""
    described = {module.name for module in specification.declared}
    free = sorted(
        {line.source for line in lines_of(specification) if isinstance(line, Data)} - described
    )
    free = [name for name in free if node_kind(name) is None]
    if not free:
        return None
    span = specification.span
    mode = parse_mode(rng.choice(["NotifyWhenReady", "NotifyAtFrequency", "NotifyOnMax(80)"]))
    assert isinstance(mode, Mode)
    hz = Fraction(rng.choice([5, 10])) if mode.name == "NotifyAtFrequency" else None
    service = Service("Sense", span, "look", "P", modes=(mode,), hz=hz)
    block = Module(rng.choice(free), span, (service,))
    return _with_blocks(specification, [*specification.declared, block])


CHANGES_OF_BLOCKS: Sequence[Change] = (
    change_offered_modes,
    change_an_offered_rate,
    change_a_representation,
    rename_a_port,
    change_an_annotation,
    drop_or_double_a_service,
    change_the_guard,
    change_a_motion,
    add_a_motion,
    move_a_vertex,
    change_an_instance,
    order_blocks_otherwise,
    drop_a_block,
    describe_a_module,
    describe_a_module,
)
CHANGES: Sequence[Change] = (
    drop_a_line,
    swap_ends,
    exchange,
    reroute,
    add_a_line,
    change_a_priority,
    change_a_priority,
    change_an_order,
    put_a_node_between,
    put_a_node_between,
    leave_a_node_out,
    merge_nodes,
    change_a_service,
    change_a_service,
    change_a_conversion,
    add_a_provider,
    drop_a_provider,
)
