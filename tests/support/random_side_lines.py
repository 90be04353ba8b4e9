"""Random small configurations with gates, resets, locks, limits and strategies, and mutants."""

import random
from collections.abc import Callable
from dataclasses import replace

from mars_asp.language.print import print_relationship
from mars_asp.model.declarations import (
    Configuration,
    Control,
    Data,
    Gating,
    Limit,
    Lock,
    Relationship,
    Reset,
    Sign,
    Strategy,
    StrategyName,
    node_kind,
)

TIMES = (100, 200, 300)


def random_side_lines(seed: int, typed: bool = False) -> str:
    """Return a configuration; where it is `typed`, sources and clients have representations."""
    rng = random.Random(f"side lines {seed}")
    sources = [f"S{n}" for n in range(rng.randint(1, 3))]
    clients = [f"C{n}" for n in range(rng.randint(1, 3))]
    drivers = [f"D{n}" for n in range(rng.randint(1, 3))]
    wheels = [f"W{n}" for n in range(rng.randint(1, 2))]
    lines: dict[str, None] = {}
    inputs: list[str] = []
    for client in clients:
        named = rng.random() < 0.5
        for n, source in enumerate(rng.sample(sources, rng.randint(1, min(2, len(sources))))):
            end = f"{client}.i{n}" if named else client
            inputs += [end] if named else []
            lines[f"{end} uses_data_from {source}"] = None
    fed = sorted({line.split()[2] for line in lines})
    steering = _control(rng, drivers, wheels, lines)
    for _ in range(rng.randint(0, 3)):
        gated, word = rng.choice(fed), rng.choice(["is_suppressed_by", "is_inhibited_by"])
        if inputs and rng.random() < 0.4:
            gated, word = rng.choice(inputs), "is_suppressed_by"
        elif steering and rng.random() < 0.4:
            gated = rng.choice(steering)
        by_command = gated in steering or (word == "is_inhibited_by" and rng.random() < 0.2)
        others = [o for o in (steering if by_command else fed) if o != gated]
        if not others:
            continue
        trigger = rng.choice(others)
        if not any(line.startswith(f"{gated} {word} {trigger} ") for line in lines):
            lines[f"{gated} {word} {trigger} {rng.choice(TIMES)}"] = None
    if rng.random() < 0.3:
        lines[f"{rng.choice(clients)} is_reset_by {rng.choice(fed)}"] = None
    _bounds(rng, wheels, fed, steering, lines)
    order = list(lines)
    rng.shuffle(order)
    names = [*sources, *clients, *drivers, *wheels]
    kind = rng.choice([" hierarchical", " hierarchical", ""])
    blocks = _blocks(rng, fed, clients, order) if typed else []
    return "\n".join([f"@configuration{kind}", f"@modules {', '.join(names)}", *order, *blocks, ""])


def random_names(seed: int) -> str:
    """Return a configuration with names that only its side lines mention."""
    rng = random.Random(f"names {seed}")
    ends = ["Filter", "Nav"]
    names = [f"N{n}" for n in range(rng.randint(1, 3))]
    lines = ["Map uses_data_from Filter", "Base is_controlled_by Nav 1"]
    for name in rng.choices(names, k=rng.randint(2, 6)):
        word = rng.choice(["suppressed", "inhibited", "inhibited", "reset", "locked", "limited"])
        if word in ("suppressed", "inhibited"):
            gated = rng.choice([end for end in (*ends, *names) if end != name])
            lines.append(f"{gated} is_{word}_by {name} {rng.choice(TIMES)}")
        else:
            lines.append(f"{'Nav' if word == 'reset' else 'Base'} is_{word}_by {name}")
    rng.shuffle(lines)
    modules = ", ".join(["Map", "Base", *ends, *names])
    return "\n".join(["@configuration hierarchical", f"@modules {modules}", *lines, ""])


def _control(
    rng: random.Random, drivers: list[str], wheels: list[str], lines: dict[str, None]
) -> list[str]:
    """Add control lines, and return the controllers."""
    used = set()
    for wheel in wheels:
        for driver in rng.sample(drivers, rng.randint(1, len(drivers))):
            hold = rng.choice(["", "", " hold 50"])
            lines[f"{wheel} is_controlled_by {driver} {rng.randint(0, 2)}{hold}"] = None
            used.add(driver)
    return sorted(used)


def _bounds(
    rng: random.Random,
    wheels: list[str],
    fed: list[str],
    steering: list[str],
    lines: dict[str, None],
) -> None:
    alike = rng.random() < 0.5
    priority, hold = rng.choice(["", " 1", " 2"]), rng.choice(["", " hold 500"])
    lock, limiter = rng.choice(fed), rng.choice(steering)
    mean = rng.choice(["flat", "weighted"])
    strategies = ["latest", f"{mean} period 30", "hierarchical", mean, f"{mean} period 100"]
    strategy = rng.choice(strategies)
    for wheel in wheels:
        if not alike:
            priority, lock = rng.choice(["", " 1", " 2"]), rng.choice(fed)
            strategy = rng.choice(strategies)
        if rng.random() < 0.6:
            lines[f"{wheel} is_locked_by {lock}{priority}{hold}"] = None
        if rng.random() < 0.2:
            lines[f"{wheel} is_limited_by {limiter}"] = None
        if rng.random() < 0.4:
            lines[f"{wheel} is_arbitrated_by {strategy}"] = None


