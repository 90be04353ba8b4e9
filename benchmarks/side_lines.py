"""Growth of commands with the gates and locks of a robot.

    python benchmarks/side_lines.py [LINES | COMMAND | FAMILY ...]

For each family of robots and each command, prints the processor seconds of whole processes at each
number of side lines, and from the first size to the last the exponent of the seconds beyond those
of one line. Without the name of a family all are measured, without a command `synthesise`, which
verifies its result.
"""

import itertools
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from growth import used

#: Yields relationships with so many side lines.
Family = Callable[[int], Iterator[str]]


def gates_apart(count: int) -> Iterator[str]:
    """Each line has a client and a trigger of its own."""
    for n in range(count):
        yield f"T{n} uses_data_from S{n}"
        yield f"S{n} is_suppressed_by A{n} 300"


def one_trigger(count: int) -> Iterator[str]:
    """One output suppresses all lines."""
    for n in range(count):
        yield f"T{n} uses_data_from S{n}"
        yield f"S{n} is_suppressed_by A 300"


def one_line(count: int) -> Iterator[str]:
    """All triggers close one line."""
    yield "T uses_data_from S"
    yield from (f"S is_suppressed_by A{n} 300" for n in range(count))


def row(count: int) -> Iterator[str]:
    """What passes a Gate triggers the next one."""
    for n in range(count):
        yield f"T{n} uses_data_from S{n}"
        yield f"S{n} is_suppressed_by S{n + 1} 300"


def inputs(count: int) -> Iterator[str]:
    """The inputs of the clients of one source are suppressed."""
    for n in range(count):
        yield f"T{n}.x uses_data_from S"
        yield f"T{n}.x is_suppressed_by A{n} 300"


def commands_apart(count: int) -> Iterator[str]:
    """Each controller is inhibited by an output of its own."""
    for n in range(count):
        yield f"W{n} is_controlled_by C{n}"
        yield f"C{n} is_inhibited_by A{n}.x 300"


def row_of_commands(count: int) -> Iterator[str]:
    """Each controller is suppressed by the next one."""
    for n in range(count):
        yield f"W{n} is_controlled_by C{n}"
        yield f"C{n} is_suppressed_by C{n + 1} 300"
    yield f"W{count} is_controlled_by C{count}"


def locks_apart(count: int) -> Iterator[str]:
    """Each module has two controllers and a lock of its own."""
    for n in range(count):
        yield f"W{n} is_controlled_by A{n} 1"
        yield f"W{n} is_controlled_by B{n} 2"
        yield f"W{n} is_locked_by L{n} 2 hold 500"


def one_lock(count: int) -> Iterator[str]:
    """One output locks all modules, of which each has two controllers."""
    for n in range(count):
        yield f"W{n} is_controlled_by A{n} 1"
        yield f"W{n} is_controlled_by B{n} 2"
        yield f"W{n} is_locked_by L 2 hold 500"


def locks_of_one(count: int) -> Iterator[str]:
    """One module with so many controllers has a lock between each two of them."""
    for n in range(count):
        yield f"W is_controlled_by A{n} {n}"
        yield f"W is_locked_by L{n} {n}"


def limits_and_means(count: int) -> Iterator[str]:
    """Each module takes weighted means, and has a limit."""
    for n in range(count):
        yield f"W{n} is_controlled_by A{n} 1"
        yield f"W{n} is_controlled_by B{n} 2"
        yield f"W{n} is_arbitrated_by weighted period 50"
        yield f"W{n} is_limited_by L{n} hold 500"


def one_of_many(count: int) -> Iterator[str]:
    """One input of so many clients of one source is suppressed."""
    yield from (f"T{n}.x uses_data_from S" for n in range(count))
    yield "T0.x is_suppressed_by A 300"


def one_output_of_many(count: int) -> Iterator[str]:
    """An output with so many clients is suppressed."""
    yield from (f"T{n} uses_data_from S" for n in range(count))
    yield "S is_suppressed_by A 300"


def one_controller(count: int) -> Iterator[str]:
    """The controller of so many modules is inhibited, and one of the modules is locked."""
    yield from (f"W{n} is_controlled_by C" for n in range(count))
    yield "C is_inhibited_by A.x 300"
    yield "W0 is_locked_by L hold 500"


def converted(count: int) -> Iterator[str]:
    """Each Gate needs a converter for its trigger or its line."""
    for n in range(count):
        yield f"T{n} uses_data_from S{n}"
        yield f"S{n} is_suppressed_by A{n} 300"


FAMILIES: Mapping[str, Family] = {
    each.__name__: each
    for each in (
        *(gates_apart, one_trigger, one_line, row, inputs, commands_apart, row_of_commands),
        *(locks_apart, one_lock, locks_of_one, limits_and_means),
        *(one_of_many, one_output_of_many, one_controller, converted),
    )
}
COMMANDS = ("synthesise", "analyse", "check", "explain", "verify")


def described(count: int) -> Iterator[str]:
    """Yield the descriptions of the robot of `converted`, in two representations."""
    for n in range(count):
        yield _block(f"S{n}", "@DataOut NotifyWhenReady", "P say()")
        yield _block(f"A{n}", "@DataOut NotifyWhenReady", "Q say()")
        yield _block(f"T{n}", "@DataIn", f"void take({'PQ'[n % 2]} x)")
    yield _block("There", "@Converts 2", "Q there(P x)")
    yield _block("Back", "@Converts 1", "P back(Q x)")


def _block(name: str, annotation: str, declaration: str) -> str:
    return f"@module_start\n@module_name {name}\n{annotation}\n{declaration};\n@module_end"


def robot(family: str, count: int) -> str:
    """Return a configuration with relationships and the modules that they name."""
    written = list(FAMILIES[family](count))
    words = (line.split() for line in written)
    ends = ((left, right) for left, word, right, *_ in words if word != "is_arbitrated_by")
    names = dict.fromkeys(end.partition(".")[0] for pair in ends for end in pair)
    head = ["@configuration hierarchical", "@modules " + ", ".join(names)]
    blocks = described(count) if family == "converted" else ()
    return "\n".join([*head, *written, *blocks, ""])


def main() -> None:
    """Measure the families, commands and sizes that are named."""
    words = sys.argv[1:]
    sizes = [int(word) for word in words if word.isdecimal()] or [250, 500, 1000, 2000]
    commands = [word for word in words if word in COMMANDS] or ["synthesise"]
    families = [word for word in words if word in FAMILIES] or list(FAMILIES)
    with tempfile.TemporaryDirectory() as folder:
        file, specification = Path(folder) / "robot.mars", Path(folder) / "spec.mars"

        def seconds(command: str, family: str, size: int) -> float:
            file.write_text(robot(family, size), encoding="utf-8")
            tool = [sys.executable, "-m", "mars_asp"]
            given = [str(file)]
            if command == "verify":
                subprocess.run(
                    [*tool, "synthesise", "-o", str(specification), str(file)],
                    check=True,
                    capture_output=True,
                )
                given = [str(specification), str(file)]
            return used([*tool, command, *given], (0, 1))[0]

        for family, command in itertools.product(families, commands):
            floor = seconds(command, family, 1)
            taken = [seconds(command, family, size) for size in sizes]
            first, last = (max(each - floor, 0.01) for each in (taken[0], taken[-1]))
            power = math.log(last / first) / math.log(sizes[-1] / sizes[0])
            figures = "  ".join(f"{each:6.2f}" for each in taken)
            print(
                f"{family:18} {command:10} {floor:5.2f}  {figures}  power {power:4.2f}", flush=True
            )


if __name__ == "__main__":
    main()
