"""Dumps of graphs: files with expected imports beside them, and files that are refused."""

import json
import random
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import MarsError
from mars_asp.exchange.lift import lifted
from mars_asp.exchange.recognise import dump_of, recognised
from mars_asp.exchange.rosgraph import import_rosgraph
from mars_asp.language import parse_text, print_configuration
from mars_asp.language.print import print_relationship
from mars_asp.model.declarations import Control, Data
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.imported import findings_of, golden_lines, meaning, place

FOLDER = ROOT / "tests" / "rosgraph"
FILES = sorted(path for path in FOLDER.iterdir() if path.suffix != ".said")
named = pytest.mark.parametrize("file", FILES, ids=lambda path: path.name)


@named
def test_each_file_gives_the_expected_output(file: Path, update_golden: bool) -> None:
    text = file.read_text(encoding="utf-8")
    assert recognised(text) == "rosgraph"
    found = "\n".join(golden_lines(import_rosgraph([(text, file.name)]))) + "\n"
    golden = file.with_name(f"{file.name}.said")
    if update_golden:
        golden.write_text(found, encoding="utf-8")
    assert golden.read_text(encoding="utf-8") == found


@named
def test_printed_imports_have_the_meaning_of_the_file(file: Path) -> None:
    found = import_rosgraph([(file.read_text(encoding="utf-8"), file.name)]).configuration
    assert meaning(parse_text(print_configuration(found), "a.mars").configuration) == meaning(found)


def test_all_five_kinds_have_a_file() -> None:
    kinds = {dump_of(file.read_text(encoding="utf-8")) for file in FILES}
    assert kinds == {"rosdiscover", "caret", "dot", "node_info", "topic_info"}


# ---- Several dumps -------------------------------------------------------------------------------

DRAWN = 'digraph g { n___a [label="/a"]; n___b [label="/b"]; n___a -> n___b [label="/cmd_vel"]; }'
TOPIC = "Type: geometry_msgs/msg/Twist\n\nPublisher count: 1\n\nNode name: {}\nNode namespace: /\n"


def test_one_dump_completes_another() -> None:
    drawn = import_rosgraph([(DRAWN, "g.dot")])
    assert [type(line) for line in drawn.configuration.relationships] == [Data]
    both = import_rosgraph([(DRAWN, "g.dot"), (TOPIC.format("c"), "cmd_vel.txt")])
    (first, second) = both.configuration.relationships
    assert isinstance(first, Control)
    assert isinstance(second, Control)
    assert [first.controlled, first.controller, first.priority] == ["/b", "/a", 0]
    assert [second.controlled, second.controller, second.span.path] == ["/b", "/c", "cmd_vel.txt"]


def test_a_controlled_node_is_not_reported_as_unable_to_move() -> None:
    text = (
        "/base\n  Subscribers:\n    /cmd_vel: geometry_msgs/msg/Twist\n    /map: nav/msg/Map\n"
        "  Publishers:\n    /odom: nav_msgs/msg/Odometry\n/joy\n  Publishers:\n"
        "    /cmd_vel: geometry_msgs/msg/Twist\n/wheels\n  Subscribers:\n"
        "    /cmd_vel: geometry_msgs/msg/Twist\n/map_server\n  Publishers:\n    /map: nav/msg/Map\n"
    )
    found = import_rosgraph([(text, "a.txt")])
    assert "/wheels" not in {module.name for module in found.configuration.declared}
    assert findings_of(found) == ["control_divergence(/joy)"]


def test_a_command_without_a_receiver_is_a_loose_end() -> None:
    text = (
        "/joy\n  Publishers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"
        "/base\n  Subscribers:\n    /cmdvel: geometry_msgs/msg/Twist\n"
    )
    assert "loose_end(/base./cmdvel)" in findings_of(import_rosgraph([(text, "a.txt")]))


