"""Random small configurations: data with converters and services, control, both, mounts, twins."""

import random
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import pairwise

from mars_asp.language import parse_text
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS, Mount
from tests.support.motions import UnclearError, least_supports

REPRESENTATIONS = ("P", "Q", "R", "S", "T")
SERVICES = (
    "",
    "",
    "",
    " NotifyAtFrequency 10",
    " NotifyAtFrequency 5",
    " NotifyAtFrequency 0.3",
    " RequestWhenReady",
)
CONDITIONS = (*SERVICES, " NotifyOnMax(80)", " NotifyOnChange", " NotifyWhenReady")
OFFERS = (
    "NotifyAtFrequency 25",
    "NotifyAtFrequency 10",
    "NotifyWhenReady",
    "NotifyWhenReady, RequestWhenReady",
    "RequestWhenReady, NotifyAtFrequency 20",
    "RequestWhenReady, NotifyOnMax(80), NotifyAtFrequency 20",
    "NotifyOnMax(80), NotifyWhenReady",
)


#: Replacements of priorities and costs from 0 to 3, and of rates: equal, or extremes in order.
_PRIORITIES = ("0 1 2 3", "0 1 2 3", "0 50000 100000 2147483647", "0 1 46341 2147483647")
_COSTS = ("0 1 2 3", "0 1 2 3", "0 1 999999 1000000")
_WRITTEN = "0.3 5 10 20 25"
_RATES = (_WRITTEN, _WRITTEN, "0.001 0.002 1 2147483 2147483.647")


def random_configuration(seed: int) -> str:
    """Return a random configuration with its modules declared, as text.

    In some of them numbers are extreme, in the same order as small ones are in others.
    """
    rng = random.Random(f"numbers {seed}")
    text = _small_configuration(seed)
    for before, written, others in (
        (r"(is_controlled_by \w+ )", "0 1 2 3", _PRIORITIES),
        (r"(@Converts )", "0 1 2 3", _COSTS),
        (r"(NotifyAtFrequency )", _WRITTEN, _RATES),
    ):
        number = dict(zip(written.split(), rng.choice(others).split(), strict=True))
        words = re.split(before + r"([\d.]+)", text)
        words[2::3] = [number.get(word, word) for word in words[2::3]]
        text = "".join(words)
    return text


def _small_configuration(seed: int) -> str:
    rng = random.Random(seed)
    kind = rng.choice(["", " hierarchical", " hierarchical"])
    what = rng.choice(["data", "control", "both"])
    names: list[str] = []
    lines: list[str] = []
    blocks: list[str] = []
    if what != "control":
        _data(rng, names, lines, blocks)
    if what != "data":
        _control(rng, names, lines, 2 if what == "both" else rng.randint(2, 4))
    rng.shuffle(lines)
    return "\n".join([f"@configuration{kind}", f"@modules {', '.join(names)}", *lines, *blocks])


def _block(name: str, *lines: str) -> str:
    return "\n".join(["@module_start", f"@module_name {name}", *lines, "@module_end"])


def _data(rng: random.Random, names: list[str], lines: list[str], blocks: list[str]) -> None:
    representations = REPRESENTATIONS[: rng.randint(2, 5)]
    sources = [f"Eye{index}" for index in range(rng.choice([1, 1, 2]))]
    clients = [f"C{index}" for index in range(rng.randint(1, 5))]
    names += [*sources, *clients]
    services: Sequence[str] = rng.choice([("",), SERVICES, CONDITIONS])
    for client in clients:
        entries = set()
        for _ in range(rng.choice([1, 1, 1, 1, 2])):
            entries.add(f"{client} uses_data_from {rng.choice(sources)}{rng.choice(services)}")
        lines += sorted(entries)
    for source in sources:
        if rng.random() < 0.9:
            output = rng.choice(["auto" if rng.random() < 0.1 else representations[0]])
            blocks.append(_block(source, f"@Sense {rng.choice(OFFERS)}", f"{output} look();"))
    for client in clients:
        if rng.random() < 0.9:
            taken = rng.sample(representations, min(len(representations), rng.choice([1, 1, 2])))
            inputs = ", ".join(f"{name} x" for name in taken)
            blocks.append(_block(client, "@DataIn", f"void take({inputs});"))
    for index in range(rng.randint(0, 6)):
        given, made = rng.sample(representations, 2)
        declaration = f"{made} turn({given} x);"
        blocks.append(_block(f"K{index}", f"@Converts {rng.randint(1, 3)}", declaration))


