"""The server as a process, and its messages over stdio, read as the protocol gives them."""

import os
import shutil
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from lsprotocol import types
from pygls.protocol import default_converter

from mars_asp.cli import run_here
from mars_asp.cli.suggested_commands import way_to_install
from tests.support.documents import ROOT
from tests.support.fixtures import Captured, Patch
from tests.support.processes import children_of
from tests.support.wire import SECONDS, Wire

CONVERTER = default_converter()  # type: ignore[no-untyped-call]


def played(scenario: Callable[[Wire], None], folder: Path, *options: str) -> None:
    wire = Wire(*options, folder=folder)
    try:
        scenario(wire)
        assert wire.complaints == []
    finally:
        assert wire.end() == 0


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return Path(shutil.copytree(ROOT / "tests" / "lsp" / "robot", tmp_path / "robot"))


def result_of(wire: Wire, method: str, params: object) -> Any:
    """Return the result of a request, refused unless it has the form of the protocol."""
    message = wire.ask(method, params)
    assert "error" not in message, message
    return CONVERTER.structure(message, types.METHOD_TO_TYPES[method][1]).result


def about(wire: Wire, question: str, uri: str, *at: int, **more: object) -> Any:
    """Return the answer to a question about a text, or about a place in it."""
    params = {"textDocument": {"uri": uri}, **more}
    if at:
        params["position"] = {"line": at[0], "character": at[1]}
    return result_of(wire, f"textDocument/{question}", params)


def hover(wire: Wire, uri: str, line: int, character: int) -> str:
    """Return the hover text at a location, empty if there is none."""
    found = about(wire, "hover", uri, line, character)
    return "" if found is None else str(found.contents.value)


def actions(wire: Wire, uri: str, place: types.Range) -> list[types.CodeAction]:
    """Return the code actions at a place."""
    range_ = CONVERTER.unstructure(place)
    found = about(wire, "codeAction", uri, range=range_, context={"diagnostics": []})
    return list(found or ())


def diagnostics(wire: Wire, uri: str, version: int = 1) -> list[types.Diagnostic]:
    """Wait for the diagnostics of a version of a text; return them."""
    found = wire.diagnostics(uri, version)
    return [CONVERTER.structure(each, types.Diagnostic) for each in found]


def labels(found: types.CompletionList) -> list[str]:
    return [each.label for each in found.items]


def stretch(place: types.Location) -> tuple[str, int, int, int]:
    """Return the file, line and columns of a place, which is in one line."""
    begin, end = place.range.start, place.range.end
    assert begin.line == end.line
    return Path(place.uri).name, begin.line, begin.character, end.character


def applied(text: str, edits: Sequence[types.TextEdit]) -> str:
    """Return a text with edits, whose columns count UTF-16 units."""
    lines = text.splitlines(keepends=True)
    starts = [sum(map(len, lines[:number])) for number in range(len(lines) + 1)]

    def offset(at: types.Position) -> int:
        before = lines[at.line].encode("utf-16-le")[: 2 * at.character] if at.character else b""
        return starts[at.line] + len(before.decode("utf-16-le"))

    for edit in sorted(edits, key=lambda each: offset(each.range.start), reverse=True):
        begin, end = offset(edit.range.start), offset(edit.range.end)
        text = text[:begin] + edit.new_text + text[end:]
    return text


def test_the_server_answers_about_a_robot(folder: Path) -> None:
    def scenario(wire: Wire) -> None:
        path = folder / "robot.mars"
        uri = wire.open(path)
        (found,) = diagnostics(wire, uri)
        assert found.message == (
            "`Joystick` and `Planner` control `Wheels` with the same priority, 1\n"
            "Among them, the latest message wins.\n"
            "help: give `Joystick` and `Planner` priorities that differ"
        )
        assert found.code == "control/ambiguous-priority"
        assert found.severity == types.DiagnosticSeverity.Warning
        assert found.range == types.Range(types.Position(12, 0), types.Position(12, 33))
        (related,) = found.related_information or ()
        assert (stretch(related.location), related.message) == (
            ("robot.mars", 13, 0, 34),
            "`Joystick` also has priority 1",
        )
        asks_for_places(wire, uri)
        asks_for_words(wire, uri)
        asks_for_lenses(wire, uri)
        asks_for_repairs(wire, uri, path)
        asks_for_another_name(wire, uri, folder)

    played(scenario, folder)