def test_a_node_does_not_command_itself() -> None:
    text = (
        "/joy\n  Publishers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"
        "/base\n  Subscribers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"
        "  Publishers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"
    )
    found = import_rosgraph([(text, "a.txt")])
    (line,) = found.configuration.relationships
    assert isinstance(line, Control)
    assert (line.controlled, line.controller) == ("/base", "/joy")


def test_commands_that_come_back_through_a_mux_are_kept() -> None:
    text = (
        "/twist_mux\n  Subscribers:\n    /nav_vel: any\n    /joy_vel: any\n"
        "  Publishers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"
        "/smoother\n  Subscribers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"
        "  Publishers:\n    /nav_vel: geometry_msgs/msg/Twist\n"
    )
    found = import_rosgraph([(text, "a.txt"), (MUX, "mux.yaml")])
    assert "control_cycle(/smoother)" in findings_of(found)


MUX = """twist_mux:
  ros__parameters:
    topics:
      nav: {topic: nav_vel, timeout: 0.5, priority: 10}
      joy: {topic: joy_vel, timeout: 0.5, priority: 100}
"""
RAN = """/twist_mux
  Subscribers:
    /nav_vel: any
    /joy_vel: any
  Publishers:
    /cmd_vel: geometry_msgs/msg/Twist
/nav
  Publishers:
    /nav_vel: geometry_msgs/msg/Twist
/base
  Subscribers:
    /cmd_vel: geometry_msgs/msg/Twist
"""
PAST = "/docking\n  Publishers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"


@pytest.mark.parametrize(
    ("ran", "lines"),
    [
        (RAN, ["/base is_controlled_by /nav 10 hold 500",
               "/base is_controlled_by joy 100 hold 500"]),
        (
            RAN + PAST,
            [
                "/base is_controlled_by /docking 0",
                "/base is_controlled_by /twist_mux 0",
                "/twist_mux is_controlled_by /nav 10 hold 500",
                "/twist_mux is_controlled_by joy 100 hold 500",
            ],
        ),
        (PAST, ["cmd_vel_out is_controlled_by nav 10 hold 500",
                "cmd_vel_out is_controlled_by joy 100 hold 500"]),
    ],
)  # fmt: skip
def test_parameters_of_a_mux_rank_the_inputs_of_its_node(ran: str, lines: list[str]) -> None:
    found = import_rosgraph([(ran, "nodes.txt"), (MUX, "mux.yaml")]).configuration
    assert list(map(print_relationship, found.relationships)) == lines


def test_connections_of_a_middleware_count_as_nodes() -> None:
    ran = RAN + PAST + "/odometry\n  Subscribers:\n    /cmd_vel: geometry_msgs/msg/Twist\n"
    found = lifted(import_rosgraph([(ran, "nodes.txt")]).configuration)
    assert list(map(print_relationship, found.relationships)) == [
        "ControlSplitter1 is_controlled_by ArbitrationNode",
        "/base is_controlled_by ControlSplitter1",
        "/odometry is_controlled_by ControlSplitter1",
        "ArbitrationNode is_controlled_by /twist_mux 0",
        "ArbitrationNode is_controlled_by /docking 0",
        "/twist_mux is_controlled_by /nav 0",
    ]
    assert run_here(["verify", str(FOLDER / "rosdiscover_warehouse.yml")]) == 0


# ---- One graph in each format --------------------------------------------------------------------

TYPES = (
    "geometry_msgs/msg/Twist",
    "sensor_msgs/msg/Joy",
    "a/msg/B",
    "trajectory_msgs/msg/JointTrajectory",
)
NAMES = ("/map", "/left/cmd_vel", "/tf", "/x/debug/y", "/odom", "/scan", "/rosout", "/goal")
#: Type, publishers and subscribers of each topic.
Drawn: TypeAlias = dict[str, tuple[str, list[str], list[str]]]


