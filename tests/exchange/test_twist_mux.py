"""Parameters of muxes: files with expected imports beside them, and files that are refused."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from mars_asp.cli import run_here
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.exchange.lift import lifted
from mars_asp.exchange.recognise import recognised
from mars_asp.exchange.twist_mux import import_muxes
from mars_asp.language import Parsed, parse_text, print_configuration
from mars_asp.model.declarations import Configuration, Control, Lock, ends_of
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.refusals import refusal

FOLDER = ROOT / "tests" / "twist_mux"
FILES = sorted(FOLDER.glob("*.yaml"))


def place(d: Diagnostic) -> str:
    return f"{d.span.line}:{d.span.column}: {d.severity}: {d.message}"


def golden_lines(found: Parsed) -> Iterator[str]:
    """Yield the muxes of a file, a line for each of their inputs, and the warnings."""
    for mux in found.configuration.muxes:
        yield f"{mux.span.line}:{mux.span.column}: {mux.engine} before {mux.module}"
    for line in found.configuration.relationships:
        assert isinstance(line, Control | Lock)
        at = f"{line.span.line}:{line.span.column}"
        controlled, source = ends_of(line)
        sign = "locked by" if isinstance(line, Lock) else "<"
        yield f"{at}: {controlled} {sign} {source} {line.priority} {line.hold_ms}"
    yield from map(place, found.warnings)


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_each_file_gives_the_expected_output(file: Path, update_golden: bool) -> None:
    text = file.read_text(encoding="utf-8")
    found = "\n".join(golden_lines(import_muxes([(text, file.name)]))) + "\n"
    golden = file.with_suffix(".txt")
    if update_golden:
        golden.write_text(found, encoding="utf-8")
    assert golden.read_text(encoding="utf-8") == found


INPUT = "{topic: t, timeout: 0.5, priority: 1}"
MUX = "m:\n  ros__parameters:\n    topics:\n      a: "
NO_MUX = "0:0: error: the file has no mux: neither `topics` nor `subscribers` with an input"
#: A text, and all that is wrong with it.
REFUSED = [
    ("", ["1:1: error: the file is empty"]),
    ("a: 1\n", [NO_MUX]),
    ("topics:\n", [NO_MUX]),
    ("topics: 3\n", ["1:9: error: `topics` is a scalar, not a map of inputs"]),
    ("topics: [3]\n", ["1:10: error: an input of the list is not a map"]),
    ("topics:\n- topic: t\n", ["2:3: error: an input of the list has no name"]),
    (
        "topics:\n- {name: a}\n- {name: a}\n",
        [
            "2:10: error: input `a` has no `topic` and no `timeout` and no `priority`",
            "3:10: error: input `a_2` has no `topic` and no `timeout` and no `priority`",
        ],
    ),
    (
        MUX + "{topic: 5, timeout: '1', priority: 1.0}\n",
        [
            "4:18: error: the topic of `a` is `5`, not the name of a topic",
            "4:30: error: the timeout of `a` is the text `1`, not a number of seconds",
            "4:45: error: the priority of `a` is `1.0`, not a whole number from 0 to 2147483647",
        ],
    ),
    (
        MUX + "{topic: , timeout: [], priority: {}}\n",
        [
            "4:17: error: the topic of `a` is nothing, not the name of a topic",
            "4:29: error: the timeout of `a` is a list, not a number of seconds",
            "4:43: error: the priority of `a` is a map, not a whole number from 0 to 2147483647",
        ],
    ),
    (
        MUX + "{topic: t, timeout: -1, priority: 2147483648}\n",
        [
            "4:30: error: the timeout of `a` is `-1`,"
            " not a number of seconds from 0 to 2147483.647",
            "4:44: error: the priority of `a` is `2147483648`,"
            " not a whole number from 0 to 2147483647",
        ],
    ),
    (
        MUX + "{topic: t, timeout: 1e999999999, priority: 010}\n",
        [
            "4:30: error: the timeout of `a` is `1e999999999`,"
            " not a number of seconds from 0 to 2147483.647",
            "4:53: error: the priority of `a` is `010`, not a whole number from 0 to 2147483647",
        ],
    ),
    (f'topics: {{"a\\nb": {INPUT}}}\n',
     ["1:10: error: the name of an input is empty, or has a line break or control character"]),
    (
        f"topics: {{i: {INPUT}}}\nlocks: {{a: {{topic: t, timeout: no}}}}\n",
        [
            "2:9: error: lock `a` has no `priority`",
            "2:32: error: the timeout of `a` is `no`, not a number of seconds",
        ],
    ),
    (MUX + "3\n", ["4:10: error: input `a` is not a map"]),
    (f"topics: {{i: {INPUT}}}\nlocks: {{a: 3}}\n", ["2:12: error: lock `a` is not a map"]),
    (f"topics: {{i: {INPUT}}}\nlocks: [3]\n", ["2:9: error: a lock of the list is not a map"]),
    (f"topics: {{i: {INPUT}}}\nlocks: 3\n",
     ["2:8: error: `locks` is a scalar, not a map of locks"]),
    (
        f"{MUX}{INPUT}\n      a: {INPUT}\n",
        ["5:7: error: `a` is given twice in one map"],
    ),
    (
        f"{MUX}{INPUT}\n    topics.a.topic: b\n",
        ["5:5: error: `topic` of `a` is given twice"],
    ),
    (
        "m:\n  ros__parameters:\n    topics:\n    - {name: a}\n",
        ["3:5: error: `topics` is a list under `ros__parameters`, which ROS 2 cannot read as"
         " parameters"],
    ),
    (
        "m:\n  ros__parameters:\n  - topics:\n",
        ["2:3: error: `ros__parameters` holds a list, which ROS 2 cannot read as parameters"],
    ),
    (f"topics: {{cmd_vel_out: {INPUT}}}\n",
     ["1:10: error: `cmd_vel_out` is the name of two things"]),
    ("topics:\n\t- name: a\n",
     ["2:1: error: this is not YAML: found character '\\t' that cannot start any token"]),
    ("topics: [\n",
     ["2:1: error: this is not YAML: expected the node content, but found '<stream end>'"]),
    ("a: *b\n", ["1:4: error: alias `*b` has no complete anchor above it"]),
    ("a: &b [*b]\n", ["1:8: error: alias `*b` has no complete anchor above it"]),
    ("a: !!python/object/apply:os.system [ls]\n",
     ["1:4: error: tag `tag:yaml.org,2002:python/object/apply:os.system` is not read"]),
    ("--- {}\n--- {}\n", ["2:1: error: a second document begins here"]),
    ("a: 1\nb: \0\n", ["2:4: error: character U+0000 is not allowed in YAML"]),
    ("[a]: 1\n", ["1:1: error: a key is a list or a map"]),
    ("<<: 1\n", ["1:5: error: `<<` expects a map"]),
    ("topics: " + "[" * 100_000, ["1:72: error: lists and maps are nested deeper than 64"]),
    (
        "a0: &a0 [x]\n"
        + "\n".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 9)),
        ["6:45: error: with its aliases the file has more than 100000 nodes"],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "wrong"), REFUSED, ids=lambda value: str(value)[:30])
def test_each_refused_file_reports_all_its_errors(text: str, wrong: list[str]) -> None:
    with pytest.raises(MarsError) as caught:
        import_muxes([(text, "m.yaml")])
    assert [place(d) for d in caught.value.diagnostics] == wrong
    assert all(d.help for d in caught.value.diagnostics)


# ---- The command line ----------------------------------------------------------------------------

SCUTTLE = """topics:
- {name: bumper response, topic: bump, timeout: 0.5, priority: 7}
- {name: tablet, topic: tab, timeout: 0.0, priority: 7}
- {name: idle, topic: idle, timeout: 0.5, priority: 0}
locks:
- {name: tablet, topic: stop, timeout: 0.2, priority: 255}
rate: 5
"""


@pytest.fixture
def mux(tmp_path: Path, monkeypatch: Patch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = Path("robot.txt")
    path.write_text(SCUTTLE, encoding="utf-8")
    return path


def outcome(words: str, capsys: Captured) -> tuple[int, str, str]:
    status = run_here(words.split())
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_findings_and_notes_of_unread_parts_have_lines_of_the_file(
    mux: Path, capsys: Captured
) -> None:
    status, findings, notes = outcome("check --format full robot.txt", capsys)
    found = findings + notes
    heads = [line.split(": ")[:2] for line in found.splitlines() if line.startswith("robot")]
    assert heads == [
        ["robot.txt:2:10", "warning"],
        ["robot.txt:3:10", "warning"],
        ["robot.txt:4:10", "warning"],
        ["robot.txt:7:1", "note"],
    ]
    assert status == 0
    for kind in ("ambiguous_priority", "never_expires", "never_wins", "not_read"):
        assert f"[{kind}]" in found
    assert "In twist_mux the first input (ROS 2: by name" in found


def test_quiet_hides_notes_of_unread_parts_and_json_keeps_them(mux: Path, capsys: Captured) -> None:
    assert "not read" not in outcome("check --quiet robot.txt", capsys)[2]
    notes = json.loads(outcome("check --quiet --format json robot.txt", capsys)[1])["notes"]
    assert [(note["code"], note["message"]) for note in notes] == [
        ("not-read", "parameters not read: 1 (`rate`)")
    ]


def test_a_file_of_others_is_never_written(mux: Path, capsys: Captured) -> None:
    status, found, notes = outcome("check --fix robot.txt", capsys)
    assert (status, found) == outcome("check robot.txt", capsys)[:2]
    assert "`robot.txt` was not fixed" in notes
    status, found, notes = outcome("check --diff robot.txt", capsys)
    assert (status, found) == (0, "")
    assert "`robot.txt` was not fixed" in notes
    status, _, found = outcome("fmt robot.txt", capsys)
    assert status == 2
    assert "`robot.txt` is a file of twist_mux" in found.replace("\n  ", " ")
    _, repairs, _ = outcome("explain --repair robot.txt ambiguous_priority", capsys)
    assert "by hand: give `bumper response` and `tablet`" in repairs
    assert mux.read_text(encoding="utf-8") == SCUTTLE


def test_a_named_format_overrides_detection(mux: Path, capsys: Captured) -> None:
    assert "expected" in outcome("check --from mars robot.txt", capsys)[1]
    mux.write_text("{ a: 1 }", encoding="utf-8")
    assert "the file has no mux" in outcome("check --from twist_mux robot.txt", capsys)[1]


def test_the_wiring_of_a_mux_is_verified_against_its_purpose(mux: Path, capsys: Captured) -> None:
    status, judged, _ = outcome("verify robot.txt", capsys)
    assert (status, judged) == (0, "the specification realises the configuration and is minimal\n")


def test_imported_lines_have_their_origins(mux: Path, capsys: Captured) -> None:
    assert outcome("import twist_mux robot.txt --quiet", capsys)[:2] == (
        0,
        """@specification hierarchical
