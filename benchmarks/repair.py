"""Repairs of hubs as whole processes, against `check` of the same file.

    python benchmarks/repair.py [MODULES ...]

Two kinds of input, each with findings in number as its modules: the hub of `growth.py`, in which
no converter makes what half of the clients accept (warnings), and clients of one source of which a
third require twice its rate (errors). Prints processor seconds of `check` and of `explain
--repair`, their ratio, and the memory of the latter.
"""

import random
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from growth import hub_lines, used

MARS = (sys.executable, "-m", "mars_asp")
#: 1 where an error is there to repair.
FINE = (0, 1)


def rate_lines(modules: int, rng: random.Random) -> Iterator[str]:
    """Yield clients of one source, a third of which require more than it delivers."""
    clients = [f"C{index}" for index in range(modules)]
    yield "@configuration"
    yield "@modules S, " + ", ".join(clients)
    for client in clients:
        rate = rng.choice(["", " NotifyAtFrequency 10", " NotifyAtFrequency 50"])
        yield f"{client} uses_data_from S{rate}"
    yield "@module_start\n@module_name S\n@Sense NotifyAtFrequency 25\nRaw grab();\n@module_end"


def main() -> None:
    """Measure each kind in each size."""
    sizes = list(map(int, sys.argv[1:])) or [100, 200, 400]
    print("processor time: check, explain --repair (of check); memory")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "hub.mars"
        for name, lines in (("warnings", hub_lines), ("errors", rate_lines)):
            for size in sizes:
                written = "\n".join(lines(size, random.Random(1)))
                file.write_text(written + "\n", encoding="utf-8")
                check, _, _ = used((*MARS, "check", str(file)), FINE)
                repair, memory, _ = used((*MARS, "explain", str(file), "--repair"), FINE)
                print(
                    f"{name:9} {size:6}  {check:6.2f} s  {repair:6.2f} s ({repair / check:5.1f})"
                    f"  {memory:5.0f} MB",
                    flush=True,
                )


if __name__ == "__main__":
    main()
