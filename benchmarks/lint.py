"""What it takes to lint a large rule pack.

`python benchmarks/lint.py [RULES]`: a pack of as many rules (4,000), made of our own rules of the
base with their predicates renamed again and again, and the processor seconds of `rules lint` on it
and on a pack of one rule, as whole processes, the least of some turns. Besides them packs of as
many rules in other shapes: what is linear takes about as long for each.
"""

import re
import sys
import tempfile
from pathlib import Path

from controllers import least

from mars_asp.reasoning.findings import CONTRACT, EXPANSIONS
from mars_asp.reasoning.rules import load_rulebook

#: Predicates that a pack may derive, too.
SHARED = {CONTRACT.finding.name, *(each.gives for each in EXPANSIONS.values())}


def pack(count: int) -> str:
    """Return at least so many rules."""
    rules = [rule for rule in load_rulebook(stages=()).rules if rule.stage == "base"]
    names = {each.name for rule in rules for each in rule.heads} - SHARED
    renamed = re.compile(rf'(?<![\w"{{])({"|".join(sorted(names, key=len, reverse=True))})\b')
    written: list[str] = []
    turn = 0
    while len(written) < count:
        turn += 1
        for rule in rules:
            if rule.listed is None:
                lines = [f"%! because: {rule.because}"] if rule.because else []
                lines += [f"%! fits: {rule.fits}"] if rule.fits else []
                text = renamed.sub(lambda name: f"{name[1]}_{turn}", rule.text)  # noqa: B023
                written.append("\n".join([*lines, text]))
    return "\n".join(written)


#: Rules of other shapes; `{0}` is the number of a rule, `{1}` that of the one before, `{2}` that of
#: the last, which comes before the first in a circle.
SHAPES = {
    "facts": 'f{0}("m", {0}). #show f{0}/2.',
    "a table": "f(k{0}, {0}). #show f/2.",
    "a chain": "c{0}(M) :- c{1}(M), module(M). #show c{2}/1.",
    "a circle": "c{0}(M) :- c{1}(M), module(M). #show c{2}/1.",
    "one head": 'p(M) :- uses_data_from(_, M, "s{0}"). #show p/1.',
    "aggregates": "p{0}(M) :- guard(M), {0} < #count {{ S : link(_, M, S) }}. #show p{0}/1.",
    "conditions": 'p{0}(M) :- guard(M); S != "s{0}" : uses_data_from(_, M, S). #show p{0}/1.',
    "sums": "q{0}(R, T + {0}) :- hold(R, T), T < {0}. #show q{0}/2.",
}


def shaped(shape: str, count: int) -> str:
    """Return so many rules of a shape."""
    first = "c0(M) :- module(M)." if shape == "a chain" else ""
    begin = 1 if first else 0
    rules = (
        SHAPES[shape].format(n, n - 1 if n else count - 1, count - 1) for n in range(begin, count)
    )
    return "\n".join([first, *rules])


def main(count: int) -> None:
    """Print what packs take."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "pack.lp"
        packs = {
            "one rule": "guarded_here(M) :- guard(M).\n#show guarded_here/1.\n",
            f"{count} rules": pack(count),
            **{f"{count} rules, {shape}": shaped(shape, count) for shape in SHAPES},
        }
        for name, text in packs.items():
            path.write_text(text)
            taken = least(("rules", "lint", str(path)))
            print(f"{name}: {taken.seconds:.2f} s", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4000)
