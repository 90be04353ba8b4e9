"""How each verb grows with the controllers of one module, beside how its answer grows.

    python benchmarks/controllers.py [CONTROLLERS ...]

A module has so many controllers, ranked (each a priority of its own) or equal (all the same).
Prints the processor seconds of whole processes, the lesser of two turns, and from the first size
to the last three exponents: of the seconds, of the seconds beyond those of two controllers, and of
the bytes that are printed.
"""

import math
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

TURNS = 2
#: 1 is an error-level finding.
FINE = (0, 1)


@dataclass(frozen=True, slots=True)
class Taken:
    """What a process takes: seconds of processor time, and how many bytes it prints."""

    seconds: float
    printed: int


def controlled(count: int, ranked: bool, without: int | None = None) -> str:
    """Return a configuration of one module with so many controllers, `without` one of them."""
    names = [f"C{number}" for number in range(count)]
    lines = ["@configuration hierarchical", "@modules W, " + ", ".join(names)]
    for number, name in enumerate(names):
        if number != without:
            lines.append(f"W is_controlled_by {name} {number if ranked else 5}")
    return "\n".join([*lines, ""])


def undeclared(count: int) -> str:
    """Return a configuration in which so many modules are used and none of them is named."""
    uses = (f"C{number} uses_data_from S" for number in range(count))
    return "\n".join(["@configuration", "@modules S", *uses, ""])


def verbs(folder: Path, count: int, ranked: bool) -> Mapping[str, Sequence[str]]:
    """Write the files of one size and return the commands on them by their titles."""
    file, less, specification, names = (
        str(folder / f"{name}.mars") for name in ("all", "less", "specification", "names")
    )
    Path(file).write_text(controlled(count, ranked), encoding="utf-8")
    Path(less).write_text(controlled(count, ranked, count // 2), encoding="utf-8")
    Path(names).write_text(undeclared(count), encoding="utf-8")
    taken("synthesise", file, "-o", specification)
    found = {
        "check": ("check", file),
        "synthesise": ("synthesise", file),
        "verify": ("verify", specification, file),
        "explain": ("explain", file),
        "explain ArbitrationNode": ("explain", file, "ArbitrationNode"),
        "explain --alternatives": ("explain", file, "--alternatives"),
        "diff, one controller less": ("diff", file, less),
    }
    return {**found, "explain --repair, undeclared names": ("explain", names, "--repair")}


def taken(*words: str) -> Taken:
    """Run a command as a process of its own."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = (sys.executable, "-m", "mars_asp", *words)
    done = subprocess.run(command, capture_output=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in FINE:
        raise SystemExit(f"{command} ended with status {done.returncode}")
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Taken(seconds, len(done.stdout) + len(done.stderr))


def least(words: Sequence[str]) -> Taken:
    """Return what a command takes, the least of some turns."""
    return min((taken(*words) for _ in range(TURNS)), key=lambda each: each.seconds)


def exponents(sizes: Sequence[int], alone: Taken, each: Sequence[Taken]) -> Iterator[str]:
    """Yield by which powers of the size grow seconds, those beyond `alone`, and bytes printed."""
    first, last = each[0], each[-1]
    times = math.log(sizes[-1] / sizes[0])
    for small, large in (
        (first.seconds, last.seconds),
        (first.seconds - alone.seconds, last.seconds - alone.seconds),
        (first.printed, last.printed),
    ):
        yield f"{math.log(large / small) / times:.2f}" if min(small, large) > 0 else "none"


def main() -> None:
    """Measure each verb in each size."""
    sizes = [int(word) for word in sys.argv[1:]] or [250, 500, 1000]
    print(f"seconds for {', '.join(map(str, sizes))} controllers; exponents of time, of time")
    print("beyond that of two controllers, and of what is printed", flush=True)
    with tempfile.TemporaryDirectory() as name:
        for kind, ranked in (("ranked", True), ("equal", False)):
            rows: dict[str, list[Taken]] = {}
            for size in (2, *sizes):
                for title, words in verbs(Path(name), size, ranked).items():
                    rows.setdefault(title, []).append(least(words))
            for title, (alone, *each) in rows.items():
                seconds = "  ".join(f"{one.seconds:6.2f}" for one in each)
                grown = "  ".join(exponents(sizes, alone, each))
                print(f"{kind:7} {title:35} {seconds}   {grown}", flush=True)


if __name__ == "__main__":
    main()