def _control(rng: random.Random, names: list[str], lines: list[str], modules: int) -> None:
    drivers = [f"D{index}" for index in range(rng.randint(2, 4))]
    wheels = [f"W{index}" for index in range(modules)]
    names += [*wheels, *drivers]
    held = rng.choice([("",), ("", "", " hold 50")])
    ranked = rng.choice([(0, 1, 2, 3), (0, 1, 1, 2, 2), (0, 0, 0, 1)])
    for wheel in wheels:
        chosen = rng.sample(drivers, rng.randint(1, len(drivers)))
        if rng.random() < 0.5:
            chosen.sort()
        for place, driver in enumerate(chosen):
            rank = ranked[place % len(ranked)] if rng.random() < 0.8 else rng.randint(0, 3)
            lines.append(f"{wheel} is_controlled_by {driver} {rank}{rng.choice(held)}")


def random_twins(seed: int) -> str:
    """Return a random configuration twice over in which all conversions cost the same.

    With equal costs, the total counts the transformers of both twins, whichever converters they
    apply. Some modules hold several converters.
    """
    cost = (1, 2, 1_000_000)[seed % 3]
    text = re.sub(r"@Converts \d+", f"@Converts {cost}", random_configuration(seed))
    head, modules, *rest = re.split(r"\n(?=[@A-Z])", text)
    parts: dict[str, list[str]] = {"lines": [], "blocks": [], "converters": []}
    for part in re.split(r"\n(?=@module_start|\w+ (?:is|uses)_)", "\n".join(["", *rest]))[1:]:
        kind = "converters" if "@Converts" in part else "blocks" if "@" in part else "lines"
        parts[kind].append(part)
    bodies = ["\n".join(block.split("\n")[2:-1]) for block in parts["converters"]]
    half = len(bodies) // 2
    converters = [
        _block(f"K{index}", *some)
        for index, some in enumerate((bodies[:half], bodies[half:]))
        if some
    ]
    once = [*parts["lines"], *parts["blocks"]]
    twice = [*map(_renamed, parts["lines"]), *map(_renamed, parts["blocks"])]
    lines = [each for each in (*once, *twice) if not each.startswith("@")]
    blocks = [each for each in (*once, *twice) if each.startswith("@")]
    names = f"{modules}, {_renamed(modules.removeprefix('@modules '))}"
    return "\n".join([head, names, *lines, *blocks, *converters])


def _renamed(text: str) -> str:
    return re.sub(r"\b(Eye|C|D|W)(\d)\b", r"Twin\1\2", text)


