"""The language server's messages as they cross the pipe, without a library between.

`python -m tests.support.wire 10000` edits texts at random that many times, sends a request after
each edit, and reports errors in answers: there should be none, and the server should go on.
"""

import json
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from queue import Queue
from typing import IO, Any

from tests.support.documents import ROOT

#: Longer than any answer takes, however busy the machine is.
SECONDS = 120.0


def framed(value: object) -> bytes:
    """Return a message as it crosses the pipe."""
    body = json.dumps(value).encode()
    return b"Content-Length: %d\r\n\r\n%b" % (len(body), body)


def bodies(stream: IO[bytes]) -> Iterator[bytes]:
    """Yield the messages of a server, until it ends."""
    while line := stream.readline():
        if line.lower().startswith(b"content-length:"):
            while stream.readline().strip():
                pass
            yield stream.read(int(line.partition(b":")[2]))


class Wire:
    """A server, and the messages to and from it."""

    def __init__(self, *options: str, folder: Path | None = None) -> None:
        """Start the server and send `initialize`, with an open folder if one is given."""
        self.process = subprocess.Popen(
            [sys.executable, "-m", "mars_asp", "lsp", *options],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        #: Shown messages and diagnostics that report failures of the server.
        self.complaints: list[str] = []
        self._heard: Queue[Mapping[str, Any] | None] = Queue()
        self._number = 0
        self.published: dict[str, Mapping[str, Any]] = {}
        #: How often the server has requested new lenses.
        self.refreshed = 0
        for reader in (self._listen, self._overhear):
            threading.Thread(target=reader, daemon=True).start()
        able = {} if folder is None else {"workspace": {"codeLens": {"refreshSupport": True}}}
        opened = [] if folder is None else [{"uri": folder.as_uri(), "name": folder.name}]
        self.ask("initialize", {"capabilities": able, "workspaceFolders": opened})
        self.tell("initialized", {})

    def tell(self, method: str, params: object) -> None:
        """Send a notification, which has no answer."""
        self._send({"method": method, "params": params})

    def ask(self, method: str, params: object) -> Mapping[str, Any]:
        """Send a request; return its answer, with its `result` or `error`."""
        self._number += 1
        self._send({"id": self._number, "method": method, "params": params})
        for message in self.messages():
            if message.get("id") == self._number and "method" not in message:
                return message
        raise AssertionError("the server ended")

    def messages(self) -> Iterator[Mapping[str, Any]]:
        """Yield the messages of the server; diagnostics are also kept in `published`."""
        while (message := self._heard.get(timeout=SECONDS)) is not None:
            if message.get("method") == "textDocument/publishDiagnostics":
                self.published[message["params"]["uri"]] = message["params"]
                found = message["params"]["diagnostics"]
                self.complaints += [each["message"] for each in found if each["code"] == "lsp"]
            elif message.get("method") == "window/showMessage":
                self.complaints.append(message["params"]["message"])
            elif message.get("method") == "workspace/codeLens/refresh":
                self.refreshed += 1
                self._send({"id": message["id"], "result": None})
            yield message

    def until(self, is_so: Callable[[], bool]) -> None:
        """Read messages of the server until they make a condition true."""
        while not is_so():
            assert next(self.messages(), None), "the server ended"

    def diagnostics(self, uri: str, version: int = 1) -> list[Mapping[str, Any]]:
        """Wait for the diagnostics of a version of a text; return them."""
        self.until(lambda: self.published.get(uri, {}).get("version") == version)
        found: list[Mapping[str, Any]] = self.published[uri]["diagnostics"]
        return found

    def open(self, path: Path, text: str | None = None) -> str:
        """Open a file, with a text that need not be on the disk; return its URI."""
        text = path.read_text(encoding="utf-8") if text is None else text
        document = {"uri": path.as_uri(), "languageId": "", "version": 1, "text": text}
        self.tell("textDocument/didOpen", {"textDocument": document})
        return path.as_uri()

    def change(self, uri: str, text: str, version: int) -> None:
        """Put another text in the place of an open one."""
        document = {"uri": uri, "version": version}
        params = {"textDocument": document, "contentChanges": [{"text": text}]}
        self.tell("textDocument/didChange", params)

    def close(self, uri: str) -> None:
        """Close a text."""
        self.tell("textDocument/didClose", {"textDocument": {"uri": uri}})

    def spent(self) -> float:
        """Return the processor seconds of the server's main thread, or NaN without `/proc`."""
        result = Path(f"/proc/{self.process.pid}/schedstat")
        return int(result.read_text().split()[0]) / 1e9 if result.is_file() else float("nan")

    def end(self) -> int:
        """End the server; return its exit status."""
        self.ask("shutdown", None)
        self.tell("exit", None)
        return self.process.wait(SECONDS)

    def _send(self, message: Mapping[str, object]) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(framed({"jsonrpc": "2.0", **message}))
        self.process.stdin.flush()

    def _overhear(self) -> None:
        assert self.process.stderr is not None
        self.complaints += [line.decode() for line in self.process.stderr]

    def _listen(self) -> None:
        assert self.process.stdout is not None
        for body in bodies(self.process.stdout):
            self._heard.put(json.loads(body))
        self._heard.put(None)


# ---- Edits at random -----------------------------------------------------------------------------

#: What is put into texts: their own words, what opens and closes, and what few expect.
PIECES = (
    *("\n", " ", ",", ".", ":", "(", ")", '"', "/", "//", "#", "@", "%", "%*", "*%", "/*", "😀"),
    *("\ufeff", "\r", "\r\n", "\x0c", "\u2028", "\0", "\ud800", "é", "_", "-1", "1e9", "\t"),
    *("@modules ", "@sources ", "@include . as x", "@module_start\n", "@module_name ", "a:-b.\n"),
    *(" uses_data_from ", " is_mounted_on ", " is_controlled_by ", "Camera", "x/y", "#show a/1."),
)
QUESTIONS = (
    *("hover", "definition", "references", "completion", "documentSymbol", "codeLens"),
    *("prepareRename", "rename", "codeAction"),
)


def edited(text: str, rng: random.Random) -> str:
    """Return a text with one edit: something inserted, deleted, or moved."""
    begin = rng.randrange(len(text) + 1)
    end = min(len(text), begin + rng.choice((0, 0, 1, 1, 3, 20)))
    piece = rng.choice(PIECES)
    if rng.random() < 0.15:
        at = rng.randrange(len(text) + 1)
        piece = text[at : at + rng.randrange(1, 60)]
    return text[:begin] + (piece if rng.random() < 0.7 else "") + text[end:]


def request_at(text: str, uri: str, rng: random.Random) -> tuple[str, dict[str, object]]:
    """Return a question about a place of a text, which may be outside of it."""
    line = rng.randrange(text.count("\n") + 3)
    place = {"line": line, "character": rng.randrange(50)}
    params: dict[str, object] = {"textDocument": {"uri": uri}, "position": place}
    question = rng.choice(QUESTIONS)
    if question == "references":
        params["context"] = {"includeDeclaration": True}
    elif question == "rename":
        params["newName"] = rng.choice(("Other", "two words", "", '"', "x/y", "\n"))
    elif question == "codeAction":
        params |= {"range": {"start": place, "end": place}, "context": {"diagnostics": []}}
    return f"textDocument/{question}", params


def main(edits: int) -> None:
    """Send random edits and requests; print their number and each error except refusals."""
    rng = random.Random(edits)
    found = [*ROOT.glob("tests/lsp/robot/*.*"), *ROOT.glob("examples/own-rules/rules/*.lp")]
    with tempfile.TemporaryDirectory() as name:
        folder, texts = Path(name), dict[str, str]()
        wire, errors, slowest = Wire(), 0, 0.0
        originals = {}
        for path in sorted(found):
            (folder / path.name).write_bytes(path.read_bytes())
            text = path.read_text(encoding="utf-8")
            uri = wire.open(folder / path.name, text)
            texts[uri] = originals[uri] = text
        for number in range(edits):
            uri = rng.choice(sorted(texts))
            # After many edits a text is noise; begin with the original again.
            text = originals[uri] if rng.random() < 0.02 else edited(texts[uri], rng)
            texts[uri] = text
            wire.change(uri, text, number + 2)
            began = time.monotonic()
            method, params = request_at(text, uri, rng)
            error = wire.ask(method, params).get("error")
            if method != "textDocument/codeAction":
                slowest = max(slowest, time.monotonic() - began)
            # The server refuses an invalid new name with this code.
            if error is not None and error["code"] != -32803:
                errors += 1
                print(method, error)
            if number % 100 == 0:
                time.sleep(0.5)
        for uri, text in originals.items():
            wire.change(uri, text, edits + 2)
        entries = [wire.diagnostics(uri, edits + 2) for uri in originals]
        print(f"{edits} edits, {errors} errors, slowest answer {1000 * slowest:.0f} ms")
        print(f"in the end {sum(map(len, entries))} findings; status {wire.end()}")
        print("complaints:", wire.complaints)


if __name__ == "__main__":
    main(int(sys.argv[1]))
