"""The server as a process, with a client over stdio."""

import asyncio
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest
from lsprotocol import types
from pygls.exceptions import JsonRpcException

from mars_asp.cli import run_here
from tests.support.documents import ROOT
from tests.support.editor import SECONDS, Editor, editor
from tests.support.fixtures import Captured, Patch

Scenario = Callable[[Editor], Awaitable[None]]


def played(scenario: Scenario, folder: Path, *options: str) -> None:
    async def play() -> None:
        async with editor(folder, *options) as client:
            await scenario(client)
            assert client.complaints == []

    asyncio.run(play())


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return Path(shutil.copytree(ROOT / "tests" / "lsp" / "robot", tmp_path / "robot"))


def document(uri: str) -> types.TextDocumentIdentifier:
    return types.TextDocumentIdentifier(uri)


def stretch(place: object) -> tuple[str, int, int, int]:
    """Return the file, line and columns of a place, which is in one line."""
    assert isinstance(place, types.Location)
    begin, end = place.range.start, place.range.end
    assert begin.line == end.line
    return Path(place.uri).name, begin.line, begin.character, end.character


def applied(text: str, edits: list[types.TextEdit]) -> str:
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
    async def scenario(client: Editor) -> None:
        path = folder / "robot.mars"
        uri = client.open(path)
        (found,) = await client.diagnostics(uri)
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
        await asks_for_places(client, uri)
        await asks_for_words(client, uri)
        await asks_for_lenses(client, uri)
        await asks_for_repairs(client, uri, path)
        await asks_for_another_name(client, uri, folder)

    played(scenario, folder)


async def asks_for_places(client: Editor, uri: str) -> None:
    at = types.Position(11, 23)  # `Camera` in `Screen uses_data_from Camera.grab`
    found = await client.text_document_definition_async(types.DefinitionParams(document(uri), at))
    assert isinstance(found, list)
    assert [stretch(each) for each in found] == [("camera.cpp", 1, 16, 22)]
    port = types.DefinitionParams(document(uri), types.Position(11, 30))
    found = await client.text_document_definition_async(port)
    assert isinstance(found, list)
    assert [stretch(each) for each in found] == [("camera.cpp", 3, 3, 30)]
    context = types.ReferenceContext(include_declaration=True)
    named = await client.text_document_references_async(
        types.ReferenceParams(context, document(uri), at)
    )
    assert [stretch(each) for each in named or ()] == [
        ("robot.mars", 3, 9, 15),
        ("robot.mars", 10, 29, 35),
        ("robot.mars", 11, 22, 28),
        ("camera.cpp", 1, 16, 22),
    ]
    symbols = await client.text_document_document_symbol_async(
        types.DocumentSymbolParams(document(uri))
    )
    assert [each.name for each in symbols or ()] == [
        *("Camera", "Planner", "Screen", "Wheels", "Joystick"),
        "Wheels",
    ]
    cameras = await client.workspace_symbol_async(types.WorkspaceSymbolParams("cam"))
    assert [(each.name, each.kind, stretch(each.location)) for each in cameras or ()] == [
        ("Camera", types.SymbolKind.Module, ("robot.mars", 3, 9, 15)),
        ("Camera", types.SymbolKind.Module, ("camera.cpp", 1, 16, 22)),
    ]
    every = await client.workspace_symbol_async(types.WorkspaceSymbolParams(""))
    assert len(every or ()) == 10


async def asks_for_words(client: Editor, uri: str) -> None:
    assert await client.hover(uri, 10, 20) == (
        "```text\nNAME[.INPUT] uses_data_from NAME[.OUTPUT] [MODE] [HZ | every N ms]\n```\n\n"
        "Delivers data of the right module to the left one, in a mode and at a rate where these "
        "are stated."
    )
    camera = await client.hover(uri, 3, 10)
    assert camera.startswith("```text\nCamera (sensor)  ")
    assert "\n  Sense NotifyAtFrequency 20: grab() -> Image\n```" in camera
    # Beyond the end of a line is its end.
    assert (await client.hover(uri, 3, 99)).startswith("`Joystick`: no annotation describes")
    finding = await client.hover(uri, 12, 10)
    while "[effective/tied]" not in finding:  # a busy machine takes longer than a hover waits
        finding = await client.hover(uri, 12, 10)
    assert "**warning**: `Joystick` and `Planner` control `Wheels`" in finding
    assert (
        "2 controllers of `Wheels` have priority 1  [effective/tied]\n            robot.mars:1"
        in finding
    )
    context = types.CompletionParams(document(uri), types.Position(11, 29))
    items = await client.text_document_completion_async(context)
    assert isinstance(items, types.CompletionList)
    assert [each.label for each in items.items] == ["grab"]


async def asks_for_lenses(client: Editor, uri: str) -> None:
    await client.until(lambda: client.refreshed > 0)
    found = await client.text_document_code_lens_async(types.CodeLensParams(document(uri)))
    entries = [(each.range.start.line, each.command and each.command.title) for each in found or ()]
    assert entries[0] == (0, "5 consequences, 1 warning, 2 nodes")
    assert (3, "Camera: 2 consequences; DataSplitter1") in entries
    command = (found or ())[1].command
    assert command is not None
    answer = await client.workspace_execute_command_async(
        types.ExecuteCommandParams(command.command, command.arguments)
    )
    assert answer is not None
    assert "data_divergence(Camera)" in str(answer)
    assert client.shown == [answer]


