"""The configurations of the paper's figures give the specifications that the paper prints."""

import json
import re
from runpy import run_path

import pytest

from mars_asp.behaviour.testing import Stepper
from tests.support.documents import ROOT, run

FIGURES = {
    "figure04-divergence": """
        @specification
        @modules Camera, OperatorScreen, HoughTransform,
        DataSplitter1
        DataSplitter1 uses_data_from Camera
        OperatorScreen uses_data_from DataSplitter1
        HoughTransform uses_data_from DataSplitter1
    """,
    "figure07-representation": """
        @specification
        @modules Camera, ObjectAnalysis, DataTransformer1
        DataTransformer1 uses_data_from Camera
        ObjectAnalysis uses_data_from DataTransformer1
    """,
    "figure10-flat-arbitration": """
        @specification flat
        @modules MobilePlatform, WanderBehaviour,
        AvoidObstacleBehaviour, ArbitrationNode
        MobilePlatform is_controlled_by ArbitrationNode
        ArbitrationNode is_controlled_by WanderBehaviour
        ArbitrationNode is_controlled_by AvoidObstacleBehaviour
    """,
    "figure13-hierarchical-arbitration": """
        @specification hierarchical
        @modules MobilePlatform, WanderBehaviour,
        AvoidObstacleBehaviour, ArbitrationNode
        MobilePlatform is_controlled_by ArbitrationNode
        ArbitrationNode is_controlled_by WanderBehaviour 0
        ArbitrationNode is_controlled_by AvoidObstacleBehaviour 1
    """,
    "figure15-control-divergence": """
        @specification
        @modules Wander, MobilePlatform1, MobilePlatform2,
        ControlSplitter1
        ControlSplitter1 is_controlled_by Wander
        MobilePlatform1 is_controlled_by ControlSplitter1
        MobilePlatform2 is_controlled_by ControlSplitter1
    """,
}


def tokens(text: str) -> list[str]:
    """Return the words of a configuration without comments, sources and module blocks."""
    body = re.sub(r"(//|#).*|^@sources.*|(?s:^@module_start.*)", "", text, flags=re.MULTILINE)
    return re.findall(r"[\w@.]+|\S", body)


@pytest.mark.parametrize("example", FIGURES)
def test_specification_of_a_figure(example: str) -> None:
    printed = run(f"mars-asp synthesise examples/{example}/config.mars")
    assert tokens(printed) == tokens(FIGURES[example])


def test_nodes_of_figure_19() -> None:
    found = json.loads(run("mars-asp synthesise --format json examples/level0/config.mars"))
    introduced = [m["kind"] for m in found["modules"] if m["origin"] == "introduced"]
    assert introduced == ["data_splitter", "data_splitter", "arbitration_node"]
    assert found["proven_minimal"]
    assert found["cost"]["nodes"] == 3


@pytest.mark.parametrize(("example", "nodes", "lines"), [("figure17", 2, 12), ("figure20", 4, 17)])
def test_figures_with_side_lines(example: str, nodes: int, lines: int) -> None:
    found = json.loads(run(f"mars-asp synthesise --format json examples/{example}/config.mars"))
    assert found["cost"] == {"nodes": nodes, "conversion": 0, "relationships": lines}
    assert found["proven_minimal"]
    assert found["optimal_count"] == 1
    assert len(found["resets"]) == 1


@pytest.mark.parametrize("example", [*FIGURES, "figure17", "figure20", "level0"])
def test_a_specification_read_back_has_nothing_to_resolve(example: str) -> None:
    specification = ROOT / "tests" / "specifications" / f"{example}.mars"
    assert specification.read_text() == run(f"mars-asp synthesise examples/{example}/config.mars")
    found = json.loads(run(f"mars-asp analyse --format json {specification}"))
    # Loose wires are findings of both; nothing of them is resolved.
    kinds = {each["kind"] for each in found["consequences"]}
    assert kinds <= {"unused_output", "loose_end"}


FIGURE_20 = run_path(str(ROOT / "examples" / "level1" / "sources" / "subsumption.py"))
HEADING, LEG, HALT = (FIGURE_20[name] for name in ("Heading", "Leg", "Halt"))


def test_turn_of_figure_20_takes_one_heading_until_its_reset() -> None:
    turn = FIGURE_20["Turn"]()
    turned = Stepper(turn, method="turn")
    for tenth in range(5):
        assert turned.step(HEADING(40 - tenth, 200 + tenth), at=tenth / 10)
        assert turn.arrived() is None
    assert turned.step(HEADING(90, 100), at=0.5) is None
    assert turn.arrived() == LEG(1, 200)
    assert turned.step(HEADING(90, 100), at=0.6) is None
    assert turn.arrived() is None
    turn.reset()
    assert turned.step(HEADING(90, 100), at=0.7) == ("Rotn_Y", 60)


@pytest.mark.parametrize(("halt", "ends_at"), [(HALT(due=False), 0.8), (HALT(due=True), 0.5)])
def test_forward_of_figure_20_drives_its_distance_or_halts(halt: object, ends_at: float) -> None:
    forward = FIGURE_20["Forward"]()
    driven = Stepper(forward, method="forward")
    assert driven.step(LEG(1, 200), HALT(due=False), at=0) == ("Trans_Z", 250)
    assert forward.moved() is None
    assert driven.step(LEG(1, 200), halt, at=ends_at) == ("Trans_Z", 0)
    assert forward.moved() == LEG(1, 200)
    assert forward.moved() is None
    assert driven.step(LEG(1, 200), HALT(due=False), at=1) is None
