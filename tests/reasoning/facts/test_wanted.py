"""Facts of some predicates are those of these predicates among all facts."""

from mars_asp.reasoning.facts.compile import FRAMES
from mars_asp.reasoning.project import load_project, project_facts
from tests.support.documents import ROOT


def test_facts_of_some_predicates_are_those_of_all() -> None:
    seen = set()
    for path in sorted((ROOT / "examples").glob("*/config.mars")):
        project = load_project(str(path))
        facts = project_facts(project)
        for name in {fact.atom.name for fact in facts}:
            seen.add(name)
            wanted = tuple(fact for fact in facts if fact.atom.name == name)
            assert project_facts(project, wanted={name}) == wanted
    assert seen & FRAMES
    assert seen - FRAMES