def asks_for_places(wire: Wire, uri: str) -> None:
    at = 11, 23  # `Camera` in `Screen uses_data_from Camera.grab`
    found = about(wire, "definition", uri, *at)
    assert [stretch(each) for each in found] == [("camera.cpp", 1, 16, 22)]
    found = about(wire, "definition", uri, 11, 30)
    assert [stretch(each) for each in found] == [("camera.cpp", 3, 3, 30)]
    named = about(wire, "references", uri, *at, context={"includeDeclaration": True})
    assert [stretch(each) for each in named] == [
        ("robot.mars", 3, 9, 15),
        ("robot.mars", 10, 29, 35),
        ("robot.mars", 11, 22, 28),
        ("camera.cpp", 1, 16, 22),
    ]
    assert [each.name for each in about(wire, "documentSymbol", uri)] == [
        *("Camera", "Planner", "Screen", "Wheels", "Joystick"),
        "Wheels",
    ]
    cameras = result_of(wire, "workspace/symbol", {"query": "cam"})
    assert [(each.name, each.kind, stretch(each.location)) for each in cameras] == [
        ("Camera", types.SymbolKind.Module, ("robot.mars", 3, 9, 15)),
        ("Camera", types.SymbolKind.Module, ("camera.cpp", 1, 16, 22)),
    ]
    assert len(result_of(wire, "workspace/symbol", {"query": ""})) == 10


def asks_for_words(wire: Wire, uri: str) -> None:
    assert hover(wire, uri, 10, 20) == (
        "```text\nNAME[.INPUT] uses_data_from NAME[.OUTPUT] [MODE] [HZ | every N ms]\n```\n\n"
        "Delivers data of the right module to the left one, in a mode and at a rate where these "
        "are stated."
    )
    camera = hover(wire, uri, 3, 10)
    assert camera.startswith("```text\nCamera (sensor)  ")
    assert "\n  Sense NotifyAtFrequency 20: grab() -> Image\n```" in camera
    # Beyond the end of a line is its end.
    assert hover(wire, uri, 3, 99).startswith("`Joystick`: no annotation describes")
    finding = hover(wire, uri, 12, 10)
    while "[effective/tied]" not in finding:  # a busy machine takes longer than a hover waits
        finding = hover(wire, uri, 12, 10)
    assert "**warning**: `Joystick` and `Planner` control `Wheels`" in finding
    assert (
        "2 controllers of `Wheels` have priority 1  [effective/tied]\n            robot.mars:1"
        in finding
    )
    assert labels(about(wire, "completion", uri, 11, 29)) == ["grab"]


def asks_for_lenses(wire: Wire, uri: str) -> None:
    wire.until(lambda: wire.refreshed > 0)
    found = about(wire, "codeLens", uri)
    entries = [(each.range.start.line, each.command.title) for each in found]
    assert entries[0] == (0, "5 consequences, 1 warning, 2 nodes")
    assert (3, "Camera: 2 consequences; DataSplitter1") in entries
    command = CONVERTER.unstructure(found[1].command)
    answer = result_of(wire, "workspace/executeCommand", command)
    assert "data_divergence(Camera)" in answer
    assert [wire.complaints.pop()] == [answer]


def asks_for_repairs(wire: Wire, uri: str, path: Path) -> None:
    place = types.Range(types.Position(12, 3), types.Position(12, 3))
    repaired = []
    for each in actions(wire, uri, place):
        assert each.edit is not None and each.edit.changes is not None
        text = applied(path.read_text(), each.edit.changes[uri])
        repaired.append((each.title, text.splitlines()[12:14]))
    assert repaired == [
        (
            "rank `Joystick` above `Planner` at `Wheels`",
            ["Wheels is_controlled_by Planner 1", "Wheels is_controlled_by Joystick 2"],
        ),
        (
            "rank `Planner` above `Joystick` at `Wheels`",
            ["Wheels is_controlled_by Planner 2", "Wheels is_controlled_by Joystick 1"],
        ),
    ]


