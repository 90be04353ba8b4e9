"""An import that is saved as a `.mars` file and read again: the same findings, whatever it was."""

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli import run_here
from mars_asp.diagnostic import Span
from mars_asp.exchange.foreign import ForeignFile, read_foreign
from mars_asp.exchange.lift import has_glue, lifted, with_origins
from mars_asp.exchange.recognise import recognised
from mars_asp.exchange.topics import configuration_of
from mars_asp.language import Parsed, parse_text
from mars_asp.language.format import format_text
from mars_asp.model.declarations import ENGINES, FOREVER, Configuration
from mars_asp.model.graph import Endpoint, Graph, GraphNode, Mux, MuxInput
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import described, load_project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from tests.support.campaigns import IS_CAMPAIGN, sample
from tests.support.documents import ROOT
from tests.support.fixtures import Captured

#: Robots in each format that can be imported.
FOLDERS = ("dora", "ros2", "rosgraph", "twist_mux", "urdf")
ROBOTS = [
    path
    for folder in FOLDERS
    for path in sorted((ROOT / "tests" / folder).iterdir())
    if path.is_dir() or recognised(path.read_text("utf-8")) not in ("mars", "ros2")
]


def imported(path: Path) -> Configuration:
    folder = path.is_dir()
    text = "" if folder else path.read_text("utf-8")
    file = ForeignFile(str(path), text, "ros2" if folder else recognised(text))
    return read_foreign([file]).configuration


@cache
def rules() -> Rulebook:
    return load_rulebook([], ("resolve",))


def findings(configuration: Configuration, format: str | None = None) -> list[tuple[object, ...]]:
    """Return the findings of a configuration, without locations.

    Paths of programs are not part of a `.mars` file.
    """
    configuration = replace(configuration, missing=())
    project = described(Parsed(configuration, ()), "", format=format)
    found = analyse(project_facts(project), rules(), configuration.span).consequences
    return sorted((c.kind, c.subject, c.participants, c.severity, c.message) for c in found)


def saved(configuration: Configuration) -> Configuration:
    """Return the configuration printed and read again; formatting in between changes no finding."""
    text = with_origins(configuration)
    again = parse_text(format_text(text, "a.mars"), "a.mars")
    assert not again.warnings
    assert findings(again.configuration) == findings(parse_text(text, "a.mars").configuration)
    return again.configuration


def test_robots_of_each_format_are_tried() -> None:
    assert len(ROBOTS) > 30
    assert {path.parent.name for path in ROBOTS} == set(FOLDERS)


@pytest.mark.parametrize("path", sample(ROBOTS, 4), ids=lambda path: path.name)
def test_a_saved_import_has_the_same_findings(path: Path) -> None:
    found = imported(path)
    assert findings(saved(found)) == findings(found, found.origin)


def at(line: int) -> Span:
    return Span("x", line, 1, line, 2)


#: Names that are written bare, quoted or after a slash, and names like printed comments.
NAMES = ("/a", "/b/a", "c", "d d", 'e"', "/f-g", "1", "imported from ros2", "h // -- not read")
TYPES = (None, "any", "geometry_msgs/msg/Twist", "sensor_msgs/msg/Image", "std_msgs/String")
topics = st.builds(
    Endpoint,
    st.sampled_from(["/s", "/t", "/u v", "/cmd_vel", "/cmd/nav"]),
    st.sampled_from(TYPES),
    st.integers(1, 9).map(at),
    st.sampled_from([None, Fraction(30), Fraction(1000, 17)]),
    measured=st.booleans(),
)
some = st.lists(topics, max_size=3).map(tuple)
inputs = st.builds(
    MuxInput,
    st.sampled_from(["nav", "joy stick"]),
    st.sampled_from(["/cmd/nav", "/cmd/joy"]),
    st.just(at(1)),
    st.integers(0, 2),
    st.sampled_from([None, 200, FOREVER]),
)


