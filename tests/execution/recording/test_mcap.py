"""Records of a run for Foxglove, read back by the package of the format."""

import io
import json
import sys
from math import atan2, degrees
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

from mars_asp.cli import run_here
from mars_asp.cli.suggested_commands import way_to_install
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.recording.mcap import SCHEMAS, Foxglove
from mars_asp.execution.trial import Trial
from mars_asp.language import parse_text
from tests.execution.recording.test_replay import SPECIFICATION, trial
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch

KINDS: dict[str, Any] = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "integer": int,
    "number": (int, float),
}


def assert_conforms(value: Any, schema: dict[str, Any]) -> None:
    """Check kinds, and that a message has every property and no other."""
    if "type" not in schema:
        return
    assert isinstance(value, KINDS[schema["type"]])
    assert isinstance(value, bool) <= (schema["type"] == "boolean")
    if "properties" in schema:
        assert value.keys() == schema["properties"].keys()
        for name, part in value.items():
            assert_conforms(part, schema["properties"][name])
    for item in value if schema["type"] == "array" else ():
        assert_conforms(item, schema["items"])


#: Nodes have no name in a topic.
TOPICS = {
    "Low -> ArbitrationNode": "/Low/P",
    "High -> ArbitrationNode": "/High/P",
    "ArbitrationNode -> P": "/P/received",
}
#: When, what, where and the value of an event.
Event = tuple[int, str, str, Any]


def recorded() -> tuple[Trial, list[Event], bytes]:
    file, events = io.BytesIO(), list[Event]()
    record = Foxglove(file, Plan(parse_text(SPECIFICATION, "x.mars").configuration, {}, {}))

    def observe(*event: Any) -> None:
        events.append(event)
        record.observe(*event)

    made = trial(observe=observe)
    record.end(made)
    return made, events, file.getvalue()


def messages(content: bytes) -> list[tuple[str, str, int, Any]]:
    """Return topic, schema, time (ns) and message of all that is in a file, in order of time."""
    found = []
    for schema, channel, message in make_reader(io.BytesIO(content)).iter_messages():
        assert schema is not None
        assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        assert json.loads(schema.data) == SCHEMAS[schema.name]
        found.append((channel.topic, schema.name, message.log_time, json.loads(message.data)))
    return found


def test_every_message_conforms_to_its_schema_and_every_event_is_there() -> None:
    _, events, content = recorded()
    found = messages(content)
    for topic, schema, at, message in found:
        assert_conforms(message, SCHEMAS[schema])
        if topic in ("/tf", "/log"):
            assert message["timestamp"] == {"sec": at // 10**9, "nsec": at % 10**9}
    assert {schema for _, schema, _, _ in found} == set(SCHEMAS)
    passed = [(topic, at, m["value"]) for topic, name, at, m in found if "mars_asp" in name]
    assert passed == [
        (TOPICS[where], at, value)
        for at, what, where, value in events
        if what in ("data", "control")
    ]
    logs = [(at, m["name"], m["message"]) for topic, _, at, m in found if topic == "/log"]
    assert logs[1] == (0, "P", "High holds control: priority 7 outranks Low (3)")
    assert len(logs) == 4


def test_the_final_robot_and_the_obstacles_are_placed_in_metres() -> None:
    made, _, content = recorded()
    found = messages(content)
    last = [message for topic, _, _, message in found if topic == "/tf"][-1]
    x, y = made.bodies[0].pose.forward / 1000, made.bodies[0].pose.side / 1000
    assert last["translation"] == pytest.approx({"x": x, "y": y, "z": 0})
    rotation = last["rotation"]
    assert (rotation["x"], rotation["y"]) == (0, 0)
    heading = degrees(2 * atan2(rotation["z"], rotation["w"]))
    assert heading == pytest.approx(made.bodies[0].pose.heading)
    (world,) = [m["entities"][0] for topic, _, _, m in found if topic == "/world"]
    assert [c["pose"]["position"]["y"] for c in world["cylinders"]] == [-0.7]
    ends = [(p["x"], p["y"]) for p in world["lines"][0]["points"]]
    assert ends == [(2, -0.9), (2, 0.9), (2, 0.9), (-0.9, 0.9)]
    moving = [m["entities"][0]["cylinders"][0] for topic, _, _, m in found if topic == "/moving"]
    assert moving[-1]["pose"]["position"]["x"] == pytest.approx(0.5)


def test_the_same_run_gives_the_same_bytes() -> None:
    assert recorded()[2] == recorded()[2]


LEVEL0 = ROOT / "examples" / "level0"
WORDS = ["run", str(LEVEL0 / "config.mars"), "--scenario", str(LEVEL0 / "scenario.toml")]


def test_the_command_line_writes_it(tmp_path: Path) -> None:
    out = tmp_path / "a.mcap"
    assert run_here([*WORDS, "--duration", "1", "--quiet", "--record", str(out)]) == 0
    topics = {topic for topic, *_ in messages(out.read_bytes())}
    assert {"/tf", "/world", "/moving", "/log", "/Sonar/SonarMap"} <= topics
    assert {"/SonarMap/sent", "/SonarMap/FeelForce", "/Turn/MobilePlatform"} <= topics
    assert not [topic for topic in topics if "Node" in topic or "Splitter" in topic]


def test_a_package_that_is_missing_is_named_before_the_run(
    tmp_path: Path, monkeypatch: Patch, capsys: Captured
) -> None:
    monkeypatch.setitem(sys.modules, "mcap", None)
    out = tmp_path / "a.mcap"
    assert run_here([*WORDS, "--record", str(out)]) == 2
    printed, errors = capsys.readouterr()
    # The folder is so long that the message may be wrapped.
    message = " ".join(errors.split())
    assert "`.mcap` needs the package `mcap`, which is not installed" in message
    assert way_to_install("mcap") in message
    assert (printed, out.exists()) == ("", False)


def test_an_unknown_file_ending_is_refused(capsys: Captured) -> None:
    with pytest.raises(SystemExit) as raised:
        run_here([*WORDS, "--record", "a.txt"])
    assert raised.value.code == 2
    assert "end it in .jsonl or .mcap" in " ".join(capsys.readouterr().err.split())