def asks_for_another_name(wire: Wire, uri: str, folder: Path) -> None:
    found = about(wire, "rename", uri, 11, 23, newName="Front camera")
    for place, edits in found.changes.items():
        path = folder / Path(place).name
        path.write_text(applied(path.read_text(), edits))
    robot = (folder / "robot.mars").read_text()
    assert '@modules "Front camera", Planner' in robot
    assert 'Screen uses_data_from "Front camera".grab' in robot
    assert '@module_name "Front camera"\n' in (folder / "camera.cpp").read_text()
    wire.change(uri, robot, 2)
    assert len(diagnostics(wire, uri, 2)) == 1
    params = {"textDocument": {"uri": uri}, "position": {"line": 11, "character": 2}}
    refused = wire.ask("textDocument/rename", {**params, "newName": "Planner"})
    assert "`Planner` is a module already" in refused["error"]["message"]


def test_edits_are_followed_in_every_file_of_a_robot(folder: Path) -> None:
    def scenario(wire: Wire) -> None:
        camera = folder / "camera.cpp"
        source = wire.open(camera)
        # Its robot is found in its folder.
        assert diagnostics(wire, source) == []
        robot = (folder / "robot.mars").as_uri()

        def codes_of_robot() -> list[str]:
            return [each["code"] for each in wire.published[robot]["diagnostics"]]

        wire.until(lambda: robot in wire.published)
        assert codes_of_robot() == ["control/ambiguous-priority"]
        text = camera.read_text(encoding="utf-8")
        wire.change(source, text.replace("@Sense Not", "@Sense Nto"), 2)
        (found,) = diagnostics(wire, source, 2)
        assert found.range.start == types.Position(3, 10)
        wire.until(lambda: not codes_of_robot())
        (action,) = actions(wire, source, types.Range(found.range.start, found.range.start))
        assert action.title == "Write `NotifyAtFrequency`"
        # After many keystrokes only the last text is diagnosed.
        for version in range(3, 30):
            wire.change(source, text + "\n" * version, version)
        wire.change(source, text, 30)
        assert diagnostics(wire, source, 30) == []
        assert "@DataOut" in labels(about(wire, "completion", source, 3, 4))
        wire.close(source)
        wire.until(lambda: not codes_of_robot())

    played(scenario, folder)


#: Texts of `robot.mars`, by what is replaced in it, and the lines and codes of their findings.
HALF_TYPED = [
    ("Screen uses", "Screen use", [(11, "syntax"), (12, "control/ambiguous-priority")]),
    ("Screen uses", "Screen\nScreen uses", [(11, "syntax"), (13, "control/ambiguous-priority")]),
    ("Joystick\n\n", "Joystick x\n", [(3, "syntax"), (11, "control/ambiguous-priority")]),
    ("Z -500 500", "Z -500", [(7, "MARS116"), (12, "control/ambiguous-priority")]),
    ("Planner 1", "Planner 1 1", [(12, "syntax")]),
    ("Screen uses", "Scren uses", [(11, "checks/misspelt"), (12, "control/ambiguous-priority")]),
    ("", "", [(12, "control/ambiguous-priority")]),
]


def test_findings_stay_while_a_line_is_half_typed(folder: Path) -> None:
    def scenario(wire: Wire) -> None:
        path = folder / "robot.mars"
        uri, text = wire.open(path), path.read_text()
        wire.diagnostics(uri)
        for version, (old, new, expected) in enumerate(HALF_TYPED, 2):
            wire.change(uri, text.replace(old, new, 1), version)
            found = diagnostics(wire, uri, version)
            assert sorted((each.range.start.line, str(each.code)) for each in found) == expected
            # The modules stay known.
            assert "grab() -> Image" in hover(wire, uri, 3, 10)
        (last,) = diagnostics(wire, uri, version)
        (related,) = last.related_information or ()
        assert related.location.range.start.line == 13

    played(scenario, folder)


