"""The engine against xclingo 2: why one atom holds, by whole processes that read a file.

    python -m venv peer; peer/bin/pip install xclingo==2.0b24
    python benchmarks/engine.py peer/bin/xclingo [SIZE ...]

Three programs about graphs, none of which chooses, for xclingo explains every answer it is given:
a chain of edges, the same with as many chains beside it, and a square grid, where very many ways
lead to each place. Prints processor seconds of both, those of clingo alone, and ratios. A peer that
takes longer than a minute is ended.
"""

import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from math import isqrt
from pathlib import Path

MOST_SECONDS = 60
RULES = """
%! id: graph/start
%! because: `{X}` is where we begin
reach(X) :- start(X).
%! id: graph/step
%! because: an edge leads from `{X}` to `{Y}`
reach(Y) :- reach(X), edge(X,Y).
"""
#: The same for the peer, and what it is asked.
TRACED = """
%!trace_rule {{"% is where we begin", X}}.
reach(X) :- start(X).
%!trace_rule {{"an edge leads from % to %", X, Y}}.
reach(Y) :- reach(X), edge(X,Y).
%!show_trace {{{goal}}}.
"""
ASK = Path(__file__).parent.parent / "examples/engine/ask.py"


def chain(size: int) -> Iterator[str]:
    """Yield the facts of a chain of `size` edges."""
    yield "start(0)."
    yield from (f"edge({at},{at + 1})." for at in range(size))


def chains(size: int) -> Iterator[str]:
    """Yield those of a chain of 10 edges that is asked about, and of as many others as needed."""
    for first in range(0, size, 10):
        yield f"start({first * 2})."
        yield from (f"edge({first * 2 + at},{first * 2 + at + 1})." for at in range(10))


def grid(size: int) -> Iterator[str]:
    """Yield those of a grid of about `size` places; edges lead right and down."""
    side = max(2, isqrt(size))
    yield "start(0)."
    for row in range(side):
        for column in range(side):
            here = row * side + column
            if column + 1 < side:
                yield f"edge({here},{here + 1})."
            if row + 1 < side:
                yield f"edge({here},{here + side})."


def last(kind: str, size: int) -> int:
    """Return the place that is asked about: the last, or the end of the first chain."""
    side = max(2, isqrt(size))
    return {"chain": size, "chains": 10, "grid": side * side - 1}[kind]


KINDS = {"chain": chain, "chains": chains, "grid": grid}


def seconds(command: Sequence[str]) -> float | None:
    """Return the processor time of a command; `None` where it took too long or failed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        subprocess.run(command, capture_output=True, check=True, timeout=MOST_SECONDS)
    except subprocess.TimeoutExpired:
        return None
    except subprocess.CalledProcessError as error:
        # clingo ends with 30 where it has found all answers.
        if error.returncode not in (10, 30):
            return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def shown(taken: float | None) -> str:
    """Return seconds as a column."""
    return f"{'-':>8}" if taken is None else f"{taken:8.2f}"


def main() -> None:
    """Run what the command line says."""
    peer, sizes = sys.argv[1], list(map(int, sys.argv[2:])) or [100, 1000, 10_000]
    print(f"{'':<16} {'clingo':>8} {'asp':>8} {'xclingo':>8}  asp/clingo  xclingo/asp")
    with tempfile.TemporaryDirectory() as folder:
        for kind, facts in KINDS.items():
            for size in sizes:
                goal = f"reach({last(kind, size)})"
                path = Path(folder) / "graph.lp"
                path.write_text("\n".join((*facts(size), RULES)), encoding="utf-8")
                traced = Path(folder) / "traced.lp"
                text = "\n".join((*facts(size), TRACED.format(goal=goal)))
                traced.write_text(text, encoding="utf-8")
                alone = seconds([sys.executable, "-m", "clingo", "--verbose=0", str(path)])
                ours = seconds([sys.executable, str(ASK), str(path), "why", goal])
                theirs = seconds([peer, "-n", "1", "1", str(traced)])
                floor = f"{ours / alone:10.1f}" if ours and alone else f"{'-':>10}"
                ratio = f"{theirs / ours:11.1f}" if ours and theirs else f"{'-':>11}"
                columns = f"{shown(alone)} {shown(ours)} {shown(theirs)}"
                print(f"{kind:<8} {size:>7} {columns}  {floor}  {ratio}", flush=True)


if __name__ == "__main__":
    main()
