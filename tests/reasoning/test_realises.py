"""`verify` accepts and refuses the same specifications as a judge written from the text.

`python -m tests.reasoning.synthesis.test_exhaustive HOW_MANY FIRST_SEED verify` tries as
many as wanted.
"""

import random
from dataclasses import replace

import pytest

from mars_asp.model.declarations import Configuration
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.verification import verify
from tests.support.campaigns import seeds
from tests.support.mutants import mutant
from tests.support.random_configurations import (
    random_carried,
    random_cascades,
    random_configuration,
    random_inputs,
    random_mounts,
)
from tests.support.realises import UnsaidError, violation
from tests.support.subjects import RULEBOOK, read, synthesised

KINDS = (random_configuration, random_mounts, random_inputs, random_carried, random_cascades)
MUTANTS = 4


def compare_judged(seed: int) -> str | None:
    """Return the difference for a specification and its mutants."""
    project = read(KINDS[seed % len(KINDS)](seed))
    found = synthesised(project)
    if found is None:
        return None
    declared = project.configuration.declared
    specification = replace(found.specification.configuration, declared=declared)
    differences = [disagreement(specification, project, "as synthesised")]
    rng = random.Random(seed)
    for _ in range(MUTANTS):
        what, changed = mutant(specification, rng)
        differences.append(disagreement(changed, project, what))
    return "; ".join(each for each in differences if each) or None


def disagreement(specification: Configuration, project: Project, what: str) -> str | None:
    """Return how `verify` differs from the judge; nothing where the text does not decide."""
    try:
        reason = violation(specification, project.configuration)
    except UnsaidError:
        return None
    violations = verify(specification, project, RULEBOOK)
    if bool(violations) == (reason is not None):
        return None
    result = violations[0].message if violations else "realises it"
    return f"[{what}] verify: {result}; the text: {reason or 'realises it'}"


@pytest.mark.parametrize("seed", seeds(4, 10))
def test_verify_judges_as_the_text_does(seed: int) -> None:
    assert compare_judged(seed) is None
