"""Growth of `analyse` and `synthesise` as whole processes, against clingo alone.

    python benchmarks/growth.py [MODULES ...]

`benchmarks/controllers.py` has the growth of other verbs with the controllers of one module.

Three kinds of input: independent robots of ten modules each, one robot that hangs together, and
one whose modules all have the same source and the same controllers.
Prints processor seconds and memory of clingo on the same facts and rules, of `analyse --format
json` with its ratio to clingo, of `synthesise`, which verifies what it prints, with its ratio to
`analyse`, and how both grow from one size to the next.
"""

import random
import subprocess
import sys
import tempfile
from collections.abc import Container, Iterator, Sequence
from pathlib import Path

from mars_asp.reasoning.facts.compile import facts_text
from mars_asp.reasoning.project import load_project, project_facts
from mars_asp.reasoning.rules import load_rulebook

PER_ROBOT = 10
#: Seconds for a synthesis, and the status that says that nothing was proven in them.
MOST_SECONDS, TIME_OVER = "120", 3
#: Runs a command and prints its status and the CPU seconds and MB that it took.
_USED = """
import resource, subprocess, sys
to = subprocess.DEVNULL
status = subprocess.run(sys.argv[1:], stdout=to, stderr=to).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(status, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
"""


def robot_lines(modules: int, rng: random.Random) -> Iterator[str]:
    """Yield independent robots of ten modules each, unequal among themselves."""
    names, lines, blocks = [], [], []
    for robot in range(modules // PER_ROBOT):
        own = [f"M{robot}_{index}" for index in range(PER_ROBOT)]
        names += own
        blocks.append(_block(own[0], "@Sense NotifyAtFrequency 25", "Raw grab()"))
        for client in own[1:5]:
            accepted = rng.choice(["Raw", "Lines", "Map"])
            blocks.append(_block(client, "@ControlOut", f"Motion act({accepted} x)"))
            service = rng.choice(["", "", " NotifyAtFrequency 10", " RequestWhenReady"])
            lines.append(f"{client} uses_data_from {own[0]}{service}")
        for wheel in own[5:7]:
            for rank, controller in enumerate(rng.sample(own[1:5], rng.choice([1, 2, 3]))):
                lines.append(f"{wheel} is_controlled_by {controller} {rank}")
    blocks.append(_block("Hough", "@Converts 2", "Edges f(Raw x)"))
    blocks.append(_block("Joining", "@Converts", "Lines f(Edges x)"))
    blocks.append(_block("Mapping", "@Converts", "Map f(Edges x)"))
    yield "@configuration hierarchical"
    yield "@modules " + ", ".join(names)
    yield from lines
    yield from blocks


def connected_lines(modules: int, rng: random.Random) -> Iterator[str]:
    """Yield one robot that hangs together.

    One source with a tree of representations serves half of the modules, and each other module is
    controlled by two or three neighbours in the row of these.
    """
    clients = [f"C{index}" for index in range(modules // 2)]
    wheels = [f"W{index}" for index in range(modules // 2)]
    made = [f"P{index}" for index in range(8)]
    yield "@configuration hierarchical"
    yield "@modules S, " + ", ".join((*clients, *wheels))
    for client in clients:
        service = rng.choice(["", "", " NotifyAtFrequency 10", " RequestWhenReady"])
        yield f"{client} uses_data_from S{service}"
    for index, wheel in enumerate(wheels):
        for rank, controller in enumerate(clients[index : index + rng.choice([2, 3])]):
            yield f"{wheel} is_controlled_by {controller} {rank}"
    yield _block("S", "@Sense NotifyAtFrequency 25", "Raw grab()")
    for client in clients:
        yield _block(client, "@ControlOut", f"Motion act({rng.choice(['Raw', *made])} x)")
    for index, name in enumerate(made):
        origin = made[(index - 1) // 2] if index else "Raw"
        yield _block(f"K{index}", f"@Converts {rng.randint(1, 3)}", f"{name} f({origin} x)")


def hub_lines(modules: int, rng: random.Random) -> Iterator[str]:
    """Yield one robot whose modules all have the same source or the same two controllers.

    No converter makes what half of the source's clients accept.
    """
    clients = [f"C{index}" for index in range(modules // 2)]
    wheels = [f"W{index}" for index in range(modules // 2)]
    yield "@configuration hierarchical"
    yield "@modules S, A, B, " + ", ".join((*clients, *wheels))
    for client in clients:
        service = rng.choice(["", "", " NotifyAtFrequency 10", " RequestWhenReady"])
        yield f"{client} uses_data_from S{service}"
    for wheel in wheels:
        yield f"{wheel} is_controlled_by A, B"
    yield _block("S", "@Sense NotifyAtFrequency 25", "Raw grab()")
    for client in clients:
        yield _block(client, "@ControlOut", f"Motion act({rng.choice(['Raw', 'Other'])} x)")


def _block(name: str, annotation: str, declaration: str) -> str:
    return f"@module_start\n@module_name {name}\n{annotation}\n{declaration};\n@module_end"


KINDS = {"independent": robot_lines, "connected": connected_lines, "hub": hub_lines}


def used(command: Sequence[str], fine: Container[int]) -> tuple[float, float, int]:
    """Return the seconds of CPU and the MB of memory that a process takes, and its status."""
    timed = [sys.executable, "-c", _USED, *command]
    done = subprocess.run(timed, capture_output=True, text=True, check=True)
    status, seconds, memory = done.stdout.split()
    if int(status) not in fine:
        raise SystemExit(f"{command} ended with status {status}")
    return float(seconds), float(memory), int(status)


def of_module(*words: str) -> tuple[float, float, int]:
    """Return that of a module of Python with arguments."""
    # clingo ends with 30 where it has found all answers.
    return used([sys.executable, "-m", *words], (0, TIME_OVER, 30))


def measure(kind: str, modules: int, folder: Path) -> tuple[float, float]:
    """Print what clingo alone, an analysis and a synthesis take, and return the last two."""
    lines = KINDS[kind]
    file, program = folder / "robots.mars", folder / "robots.lp"
    file.write_text("\n".join(lines(modules, random.Random(1))) + "\n", encoding="utf-8")
    facts = facts_text(project_facts(load_project(str(file))))
    program.write_text(f"{load_rulebook().text('base')}\n{facts}", encoding="utf-8")
    alone, _, _ = of_module("clingo", "--warn=none", str(program))
    analysed, kept, _ = of_module("mars_asp", "analyse", "--format", "json", str(file))
    synthesise = ("synthesise", "--time-limit", MOST_SECONDS, str(file))
    synthesised, most, status = of_module("mars_asp", *synthesise)
    print(
        f"{kind:11} {modules:7} {alone:8.2f} s  {analysed:8.2f} s ({analysed / alone:4.1f})"
        f" {kept:6.0f} MB  {synthesised:8.2f} s ({synthesised / analysed:3.1f}) {most:6.0f} MB"
        f"  {'not proven' if status == TIME_OVER else 'proven'}",
        end="",
        flush=True,
    )
    return analysed, synthesised


def main() -> None:
    sizes = [int(word) for word in sys.argv[1:]] or [100, 1000, 10000]
    print(
        "processor time: clingo alone, analyse (of clingo), synthesise (of analyse); growth of both"
    )
    with tempfile.TemporaryDirectory() as folder:
        for kind in KINDS:
            previous: tuple[float, float] | None = None
            for size in sizes:
                now = measure(kind, size, Path(folder))
                grown = zip(now, previous or (), strict=False)
                print("".join(f"  {after / before:5.1f}" for after, before in grown))
                previous = now


if __name__ == "__main__":
    main()
