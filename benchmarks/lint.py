"""What it takes to lint a large rule pack.

`python benchmarks/lint.py [RULES]`: a pack of as many rules (4,000), made of our own rules of the
base with their predicates renamed again and again, and the processor seconds of `rules lint` on it
and on a pack of one rule, as whole processes, the least of some turns.
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


def main(count: int) -> None:
    """Print what packs take."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "pack.lp"
        taken = []
        for text in ("guarded_here(M) :- guard(M).\n#show guarded_here/1.\n", pack(count)):
            path.write_text(text)
            taken.append(least(("rules", "lint", str(path))))
        small, large = taken
        print(f"one rule: {small.seconds:.2f} s; {count} rules: {large.seconds:.2f} s")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4000)
