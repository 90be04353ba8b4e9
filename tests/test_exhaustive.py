"""What is found and proven minimal costs what an exhaustive search finds.

    python -m tests.test_exhaustive HOW_MANY [FIRST_SEED]

does the same for as many random configurations as wanted.
"""

import sys

import pytest

from mars_asp.analysis import analyse
from mars_asp.language import parse_text
from mars_asp.project import Project, project_facts
from mars_asp.resolve import CONVERSION, NODES, RELATIONSHIPS, Synthesis, synthesise
from mars_asp.rulebook import load_rulebook
from mars_asp.verify import verify
from tests.exhaustive import minimal
from tests.random_configurations import random_configuration

RULEBOOK = load_rulebook(stages=("resolve", "verify"))


def read(text: str) -> Project:
    return Project(parse_text(text, "c.mars").configuration, {}, ())


def synthesised(project: Project) -> Synthesis | None:
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    return synthesise(project.configuration, {}, analysis, RULEBOOK)


def compare(seed: int) -> str | None:
    """Return what differs for a random configuration."""
    project = read(random_configuration(seed))
    expected = minimal(project.configuration, {})
    found = synthesised(project)
    if found is None or expected is None:
        agree = found is None and expected is None
        return None if agree else f"{found and found.resolution}; exhaustive search {expected}"
    cost = (found.cost(NODES), found.cost(CONVERSION), found.cost(RELATIONSHIPS))
    if (cost, found.resolution.count) != expected:
        return f"{cost}, {found.resolution.count} optima; exhaustive search {expected}"
    violations = verify(found.specification.configuration, project, RULEBOOK)
    return violations[0].message if violations else None


@pytest.mark.parametrize("seed", range(200))
def test_the_cost_is_that_of_an_exhaustive_search(seed: int) -> None:
    assert compare(seed) is None


def main() -> None:
    many, first = (int(word) for word in (*sys.argv[1:], "0")[:2])
    wrong = 0
    for seed in range(first, first + many):
        if difference := compare(seed):
            wrong += 1
            print(f"seed {seed}: {difference}")
    print(f"{many} configurations, {wrong} differ")


if __name__ == "__main__":
    main()