def drawn(rng: random.Random) -> Drawn:
    nodes = [f"/n{number}" for number in range(5)]
    return {
        name: (rng.choice(TYPES), rng.sample(nodes, rng.choice([0, 1, 1, 2])),
               rng.sample(nodes, rng.choice([0, 1, 2, 3])))
        for name in rng.sample(NAMES, 6)
    }  # fmt: skip


def expected(graph: Drawn, typed: bool) -> set[tuple[str, ...]]:
    """Return the commands and the data relationships of a graph by the rules of real-robots.md."""
    found: set[tuple[str, ...]] = set()
    for name, (type_, publishers, subscribers) in graph.items():
        if name in ("/tf", "/rosout") or "debug" in name:
            continue
        pairs = {(s, p) for s in subscribers for p in publishers}
        commands = typed and type_.endswith(("Twist", "JointTrajectory"))
        # A node does not command itself.
        found |= (
            {(s, p) for s, p in pairs if s != p} if commands else {(s, p, name) for s, p in pairs}
        )
    return found


def written(graph: Drawn) -> Iterator[tuple[str, str, bool]]:
    """Yield the text of each format, with a file name, and whether the format states types."""
    nodes = sorted({n for _, out, into in graph.values() for n in (*out, *into)})
    ends = {n: [[t for t, each in graph.items() if n in each[i]] for i in (1, 2)] for n in nodes}
    yield (
        "".join(
            f"- fullname: {n}\n  pubs: [{', '.join(_published(t, graph[t][0]) for t in out)}]\n"
            f"  subs: [{', '.join(f'{{name: {t}, format: any}}' for t in into)}]\n"
            for n, (out, into) in ends.items()
        ),
        "r.yml",
        True,
    )
    yield (
        "".join(
            f"{n}\n  Subscribers:\n"
            + "".join(f"    {t}: {graph[t][0]}\n" for t in into)
            + "  Publishers:\n"
            + "".join(f"    {t}: {graph[t][0]}\n" for t in out)
            for n, (out, into) in ends.items()
        ),
        "n.txt",
        True,
    )
    yield (
        "".join(
            f"$ ros2 topic info -v {t}\nType: {type_}\n"
            + "".join(
                f"{head} count: {len(of)}\n"
                + "".join(
                    f"Node name: {n[1:]}\nNode namespace: /\nEndpoint type: {word}\n" for n in of
                )
                for head, word, of in (
                    ("Publisher", "PUBLISHER", out),
                    ("Subscription", "SUBSCRIPTION", into),
                )
            )
            for t, (type_, out, into) in graph.items()
        ),
        "t.txt",
        True,
    )
    yield (
        "nodes:\n"
        + "".join(
            f"- node_name: {n}\n  publishes: [{', '.join(f'{{topic_name: {t}}}' for t in out)}]\n"
            f"  callbacks: [{', '.join(_callback(t, graph[t][0]) for t in into)}]\n"
            for n, (out, into) in ends.items()
        ),
        "c.yaml",
        True,
    )
    yield (
        "digraph g {\n"
        + "".join(f'"n_{n}" [label="{n}"];\n' for n in nodes)
        + "".join(
            f'"t_{t}" [label="{t}", tooltip="topic:{t}"];\n'
            + "".join(f'"n_{n}" -> "t_{t}";\n' for n in out)
            + "".join(f'"t_{t}" -> "n_{n}";\n' for n in into)
            for t, (_, out, into) in graph.items()
        )
        + "}\n",
        "g.dot",
        False,
    )


def _published(topic: str, type_: str) -> str:
    return f"{{name: {topic}, format: {type_}}}"


def _callback(topic: str, type_: str) -> str:
    symbol = f'"N::on(std::shared_ptr<{type_.replace("/", "::")}>)"'
    return f"{{callback_type: subscription_callback, topic_name: {topic}, symbol: {symbol}}}"


