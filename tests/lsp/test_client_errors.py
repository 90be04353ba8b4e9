"""The language server reports a client's errors to the client, and reads regular files alone."""

import json
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

from mars_asp.lsp import client_errors
from mars_asp.lsp.client_errors import BoundedInput
from mars_asp.lsp.workspace import EditorWorkspace
from tests.support import hostile_editor
from tests.support.fixtures import Patch
from tests.support.processes import HANGING
from tests.support.wire import bodies, framed

HOVER = {"textDocument": {"uri": "file:///a.mars"}, "position": {"line": 0, "character": 0}}
HELLO: dict[str, Any] = {"processId": None, "rootUri": None, "capabilities": {}}


def request(identity: object, method: str, params: object = None) -> bytes:
    return framed({"jsonrpc": "2.0", "id": identity, "method": method, "params": params})


def notice(method: str, **params: object) -> bytes:
    return framed({"jsonrpc": "2.0", "method": method, "params": params})


def at(line: object, character: object, uri: object = "file:///a.mars") -> dict[str, Any]:
    return {
        "textDocument": {"uri": uri},
        "position": {"line": line, "character": character},
    }


def explaining(*arguments: object) -> dict[str, object]:
    return {"command": "mars-asp.explain", **({"arguments": arguments} if arguments else {})}


OPENED = {
    "uri": "file:///a.mars",
    "languageId": "mars",
    "version": 1,
    "text": "@configuration\n@modules A\n",
}
OPTIONS = {"options": {"tabSize": 2, "insertSpaces": True}}
#: What a client sends, and what tells it so: the answered request and a code, or a line of the log.
MESSAGES: tuple[tuple[bytes, tuple[object, int] | str], ...] = (
    (request(1, "textDocument/hover", HOVER), (1, -32002)),
    (notice("initialized"), "came before `initialize`"),
    (request(2, "initialize", HELLO), (2, 0)),
    (request(3, "initialize", HELLO), (3, -32600)),
    (request(4, "no/such"), (4, -32601)),
    (request(5, "textDocument/hover", {"textDocument": 7}), (5, -32602)),
    (request({"a": 1}, "textDocument/hover"), "the `id` of a message is a number or a text"),
    (request(6, 7), (6, -32600)),  # type: ignore[arg-type]
    (notice("textDocument/didOpen", textDocument=3), "has not the form that the protocol gives it"),
    (
        notice(
            "textDocument/didChange",
            textDocument={"uri": "file:///gone.mars", "version": 1},
            contentChanges=[{"text": ""}],
        ),
        "`file:///gone.mars` is not open",
    ),
    # Places beyond a text are its nearest ones; a text that is not open has no answers.
    (notice("textDocument/didOpen", textDocument=OPENED), (2, 0)),
    (request(10, "textDocument/hover", at(99, 99)), (10, 0)),
    (request(11, "textDocument/hover", at(2**31 - 1, 0)), (11, 0)),
    (request(12, "textDocument/hover", at(0, 0, "file:///gone.mars")), (12, 0)),
    (request(13, "textDocument/definition", at(0, 0, "untitled:1")), (13, 0)),
    (request(14, "textDocument/formatting", {**at(0, 0, "file://["), **OPTIONS}), (14, 0)),
    (request(15, "textDocument/rename", {**at(0, 0, "file:///b.mars"), "newName": "x"}), (15, 0)),
    (request(16, "textDocument/hover", at(1.0, 0)), (16, 0)),
    # Parameters of the wrong form.
    (request(20, "textDocument/hover", at(-1, 0)), (20, -32602)),
    (request(21, "textDocument/hover", at(2**31, 0)), (21, -32602)),
    (request(22, "textDocument/hover", at(1.5, 0)), (22, -32602)),
    (request(23, "textDocument/hover", at("1", 0)), (23, -32602)),
    (request(24, "textDocument/hover", at(0, True)), (24, -32602)),
    (request(25, "textDocument/definition", at(0, 0, 5)), (25, -32602)),
    (
        request(26, "textDocument/completion", {"textDocument": {"uri": "file:///a.mars"}}),
        (26, -32602),
    ),
    (request(27, "textDocument/rename", {**at(1, 10), "newName": 5}), (27, -32602)),
    (request(28, "textDocument/rename", {**at(0, 3), "newName": "x"}), (28, -32803)),
    (request(29, "textDocument/formatting", at(0, 0)), (29, -32602)),
    (request(30, "workspace/symbol", {}), (30, -32602)),
    (request(31, "workspace/symbol", {"query": 3}), (31, -32602)),
    (request(32, "workspace/executeCommand", {"command": "no.such"}), (32, -32602)),
    (request(33, "workspace/executeCommand", explaining()), (33, -32602)),
    (request(34, "workspace/executeCommand", explaining("/a.mars")), (34, -32602)),
    (request(35, "workspace/executeCommand", explaining("/a.mars", ["A"])), (35, -32602)),
    (request(36, "workspace/executeCommand", explaining({}, None)), (36, -32602)),
    (request(37, "workspace/executeCommand", explaining("/a.mars", "A", "B")), (37, -32602)),
    (request(38, "workspace/executeCommand", explaining("/gone.mars", None)), (38, 0)),
    (b"Content-Length: 1\r\n\r\n{", (None, -32700)),
    (b"Content-Length: 2\r\n\r\n[]", 'a message is an object with `"jsonrpc": "2.0"`'),
    (b"Content-Length: -1\r\n\r\n", "a message begins with `Content-Length: N`"),
    (b"nonsense\r\n", "a message begins with `Content-Length: N`"),
    (request(7, "shutdown"), (7, 0)),
    (request(8, "textDocument/hover", HOVER), (8, -32600)),
)


def test_errors_of_a_client_are_reported_to_it() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mars_asp", "lsp"],
        input=b"".join(sent for sent, _ in MESSAGES),
        capture_output=True,
        timeout=HANGING,
        check=False,
    )
    answers = [json.loads(each) for each in bodies(BytesIO(done.stdout))]
    codes = [
        (each.get("id"), each.get("error", {}).get("code", 0))
        for each in answers
        if "method" not in each
    ]
    logged = [each["params"]["message"] for each in answers if "method" in each]
    for _, expected in MESSAGES:
        if isinstance(expected, str):
            assert any(expected in each for each in logged), expected
        else:
            assert expected in codes
    assert done.stderr == b""


def test_a_message_that_is_too_large_is_dropped(monkeypatch: Patch) -> None:
    monkeypatch.setattr(client_errors, "MOST_BYTES", 5)
    given = BoundedInput(BytesIO(b"Content-Length: 9\r\n\r\n123456789Content-Length: 2\r\n\r\n[]"))
    assert [given.readline(), given.readline()] == [b"Content-Length: 9\r\n", b"\r\n"]
    assert given.read(9) == b'"too large"'
    assert [given.readline(), given.readline(), given.read(2)][::2] == [
        b"Content-Length: 2\r\n",
        b"[]",
    ]


def test_open_texts_are_compared_with_regular_files_of_their_size(tmp_path: Path) -> None:
    (tmp_path / "large.mars").write_bytes(b"x" * 100_000)
    (tmp_path / "same.mars").write_text("text")
    desk = EditorWorkspace()
    paths = ["/dev/zero", "/proc/self/environ", *(str(each) for each in tmp_path.iterdir())]
    desk.texts |= dict.fromkeys(paths, "text")
    assert sorted(desk.overlay()) == sorted(
        each for each in paths if not each.endswith("same.mars")
    )


def test_messages_that_no_editor_should_send_harm_nothing() -> None:
    assert hostile_editor.converse(60, 2)[0] == []