async def asks_for_repairs(client: Editor, uri: str, path: Path) -> None:
    place = types.Range(types.Position(12, 3), types.Position(12, 3))
    found = await client.text_document_code_action_async(
        types.CodeActionParams(document(uri), place, types.CodeActionContext([]))
    )
    repaired = []
    for each in found or ():
        assert isinstance(each, types.CodeAction)
        assert each.edit is not None and each.edit.changes is not None
        text = applied(path.read_text(), list(each.edit.changes[uri]))
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


async def asks_for_another_name(client: Editor, uri: str, folder: Path) -> None:
    at = types.Position(11, 23)
    found = await client.text_document_rename_async(
        types.RenameParams(document(uri), at, "Front camera")
    )
    assert found is not None and found.changes is not None
    for place, edits in found.changes.items():
        path = folder / Path(place).name
        path.write_text(applied(path.read_text(), list(edits)))
    robot = (folder / "robot.mars").read_text()
    assert '@modules "Front camera", Planner' in robot
    assert 'Screen uses_data_from "Front camera".grab' in robot
    assert '@module_name "Front camera"\n' in (folder / "camera.cpp").read_text()
    client.change(uri, robot, 2)
    assert len(await client.diagnostics(uri, 2)) == 1
    refused = types.RenameParams(document(uri), types.Position(11, 2), "Planner")
    with pytest.raises(JsonRpcException, match="`Planner` is a module already"):
        await client.text_document_rename_async(refused)


def test_edits_are_followed_in_every_file_of_a_robot(folder: Path) -> None:
    async def scenario(client: Editor) -> None:
        camera = folder / "camera.cpp"
        source = client.open(camera)
        # Its robot is found in its folder.
        assert await client.diagnostics(source) == []
        robot = (folder / "robot.mars").as_uri()
        await client.until(lambda: robot in client.published)
        assert [each.code for each in client.published[robot]] == ["control/ambiguous-priority"]
        text = camera.read_text(encoding="utf-8")
        client.change(source, text.replace("@Sense Not", "@Sense Nto"), 2)
        (found,) = await client.diagnostics(source, 2)
        assert found.range.start == types.Position(3, 10)
        await client.until(lambda: not client.published[robot])
        place = types.Range(found.range.start, found.range.start)
        (action,) = (
            await client.text_document_code_action_async(
                types.CodeActionParams(document(source), place, types.CodeActionContext([]))
            )
            or ()
        )
        assert action.title == "Write `NotifyAtFrequency`"
        # After many keystrokes only the last text is diagnosed.
        for version in range(3, 30):
            client.change(source, text + "\n" * version, version)
        client.change(source, text, 30)
        assert await client.diagnostics(source, 30) == []
        items = await client.text_document_completion_async(
            types.CompletionParams(document(source), types.Position(3, 4))
        )
        assert isinstance(items, types.CompletionList)
        assert "@DataOut" in {each.label for each in items.items}
        client.close(source)
        await client.until(lambda: not client.published[robot])

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
    async def scenario(client: Editor) -> None:
        path = folder / "robot.mars"
        uri, text = client.open(path), path.read_text()
        await client.diagnostics(uri)
        for version, (old, new, expected) in enumerate(HALF_TYPED, 2):
            client.change(uri, text.replace(old, new, 1), version)
            found = await client.diagnostics(uri, version)
            assert sorted((each.range.start.line, str(each.code)) for each in found) == expected
            # The modules stay known.
            assert "grab() -> Image" in await client.hover(uri, 3, 10)
        (last,) = await client.diagnostics(uri, version)
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
    options = types.FormattingOptions(8, insert_spaces=False)

    async def scenario(client: Editor) -> None:
        for name, text, expected in FORMATTING:
            path = tmp_path / name
            uri = client.open(path, text)
            params = types.DocumentFormattingParams(document(uri), options)
            edits = await client.text_document_formatting_async(params) or ()
            client.close(uri)
            ranges = [(each.range.start, each.range.end, each.new_text) for each in edits]
            assert [((s.line, s.character), (e.line, e.character), t) for s, e, t in ranges] == (
                expected
            )
            if expected:
                path.write_bytes(text.encode())
                assert run_here(["fmt", str(path)]) == 0
                assert path.read_bytes().decode() == expected[0][2]
        params = types.DocumentFormattingParams(document("file:///gone.mars"), options)
        assert not await client.text_document_formatting_async(params)

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
    async def scenario(client: Editor) -> None:
        path = tmp_path / "mine.lp"
        path.write_text("")
        uri = client.open(path, RULES)
        (found, *_) = await client.diagnostics(uri)
        assert found.code == "rules-refused"
        assert found.range.start == types.Position(6, 34)
        client.change(uri, RULES.replace(". 😀", "."), 2)
        await client.diagnostics(uri, 2)
        assert "The configuration names M in `@modules`." in await client.hover(uri, 2, 15)
        assert "Module M is 😀 wide." in await client.hover(uri, 6, 2)
        assert "What the rule tells" in await client.hover(uri, 1, 5)
        where = types.DefinitionParams(document(uri), types.Position(2, 30))
        places = await client.text_document_definition_async(where)
        assert isinstance(places, list)
        assert [stretch(each) for each in places][:2] == [
            ("mine.lp", 3, 4, 8),
            ("mine.lp", 6, 0, 4),
        ]
        given = types.DefinitionParams(document(uri), types.Position(2, 16))
        places = await client.text_document_definition_async(given)
        assert isinstance(places, list)
        assert "vocabulary.lp" in {Path(each.uri).name for each in places}
        named = await client.text_document_references_async(
            types.ReferenceParams(
                types.ReferenceContext(include_declaration=False), document(uri), where.position
            )
        )
        assert [stretch(each) for each in named or ()] == [("mine.lp", 2, 29, 33)]
        items = await client.text_document_completion_async(
            types.CompletionParams(document(uri), types.Position(2, 30))
        )
        assert isinstance(items, types.CompletionList)
        labels = {each.label for each in items.items}
        assert {"wide", "watched"} <= labels
        assert "is_sensor" not in labels
        symbols = await client.text_document_document_symbol_async(
            types.DocumentSymbolParams(document(uri))
        )
        assert [each.name for each in symbols or ()] == ["watched/1", "wide/1"]

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
    async def scenario(client: Editor) -> None:
        path = tmp_path / "roads.lp"
        # What is on the disk is not what is mended.
        path.write_text("")
        uri, text, taken = client.open(path, FAULTY), FAULTY, []
        for version in range(2, 7):
            for found in await client.diagnostics(uri, version - 1):
                result = await client.text_document_code_action_async(
                    types.CodeActionParams(document(uri), found.range, types.CodeActionContext([]))
                )
                if result:
                    break
            else:
                break
            (action,) = result
            assert isinstance(action, types.CodeAction) and action.edit is not None
            assert action.is_preferred and action.kind == types.CodeActionKind.QuickFix
            assert list(action.diagnostics or ()) == [found] and action.edit.changes is not None
            taken.append((found.code, action.title))
            text = applied(text, list(action.edit.changes[uri]))
            client.change(uri, text, version)
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
    rules = folder / "endless.lp"
    rules.write_text(ENDLESS)

    async def scenario(client: Editor) -> None:
        uri = client.open(folder / "robot.mars")
        await client.hover(uri, 10, 20)
        assert uri not in client.published

    played(scenario, folder, f"--rules={rules}", "--time-limit=1000")


