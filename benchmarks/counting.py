"""How explanations grow with how often a rule fires that counts over what it fires for.

`python benchmarks/counting.py [QUESTION ...] [SIZE ...]`: a rule pack for each construct, of which
one rule fires for each of SIZE values and counts over all of them; QUESTION is "why", "every
derivation" or "why not". Prints the processor seconds of whole processes beyond those with two
values, the lesser of two turns, and how many times as much each size takes as the one before: twice
as much where the size doubles and growth is linear. From the first size to the last there are three
exponents: of the seconds of the whole process, of those beyond two values, and of the bytes that
are printed.
"""

import sys
import tempfile
from pathlib import Path

from controllers import Taken, exponents, least

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
    "conditional, negated": "value(_,S), not value(V,S) : listed(V).",
    "conditional, value named": "value(W,S), s(V) : listed(V).",
    "conditional, two values": "value(_,S), value(_,S), s(V) : listed(V).",
    "conditional and count": "value(W,S), {size} <= #count {{ V : value(V,S) }}, s(V) : listed(V).",
    "none of any": "value(W,S), not value(_,S).",
    "negation": "value(_,S), 2 <= #count {{ V : value(V,S) }}, not s(S).",
}
ASKED = {
    "why": (BODIES, ("counted",)),
    "every derivation": (BODIES, ("counted", "--all")),
    "why not": (ABSENT, ("--why-not", "counted(Drive)")),
}


def asked(folder: Path, body: str, size: int, *words: str) -> Taken:
    """Return what an explanation takes."""
    file, pack = folder / "drive.mars", folder / "pack.lp"
    file.write_text(CONFIGURATION, encoding="utf-8")
    pack.write_text(f"{HEAD}{body} {VALUES}".format(size=size), encoding="utf-8")
    return least(("explain", "--rules", str(pack), str(file), *words))


def main() -> None:
    sizes = [int(word) for word in sys.argv[1:] if word.isdigit()] or [250, 500, 1000, 2000, 4000]
    questions = [word for word in sys.argv[1:] if not word.isdigit()] or list(ASKED)
    print(f"seconds for {', '.join(map(str, sizes))} values (times the size before); exponents")
    print("of time, of time beyond that of two values, and of what is printed")
    with tempfile.TemporaryDirectory() as name:
        for title in questions:
            bodies, words = ASKED[title]
            for construct, body in bodies.items():
                empty = asked(Path(name), body, 2, *words)
                print(f"{title}, {construct}:", end="", flush=True)
                each: list[Taken] = []
                previous = 0.0
                for size in sizes:
                    each.append(asked(Path(name), body, size, *words))
                    beyond = each[-1].seconds - empty.seconds
                    grown = f" ({beyond / previous:.1f})" if previous > 0 else ""
                    print(f"  {beyond:.2f}{grown}", end="", flush=True)
                    previous = beyond
                print("  ", "  ".join(exponents(sizes, empty, each)), flush=True)


if __name__ == "__main__":
    main()
