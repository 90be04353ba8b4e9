"""How `synthesise` grows with clients that share a library of converters.

    python benchmarks/library.py [CLIENTS ...]

A library has five times the root of the number of clients in converters. In a tree each makes a
representation of its own out of an earlier one; with other ways, every fifth makes one that is made
already, by another way or back, and some clients accept two. The clients use one source, a source
for each twenty of them, or each its own. A quarter of the clients is measured with other ways.
Prints the processor seconds of whole processes, the lesser of two turns, and the exponents with
which they grow from one size to the next.
"""

import math
import random
import sys
import tempfile
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

from growth import used

TURNS = 2
#: How many clients share a source; 0 stands for all.
KINDS = {"one source": 0, "a source for 20": 20, "a source for each": 1}
SERVICES = ("", "", " NotifyAtFrequency 10", " RequestWhenReady")


def library_lines(clients: int, together: int, tree: bool, rng: random.Random) -> Iterator[str]:
    """Yield a robot with so many clients, of which so many have one source."""
    sources = -(-clients // (together or clients))
    names = [*(f"S{at}" for at in range(sources)), *(f"C{at}" for at in range(clients))]
    yield "@configuration"
    yield "@modules " + ", ".join(names)
    for at in range(clients):
        yield f"C{at} uses_data_from S{at * sources // clients}{rng.choice(SERVICES)}"
    made = ["R0"]
    for at in range(round(5 * math.sqrt(clients))):
        if not tree and at % 5 == 4:
            one, other = rng.sample(made, 2)
        else:
            one, other = rng.choice(made), f"R{len(made)}"
            made.append(other)
        yield _block(f"K{at}", f"@Converts {rng.randint(1, 3)}", f"{other} f({one} x)")
    for at in range(sources):
        yield _block(f"S{at}", "@Sense NotifyAtFrequency 25", "R0 grab()")
    for at in range(clients):
        accepted = rng.sample(made, 1 if tree else rng.choice([1, 1, 2]))
        inputs = ", ".join(f"{each} x{number}" for number, each in enumerate(accepted))
        yield _block(f"C{at}", "@ControlOut", f"Motion act({inputs})")


def _block(name: str, annotation: str, declaration: str) -> str:
    return f"@module_start\n@module_name {name}\n{annotation}\n{declaration};\n@module_end"


def seconds(clients: int, together: int, tree: bool, folder: Path) -> float:
    """Return the processor seconds that a synthesis takes, the least of some turns."""
    file = folder / "library.mars"
    lines = library_lines(clients, together, tree, random.Random(1))
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    command = (sys.executable, "-m", "mars_asp", "synthesise", str(file))
    return min(used(command, (0,))[0] for _ in range(TURNS))


def main() -> None:
    """Measure each kind in each size."""
    clients = [int(word) for word in sys.argv[1:]] or [1250, 2500, 5000]
    with tempfile.TemporaryDirectory() as folder:
        for tree in (True, False):
            sizes = clients if tree else [size // 4 for size in clients]
            print(f"{'tree' if tree else 'other ways'}: seconds for {sizes} clients, exponents")
            for kind, together in KINDS.items():
                taken = [seconds(size, together, tree, Path(folder)) for size in sizes]
                print(f"{kind:18} {'  '.join(f'{each:6.2f}' for each in taken)}", end="   ")
                print("  ".join(exponents(sizes, taken)), flush=True)


def exponents(sizes: Sequence[int], taken: Sequence[float]) -> Iterator[str]:
    """Yield with which power of the size seconds grow from each size to the next."""
    for (small, before), (large, after) in pairwise(zip(sizes, taken, strict=True)):
        yield f"{math.log(after / before) / math.log(large / small):.2f}"


if __name__ == "__main__":
    main()