def test_a_long_analysis_is_ended(folder: Path) -> None:
    rules = folder / "endless.lp"
    rules.write_text(ENDLESS)

    async def scenario(client: Editor) -> None:
        uri = client.open(folder / "robot.mars")
        (found,) = await client.diagnostics(uri)
        assert found.message.startswith("this was not analysed: it took longer than 1 s")

    played(scenario, folder, f"--rules={rules}", "--time-limit=1")


def test_a_worker_with_too_much_memory_is_ended(folder: Path) -> None:
    rules = folder / "endless.lp"
    rules.write_text(ENDLESS)

    async def scenario(client: Editor) -> None:
        uri = client.open(folder / "robot.mars")
        (found,) = await client.diagnostics(uri)
        assert found.message.startswith("this was not analysed: the ")

    played(scenario, folder, f"--rules={rules}", "--memory-limit=300")


def test_without_the_extra_it_tells_how_to_install_it(capsys: Captured, monkeypatch: Patch) -> None:
    monkeypatch.setattr("mars_asp.cli.lsp.find_spec", lambda name: None)
    assert run_here(["lsp"]) == 2
    text = "mars-asp lsp: the language server needs the extra `lsp`: pip install 'mars-asp[lsp]'\n"
    assert capsys.readouterr() == ("", text)


def children(of: int) -> list[int]:
    tasks = Path(f"/proc/{of}/task/{of}/children")
    return [int(each) for each in tasks.read_text().split()]


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="reads /proc")
def test_nothing_is_left_when_the_editor_is_gone(folder: Path) -> None:
    command = [sys.executable, "-m", "mars_asp", "lsp"]
    server = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert server.stdin is not None and server.stdout is not None
    messages = (
        '{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"capabilities":{}}}',
        '{"jsonrpc":"2.0","method":"initialized","params":{}}',
    )
    for text in messages:
        server.stdin.write(f"Content-Length: {len(text)}\r\n\r\n{text}".encode())
    server.stdin.flush()
    until = time.monotonic() + SECONDS
    while not (workers := children(server.pid)) and time.monotonic() < until:
        time.sleep(0.05)
    assert workers
    server.kill()
    server.wait()
    while any(Path(f"/proc/{each}").is_dir() for each in workers) and time.monotonic() < until:
        time.sleep(0.05)
    assert not [each for each in workers if os.path.isdir(f"/proc/{each}")]  # noqa: PTH112
    server.stdout.close()
