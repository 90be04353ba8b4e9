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
from collections.abc import Iterator, Mapping
from pathlib import Path
from queue import Empty, Queue
from typing import Any

from tests.support.documents import ROOT

#: Longer than any answer takes.
SECONDS = 120.0


class Wire:
    """A server, and the messages to and from it."""

    def __init__(self, *options: str) -> None:
        """Start the server and send `initialize`."""
        self._server = subprocess.Popen(
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
        for reader in (self._listen, self._overhear):
            threading.Thread(target=reader, daemon=True).start()
        self.ask("initialize", {"capabilities": {}})
        self.tell("initialized", {})

    def tell(self, method: str, params: object) -> None:
        """Send a notification, which has no answer."""
        self._send({"jsonrpc": "2.0", "method": method, "params": params})

    def begin(self, method: str, params: object) -> int:
        """Send a question; return its number."""
        self._number += 1
        self._send({"jsonrpc": "2.0", "id": self._number, "method": method, "params": params})
        return self._number

    def answer(self, number: int) -> Mapping[str, Any]:
        """Return the answer to a question, with its `result` or `error`."""
        for message in self.messages():
            if message.get("id") == number and "method" not in message:
                return message
        raise AssertionError("the server ended")

    def ask(self, method: str, params: object) -> Mapping[str, Any]:
        """Send a request; return its answer."""
        return self.answer(self.begin(method, params))

    def messages(self) -> Iterator[Mapping[str, Any]]:
        """Yield the messages of the server; diagnostics are also kept in `published`."""
        while (message := self._heard.get(timeout=SECONDS)) is not None:
            if message.get("method") == "textDocument/publishDiagnostics":
                self.published[message["params"]["uri"]] = message["params"]
                found = message["params"]["diagnostics"]
                self.complaints += [each["message"] for each in found if each["code"] == "lsp"]
            elif message.get("method") == "window/showMessage":
                self.complaints.append(message["params"]["message"])
            yield message

    def diagnostics(self, uri: str, version: int) -> list[Mapping[str, Any]]:
        """Wait for the diagnostics of a version of a text; return them."""
        if self.published.get(uri, {}).get("version") != version:
            for _ in self.messages():
                if self.published.get(uri, {}).get("version") == version:
                    break
        found: list[Mapping[str, Any]] = self.published[uri]["diagnostics"]
        return found

    def open(self, path: Path, text: str) -> str:
        """Open a file with a text; return its URI."""
        document = {"uri": path.as_uri(), "languageId": "", "version": 1, "text": text}
        self.tell("textDocument/didOpen", {"textDocument": document})
        return path.as_uri()

    def change(self, uri: str, text: str, version: int) -> None:
        """Put another text in the place of an open one."""
        document = {"uri": uri, "version": version}
        params = {"textDocument": document, "contentChanges": [{"text": text}]}
        self.tell("textDocument/didChange", params)

    def spent(self) -> float:
        """Return the processor seconds of the server's main thread, or NaN without `/proc`."""
        result = Path(f"/proc/{self._server.pid}/schedstat")
        return int(result.read_text().split()[0]) / 1e9 if result.is_file() else float("nan")

    def end(self) -> int:
        """End the server; return its exit status."""
        self.ask("shutdown", None)
        self.tell("exit", None)
        return self._server.wait(SECONDS)

    def drain(self) -> None:
        """Discard the messages that have arrived and were not read."""
        while True:
            try:
                message = self._heard.get_nowait()
            except Empty:
                return
            assert message is not None, "the server ended"

    def _send(self, message: Mapping[str, object]) -> None:
        body = json.dumps(message).encode()
        assert self._server.stdin is not None
        self._server.stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
        self._server.stdin.flush()

    def _overhear(self) -> None:
        assert self._server.stderr is not None
        self.complaints += [line.decode() for line in self._server.stderr]

    def _listen(self) -> None:
        stream = self._server.stdout
        assert stream is not None
        while True:
            length = 0
            while (line := stream.readline().strip()) or not length:
                if not line:
                    self._heard.put(None)
                    return
                name, _, value = line.partition(b":")
                length = int(value) if name.lower() == b"content-length" else length
            self._heard.put(json.loads(stream.read(length)))


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
