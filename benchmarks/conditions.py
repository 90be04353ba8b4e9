"""Conditions of launch files: whole commands on robots with and without their conditions.

    python benchmarks/conditions.py [ARGUMENTS]

Each robot is one launch file whose nodes depend on launch arguments, one for each, in four shapes:
nodes apart, pairs of which one or the other starts, a chain of pairs under neighbouring arguments,
and all on one topic. Prints processor seconds of `check` and `explain` without the conditions,
with them, and the ratio.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

SHAPES = ("apart", "either", "chain", "one topic")
NODE = (
    '  <node pkg="turtlesim" exec="turtle_teleop_key" name="{}"{}>'
    '<remap from="turtle1/cmd_vel" to="{}"/></node>'
)
_USED = """
import resource, subprocess, sys
to = subprocess.DEVNULL
subprocess.run(sys.argv[1:], stdout=to, stderr=to)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime)
"""


def launch_file(shape: str, arguments: int, *, conditional: bool) -> str:
    """Return a launch file of a shape."""
    lines = ["<launch>"]
    for at in range(arguments):
        default = "true" if at % 2 else "false"
        lines.append(f'  <arg name="a{at}" default="{default}"/>')

    def add(name: str, topic: str, test: str, of: int) -> None:
        condition = f' {test}="$(var a{of})"' if conditional else ""
        lines.append(NODE.format(name, condition, topic))

    for at in range(arguments):
        topic = "/cmd_vel" if shape == "one topic" else f"/cmd_vel{at}"
        add(f"n{at}", topic, "if", at)
        if shape == "either":
            add(f"n{at}" if conditional else f"m{at}", topic, "unless", at)
        elif shape == "chain":
            add(f"m{at}", topic, "if", (at + 1) % arguments)
    return "\n".join((*lines, "</launch>\n"))


def seconds(verb: str, folder: str) -> float:
    """Return the processor seconds of a verb on a folder."""
    words = [sys.executable, "-c", _USED, sys.executable, "-m", "mars_asp", verb, folder]
    return float(subprocess.run(words, capture_output=True, text=True, check=True).stdout)


def main() -> None:
    """Print the figures of all shapes."""
    arguments = int((*sys.argv[1:], "60")[0])
    print(f"{arguments} arguments; seconds without conditions, with them, and the ratio")
    for shape in SHAPES:
        for verb in ("check", "explain"):
            used = []
            for conditional in (False, True):
                with tempfile.TemporaryDirectory() as folder:
                    text = launch_file(shape, arguments, conditional=conditional)
                    Path(folder, "robot.launch.xml").write_text(text, encoding="utf-8")
                    used.append(min(seconds(verb, folder) for _ in range(3)))
            before, after = used
            print(f"{shape:10} {verb:8} {before:6.2f} {after:6.2f} {after / before:6.2f}")


if __name__ == "__main__":
    main()