def _blocks(rng: random.Random, fed: list[str], clients: list[str], lines: list[str]) -> list[str]:
    """Return descriptions of sources and clients, and converters between all representations."""
    kinds = ["P", "Q", "bool"]
    blocks = [
        f"@module_start\n@module_name {each}\n@DataOut NotifyWhenReady\n"
        f"{rng.choice(kinds)} say();\n@module_end"
        for each in fed
    ]
    unnamed = [c for c in clients if not any(line.startswith(f"{c}.") for line in lines)]
    for client in unnamed:
        if sum(line.startswith(f"{client} uses_data_from") for line in lines) == 1:
            blocks.append(
                f"@module_start\n@module_name {client}\n@DataIn\n"
                f"void take({rng.choice(kinds)} x);\n@module_end"
            )
    turns = [(a, b) for a in kinds for b in kinds if a != b]
    for n, (given, made) in enumerate(turns):
        blocks.append(
            f"@module_start\n@module_name K{n}\n@Converts {rng.randint(1, 3)}\n"
            f"{made} turn({given} x);\n@module_end"
        )
    return blocks


def changed(specification: Configuration, rng: random.Random) -> tuple[str, Configuration]:
    """Return a specification with one change, and what was changed."""
    lines = list(specification.relationships)
    change: Callable[[list[Relationship], random.Random], str] = rng.choice(
        [_dropped, _timed, _exchanged, _redirected, _added, _ranked]
    )
    what = change(lines, rng)
    return what, replace(specification, relationships=tuple(lines))


def _dropped(lines: list[Relationship], rng: random.Random) -> str:
    line = lines.pop(rng.randrange(len(lines)))
    return f"without {print_relationship(line)}"


def _timed(lines: list[Relationship], rng: random.Random) -> str:
    """Change a time, sign, priority or strategy of a side line."""
    places = [n for n, r in enumerate(lines) if isinstance(r, Gating | Lock | Limit | Strategy)]
    if not places:
        return "unchanged"
    place = rng.choice(places)
    line = lines[place]
    match line:
        case Gating():
            turned: Sign = "inhibit" if line.sign == "suppress" else "suppress"
            either = (replace(line, ms=line.ms + 1), replace(line, sign=turned))
            lines[place] = rng.choice(either)
        case Lock(priority=priority):
            raised = None if priority else 2
            lines[place] = rng.choice(
                (replace(line, priority=raised), replace(line, hold_ms=(line.hold_ms or 0) + 7))
            )
        case Limit():
            lines[place] = replace(line, hold_ms=(line.hold_ms or 0) + 7)
        case Strategy():
            other: StrategyName = "latest" if line.strategy == "flat" else "flat"
            lines[place] = replace(line, strategy=other)
    return f"{print_relationship(line)} as {print_relationship(lines[place])}"


def _ends(line: Relationship) -> tuple[str, str]:
    match line:
        case Data():
            return "client", "source"
        case Control():
            return "controlled", "controller"
        case Gating():
            return "gated", "trigger"
        case Reset():
            return "module", "source"
        case _:
            return "controlled", "source"


def _movable(lines: list[Relationship]) -> list[int]:
    kinds = Data | Control | Gating | Reset | Lock | Limit
    return [n for n, line in enumerate(lines) if isinstance(line, kinds)]


def _exchanged(lines: list[Relationship], rng: random.Random) -> str:
    """Let two lines take from each other's sources."""
    places = _movable(lines)
    if len(places) < 2:
        return "unchanged"
    one, other = rng.sample(places, 2)
    return _moved(lines, one, getattr(lines[other], _ends(lines[other])[1]))


def _redirected(lines: list[Relationship], rng: random.Random) -> str:
    """Let one line take from another node."""
    places = _movable(lines)
    names = {getattr(lines[n], end) for n in places for end in _ends(lines[n])}
    nodes = sorted(name for name in names if node_kind(name))
    if not nodes:
        return "unchanged"
    return _moved(lines, rng.choice(places), rng.choice(nodes))


def _moved(lines: list[Relationship], place: int, source: str) -> str:
    line = lines[place]
    if getattr(line, _ends(line)[0]) == source:
        return "unchanged"
    lines[place] = replace(line, **{_ends(line)[1]: source})  # type: ignore[arg-type]
    return f"{print_relationship(line)} as {print_relationship(lines[place])}"


def _added(lines: list[Relationship], rng: random.Random) -> str:
    """Add a trigger, reset or lock from an output that there is."""
    places = _movable(lines)
    line = lines[rng.choice(places)]
    source = getattr(line, _ends(line)[1])
    gates = [r for r in lines if isinstance(r, Gating | Reset | Lock)]
    if not gates:
        return "unchanged"
    model = rng.choice(gates)
    more = replace(model, **{_ends(model)[1]: source})
    if more in lines or source == getattr(model, _ends(model)[0]):
        return "unchanged"
    lines.append(more)
    return f"with {print_relationship(more)}"


def _ranked(lines: list[Relationship], rng: random.Random) -> str:
    places = [n for n, r in enumerate(lines) if isinstance(r, Control) and r.priority is not None]
    if not places:
        return "unchanged"
    place = rng.choice(places)
    line = lines[place]
    assert isinstance(line, Control)
    lines[place] = replace(line, priority=rng.randint(0, 3))
    return f"{print_relationship(line)} as {print_relationship(lines[place])}"