def random_ports(seed: int) -> str:
    """Return a random configuration of data whose lines name outputs and inputs.

    Where a name may be left out some leave it out.
    """
    rng = random.Random(f"ports {seed}")
    types = REPRESENTATIONS[: rng.randint(2, 4)]
    blocks: list[str] = []
    outputs: list[str] = []
    for name in ("Eye", "Ear")[: rng.choice([1, 1, 2])]:
        body: list[str] = []
        many = rng.randint(1, 3)
        for number in range(many):
            port = rng.choice([f"o{number}", f"o{number}", f"raw {number}"])
            body.append(f"@{rng.choice(['Sense', 'DataOut'])} {rng.choice(OFFERS)}")
            body += [f'@Port "{port}"'] if " " in port else []
            outputs.append(name if many == 1 and rng.random() < 0.5 else f'{name}."{port}"')
            body.append(f"{rng.choice(types[:2])} o{number}();")
        blocks.append(_block(name, *body))
    entries: list[str] = []
    clients = [f"C{index}" for index in range(rng.randint(1, 3))]
    for client in clients:
        names = [f"in{number}" for number in range(rng.randint(1, 3))]
        entries += [client, *(f"{client}.{name}" for name in names)]
        parameters = [f"{rng.choice([*types, *types, 'auto'])} {name}" for name in names]
        cut = rng.randint(0, len(names))
        body = []
        for number, some in enumerate((parameters[:cut], parameters[cut:])):
            if some:
                body += ["@DataIn", f"void take{number}({', '.join(some)});"]
        if rng.random() < 0.9:
            blocks.append(_block(client, *body))
    for index in range(rng.randint(0, 4)):
        given, made = rng.sample(types, 2)
        blocks.append(
            _block(f"K{index}", f"@Converts {rng.randint(1, 3)}", f"{made} turn({given} x);")
        )
    services = rng.choice([("",), ("", *SERVICES, " NotifyAtFrequency every 70 ms"), CONDITIONS])
    lines = [
        f"{rng.choice(entries)} uses_data_from {rng.choice(outputs)}{rng.choice(services)}"
        for _ in range(rng.randint(1, 6))
    ]
    modules = ", ".join([*clients, *("Eye", "Ear")])
    return "\n".join(["@configuration", f"@modules {modules}", *lines, *blocks])


def random_mounts(seed: int) -> str:
    """Return a random configuration in which modules are commanded in inherited functions."""
    rng = random.Random(seed)
    bodies = [f"B{index}" for index in range(rng.randint(2, 5))]
    # Names in another order than mounts, so that the order by name differs from that by position.
    rng.shuffle(bodies)
    declared = {name: _body(rng, last=index > 1) for index, name in enumerate(bodies)}
    mounts = _mounts(rng, bodies)
    text = "\n".join(["@configuration", f"@modules {', '.join(bodies)}", *mounts])
    blocks = [_block(name, *lines) for name, lines in declared.items()]
    offered = _offered("\n".join([text, *blocks]), bodies)
    lines = [*mounts]
    ranked = rng.choice([(0, 1, 2, 3), (0, 1, 1, 2), (2, 0, 1, 0)])
    held = rng.choice([("",), ("", "", " hold 50")])
    drivers = []
    commanded = [name for name in bodies if offered[name]]
    some = rng.sample(commanded, min(len(commanded), rng.randint(1, 3)))
    for driver in ("D0", "D1", "D2", "D3")[: rng.randint(1, 4)]:
        led = [name for name in some if rng.random() < 0.6]
        common = {*MOTION_FUNCTIONS, GRASP}.intersection(*(offered[name] for name in led))
        result = rng.sample(sorted(common), min(len(common), rng.randint(0, 2)))
        for name in led:
            rank = rng.choice(ranked)
            lines.append(f"{name} is_controlled_by {driver} {rank}{rng.choice(held)}")
        drivers.append(driver)
        blocks.append(_block(driver, f"@ControlOut {', '.join(result)}", "Command lead();"))
    rng.shuffle(lines)
    kind = rng.choice(["", " hierarchical", " hierarchical"])
    names = ", ".join([*bodies, *drivers])
    return "\n".join([f"@configuration{kind}", f"@modules {names}", *lines, *blocks])


def _body(rng: random.Random, *, last: bool) -> list[str]:
    """Return the declarations of a mounted module: motions, a grasp or a sense, vertices."""
    few = ("Rotn_Y", "Rotn_Z"), ("Trans_X", "Trans_Z")
    some = rng.choice([*few, MOTION_FUNCTIONS, MOTION_FUNCTIONS])
    motions = rng.sample(some, rng.choice([0, 1, 1] if last else [1, 1, 2]))
    lines = [f"@{name}" for name in motions]
    if not motions:
        lines += rng.choice([["@Grasp"], ["@Sense NotifyWhenReady", "Image look();"]])
    for number in (0, 1, 2):
        if rng.random() < 0.25:
            lines.append(f"@Vertex {number} {_tuple(rng)}")
    return lines


