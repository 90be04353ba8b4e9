"""A link that states no mode carries the one that serves its clients."""

import json
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.language import parse_text
from mars_asp.model.declarations import Data
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.carried_modes import state_modes
from tests.support.fixtures import Captured

RULEBOOK = load_rulebook()
CAMERA = """
@module_start
@module_name Camera
@Sense NotifyAtFrequency, RequestWhenReady 30
Image grab();
@module_end
"""


@pytest.mark.parametrize(
    ("lines", "mode"),
    [
        (["S1 uses C", "A uses S1 NotifyAtFrequency 40", "B uses S1 NotifyAtFrequency 10"], 1),
        (["S1 uses C", "A uses S1 NotifyAtFrequency 30", "B uses S1 NotifyAtFrequency 10"], 0),
        (["S1 uses C", "A uses S1", "B uses S1"], 0),
        (["A uses C"], 0),
        (["T1 uses C", "S1 uses T1", "A uses S1 NotifyAtFrequency 50", "B uses S1"], 1),
        (["S1 uses C", "S2 uses S1 NotifyAtFrequency 90", "A uses S2", "B uses S2"], 1),
    ],
)
def test_the_mode_that_serves_the_clients_is_written(lines: list[str], mode: int) -> None:
    long = {"uses": "uses_data_from", "C": "Camera", "S1": "DataSplitter1", "S2": "DataSplitter2"}
    long["T1"] = "DataTransformer1"
    body = "\n".join(" ".join(long.get(word, word) for word in line.split()) for line in lines)
    names = dict.fromkeys(w for line in body.splitlines() for w in line.split() if w[0] in "ABCD")
    text = f"@specification\n@modules {', '.join(names)}\n{body}\n{CAMERA}"
    specification = parse_text(text, "s.mars").configuration
    found = state_modes(specification, {}, RULEBOOK)
    (line,) = (r for r in found.relationships if isinstance(r, Data) and r.source == "Camera")
    assert line.mode is not None
    assert line.mode.name == ("NotifyAtFrequency", "RequestWhenReady")[mode]


SCANNER = """
@module_start
@module_name Scanner
@Sense NotifyWhenReady
Echo ping();
@Sense NotifyAtFrequency, RequestWhenReady 30
Cloud scan();
@Sense RequestWhenReady, NotifyAtFrequency 5
Image grab();
@module_end
"""


@pytest.mark.parametrize(
    ("lines", "modes"),
    [
        (
            ["S1 uses Scanner.scan", "A uses S1 NotifyAtFrequency 40", "B uses S1"],
            {"scan": "RequestWhenReady"},
        ),
        (
            ["S1 uses Scanner.scan", "A uses S1", "C uses Scanner.grab"],
            {"scan": "NotifyAtFrequency", "grab": "RequestWhenReady"},
        ),
        (
            ["T1 uses Scanner.scan", "A uses T1 NotifyAtFrequency 90", "C uses Scanner.ping"],
            {"scan": "RequestWhenReady", "ping": None},
        ),
        # Of a line that names no output nothing is known.
        (["A uses Scanner"], {None: None}),
    ],
)
def test_each_output_carries_the_mode_that_serves_its_clients(
    lines: list[str], modes: dict[str | None, str | None]
) -> None:
    long = {"uses": "uses_data_from", "S1": "DataSplitter1", "T1": "DataTransformer1"}
    body = "\n".join(" ".join(long.get(word, word) for word in line.split()) for line in lines)
    text = f"@specification\n@modules A, B, C, Scanner\n{body}\n{SCANNER}"
    found = state_modes(parse_text(text, "s.mars").configuration, {}, RULEBOOK)
    assert modes == {
        line.source_port: None if line.mode is None else line.mode.name
        for line in found.relationships
        if isinstance(line, Data) and line.source == "Scanner"
    }


def test_a_specification_without_a_choice_of_mode_is_unchanged() -> None:
    text = f"@specification\n@modules A, Camera\nA uses_data_from Camera RequestWhenReady\n{CAMERA}"
    specification = parse_text(text, "s.mars").configuration
    assert state_modes(specification, {}, RULEBOOK) is specification


def test_a_run_delivers_by_a_mode_other_than_the_first(tmp_path: Path, capsys: Captured) -> None:
    (tmp_path / "c.mars").write_text(
        "@configuration\n@modules Camera, Fast, Slow, Base\n"
        "Fast uses_data_from Camera NotifyAtFrequency 40\n"
        f"Slow uses_data_from Camera NotifyAtFrequency 10\n{CAMERA}"
    )
    (tmp_path / "s.toml").write_text(
        'duration = 5\n[robot]\nmodule = "Base"\n'
        '[devices.Camera]\nkind = "odometry"\nperiod = 20\n'
        '[bindings.Fast]\npython = "sink.py:take"\n'
        '[bindings.Slow]\npython = "sink.py:take"\n'
    )
    (tmp_path / "sink.py").write_text("def take(value):\n    return None\n")
    words = ["run", str(tmp_path / "c.mars"), "--scenario", str(tmp_path / "s.toml")]
    status = run_here([*words, "--format", "json", "--quiet"])
    captured = capsys.readouterr()
    assert status == 0, captured
    found = json.loads(captured.out)
    assert found["verdict"] == "pass"
    got = {link["client"]: (link["asked_hz"], link["got_hz"]) for link in found["links"]}
    assert got["Fast"] == (40, 40)
    assert got["Slow"] == (10, 10)
    assert got["DataSplitter1"][0] is None
