"""Random small configurations: data with converters and services, control, or both."""

import random
from collections.abc import Sequence

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


def random_configuration(seed: int) -> str:
    """Return a random configuration with its modules declared, as text."""
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
        said = set()
        for _ in range(rng.choice([1, 1, 1, 1, 2])):
            said.add(f"{client} uses_data_from {rng.choice(sources)}{rng.choice(services)}")
        lines += sorted(said)
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
