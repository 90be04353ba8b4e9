"""The cost of explanations: whole processes, as ratios to others in the same run.

`python benchmarks/explain.py [MODULES]`: robots of ten modules each, one source with many clients,
and clients that share converters. Explanations of everything are compared with the command that
they contain, a question about a consequence with `analyse`, one about a node with `synthesise`.
"""

import random
import statistics
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from growth import robot_lines, used
from library import library_lines

#: How often each command is measured, beside what it is compared with each time.
TURNS = 5
#: So many clients share 300 converters in `library.py`.
CLIENTS = 3600
#: The question about the small robot that is subtracted, by the command that it contains.
SMALL = {"analyse": "data_divergence(Hub)", "synthesise": "DataSplitter1"}


def measure(*words: str) -> tuple[float, float]:
    """Return the seconds of CPU and the MB of memory that a command takes."""
    # 1 is an error-level finding, 30 that clingo has found all answers.
    seconds, memory, _ = used(words, (0, 1, 30))
    return seconds, memory


def mars(*words: str) -> tuple[float, float]:
    return measure(sys.executable, "-m", "mars_asp", *words)


def hub_lines(clients: int) -> list[str]:
    """Return a robot in which one source has many clients."""
    names = [f"C{number}" for number in range(clients)]
    lines = [f"{name} uses_data_from Hub" for name in names]
    return ["@configuration", f"@modules Hub, {', '.join(names)}", *lines]


def ratios(path: str) -> None:
    """Print what whole explanations take and keep, as ratios to the verb that they contain."""
    for title, words, contained in (
        ("everything", ("explain", path), "synthesise"),
        ("everything, lines of JSON", ("explain", path, "--format", "jsonl"), "synthesise"),
        ("all consequences", ("explain", path, "--only", "consequences"), "analyse"),
        ("synthesise", ("synthesise", path), "analyse"),
    ):
        turns = [(mars(contained, path), mars(*words)) for _ in range(TURNS)]
        time = statistics.median(taken / base for (base, _), (taken, _) in turns)
        memory = statistics.median(kept / base for (_, base), (_, kept) in turns)
        print(f"{title:<26} {time:5.2f} x {contained:<10}  memory {memory:5.2f}", flush=True)


def question(path: str, contained: str, words: Sequence[str], small: str) -> None:
    """Print how long a question takes, as a ratio to the command that it contains.

    Start-up is not counted: of each command, the time that it takes for the `small` robot is
    subtracted.
    """
    turns = []
    for _ in range(TURNS):
        base = mars(contained, path)[0] - mars(contained, small)[0]
        # The small robot is a hub of two clients, so it has the consequence of any hub.
        taken = mars("explain", path, *words)[0] - mars("explain", small, SMALL[contained])[0]
        turns.append(taken / base)
    asked = " ".join(words)
    print(f"{Path(path).stem:<12} {asked:<34} {statistics.median(turns):5.2f} x {contained}")


def main() -> None:
    modules = int((*sys.argv[1:], "10000")[0])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def robot(title: str, lines: Iterable[str]) -> str:
            path = folder / f"{title}.mars"
            path.write_text("\n".join(lines) + "\n")
            return str(path)

        small = robot("small", hub_lines(2))
        islands = [robot(f"islands{n}", robot_lines(n, random.Random(1))) for n in (100, 1000)]
        hubs = [robot(f"hub{n}", hub_lines(n)) for n in (60, 200, 500)]
        library = robot("library", library_lines(CLIENTS, 1, True, random.Random(1)))
        print(f"medians of {TURNS} turns; {modules} modules in islands of ten", flush=True)
        ratios(robot("islands", robot_lines(modules, random.Random(1))))
        for path in islands:
            question(path, "analyse", ("data_divergence(M7_0)",), small)
            question(path, "synthesise", ("DataSplitter1",), small)
        for path in hubs:
            question(path, "analyse", ("data_divergence(Hub)",), small)
            question(path, "synthesise", ("DataSplitter1",), small)
        question(library, "analyse", ("representation_dependency(C200)",), small)
        question(library, "synthesise", ("DataTransformer1",), small)


if __name__ == "__main__":
    main()
