"""How explanations grow with how often a rule fires that counts over what it fires for.

`python benchmarks/counting.py [SIZE ...]`: a rule pack for each construct, of which one rule fires
for each of SIZE values and counts over all of them. Prints the processor seconds of whole processes
beyond those with two values, the least of three runs, and how many times as much each size takes as
the one before: twice as much where the size doubles and growth is linear.
"""

import sys
import tempfile
from pathlib import Path

from growth import used

CONFIGURATION = "@configuration\n@modules Drive\n"
HEAD = 'consequence(counted, note, "Drive", values) :- '
#: What is counted is derived, so that it has premises of its own.
VALUES = "value(V,s) :- listed(V). listed(1..{size}). s(s)."
#: A body that counts, by construct; braces of the rule are doubled.
BODIES = {
    "count": "value(_,S), 2 <= #count {{ V : value(V,S) }}.",
    "count =": "value(_,S), N = #count {{ V : value(V,S) }}.",
    "sum": "value(_,S), {size} <= #sum {{ V : value(V,S) }}.",
    "sum =": "value(_,S), N = #sum {{ V : value(V,S) }}.",
    "min": "value(_,S), #min {{ V : value(V,S) }} <= 1.",
    "min =": "value(_,S), N = #min {{ V : value(V,S) }}.",
    "max": "value(_,S), {size} <= #max {{ V : value(V,S) }}.",
    "max =": "value(_,S), N = #max {{ V : value(V,S) }}.",
    "set": "value(_,S), 2 {{ value(V,S) }}.",
    "conditional": "value(_,S), value(V,S) : listed(V).",
    "recursion": (
        "{size} <= #count {{ V : on(V) }}. "
        "on(1..2). on(V) :- value(V,_), 2 <= #count {{ W : on(W) }}."
    ),
    "steps": (
        "on({size}). "
        "on(1..2). on(V) :- step(V), 2 <= #count {{ W : up(W) }}. up(V) :- on(V), V < 3. "
        "step(V+1) :- on(V), V < {size}. step(1)."
    ),
}
#: Bodies that fail for each value.
ABSENT = {
    "count": "value(_,S), {size} < #count {{ V : value(V,S) }}.",
    "sum": "value(_,S), 0 > #sum {{ V : value(V,S) }}.",
    "min": "value(_,S), #min {{ V : value(V,S) }} > 1.",
    "max": "value(_,S), {size} < #max {{ V : value(V,S) }}.",
    "set": "value(_,S), {{ value(V,S) }} 2.",
    "conditional": "value(_,S), s(V) : listed(V).",
    "negation": "value(_,S), 2 <= #count {{ V : value(V,S) }}, not s(S).",
}
ASKED = {
    "why": (BODIES, ("counted",)),
    "every derivation": (BODIES, ("counted", "--all")),
    "why not": (ABSENT, ("--why-not", "counted(Drive)")),
}


def seconds(folder: Path, body: str, size: int, *words: str) -> float:
    """Return the seconds of CPU that an explanation takes."""
    file, pack = folder / "drive.mars", folder / "pack.lp"
    file.write_text(CONFIGURATION, encoding="utf-8")
    pack.write_text(f"{HEAD}{body} {VALUES}".format(size=size), encoding="utf-8")
    explain = (sys.executable, "-m", "mars_asp", "explain", "--rules", str(pack), str(file))
    return min(used((*explain, *words), (0,))[0] for _ in range(3))


def main() -> None:
    sizes = [int(word) for word in sys.argv[1:]] or [250, 500, 1000, 2000, 4000]
    print(f"seconds for {', '.join(map(str, sizes))} values (times the size before)")
    with tempfile.TemporaryDirectory() as name:
        for title, (bodies, words) in ASKED.items():
            for construct, body in bodies.items():
                empty = seconds(Path(name), body, 2, *words)
                print(f"{title}, {construct}:", end="", flush=True)
                previous = 0.0
                for size in sizes:
                    beyond = seconds(Path(name), body, size, *words) - empty
                    grown = f" ({beyond / previous:.1f})" if previous > 0 else ""
                    print(f"  {beyond:.2f}{grown}", end="", flush=True)
                    previous = beyond
                print(flush=True)


if __name__ == "__main__":
    main()
