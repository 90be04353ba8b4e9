"""Rule packs that would take for ever.

`python -m tests.support.runaways` runs each under every limit. Each ends with the right reason and
in time, which is processor time, or is refused before clingo sees it. Without an option memory is
limited to half of the available memory; a runaway within that limit is interrupted, and ends.
"""

import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from tests.support.documents import ROOT
from tests.support.processes import ended_children_time

MARS = (sys.executable, "-m", "mars_asp")
LEVEL0 = "examples/level0/config.mars"

PACKS: Mapping[str, str] = {
    "successor": "p(1).\np(X + 1) :- p(X).\n",
    "nesting of functions": "p(a).\np(f(X)) :- p(X).\n",
    "pairs of pairs": "p(a).\np((X, X)) :- p(X).\n",
    "interval": "p(1..2000000000).\n",
    "cross product": "d(1..3000).\nq(X, Y, Z) :- d(X), d(Y), d(Z).\n",
    "aggregate over a cube": "d(1..1500).\nq(N) :- N = #count { X, Y, Z : d(X), d(Y), d(Z) }.\n",
    "join": "d(1..60000).\nq(X, Y) :- d(X), d(Y), X != Y.\n",
    "transitive closure": (
        "e(1..4000, 1..4000).\nr(X, Y) :- e(X, Y).\nr(X, Z) :- r(X, Y), e(Y, Z).\n"
    ),
    "condition over pairs": "d(1..60000).\nq :- X != Y : d(X), d(Y).\n",
    "pools in pools": f"p({', '.join(['(1; 2)'] * 40)}).\n",
    "sums of sums": "s(0).\nd(1..100000).\ns(N + M) :- s(N), d(M), N + M < 2000000000.\n",
    "terms of two": "p(a).\np(b).\np(f(X, Y)) :- p(X), p(Y).\n",
    "deep terms": f"p({'f(' * 50_000}a{')' * 50_000}).\n",
    "long sum": f"p(X) :- X = {' + '.join(['1'] * 30_000)}.\n",
    "sum within the bounds of the gate": f"p(X) :- X = {' + '.join(['1'] * 4_000)}.\n",
    "signs": f"p(X) :- X = {'-' * 4_000}1.\n",
    "long body": (
        f"d(0..1).\nq :- {', '.join(f'd(X{i})' for i in range(40))}, "
        f"{' + '.join(f'X{i}' for i in range(40))} = 41.\n"
    ),
    "facts": "".join(f"p({i}).\n" for i in range(700_000)),
}
#: By options: the message when they end a runaway, and the seconds that it may take.
MODES: Mapping[tuple[str, ...], tuple[str, float]] = {
    ("--time-limit", "5"): ("the time limit of 5 s ended this", 6.0),
    ("--memory-limit", "512", "--time-limit", "60"): (" ended this", 61.0),
    (): ("half of what there is", 120.0),
}
#: Seconds within which an interrupted command ends.
_SOON = 1.0
_REFUSED, _ENDED, _INTERRUPTED = 2, 3, 128 + signal.SIGINT


def contained(name: str, options: tuple[str, ...], message: str, seconds: float) -> tuple[str, str]:
    """Run a runaway; return its end, and the fault of that end or an empty text.

    Without a time limit in the options, it is interrupted after `seconds`.
    """
    with tempfile.TemporaryDirectory() as folder:
        pack = Path(folder) / "pack.lp"
        pack.write_text(PACKS[name])
        begun = ended_children_time()
        command = subprocess.Popen(
            [*MARS, "analyse", LEVEL0, "--rules", str(pack), *options],
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            _, result = command.communicate(timeout=None if options else seconds)
        except subprocess.TimeoutExpired:
            seconds += _SOON
            command.send_signal(signal.SIGINT)
            _, result = command.communicate()
        took = ended_children_time() - begun
    last = (result.strip().splitlines() or [f"status {command.returncode}"])[-1]
    end = f"{took:.1f} s, {last:.100}"
    if "internal error" in result or "Traceback" in result:
        return end, "an internal error"
    if took > seconds:
        return end, f"took more than {seconds} s"
    if command.returncode == _ENDED and message not in result and "memory limit" not in result:
        return end, f"does not say `{message}`"
    if command.returncode == _REFUSED and "pack.lp:" not in result:
        return end, "is refused without a place"
    if command.returncode not in (0, _REFUSED, _ENDED, _INTERRUPTED):
        return end, f"status {command.returncode}"
    return end, ""


def main() -> int:
    """Run all; 1 where one was not contained."""
    faults = 0
    for options, (item, seconds) in MODES.items():
        print(" ".join(options))
        for name in PACKS:
            end, wrong = contained(name, options, item, seconds)
            faults += bool(wrong)
            print(f"  {name}: {end}{'  WRONG: ' if wrong else ''}{wrong}", flush=True)
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())