def test_every_format_gives_the_same_graph() -> None:
    rng = random.Random(1)
    kinds = Counter[str]()
    for _ in range(40):
        graph = drawn(rng)
        for text, name, typed in written(graph):
            wanted = expected(graph, typed)
            if not wanted:
                continue
            kinds[name] += 1
            lines = import_rosgraph([(text, name)]).configuration.relationships
            found = {
                (r.client, r.source, r.client_port or "") if isinstance(r, Data)
                else (r.controlled, r.controller) if isinstance(r, Control) else ()
                for r in lines
            }  # fmt: skip
            assert found == wanted, text
            assert len(lines) == len(found)
    assert min(kinds.values()) > 30
    assert len(kinds) == 5


# ---- Files that are refused ----------------------------------------------------------------------

NAMED = '- fullname: /a\n  pubs: [{name: "/x'
TIMER = "nodes:\n- node_name: /a\n  callbacks:\n  - {callback_type: timer_callback, period_ns: "
WHOLE = "of `/a` has no period of whole nanoseconds above 0"
#: The kind of a dump, a text, and all that is wrong with it.
REFUSED = [
    ("rosdiscover", "- fullname: /a\n  pubs: 1\n- 2\n- {}\n- name: ''\n  subs: []",
     ["2:9: error: `pubs` is not a list", "3:3: error: an entry of `nodes` is not a map",
      "4:3: error: a node has no `fullname`", "5:3: error: a node has no `fullname`"]),
    ("rosdiscover", "- fullname: /a\n  pubs: [{format: a/B}, 3]\n",
     ["2:10: error: an entry of `pubs` of `/a` has no `name`",
      "2:25: error: an entry of `pubs` is not a map"]),
    ("rosdiscover", NAMED + '\\n", format: a/B}]\n', ["2:17: error: `/x\n` cannot be a name"]),
    ("rosdiscover", NAMED + '", format: a/B}]\n  x: &a [*a]\n',
     ["3:10: error: alias `*a` has no complete anchor above it"]),
    ("rosdiscover", "- fullname: /a\n  pubs: []\n  subs: [{name: /tf}]\n",
     ["0:0: error: no node has a topic that is read"]),
    ("rosdiscover", NAMED + '"}]\n  reads: ' + "[" * 100_000,
     ["3:72: error: lists and maps are nested deeper than 64"]),
    ("rosdiscover", "- fullname: /a\n  pubs: []\n" + "  a0: &a0 [x]\n" + "".join(
        f"  a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 9)),
     ["9:47: error: with its aliases the file has more than 1000000 nodes"]),
    ("caret", TIMER + "0}\n", [f"4:48: error: a timer {WHOLE}"]),
    ("caret", TIMER + "9" * 5000 + "}\n", [f"4:48: error: a timer {WHOLE}"]),
    ("caret", "nodes:\n- node_name: /a\n  callbacks: [{}, {type: subscription_callback}]\n- 1",
     ["3:15: error: a callback of `/a` has no `callback_type`",
      "3:19: error: a subscription of `/a` has no `topic_name`",
      "4:3: error: an entry of `nodes` is not a map"]),
    ("dot", "digraph g {}", ["0:0: error: the graph has no edges"]),
    ("dot", "digraph g {\na -- b }",
     ["2:3: error: an edge without a direction does not show which node publishes"]),
    ("dot", 'digraph g { a [label="' + "\\x" * 100_000, ["1:22: error: this text does not end"]),
    ("dot", "digraph g { a [label=<<b>a</b>>]; a -> b [label=x] }",
     ["1:22: error: a label in HTML, which is not read"]),
    ("dot", "digraph g { a [label=" + "<" * 99_999,
     ["1:22: error: this text in HTML does not end"]),
    ("dot", "digraph g { /* " + "*" * 100_000, ["1:13: error: this comment does not end"]),
    ("dot", "digraph g " + "{" * 100_000, ["1:76: error: subgraphs are nested deeper than 64"]),
    ("dot", "digraph g { a ->", ["1:17: error: the text ends within the graph"]),
    ("dot", "digraph g { a [[", ["1:16: error: expected the name of an attribute, found `[`"]),
    ("dot", "digraph g { a -> {b c} }", ["1:18: error: expected the name of a node, found `{`"]),
    ("dot", "digraph g { a -> b [label=;] }", ["1:27: error: expected a value, found `;`"]),
    ("dot", "digraph g { ? }", ["1:13: error: character U+003F has no meaning here"]),
    ("node_info", "  Subscribers:\n    /x: a/msg/B\n",
     ["1:3: error: `Subscribers` of a node without a name"]),
    ("topic_info", "Type: a/msg/B\nPublisher count: 2\n\nSubscription count: 0\n",
     ["2:18: error: the nodes at `/cmd_vel` are counted, but not named"]),
    ("topic_info", TOPIC.format("a") + TOPIC.format("b"),
     ["1:7: error: the topic that this is about is not named",
      "7:7: error: the topic that this is about is not named"]),
    (None, "hello\n", ["0:0: error: this is not a known kind of graph dump"]),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "text", "wrong"), REFUSED, ids=lambda value: str(value)[:30])
