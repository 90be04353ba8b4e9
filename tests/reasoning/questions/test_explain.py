"""Explanations of one sort alone."""

from pathlib import Path

import pytest

from mars_asp.asp.trace.document import trace_json
from mars_asp.diagnostic import MarsError
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.documents import ROOT, run
from tests.support.refusals import refusals

LEVEL0 = load_project(str(ROOT / "examples" / "level0" / "config.mars"))
#: `A` takes no part in what cannot be resolved.
IMPOSSIBLE = """\
@configuration
@modules A, B, C, D, E, F, G
A uses_data_from E
C uses_data_from E
F uses_data_from G
D uses_data_from B NotifyWhenReady
@module_start
@module_name B
@Sense RequestWhenReady
Image look();
@module_end
"""


@pytest.mark.parametrize("subject", [None, "Turn"])
def test_both_sorts_are_the_whole(subject: str | None) -> None:
    rulebook = load_rulebook()
    parts = [
        explain(Reasoner(LEVEL0, rulebook), subject, only=only)
        for only in ("consequences", "nodes")
    ]
    whole = explain(Reasoner(LEVEL0, rulebook), subject)

    assert parts[0].synthesis is None
    assert all(part.topics for part in parts)
    entries = [(t.title, trace_json(t.trace)) for part in parts for t in part.topics]
    assert entries == [(t.title, trace_json(t.trace)) for t in whole.topics]


def test_where_nothing_realises_the_configuration(tmp_path: Path) -> None:
    (tmp_path / "c.mars").write_text(IMPOSSIBLE)

    assert "data_divergence(E)" in run("mars-asp explain c.mars A --only consequences", tmp_path)
    answer = run("mars-asp explain c.mars --only nodes", tmp_path)
    assert answer.lstrip().startswith("no specification realises this configuration:")
    assert "so there is no node to explain" in " ".join(answer.split())
    refused = run("mars-asp explain c.mars A --only nodes", tmp_path)
    assert "no node resolves what concerns `A`: no specification" in refused
    refused = run("mars-asp explain c.mars F --only consequences", tmp_path)
    assert "nothing concerns `F`" in refused


def test_an_absent_consequence_is_reported_without_resolving() -> None:
    """The whole gives the same answer, after a specification was looked for."""
    rulebook = load_rulebook()
    whole = Reasoner(LEVEL0, rulebook)
    assert whole.synthesis is not None
    there = {topic.name for topic in explain(whole, only="consequences").topics}
    names = [name.text for name in LEVEL0.configuration.modules]
    subjects = [
        f"{kind}({name})" for kind in ("control_divergence", "service_dependency") for name in names
    ]
    subjects += ["control_divergence(Trun)", "control_divergence(", "control_divergence()"]
    for subject in subjects:
        if subject in there:
            continue
        part = Reasoner(LEVEL0, rulebook)
        with pytest.raises(MarsError) as result:
            explain(part, subject)
        assert result.value.diagnostics == refusals(explain, whole, subject)
        assert not part.is_resolved, subject
