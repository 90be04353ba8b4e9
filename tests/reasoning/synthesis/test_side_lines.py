"""Gates, resets, locks, limits and strategies against second opinions, written from the text.

    python -m tests.reasoning.synthesis.test_side_lines HOW_MANY [FIRST_SEED [PART ...]]

tries as many random configurations of each part: `cost` and `typed` (the exhaustive search finds
the same least cost, and the judge accepts what is synthesised), `verify` (the judge accepts and
refuses the same changed specifications as `verify`), `again` and `names` (a printed specification
is its own specification; of `names`, with triggers that nothing else mentions).
"""

import random
import sys
from collections.abc import Callable, Sequence

import pytest

from mars_asp.language import print_configuration
from mars_asp.reasoning.verification import verify
from tests.reasoning.synthesis.test_exhaustive import cost_of
from tests.support.campaigns import seeds
from tests.support.exhaustive_sides import least_cost_with_sides
from tests.support.random_side_lines import changed, random_names, random_side_lines
from tests.support.realises import UnsaidError
from tests.support.subjects import RULEBOOK, alarms, read, synthesised
from tests.support.subsumes import subsumption_violation

CHANGES = 4


def compare_cost(seed: int, typed: bool = False) -> str | None:
    """Return the difference for a configuration, or None."""
    project = read(random_side_lines(seed, typed))
    expected = least_cost_with_sides(project.configuration, {})
    found = synthesised(project)
    if found is None or expected is None:
        agree = found is None and expected is None
        return None if agree else f"{found and cost_of(found)}; exhaustive search {expected}"
    if cost_of(found) != expected:
        return f"{cost_of(found)}; exhaustive search {expected}"
    specification = found.specification.configuration
    violations = verify(specification, project, RULEBOOK)
    if violations:
        return f"verify: {violations[0].message}"
    refused = None if typed else subsumption_violation(specification, project.configuration)
    return refused and f"the judge: {refused}"


def compare_verify(seed: int) -> str | None:
    """Return the differences for a specification and some changes of it, or None."""
    project = read(random_side_lines(seed))
    found = synthesised(project)
    if found is None:
        return None
    rng = random.Random(seed)
    differences = []
    for _ in range(CHANGES):
        what, specification = changed(found.specification.configuration, rng)
        try:
            reason = subsumption_violation(specification, project.configuration)
        except UnsaidError:
            continue
        violations = verify(specification, project, RULEBOOK)
        if bool(violations) != (reason is not None):
            result = violations[0].message if violations else "realises it"
            differences.append(f"[{what}] verify: {result}; the text: {reason or 'realises it'}")
    return "; ".join(differences) or None


def compare_again(text: str) -> str | None:
    """Return the difference when the specification of a text is read back, or None."""
    configured = read(text)
    found = synthesised(configured)
    if found is None:
        return None
    printed = print_configuration(found.specification.configuration)
    blocks = text[text.find("@module_start") :] if "@module_start" in text else ""
    project = read(printed + blocks)
    again = synthesised(project)
    if again is None:
        return f"nothing realises\n{printed}"
    specification = again.specification.configuration
    violations = verify(specification, project, RULEBOOK)
    if violations:
        return f"verify: {violations[0].message}\n{printed}"
    if (reprinted := print_configuration(specification)) != printed:
        return f"{printed}is read back as\n{reprinted}"
    known = alarms(configured)
    new = alarms(project) - known
    if known & {"idle_gate", "suppression_cycle"}:
        # A line that gates nothing that is used leaves no line in the specification.
        new -= {"unused_module"}
    return f"new findings: {', '.join(new)}\n{printed}" if new else None


PARTS: dict[str, Callable[[int], str | None]] = {
    "cost": compare_cost,
    "typed": lambda seed: compare_cost(seed, typed=True),
    "verify": compare_verify,
    "again": lambda seed: compare_again(random_side_lines(seed, typed=seed % 2 == 1)),
    "names": lambda seed: compare_again(random_names(seed)),
}


@pytest.mark.parametrize(
    ("part", "seed"), [(part, seed) for part in PARTS for seed in seeds(3, 60)]
)
def test_side_lines_as_the_text_has_them(part: str, seed: int) -> None:
    assert PARTS[part](seed) is None


def main(words: Sequence[str]) -> int:
    many, first = (int(word) for word in (*words, "0")[:2])
    wrong = 0
    for part in words[2:] or PARTS:
        differ = 0
        for seed in range(first, first + many):
            if difference := PARTS[part](seed):
                differ += 1
                print(f"{part}, seed {seed}: {difference}", flush=True)
        print(f"{part}: {many} from seed {first}, {differ} differ")
        wrong += differ
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
