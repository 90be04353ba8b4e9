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
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from growth import used


class Family(NamedTuple):
    """Relationships of robots that differ in size: once for each number `{n}`, and once in all."""

    each: tuple[str, ...]
    once: tuple[str, ...] = ()


_TWO_CONTROLLERS = ("W{n} is_controlled_by A{n} 1", "W{n} is_controlled_by B{n} 2")
_GATES_APART = Family(("T{n} uses_data_from S{n}", "S{n} is_suppressed_by A{n} 300"))

#: `{next}` is the number after `{n}`, and `{count}` that of all.
FAMILIES: Mapping[str, Family] = {
    # Each line has a client and a trigger of its own.
    "gates_apart": _GATES_APART,
    # One output suppresses all lines.
    "one_trigger": Family(("T{n} uses_data_from S{n}", "S{n} is_suppressed_by A 300")),
    # One output inhibits all lines, or resets all modules.
    "one_inhibitor": Family(("T{n} uses_data_from S{n}", "S{n} is_inhibited_by A 300")),
    "one_reset": Family(("T{n} uses_data_from S{n}", "S{n} is_reset_by A")),
    # All triggers close one line.
    "one_line": Family(("S is_suppressed_by A{n} 300",), ("T uses_data_from S",)),
    # What passes a Gate triggers the next one.
    "row": Family(("T{n} uses_data_from S{n}", "S{n} is_suppressed_by S{next} 300")),
    # The inputs of the clients of one source are suppressed.
    "inputs": Family(("T{n}.x uses_data_from S", "T{n}.x is_suppressed_by A{n} 300")),
    # Each controller is inhibited by an output of its own.
    "commands_apart": Family(("W{n} is_controlled_by C{n}", "C{n} is_inhibited_by A{n}.x 300")),
    # Each controller is suppressed by the next one.
    "row_of_commands": Family(
        ("W{n} is_controlled_by C{n}", "C{n} is_suppressed_by C{next} 300"),
        ("W{count} is_controlled_by C{count}",),
    ),
    # Each module has two controllers and a lock of its own.
    "locks_apart": Family((*_TWO_CONTROLLERS, "W{n} is_locked_by L{n} 2 hold 500")),
    # One output locks all modules, of which each has two controllers.
    "one_lock": Family((*_TWO_CONTROLLERS, "W{n} is_locked_by L 2 hold 500")),
    # One output limits all modules.
    "one_limit": Family((*_TWO_CONTROLLERS, "W{n} is_limited_by L hold 500")),
    # One module with so many controllers has a lock between each two of them.
    "locks_of_one": Family(("W is_controlled_by A{n} {n}", "W is_locked_by L{n} {n}")),
    # Each module takes weighted means, and has a limit.
    "limits_and_means": Family(
        (
            *_TWO_CONTROLLERS,
            "W{n} is_arbitrated_by weighted period 50",
            "W{n} is_limited_by L{n} hold 500",
        )
    ),
    # One input of so many clients of one source is suppressed.
    "one_of_many": Family(("T{n}.x uses_data_from S",), ("T0.x is_suppressed_by A 300",)),
    # An output with so many clients is suppressed.
    "one_output_of_many": Family(("T{n} uses_data_from S",), ("S is_suppressed_by A 300",)),
    # The controller of so many modules is inhibited, and one of the modules is locked.
    "one_controller": Family(
        ("W{n} is_controlled_by C",), ("C is_inhibited_by A.x 300", "W0 is_locked_by L hold 500")
    ),
    # Each Gate needs a converter for its trigger or its line, by the blocks of `described`.
    "converted": _GATES_APART,
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
    each, once = FAMILIES[family]
    written = [line.format(count=count) for line in once]
    written += (line.format(n=n, next=n + 1) for n in range(count) for line in each)
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