#: Texts of an editor and the edits of formatting them: the whole text, or none.
UNFORMATTED = "\ufeff@configuration   flat\r\n@modules A,B // 😀\r\n\r\n\r\n\r\nA  uses_data_from B"
FORMATTED = "@configuration flat\n@modules A, B  // 😀\n\nA uses_data_from B\n"
FORMATTING = [
    ("a.mars", UNFORMATTED, [((0, 0), (5, 19), FORMATTED)]),
    ("a.mars", f"{FORMATTED}\n", [((0, 0), (5, 0), FORMATTED)]),
    ("a.mars", FORMATTED, []),
    ("a.mars", "@configuration   flat\n@modules A,B\nA uses_data_from\n", []),
    ("a.mars", "", []),
    ("a.lp", "p(X)  :-  module(X).\n", []),
    ("a.py", "#   @module_start\n", []),
]


def test_formatting_writes_the_text_of_fmt(tmp_path: Path) -> None:
    options = {"tabSize": 8, "insertSpaces": False}

    def scenario(wire: Wire) -> None:
        for name, text, expected in FORMATTING:
            path = tmp_path / name
            uri = wire.open(path, text)
            edits = about(wire, "formatting", uri, options=options) or ()
            wire.close(uri)
            ranges = [(each.range.start, each.range.end, each.new_text) for each in edits]
            assert [((s.line, s.character), (e.line, e.character), t) for s, e, t in ranges] == (
                expected
            )
            if expected:
                path.write_bytes(text.encode())
                assert run_here(["fmt", str(path)]) == 0
                assert path.read_bytes().decode() == expected[0][2]
        assert not about(wire, "formatting", "file:///gone.mars", options=options)

    played(scenario, tmp_path)


RULES = """\
%! id: mine/watched
%! because: `{M}` is watched
watched(M) :- module(M), not wide(M).
%*! wide(M: module)
Module M is 😀 wide.
*%
wide(M) :- module(M), watched(M). 😀
"""


def test_the_server_answers_about_rules(tmp_path: Path) -> None:
    def scenario(wire: Wire) -> None:
        path = tmp_path / "mine.lp"
        path.write_text("")
        uri = wire.open(path, RULES)
        (found, *_) = diagnostics(wire, uri)
        assert found.code == "rules-refused"
        assert found.range.start == types.Position(6, 34)
        wire.change(uri, RULES.replace(". 😀", "."), 2)
        wire.diagnostics(uri, 2)
        assert "The configuration names M in `@modules`." in hover(wire, uri, 2, 15)
        assert "Module M is 😀 wide." in hover(wire, uri, 6, 2)
        assert "What the rule tells" in hover(wire, uri, 1, 5)
        places = about(wire, "definition", uri, 2, 30)
        assert [stretch(each) for each in places][:2] == [
            ("mine.lp", 3, 4, 8),
            ("mine.lp", 6, 0, 4),
        ]
        given = about(wire, "definition", uri, 2, 16)
        assert "vocabulary.lp" in {Path(each.uri).name for each in given}
        named = about(wire, "references", uri, 2, 30, context={"includeDeclaration": False})
        assert [stretch(each) for each in named] == [("mine.lp", 2, 29, 33)]
        proposed = labels(about(wire, "completion", uri, 2, 30))
        assert {"wide", "watched"} <= {*proposed}
        assert "is_sensor" not in proposed
        symbols = about(wire, "documentSymbol", uri)
        assert [each.name for each in symbols] == ["watched/1", "wide/1"]

    played(scenario, tmp_path)


