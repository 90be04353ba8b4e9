"""A session answers many questions, each as a session of its own would."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest

from mars_asp.asp.trace.document import trace_json
from mars_asp.reasoning import session
from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.alternatives import alternatives
from mars_asp.reasoning.questions.explain import explain
from mars_asp.reasoning.questions.why_not import why_not
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.campaigns import sample
from tests.support.documents import ROOT
from tests.support.fixtures import Patch

PROJECT = load_project(str(ROOT / "examples/level1/config.mars"))
RULEBOOK = load_rulebook(stages=("resolve", "account"))
SUBJECTS = (
    "data_divergence(SonarMap)",
    "ArbitrationNode",
    "control_convergence",
    "MobilePlatform",
    None,
)


def explanation_of(reasoner: Reasoner, subject: str | None) -> list[object]:
    return [(t.title, trace_json(t.trace)) for t in explain(reasoner, subject).topics]


def answer_to(reasoner: Reasoner, question: int) -> object:
    if question < len(SUBJECTS):
        return explanation_of(reasoner, SUBJECTS[question])
    if question == len(SUBJECTS):
        answer = why_not(reasoner, "DataSplitter(Sonar)")
        return trace_json(answer.trace), answer.extra, answer.offered
    found = alternatives(reasoner, None, 2)
    return None if found is None else (found.forced, len(found.others), len(found.needs))


EVERY = range(len(SUBJECTS) + 2)


def fresh() -> Reasoner:
    return Reasoner(PROJECT, RULEBOOK)


@cache
def of(question: int) -> object:
    try:
        return answer_to(fresh(), question)
    except Exception as error:  # whatever it is, it is the answer
        return repr(error)


@pytest.mark.parametrize("first", sample(EVERY, 8))
def test_every_question_is_answered_after_any_other(first: int) -> None:
    reasoner = fresh()
    for question in (first, *EVERY, first):
        try:
            found = answer_to(reasoner, question)
        except Exception as error:
            found = repr(error)
        assert found == of(question), (first, question)


def counted(monkeypatch: Patch, name: str) -> list[tuple[object, ...]]:
    calls: list[tuple[object, ...]] = []
    own: Callable[..., object] = getattr(session, name)

    def call(*arguments: object, **settings: object) -> object:
        calls.append(arguments)
        return own(*arguments, **settings)

    monkeypatch.setattr(session, name, call)
    return calls


def test_a_specification_is_found_once(monkeypatch: Patch) -> None:
    analysed, synthesised = counted(monkeypatch, "analyse"), counted(monkeypatch, "synthesise")
    reasoner = fresh()
    for subject in (None, "ArbitrationNode", None, "MobilePlatform"):
        explain(reasoner, subject)
    why_not(reasoner, "DataSplitter(Sonar)")
    # What a change would give is looked for in another configuration.
    own = [call for call in analysed if call[0] == reasoner.facts]
    assert len(own) == len([call for call in synthesised if call[0] is reasoner.project]) == 1


def test_a_reasoner_that_explained_consequences_is_grounded_again_once(
    monkeypatch: Patch,
) -> None:
    analysed = counted(monkeypatch, "analyse")
    reasoner = fresh()
    explain(reasoner, None, only="consequences")
    explain(reasoner, None)
    explain(reasoner, None, only="consequences")
    assert reasoner.synthesis is not None
    assert len(analysed) == 2


def test_a_reasoner_verifies_its_synthesis_and_refuses_less() -> None:
    reasoner = Reasoner(PROJECT, load_rulebook(stages=("resolve", "verify")))
    assert reasoner.synthesis is not None
    whole = reasoner.synthesis.specification.configuration
    assert reasoner.verify(whole) == ()
    less = replace(whole, relationships=whole.relationships[1:])
    assert {violation.clause for violation in reasoner.verify(less)}
