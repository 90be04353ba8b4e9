"""All absences in one query have the explanations that `why_not` gives one by one."""

from pathlib import Path

import pytest

from mars_asp.reasoning.project import load_project
from mars_asp.reasoning.questions.absences import Absence, absences
from mars_asp.reasoning.questions.connected import BY_TYPE
from mars_asp.reasoning.questions.why_not import why_not
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.session import Reasoner
from tests.support.documents import ROOT
from tests.support.fixtures import Patch

#: A circle that begins with A, two controllers, and a module that nothing relates.
ROBOT = """\
@configuration hierarchical
@modules A, B, C, Base, Alone
A uses_data_from B
B uses_data_from C
C uses_data_from A
Base uses_data_from A
Base is_controlled_by B 1
Base is_controlled_by C 2
"""
QUESTIONS = [
    "data_cycle(B)",
    "DataSplitter(A)",
    "ArbitrationNode(Alone)",
    "control_convergence(Base)",
    "ControlSplitter(B)",
]


def reasoner(path: Path) -> Reasoner:
    return Reasoner(load_project(str(path)), load_rulebook(stages=("resolve",)))


def absences_by_title(path: Path, modules: list[str]) -> dict[str, Absence]:
    return {each.title: each for each in absences(reasoner(path), modules)}


@pytest.mark.parametrize(
    ("robot", "questions"),
    [
        (ROBOT, QUESTIONS),
        (None, ["DataSplitter(Head)", "module_conflict(Head)"]),
    ],
    ids=["circle", "unrealised"],
)
def test_each_answer_is_that_of_why_not(
    robot: str | None, questions: list[str], tmp_path: Path
) -> None:
    path = ROOT / "examples" / "module-conflict" / "config.mars"
    if robot is not None:
        path = tmp_path / "config.mars"
        path.write_text(robot)
    names = [name.text for name in reasoner(path).project.configuration.modules]
    found = absences_by_title(path, names)
    for question in questions:
        alone = why_not(reasoner(path), question, 1)
        together = found[question]
        assert (together.answer, together.evidence) == (alone.answer, alone.evidence)
        assert (together.present is not None) == alone.present


def test_absences_of_some_modules_are_those_of_the_whole_robot(tmp_path: Path) -> None:
    path = tmp_path / "config.mars"
    path.write_text(ROBOT)
    every = absences_by_title(path, ["A", "B", "C", "Base", "Alone"])
    alone = absences_by_title(path, ["Alone"])
    own = {title: each for title, each in every.items() if each.module == "Alone"}
    assert alone == {title: each for title, each in own.items() if each.kind not in BY_TYPE}


def test_too_many_modules_have_no_absences(tmp_path: Path, monkeypatch: Patch) -> None:
    path = tmp_path / "config.mars"
    path.write_text(ROBOT)
    monkeypatch.setattr("mars_asp.reasoning.questions.absences.MOST_MODULES", 4)
    assert absences_by_title(path, ["A", "B", "C", "Base", "Alone"]) == {}
    assert absences_by_title(path, ["Alone"])