@st.composite
def graphs(draw: st.DrawFn) -> Graph:
    names = draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=5, unique=True))
    guard = st.none() | st.just(at(2))
    nodes = [
        GraphNode(name, at(3), draw(some), draw(some), draw(guard), unread=draw(st.booleans()))
        for name in names[1:]
    ]
    heard = draw(st.lists(inputs, min_size=1, max_size=3, unique_by=lambda each: each.name))
    engine = draw(st.sampled_from(ENGINES))
    mux = Mux(names[0], engine, at(4), "/cmd_vel", tuple(heard))
    muxes = (mux,) if draw(st.booleans()) or not nodes else ()
    return Graph("x", tuple(nodes), muxes, draw(st.booleans()))


@settings(max_examples=30 if IS_CAMPAIGN else 5, deadline=None, derandomize=True)
@given(graphs(), st.sampled_from(["ros2", "rosgraph", "twist_mux"]))
def test_whatever_a_graph_holds_is_saved(graph: Graph, origin: str) -> None:
    found = replace(configuration_of(graph)[0], origin=origin)
    assume(found.modules)
    assert findings(saved(found)) == findings(found, origin)


def test_glue_saved_as_nodes_keeps_the_meaning_of_numbers_of_its_mux() -> None:
    found = imported(ROOT / "tests/twist_mux/ros2_forever.yaml")
    assert has_glue(found)
    glue = {("never_wins", "idle"), ("never_expires", "operator")}
    entries = {(kind, subject) for kind, subject, *_ in findings(saved(lifted(found)))}
    assert glue <= entries


def test_a_saved_import_keeps_its_findings_when_included(tmp_path: Path) -> None:
    found = imported(ROOT / "tests/twist_mux/ros2_forever.yaml")
    (tmp_path / "mux.mars").write_text(with_origins(found), encoding="utf-8")
    own = tmp_path / "two.mars"
    own.write_text("@configuration hierarchical\n@include mux.mars as left\n", encoding="utf-8")
    project = load_project(str(own))
    result = analyse(project_facts(project), rules(), project.configuration.span).consequences
    assert ("never_wins", "left/idle") in {(each.kind, each.subject) for each in result}


def test_comments_without_an_import_are_ignored() -> None:
    message = "// A: not all topics read\n// A: commands pass a twist_mux\n"
    text = f"@configuration\n@modules A\n{message}"
    read = parse_text(text, "a.mars").configuration
    assert (read.origin, read.opaque, read.muxes) == (None, (), ())


def test_a_comment_about_a_module_that_is_gone_is_reported() -> None:
    text = "@configuration\n@modules /a\n// imported from ros2\n// /b: not all topics read\n"
    [warning] = parse_text(text, "a.mars").warnings
    assert (warning.span.line, warning.span.column) == (4, 4)
    assert "`/b`, which is not a module of the configuration" in warning.message


@pytest.mark.parametrize("words", [(), ("--contract",)])
def test_a_workspace_does_not_differ_from_its_import(
    words: tuple[str, ...], tmp_path: Path, capsys: Captured
) -> None:
    robot, saved = str(ROOT / "examples" / "ros2_workspace"), tmp_path / "saved.mars"
    assert run_here(["import", "ros2", robot, "-q", "-o", str(saved), *words]) == 0
    for pair in ((robot, str(saved)), (str(saved), robot)):
        assert run_here(["diff", "-q", *pair, "--format", "json"]) == 0
        found = json.loads(capsys.readouterr().out)
        assert [found[key] for key in ("consequences", "nodes", "added", "removed")] == [[]] * 4
    lines = saved.read_text("utf-8").splitlines()
    saved.write_text("\n".join(line for line in lines if "controlled_by /patrol" not in line))
    assert run_here(["diff", "-q", robot, str(saved)]) == 0
    output = capsys.readouterr().out
    assert "ambiguous_priority: `/follow` and `/patrol` control" in " ".join(output.split())
    assert "patrol.py:13: self.commands" in output and "<imported>" not in output