def test_each_refused_file_reports_all_its_errors(
    kind: str | None, text: str, wrong: list[str]
) -> None:
    assert dump_of(text) == kind
    with pytest.raises(MarsError) as caught:
        import_rosgraph([(text, "cmd_vel.txt")])
    assert [place(d) for d in caught.value.diagnostics] == wrong
    assert all(d.help for d in caught.value.diagnostics)


FLOW = "nodes:\n- id: a\n  outputs: [x]\n- id: b\n  inputs: {i: a/x}\n"
#: The content of a file, and the message of `check`.
BYTES = [
    (bytes(range(256)) * 9, "2:1: error: the file is not UTF-8"),
    (FLOW.replace("a", "\xe9").encode("latin-1"), "2:1: error: the file is not UTF-8"),
    (FLOW.encode("utf-16")[:-1], "the file is not UTF-8"),
    (FLOW.encode("utf-16-le"), "d.yml` is not a robot"),
    (FLOW.replace("x", "\0").encode(), "3:13: error: character U+0000 is not allowed in YAML"),
    (FLOW.encode("utf-16"), None),
    (("\ufeff" + FLOW).replace("\n", "\r\n").encode(), None),
]


@pytest.mark.parametrize(("raw", "message"), BYTES, ids=range(len(BYTES)))
def test_bytes_other_than_text_are_refused_with_a_location(
    raw: bytes, message: str | None, tmp_path: Path, capsys: Captured
) -> None:
    path = tmp_path / "d.yml"
    path.write_bytes(raw)
    assert run_here(["check", "--quiet", str(path)]) == (0 if message is None else 2)
    found = " ".join(capsys.readouterr().out.split())
    assert message is None or (message in found and "d.yml" in found)


# ---- The command line ----------------------------------------------------------------------------


def outcome(words: str, capsys: Captured) -> tuple[int, str, str]:
    status = run_here(words.split())
    captured = capsys.readouterr()
    return status, captured.out, captured.err


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, text in {
        "g.dot": DRAWN,
        "cmd_vel.txt": TOPIC.format("c"),
        "ours.mars": "@configuration\n@modules A\n",
        "flow.yml": "nodes:\n- id: a\n  outputs: [x]\n- id: b\n  inputs: {i: a/x}\n",
    }.items():
        Path(name).write_text(text, encoding="utf-8")
    return tmp_path


def test_files_of_others_are_one_robot_and_each_of_ours_is_its_own(
    folder: Path, capsys: Captured
) -> None:
    _, found, _ = outcome("check --format json g.dot ours.mars cmd_vel.txt flow.yml", capsys)
    files = json.loads(found)["files"]
    assert [(each["path"], each["further"]) for each in files] == [
        ("g.dot", ["cmd_vel.txt", "flow.yml"]),
        ("ours.mars", []),
    ]
    _, found, _ = outcome("analyse --quiet g.dot cmd_vel.txt flow.yml", capsys)
    assert "cmd_vel.txt:5:12: warning: ambiguous_priority: `/a` and `/c` control" in found
    status, _, found = outcome("analyse g.dot ours.mars", capsys)
    assert status == 2
    assert "`ours.mars` is a robot of its own" in found


