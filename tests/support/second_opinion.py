"""A second opinion on minimal specifications, from the rules of `rules/verify` alone.

clingo chooses the wiring of a bounded number of nodes freely (`tests/support/second_opinion.lp`),
and looks for one that is cheaper than the result of `synthesise`, or for any one if `synthesise`
finds none. The rules that resolve are not used. A result is a fault of one of the two.

    python -m tests.support.second_opinion HOW_MANY [FIRST_SEED [PART ...]]

checks as many random configurations of each part: `wiring`, `inputs`, `carried`, `cascades`.
"""

import random
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import clingo

from mars_asp.language import parse_text, print_configuration
from mars_asp.model.declarations import (
    NODE_NAMES,
    Configuration,
    Control,
    Conversion,
    Data,
    Mount,
    Name,
    Relationship,
)
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.facts.identifiers import mode_of
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import CONVERSION, NODES, RELATIONSHIPS, load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise
from mars_asp.reasoning.verification import verify
from tests.support.random_configurations import random_configuration

RULEBOOK = load_rulebook(stages=("resolve", "verify"))
_ANY = (Path(__file__).parent / "second_opinion.lp").read_text()
_RULES = f"{RULEBOOK.text('base')}\n{RULEBOOK.text('verify')}\n{_ANY}"
_OPTIONS = ("--warn=none", "--stats=0", "--seed=1")
#: More nodes than this make the search too long: such configurations are counted as skipped.
MOST_NODES = 6
#: Where `synthesise` finds nothing, specifications of so many nodes are looked for.
_NODES_OF_NONE = 3
_SECONDS = 10.0


@dataclass(frozen=True, slots=True)
class Opinion:
    """`agrees`, `differs`, `skipped` (too large) or `late`; `better` is a cheaper specification."""

    verdict: str
    better: str = ""


def second_opinion(text: str, seconds: float = _SECONDS) -> Opinion:
    """Look for a specification that is cheaper than the result of `synthesise`."""
    project = Project(parse_text(text, "c.mars").configuration, {}, ())
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    found = synthesise(project, analysis, RULEBOOK)
    least = None
    if found is not None:
        least = (found.cost(NODES), found.cost(CONVERSION), found.cost(RELATIONSHIPS))
        if found.cost(NODES) > MOST_NODES:
            return Opinion("skipped")
    try:
        better = cheaper_than(least, project, seconds)
    except TimeoutError:
        return Opinion("late")
    if better is None:
        return Opinion("agrees")
    entries = [violation.message for violation in verify(better, project, RULEBOOK)]
    notes = "".join(f"# read back it is refused: {message}\n" for message in entries)
    return Opinion("differs", f"{print_configuration(better)}{notes}")


def cheaper_than(
    least: tuple[int, int, int] | None, project: Project, seconds: float = _SECONDS
) -> Configuration | None:
    """Return any specification that the rules of `rules/verify` accept and that costs less.

    `least` are nodes, conversion cost and lines; None: any specification of a few nodes.

    Raises:
        TimeoutError: the seconds were over before the search was.
    """
    slots = _NODES_OF_NONE if least is None else least[0]
    given = [f'slot({number},"?{number}").' for number in range(1, slots + 1)]
    if least is not None:
        given.append(f"at_most({','.join(map(str, least))}).")
    control = clingo.Control(_OPTIONS)
    facts = facts_text(project_facts(project))
    control.add("base", [], "\n".join([_RULES, facts, *given]))
    control.ground()
    with control.solve(yield_=True, async_=True) as handle:
        if not handle.wait(seconds):
            handle.cancel()
            raise TimeoutError
        model = handle.model()
        return None if model is None else specification_of(model.symbols(atoms=True), project)


def specification_of(atoms: Sequence[clingo.Symbol], project: Project) -> Configuration:
    """Return the specification that facts describe, with nodes named as in the text form."""
    rows: dict[str, list[list[clingo.Symbol]]] = {}
    for atom in atoms:
        rows.setdefault(atom.name, []).append(atom.arguments)
    span = project.configuration.span
    named = {module.text: module.text for module in project.configuration.modules}
    counted: Counter[str] = Counter()
    for node, kind in sorted(rows.get("spec_node", ()), key=lambda row: row[0].string):
        stem = NODE_NAMES[kind.name]  # type: ignore[index]
        counted[stem] += 1
        bare = kind.name == "arbitration_node" and counted[stem] == 1
        named[node.string] = stem if bare else f"{stem}{counted[stem]}"

    def of(predicate: str) -> dict[clingo.Symbol, clingo.Symbol]:
        return {row[0]: row[1] for row in rows.get(predicate, ())}

    modes, rates = of("spec_required_mode"), of("spec_required_rate")
    priorities, holds = of("spec_priority"), of("spec_hold")
    allocations = of("spec_allocation")
    entries = of("spec_into")
    lines: list[Relationship] = [
        line for line in project.configuration.relationships if isinstance(line, Mount)
    ]
    for line, client, source in sorted(rows.get("spec_uses_data_from", ())):
        mode = mode_of(modes[line]) if line in modes else None
        hz = Fraction(rates[line].number, 1000) if line in rates else None
        port = entries[line].string.partition(".")[2].strip('"') if line in entries else None
        lines.append(Data(named[client.string], named[source.string], span, mode, hz, port))
    for line, controlled, controller in sorted(rows.get("spec_is_controlled_by", ())):
        lines.append(
            Control(
                named[controlled.string],
                named[controller.string],
                span,
                priorities[line].number if line in priorities else None,
                holds[line].number if line in holds else None,
                allocations[line].name if line in allocations else None,  # type: ignore[arg-type]
            )
        )
    converters = of("spec_converter")
    conversions = [
        Conversion(
            named[node.string],
            converters[node].string if node in converters else None,
            given.string,
            made.string,
            span,
        )
        for node, given, made in rows.get("spec_converts", ())
    ]
    return Configuration(
        "s.mars",
        span,
        "specification",
        project.configuration.architecture,
        True,
        project.configuration.period_ms,
        modules=tuple(Name(name, span) for name in named.values()),
        relationships=tuple(lines),
        conversions=tuple(conversions),
    )


# ---- Random configurations -----------------------------------------------------------------------


def _block(name: str, *lines: str) -> str:
    return "\n".join(["@module_start", f"@module_name {name}", *lines, "@module_end"])


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


PARTS: dict[str, Callable[[int], str]] = {
    "wiring": random_configuration,
    "inputs": random_inputs,
    "carried": random_carried,
    "cascades": random_cascades,
}


def main(words: Sequence[str]) -> int:
    """Check random configurations; return 1 if some differ."""
    many, first = int(words[0]), int(words[1]) if len(words) > 1 else 0
    total: Counter[str] = Counter()
    begin = time.monotonic()
    for part in words[2:] or PARTS:
        for seed in range(first, first + many):
            text = PARTS[part](seed)
            opinion = second_opinion(text)
            total[opinion.verdict] += 1
            if opinion.better:
                print(f"# {part} {seed}\n{text}\n# costs less:\n{opinion.better}", flush=True)
            elif opinion.verdict == "late":
                print(f"# {part} {seed} is late", flush=True)
            if sum(total.values()) % 100 == 0:
                print(f"{part} {seed}: {dict(total)}, {time.monotonic() - begin:.0f} s", flush=True)
    print(
        f"{sum(total.values())} configurations, {total['agrees']} agree, {total['differs']} differ,"
        f" {total['skipped']} skipped as too large, {total['late']} late,"
        f" {time.monotonic() - begin:.0f} s"
    )
    return int(total["differs"] > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
