"""No specification that `rules/verify` accepts is cheaper than a minimal one."""

import pytest

from mars_asp.language import parse_text
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import Project, project_facts
from mars_asp.reasoning.rules import CONVERSION, NODES, RELATIONSHIPS
from mars_asp.reasoning.synthesis.synthesise import synthesise
from mars_asp.reasoning.verification import verify
from tests.support.campaigns import seeds
from tests.support.second_opinion import MOST_NODES, PARTS, RULEBOOK, cheaper_than, second_opinion


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("seed", seeds(2, 40))
def test_no_specification_is_better_than_the_least(part: str, seed: int) -> None:
    text = PARTS[part](seed)
    opinion = second_opinion(text)
    assert not opinion.better, f"{text}\n{opinion.better}"


@pytest.mark.parametrize("part", PARTS)
def test_the_search_finds_the_optimum(part: str) -> None:
    """Where a node, a cost or a line more is called least, the true least is found."""
    compared = 0
    for seed in seeds(1, 3):
        project = Project(parse_text(PARTS[part](seed), "c.mars").configuration, {}, ())
        analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
        found = synthesise(project, analysis, RULEBOOK)
        if found is None or found.cost(NODES) >= MOST_NODES:
            continue
        least = (found.cost(NODES), found.cost(CONVERSION), found.cost(RELATIONSHIPS))
        for more in ((1, 0, 0), (0, 1, 0)):
            nodes, conversion, lines = (a + b for a, b in zip(least, more, strict=True))
            other = cheaper_than((nodes, conversion, lines), project)
            assert other is not None, f"{PARTS[part](seed)}\n{least} {more}"
            assert verify(other, project, RULEBOOK) == ()
        compared += 1
    assert compared