def _tuple(rng: random.Random) -> str:
    turns = ["_", "_", "_", "_"]
    for slot in (0, 2):
        if rng.random() < 0.35:
            degrees = rng.choice([90, -90, 180, 90, 270, 45, 30, -60])
            turns[slot : slot + 2] = [rng.choice("xyz"), str(degrees)]
    shifts = [str(rng.choice(["_", "_", 100, -50, 80])) for _ in range(3)]
    return f"({','.join([*turns, *shifts])})"


def _mounts(rng: random.Random, bodies: Sequence[str]) -> list[str]:
    """Mount each body on the one before it, or on another before it."""
    free = {name: [0, 1, 2] for name in bodies}
    lines = []
    for index, name in enumerate(bodies[1:], 1):
        carrier = bodies[index - 1] if rng.random() < 0.8 else rng.choice(bodies[:index])
        on = rng.choice(free[carrier])
        if on:
            free[carrier].remove(on)
        at = rng.choice(free[name])
        if at:
            free[name].remove(at)
        where = _tuple(rng) if rng.random() < 0.7 else ""
        lines.append(f"{name} {at or ''} is_mounted_on {carrier} {on or ''} {where}".rstrip())
    return lines


def _offered(text: str, bodies: Sequence[str]) -> Mapping[str, set[str]]:
    """Return the functions that each body has or inherits."""
    configuration = parse_text(text, "mounts.mars").configuration
    modules = {module.name: module for module in configuration.declared}
    mounts = {m.mounting: m for m in configuration.relationships if isinstance(m, Mount)}
    found = {}
    for name in bodies:
        found[name] = {f.name for f in modules[name].functions}
        # If floating point cannot decide, the oracle reports this later.
        with suppress(UnclearError):
            found[name] |= least_supports(name, mounts, modules).keys()
    return found


def random_control(seed: int) -> str:
    """Return a random configuration to run, whose controllers all command `Trans_Z`.

    Riders have no motion and are carried by modules with one, on mounts without rotation. Some
    carry an onlooker, which is rotated and has no controller.
    """
    rng = random.Random(seed)
    wheels = [f"W{index}" for index in range(rng.randint(1, 3))]
    riders = [f"R{index}" for index in range(rng.choice([0, 0, 1, 1, 2]))]
    drivers = [f"D{index}" for index in range(rng.randint(2, 5))]
    kind = rng.choice([" hierarchical", " hierarchical", " hierarchical", "", " flat period 50"])
    held = rng.choice([("",), ("", "", " hold 50"), (" hold 15", " hold 44", " hold 90", "")])
    ranked = rng.choice([(0, 1, 2, 3, 4), (0, 1, 1, 2, 2), (0, 0, 0, 1), (5, 0, 70000, 3, 2)])
    lines = [
        f"{name} is_mounted_on {rng.choice([*wheels, *riders[:i]])}"
        for i, name in enumerate(riders)
    ]
    if len(wheels) > 1 and rng.random() < 0.4:
        lines.append("W1 is_mounted_on W0")
    for name in (*wheels, *riders):
        chosen = rng.sample(drivers, rng.randint(0 if name in wheels else 1, len(drivers)))
        for place, driver in enumerate(chosen):
            rank = (
                ranked[place] if rng.random() < 0.8 and place < len(ranked) else rng.randint(0, 3)
            )
            lines.append(f"{name} is_controlled_by {driver} {rank}{rng.choice(held)}")
    onlookers = [f"T{index}" for index in range(rng.choice([0, 1, 2]))]
    for i, name in enumerate(onlookers):
        turn = rng.choice(["(y,90,_,_,_,_,_)", "(y,180,_,_,_,_,_)", "(x,-90,y,45,_,_,_)"])
        lines.append(
            f"{name} is_mounted_on {rng.choice([*wheels, *riders, *onlookers[:i]])} {turn}"
        )
    rng.shuffle(lines)
    blocks = [_block(name, "@Trans_Z") for name in wheels]
    blocks += [_block(name) for name in (*riders, *onlookers)]
    blocks += [_block(name, "@ControlOut Trans_Z", "Command lead();") for name in drivers]
    names = ", ".join([*onlookers, *wheels, *riders, *drivers])
    return "\n".join([f"@configuration{kind}", f"@modules {names}", *lines, *blocks])


