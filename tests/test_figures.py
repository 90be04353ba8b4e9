"""The configurations of the paper's figures give the specifications that the paper prints."""

import json
import re

import pytest

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


@pytest.mark.parametrize("example", [*FIGURES, "level0"])
def test_a_specification_read_back_has_nothing_to_resolve(example: str) -> None:
    specification = ROOT / "tests" / "specifications" / f"{example}.mars"
    assert specification.read_text() == run(f"mars-asp synthesise examples/{example}/config.mars")
    found = json.loads(run(f"mars-asp analyse --format json {specification}"))
    # Loose wires are findings of both; nothing of them is resolved.
    kinds = {each["kind"] for each in found["consequences"]}
    assert kinds <= {"unused_output", "loose_end"}


@pytest.mark.parametrize("example", [*FIGURES, "level0"])
def test_a_specification_is_its_own_specification(example: str) -> None:
    printed = run(f"mars-asp synthesise tests/specifications/{example}.mars")
    again = (ROOT / "tests" / "specifications" / f"{example}.mars").read_text()
    assert tokens(printed) == tokens(again)


@pytest.mark.parametrize("source", ["python", "cpp"])
def test_level_0_from_annotated_sources(source: str) -> None:
    specification = ROOT / "tests" / "specifications" / "level0.mars"
    printed = run(f"mars-asp synthesise examples/level0/{source}.mars")
    assert tokens(printed) == tokens(specification.read_text())


def test_the_mobile_camera_is_the_same_in_both_languages() -> None:
    cpp, python = (
        run(f"mars-asp synthesise examples/mobile-camera/{name}.mars")
        for name in ("config", "python")
    )
    assert tokens(cpp) == tokens(python)
