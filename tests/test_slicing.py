"""What is explained from a slice is explained as from all rules and facts."""

from pathlib import Path

import pytest

from mars_asp.explain import explain
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
    facts = tuple(project_facts(project))
    part = slice_for("data_divergence(Runaway)", RULEBOOK, facts)
    assert part is not None
    assert len(part.facts) < len(facts) / 2
    assert len(part.rulebook.rules) < len(RULEBOOK.rules) / 4
    assert slice_for('splitter("Runaway",origin)', RULEBOOK, facts) is None
    assert slice_for("DataSplitter1", RULEBOOK, facts) is None
    assert slice_for("nothing(", RULEBOOK, facts) is None