@modules cmd_vel_out, "bumper response", tablet, idle, stop,
ArbitrationNode
// imported from twist_mux
// ArbitrationNode: commands pass a twist_mux
cmd_vel_out is_controlled_by ArbitrationNode  // from robot.txt:1
ArbitrationNode is_controlled_by "bumper response" 7 hold 500  // from robot.txt:2
ArbitrationNode is_controlled_by tablet 7 hold forever  // from robot.txt:3
ArbitrationNode is_controlled_by idle 0 hold 500  // from robot.txt:4
ArbitrationNode is_locked_by stop 255 hold 200  // from robot.txt:6
""",
    )


def meaning(of: Configuration) -> tuple[object, ...]:
    lines = [(*ends_of(r), r.priority, r.hold_ms)
             for r in of.relationships if isinstance(r, Control | Lock)]  # fmt: skip
    return of.kind, of.architecture, [name.text for name in of.modules], lines


@pytest.mark.parametrize("file", FILES, ids=lambda path: path.stem)
def test_printed_imports_have_the_meaning_of_the_file(file: Path) -> None:
    found = import_muxes([(file.read_text(encoding="utf-8"), file.name)]).configuration
    for shape in (found, lifted(found)):
        assert meaning(parse_text(print_configuration(shape), "a.mars").configuration) == meaning(
            shape
        )


def test_a_node_is_never_named_like_an_input() -> None:
    text = f"topics: {{ArbitrationNode: {INPUT}}}"
    found = lifted(import_muxes([(text, "m.yaml")]).configuration)
    assert [name.text for name in found.modules] == [
        "cmd_vel_out",
        "ArbitrationNode",
        "ArbitrationNode2",
    ]


# ---- Real files ----------------------------------------------------------------------------------

SHARED = ROOT.parents[1] / "shared" / "cases" / "imports" / "twist_mux"
#: The kinds of findings and their subjects, as the files' README tells them.
KNOWN = {
    "twist_mux_sample": (4, ["15:7: `joystick` and `tablet` control"]),
    "clearpath_common": (4, []),
    "rmp": (4, ["4:7: `common` has priority 0"]),
    "scuttle": (5, ["20:13: `joystick` and `tablet` control"]),
}


@pytest.mark.skipif(not SHARED.is_dir(), reason=f"the real files are not here: {SHARED}")
@pytest.mark.parametrize("name", KNOWN)
def test_real_files_give_their_known_answers(name: str, capsys: Captured) -> None:
    path = SHARED / f"{name}.yaml"
    inputs, findings = KNOWN[name]
    found = import_muxes([(path.read_text(encoding="utf-8"), str(path))]).configuration
    assert len(found.relationships) == inputs
    _, document, _ = outcome(f"check --format json {path}", capsys)
    warned = json.loads(document)["findings"]
    places = [f"{r['line']}:{r['column']}: {r['message']}" for r in warned]
    assert [p[: len(f)] for p, f in zip(places, findings, strict=True)] == findings


@pytest.mark.parametrize(
    ("text", "format"),
    [
        ("topics:\n", "twist_mux"),
        ("m: {ros__parameters: {}}", "twist_mux"),
        ("m:\n  ros__parameters:\n    topics.joy.topic: a\n", "twist_mux"),
        ("subscribers:\n", "twist_mux"),
        ('{"topics": []}', "twist_mux"),
        ("@modules a\n// topics: b\n", "mars"),
        ("# topics: all\n", "mars"),
        ("@modules a\n@module_start\ntopics:\n@module_end\n", "mars"),
        ("a is_controlled_by topics\n", "mars"),
        ("", "mars"),
    ],
)
def test_a_file_is_recognised_by_its_content(text: str, format: str) -> None:
    assert recognised(text) == format


LONG = "x" * 20_000
LONG_WORDS = [f"topics: !{LONG}\n", f"topics: {{a: *{LONG}}}\n"]


@pytest.mark.parametrize("text", LONG_WORDS)
@pytest.mark.parametrize("format", ["text", "json"])
def test_long_foreign_text_is_quoted_shortened(
    text: str, format: str, tmp_path: Path, capsys: Captured
) -> None:
    file = tmp_path / "m.yaml"
    file.write_text(text, encoding="utf-8")
    run_here(["check", "--from", "twist_mux", "--format", format, str(file)])
    outcome = capsys.readouterr().out
    assert "xxx...xxx" in outcome
    assert len(outcome) < 3000


def test_names_in_a_list_are_labels() -> None:
    inputs = (("a", "x", 1), ("a", "y", 2), ("a_2", "z", 3))
    item = "- {{name: {}, topic: {}, timeout: 0.5, priority: {}}}\n"
    text = "topics:\n" + "".join(item.format(*each) for each in inputs)
    lines = import_muxes([(text, "mux.yaml")]).configuration.relationships
    found = [(str(each.controller), each.priority) for each in lines if isinstance(each, Control)]
    assert found == [("a", 1), ("a_2", 2), ("a_2_2", 3)]


TOPICS = """twist_mux:
  ros__parameters:
    topics:
      nav: {topic: nav_vel, timeout: 0.5, priority: 10}
"""
LOCKS = """{node}:
  ros__parameters:
    locks:
      pause: {{topic: pause_navigation, timeout: 0.0, priority: 50}}
"""


@pytest.mark.parametrize("is_first", [False, True])
def test_locks_in_a_file_of_their_own_are_those_of_the_mux(*, is_first: bool) -> None:
    files = [(LOCKS.format(node="twist_mux"), "locks.yaml"), (TOPICS, "topics.yaml")]
    lines = import_muxes(files if is_first else files[::-1]).configuration.relationships
    (lock,) = (each for each in lines if isinstance(each, Lock))
    assert (lock.controlled, str(lock.source), lock.priority) == ("cmd_vel_out", "pause", 50)
    assert (lock.span.path, lock.span.line) == ("locks.yaml", 4)


def test_locks_of_another_node_are_refused() -> None:
    files = [(TOPICS, "topics.yaml"), (LOCKS.format(node="other"), "locks.yaml")]
    assert "has no mux" in refusal(import_muxes, files).message