def random_inputs(seed: int) -> str:
    """Return clients that accept one or two representations, few of which converters reach."""
    rng = random.Random(seed)
    representations = ("A", "D", "E", "X")
    clients = [f"C{index}" for index in range(rng.randint(2, 4))]
    offer = rng.choice(["NotifyWhenReady", "NotifyAtFrequency 20", "RequestWhenReady"])
    services = rng.choice([("",), ("", " NotifyOnMax", " RequestWhenReady")])
    blocks = [_block("Eye", f"@Sense {offer}", "A look();")]
    lines = []
    for client in clients:
        lines.append(f"{client} uses_data_from Eye{rng.choice(services)}")
        taken = rng.sample(representations, rng.choice([1, 2, 2]))
        inputs = ", ".join(f"{name} x" for name in taken)
        if rng.random() < 0.1:
            inputs += ", auto y"
        blocks.append(_block(client, "@DataIn", f"void take({inputs});"))
    for index in range(rng.choice([0, 0, 1, 2])):
        given, made = rng.sample(representations, 2)
        blocks.append(
            _block(f"K{index}", f"@Converts {rng.randint(1, 3)}", f"{made} turn({given} x);")
        )
    return "\n".join(["@configuration", f"@modules Eye, {', '.join(clients)}", *lines, *blocks])


def random_carried(seed: int) -> str:
    """Return carried modules that are commanded in inherited functions, through right angles."""
    rng = random.Random(seed)
    functions = ("Rotn_X", "Rotn_Y", "Trans_Z")
    movers = ["Base", "Neck"][: rng.randint(1, 2)]
    tools = [f"T{index}" for index in range(rng.randint(1, 2))]
    drivers = [f"D{index}" for index in range(rng.randint(1, 3))]
    turns = ("", "", " (x,90,_,_,_,_,_)", " (z,180,_,_,_,_,_)", " (y,-90,_,_,_,50,_)")
    lines = [f"Neck is_mounted_on Base{rng.choice(turns)}"] if len(movers) > 1 else []
    lines += [f"{tool} is_mounted_on {rng.choice(movers)}{rng.choice(turns)}" for tool in tools]
    allocations = rng.choice([("",), ("", "", " allocation root", " allocation split")])
    holds = rng.choice([("",), ("", "", " hold 50")])
    for module in (*tools, *movers):
        for driver in rng.sample(drivers, rng.randint(0, min(2, len(drivers)))):
            rank = rng.randint(0, 3)
            text = f"{rank}{rng.choice(holds)}{rng.choice(allocations)}"
            lines.append(f"{module} is_controlled_by {driver} {text}")
    blocks = [
        _block(mover, *(f"@{name}" for name in rng.sample(functions, rng.randint(1, 2))))
        for mover in movers
    ]
    for tool in tools:
        grip, look = ("@Grasp", "void grasp(double w);"), ("@Sense NotifyWhenReady", "P look();")
        blocks.append(_block(tool, *rng.choice([grip, look])))
    for driver in drivers:
        text = ", ".join(rng.sample(functions, rng.choice([0, 0, 1])))
        blocks.append(_block(driver, f"@ControlOut {text}".rstrip(), "Command go();"))
    kind = rng.choice(["flat", "hierarchical", "hierarchical"])
    names = ", ".join((*movers, *tools, *drivers))
    return "\n".join([f"@configuration {kind}", f"@modules {names}", *lines, *blocks])


