"""What is explained from a slice is explained as from all rules and facts."""

from collections.abc import Set
from pathlib import Path

import pytest

from mars_asp.atom import Fact
from mars_asp.explain import explain
from mars_asp.facts import ANNOTATIONS, WIRING
from mars_asp.project import load_project, project_facts
from mars_asp.rulebook import load_rulebook
from mars_asp.slicing import slice_for
from mars_asp.trace.text import trace_json
from tests.documents import ROOT

CONFIGURATIONS = sorted((ROOT / "examples").glob("*/config.mars"))
RULEBOOK = load_rulebook()


@pytest.mark.parametrize("path", CONFIGURATIONS, ids=lambda path: path.parent.name)
def test_a_slice_explains_as_the_whole_does(path: Path) -> None:
    project = load_project(str(path))
    whole = explain(project, RULEBOOK)
    for topic in whole.topics[: len(whole.analysis.consequences)]:
        part = explain(project, RULEBOOK, topic.title)
        assert part.synthesis is None
        traces = [trace_json(found.trace) for found in part.topics if found.title == topic.title]
        assert trace_json(topic.trace) in traces


def test_a_slice_is_smaller_and_what_is_chosen_has_none() -> None:
    project = load_project(str(ROOT / "examples" / "level0" / "config.mars"))

    def facts_of(names: Set[str]) -> tuple[Fact, ...]:
        return project_facts(project, wanted=names)

    part = slice_for("data_divergence(Runaway)", RULEBOOK, facts_of)
    assert part is not None
    assert len(part.facts) < len(project_facts(project)) / 2
    assert len(part.rulebook.rules) < len(RULEBOOK.rules) / 4
    assert slice_for('splitter("Runaway",origin)', RULEBOOK, facts_of) is None
    assert slice_for("DataSplitter1", RULEBOOK, facts_of) is None
    assert slice_for("nothing(", RULEBOOK, facts_of) is None


#: What the configurations of the project leave out.
RARE = """\
@configuration flat period 50
@modules Eye, Lens, Reader, Wheel, Turn, Part
Reader uses_data_from Eye
Wheel is_controlled_by Turn 2 hold 300
Part is_controlled_by Turn allocation root
@module_start
@module_name Eye
@Sense RequestWhenReady
a::Image grab();
@module_end
@module_start
@module_name Lens
@Sense RequestWhenReady
b::Image grab();
@module_end
@module_start
@module_name Reader
@DataIn
void read(Image image, auto other);
@module_end
"""


def test_facts_of_some_predicates_are_those_of_all(tmp_path: Path) -> None:
    rare = tmp_path / "rare.mars"
    rare.write_text(RARE)
    seen = set()
    paths = [*CONFIGURATIONS, *(ROOT / "tests" / "specifications").rglob("*.mars"), rare]
    paths += [ROOT / "tests" / "mixed.mars", ROOT / "tests" / "swapped.mars"]
    for path in paths:
        project = load_project(str(path))
        facts = project_facts(project)
        for name in {fact.atom.name for fact in facts}:
            seen.add(name)
            wanted = tuple(fact for fact in facts if fact.atom.name == name)
            assert project_facts(project, wanted={name}) == wanted
    assert seen >= WIRING | ANNOTATIONS | {"closed_walk"}