def test_words_before_the_subject_of_explain_are_files(folder: Path, capsys: Captured) -> None:
    status, found, _ = outcome("explain --quiet g.dot cmd_vel.txt ambiguous_priority", capsys)
    assert status == 0
    assert "ambiguous_priority(/b)" in found


def test_an_import_names_its_origins_and_reads_back(folder: Path, capsys: Captured) -> None:
    status, found, _ = outcome("import rosgraph g.dot cmd_vel.txt", capsys)
    assert status == 0
    assert "/b is_controlled_by /a 0  // from g.dot:1\n" in found
    assert "/b is_controlled_by /c 0  // from cmd_vel.txt:5\n" in found
    assert "\n// from g.dot:1\n@module_start\n@module_name /a\n" in found
    read = import_rosgraph([(DRAWN, "g.dot"), (TOPIC.format("c"), "cmd_vel.txt")])
    assert meaning(parse_text(found, "a.mars").configuration) == meaning(read.configuration)


# ---- Real files ----------------------------------------------------------------------------------

SHARED = ROOT.parents[1] / "shared" / "cases" / "imports" / "rosdiscover"
IMU = "/error_reproducer./imu/data_compass"
RIGHT, LEFT = "/error_reproducer./right_camera", "/error_reproducer./left_camera"
#: Of each file some loose inputs with their candidates, the first of them, as its README tells.
KNOWN: dict[str, dict[str, list[str]]] = {
    "husky-02.buggy": {IMU: ["/gazebo./imu/data", "/gazebo./imu/data/bias"]},
    "husky-02.fixed": {IMU: []},
    "autoware-02.buggy": {"/lattice_trajectory_gen./control_pose": ["/odom_gen./sim_pose"]},
    "autoware-02.fixed": {"/lattice_trajectory_gen./control_pose": []},
    "autorally-03.buggy": {
        RIGHT: ["/gazebo./camera/right/image_raw"],
        LEFT: ["/gazebo./camera/left/image_raw"],
    },
    "autorally-03.fixed": {
        RIGHT: ["/gazebo./right_camera/image_raw"],
        LEFT: ["/gazebo./left_camera/image_raw"],
    },
    "autoware-07.buggy": {"/lane_rule./lane_waypoints_array": []},
    "autoware-07.fixed": {"/lane_rule./lane_waypoints_array": []},
}


@pytest.mark.skipif(not SHARED.is_dir(), reason=f"the real files are not here: {SHARED}")
@pytest.mark.parametrize("name", KNOWN)
def test_real_files_give_their_known_answers(name: str, capsys: Captured) -> None:
    _, found, _ = outcome(f"analyse --format json {SHARED / name}.yml", capsys)
    consequences = json.loads(found)["consequences"]
    loose = {c["subject"]: c["participants"] for c in consequences if c["kind"] == "loose_end"}
    for subject, first in KNOWN[name].items():
        candidates = [p for p in loose.get(subject, []) if p != subject]
        assert candidates[: len(first) or 1] == first
    assert not [c for c in consequences if c["severity"] == "error"]


@pytest.mark.skipif(not SHARED.is_dir(), reason=f"the real files are not here: {SHARED}")
def test_of_a_node_that_is_missing_inputs_wait(capsys: Captured) -> None:
    unfed = []
    for name in ("autoware-07.buggy", "autoware-07.fixed"):
        _, found, _ = outcome(f"analyse --format json {SHARED / name}.yml", capsys)
        consequences = json.loads(found)["consequences"]
        assert "loose_end" not in {c["kind"] for c in consequences}
        unfed.append({c["message"] for c in consequences if c["kind"] == "unfed_input"})
    assert len(unfed[0] - unfed[1]) == 2