#: One finding of each lint with a safe fix, `😀` before one, and what is left when all are taken.
FAULTY = """\
%*! road(R: road, K: {paved, gravel}, N: text)
R is a road of kind K, called N.
*%
#defined road/3.
first(R) :- road(R, pavd, _).
second(R) :- road(R, _, "😀"), road(R, "paved", _).
third(R) :- road(R, gravel, _), road(R, gravel, _).
fourth(R) :- road(R, _, N), N = main.
#show first/1. #show second/1. #show third/1. #show fourth/1.
"""
MENDED = """\
first(R) :- road(R, paved, _).
second(R) :- road(R, _, "😀"), road(R, paved, _).
third(R) :- road(R, gravel, _).
fourth(R) :- road(R, _, N), N = "main".
"""


def test_lints_are_fixed_by_code_actions(tmp_path: Path) -> None:
    def scenario(wire: Wire) -> None:
        path = tmp_path / "roads.lp"
        # What is on the disk is not what is mended.
        path.write_text("")
        uri, text, taken = wire.open(path, FAULTY), FAULTY, []
        for version in range(2, 7):
            for found in diagnostics(wire, uri, version - 1):
                if result := actions(wire, uri, found.range):
                    break
            else:
                break
            (action,) = result
            assert action.is_preferred and action.kind == types.CodeActionKind.QuickFix
            assert list(action.diagnostics or ()) == [found]
            assert action.edit is not None and action.edit.changes is not None
            taken.append((found.code, action.title))
            text = applied(text, action.edit.changes[uri])
            wire.change(uri, text, version)
        assert taken == [
            ("rule-value", "Write `paved`"),
            ("rule-form", "Write `paved`"),
            ("rule-redundant", "Leave it out"),
            ("rule-form", 'Write `"main"`'),
        ]
        assert text.splitlines()[4:8] == MENDED.splitlines()
        path.write_text(FAULTY)
        run_here(["rules", "lint", "--fix", str(path)])
        assert path.read_text() == text

    played(scenario, tmp_path)


#: Rules that are grounded for ever.
ENDLESS = "far(0) :- module(_).\nfar(X+1) :- far(X), X < 2000000000.\n"


def test_a_long_analysis_delays_no_answer(folder: Path) -> None:
    def scenario(wire: Wire) -> None:
        uri = wire.open(folder / "robot.mars")
        hover(wire, uri, 10, 20)
        assert uri not in wire.published

    rules = folder / "endless.lp"
    rules.write_text(ENDLESS)
    played(scenario, folder, f"--rules={rules}", "--time-limit=1000")


@pytest.mark.parametrize(
    ("limit", "reason"),
    [("--time-limit=1", "it took longer than 1 s"), ("--memory-limit=300", "the ")],
)
def test_a_long_analysis_is_ended(folder: Path, limit: str, reason: str) -> None:
    def scenario(wire: Wire) -> None:
        (found,) = diagnostics(wire, wire.open(folder / "robot.mars"))
        assert found.message.startswith(f"this was not analysed: {reason}")
        assert [wire.complaints.pop()] == [found.message]

    rules = folder / "endless.lp"
    rules.write_text(ENDLESS)
    played(scenario, folder, f"--rules={rules}", limit)


def test_without_the_extra_it_tells_how_to_install_it(capsys: Captured, monkeypatch: Patch) -> None:
    monkeypatch.setattr("mars_asp.cli.lsp.find_spec", lambda name: None)
    assert run_here(["lsp"]) == 2
    way = way_to_install("lsp")
    text = f"mars-asp lsp: the language server needs the extra `lsp`: {way}\n"
    assert capsys.readouterr() == ("", text)


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="reads /proc")
def test_nothing_is_left_when_the_editor_is_gone() -> None:
    wire = Wire()
    until = time.monotonic() + SECONDS
    while not (workers := children_of(wire.process.pid)) and time.monotonic() < until:
        time.sleep(0.05)
    assert workers
    wire.process.kill()
    wire.process.wait()
    while any(Path(f"/proc/{each}").is_dir() for each in workers) and time.monotonic() < until:
        time.sleep(0.05)
    assert not [each for each in workers if os.path.isdir(f"/proc/{each}")]  # noqa: PTH112