def random_cascades(seed: int) -> str:
    """Return controllers that control each other, and modules that share runs of priorities."""
    rng = random.Random(seed)
    drivers = [f"D{index}" for index in range(rng.randint(2, 4))]
    wheels = [f"W{index}" for index in range(rng.randint(1, 3))]
    lines = []
    holds = rng.choice([("",), ("", "", " hold 50", " hold 60")])
    for wheel in wheels:
        heard = rng.sample(drivers, rng.randint(1, len(drivers)))
        if rng.random() < 0.6:
            heard.sort()
        for place, driver in enumerate(heard):
            rank = rng.choice([place, place, place * 50_000, 2_147_483_647 - 9 + place, 1])
            text = "" if rng.random() < 0.1 else f" {rank}"
            lines.append(f"{wheel} is_controlled_by {driver}{text}{rng.choice(holds)}")
    for low, high in pairwise(drivers):
        if rng.random() < 0.25:
            lines.append(f"{low} is_controlled_by {high} {rng.randint(0, 2)}")
    blocks = [_block(driver, "@ControlOut", "Command go();") for driver in drivers]
    kind = rng.choice(["flat", "hierarchical", "hierarchical"])
    names = ", ".join((*wheels, *drivers))
    return "\n".join([f"@configuration {kind}", f"@modules {names}", *lines, *blocks])


def random_faults(seed: int) -> str:
    """Return a random configuration of one of the other kinds, with faults in it."""
    rng = random.Random(f"faults {seed}")
    of = rng.choice((random_configuration, random_control, random_mounts))
    lines = of(seed).split("\n")
    for spoil in rng.sample(_FAULTS, 2):
        _spoil(rng, lines, spoil)
    return "\n".join(lines)


#: What spoils a line: what it looks for, and what it writes there.
_FAULTS: Sequence[tuple[str, str]] = (
    (r"^(\w+) (uses_data_from|is_controlled_by) (\w+)(.*)$", r"\1 \2 \3\4\n\1 \2 \3\4"),
    (r"^(\w+) is_controlled_by (\w+).*$", r"\1 is_controlled_by \2 1\n\1 is_controlled_by \2 2"),
    (r"^(\w+) (uses_data_from|is_controlled_by) (\w+)", r"\3 \2 \1"),
    (r"^(\w+) (uses_data_from|is_controlled_by) (\w+)", r"\1 \2 \3\n\3 \2 \1"),
    (r"^(\w+) uses_data_from (\w+)", r"\1 uses_data_from \2\n\1 is_controlled_by \2"),
    (r"^(\w+) is_controlled_by (\w+)", r"\1 uses_data_from \2\n\1 is_controlled_by \2"),
    (r"^(@modules) \w+, ", r"\1 "),
    (r"^(@modules)", r"\1 Idle,"),
    (r"^(@ControlOut).*$", r"\1 Rotn_X, Trans_Y, Grasp"),
    (r"^(@Sense).*$", r"\1 RequestWhenReady"),
    (r"^(@Sense).*$", r"@DataOut NotifyAtFrequency 10"),
    (r"^(.*is_controlled_by \w+ \d+)$", r"\1 hold 5"),
    (r"^(void take)\(.*$", r"\1(Nothing x);\n@DataIn\nvoid also(P x);"),
    (r"^(\w+ \d? ?is_mounted_on.*)$", r"\1\n\1"),
)


def _spoil(rng: random.Random, lines: list[str], fault: tuple[str, str]) -> None:
    pattern, written = fault
    places = [number for number, line in enumerate(lines) if re.search(pattern, line)]
    if places:
        place = rng.choice(places)
        lines[place : place + 1] = re.sub(pattern, written, lines[place]).split("\n")
