"""Messages that no editor should send: the language server refuses them, and goes on.

python -m tests.support.hostile_editor HOW_MANY FIRST_SEED
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

from tests.support.documents import ROOT
from tests.support.processes import HANGING
from tests.support.wire import bodies, framed

#: Megabytes that the server may have in memory.
MEMORY = 1000
_METHODS = (
    *("initialize", "initialized", "textDocument/didOpen", "textDocument/didChange"),
    *("textDocument/didClose", "textDocument/didSave", "textDocument/hover", "$/cancelRequest"),
    *("textDocument/definition", "textDocument/references", "textDocument/documentSymbol"),
    *("textDocument/prepareRename", "textDocument/rename", "textDocument/completion"),
    *("textDocument/codeAction", "textDocument/codeLens", "workspace/executeCommand"),
    *("textDocument/formatting", "workspace/symbol"),
    *("workspace/didChangeWatchedFiles", "workspace/didChangeConfiguration", "no/such"),
)
_TEXTS = (
    "@configuration flat\n@modules A, B\nA uses_data_from B\n",
    "@configuration\n@include /proc/self/environ\n@sources /dev/zero\n",
    "p(X) :- q(X).\n%*! q(X)\n",
    "// @module_start\n// @module_name A\n// @Sense\nX f();\n",
    *("", "\0", "\ud800", "@" * 10_000, "[" * 10_000, "é\U0001f600\r\n@modules \U0001f600"),
)


def _odd(rng: random.Random, depth: int = 0) -> Any:
    """Return a value of JSON that nothing expects."""
    if depth < 3 and rng.random() < 0.3:
        return {rng.choice(("uri", "line", "text", "x")): _odd(rng, depth + 1) for _ in "12"}
    values: tuple[Any, ...] = (
        None,
        True,
        -1,
        2**31,
        2**70,
        1.5,
        "",
        "x",
        [],
        {},
        "file:///dev/zero",
        "\ud800",
    )
    return rng.choice(values)


def _uri(rng: random.Random, folder: Path) -> Any:
    inside = [(folder / name).as_uri() for name in ("a.mars", "b.cpp", "c.lp", "gone.mars", "d é")]
    outside = (
        "file:///dev/zero",
        "file:///proc/self/environ",
        "file:///",
        "untitled:1",
        "file://[",
    )
    other = ("http://x/a.mars", "file:///dev/stdin.mars", "file:" + "/a" * 3000, "file:///%00.mars")
    pipe = (folder / "fifo.mars").as_uri()
    return rng.choice((*inside, *inside, *outside, *other, pipe))


def message(rng: random.Random, number: int, folder: Path) -> Any:
    """Return a message; most are nearly right."""
    method = rng.choice(_METHODS)
    place = {"line": rng.choice((0, 1, 2, 99, 2**31 - 1)), "character": rng.choice((0, 3, 10**6))}
    document = {"uri": _uri(rng, folder), "version": rng.choice((1, 2, -1))}
    text = rng.choice(_TEXTS)
    opened = {**document, "languageId": "mars", "text": text}
    params: dict[str, Any] = {
        "textDocument": opened if method.endswith("didOpen") else document,
        "position": place,
        "range": {"start": place, "end": place},
        "contentChanges": [{"text": text}],
        "context": {"diagnostics": [], "includeDeclaration": True},
        "options": {"tabSize": 2, "insertSpaces": True},
        "query": text[:3],
        "newName": rng.choice("A1 "),
        "command": "mars-asp.explain",
        "arguments": [_odd(rng)],
        "changes": [],
        "settings": {},
        "capabilities": {},
        "id": rng.randrange(number + 1),
    }
    for _ in range(rng.choice((0, 0, 0, 1, 2))):
        holder = rng.choice([params, params, document, place])
        key = rng.choice(sorted(holder))
        if rng.random() < 0.5:
            holder[key] = _odd(rng)
        else:
            del holder[key]
    whole: dict[str, Any] = {"jsonrpc": "2.0", "method": method, "params": params}
    is_notice = method.startswith(("initialized", "textDocument/did", "workspace/did", "$"))
    if not is_notice or rng.random() < 0.05:
        whole["id"] = number
    if rng.random() < 0.05:
        whole[rng.choice(("jsonrpc", "method", "params", "id"))] = _odd(rng)
    return whole if rng.random() > 0.02 else _odd(rng)


def _raw(rng: random.Random, value: Any) -> bytes:
    """Return the bytes of a message, of which a few are wrong."""
    body = json.dumps(value).encode()
    chance = rng.random()
    if chance < 0.01:
        body = rng.choice((b"{", b"\xff\xfe", b"[" * 100_000, b'{"a":' * 5000, b"9" * 5000, b"nul"))
    if chance > 0.99:
        return rng.choice(
            (b"Content-Length: -1\r\n\r\n", b"x" * 100_000 + b"\r\n", b"\r\n", b"a\n")
        )
    if chance > 0.985:
        return b"Content-Length: " + b"9" * 5000 + b"\r\n\r\n"
    return b"content-length: %d\r\n\r\n" % len(body) + body


def converse(number: int, seed: int) -> tuple[list[str], float]:
    """Send messages to one server; return its faults and its megabytes."""
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as made, tempfile.TemporaryFile() as errors:
        folder = Path(made)
        for name, text in zip(("a.mars", "c.lp", "b.cpp"), (_TEXTS[0], *_TEXTS[2:4]), strict=True):
            (folder / name).write_text(text)
        os.mkfifo(folder / "fifo.mars")
        server = subprocess.Popen(
            [sys.executable, "-m", "mars_asp", "lsp"],
            cwd=folder,
            env={**os.environ, "PYTHONPATH": str(ROOT), "TOKEN": "hunter2"},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
        )
        assert server.stdin is not None and server.stdout is not None
        answers: list[bytes] = []
        hearing = threading.Thread(target=answers.extend, args=(bodies(server.stdout),))
        hearing.start()
        hello: dict[str, Any] = {"processId": None, "rootUri": folder.as_uri(), "capabilities": {}}
        first = {"jsonrpc": "2.0", "id": "first", "method": "initialize", "params": hello}
        last = {"jsonrpc": "2.0", "id": "last", "method": "textDocument/hover", "params": {}}
        if rng.random() < 0.8:
            server.stdin.write(framed(first))
        wrong: list[str] = []
        try:
            for each in range(number):
                server.stdin.write(_raw(rng, message(rng, each, folder)))
            server.stdin.write(framed(last))
            server.stdin.flush()
        except BrokenPipeError:
            wrong.append("it ended")
        until = time.monotonic() + HANGING
        while not any(b'"last"' in each for each in answers) and time.monotonic() < until:
            if server.poll() is not None:
                break
            time.sleep(0.05)
        if not any(b'"last"' in each for each in answers):
            wrong.append("it does not answer any more")
        used = _memory(server.pid)
        server.stdin.close()
        try:
            server.wait(HANGING)
        except subprocess.TimeoutExpired:
            wrong.append("it goes on without an editor")
            server.kill()
        hearing.join(HANGING)
        errors.seek(0)
        printed = errors.read()
    if b"Traceback" in printed or b"fault" in printed:
        wrong.append(printed[:3000].decode(errors="replace"))
    wrong += [f"answered {each[:300]!r}" for each in answers if b"internal error" in each][:3]
    if any(b"hunter2" in each for each in answers):
        wrong.append("printed a secret")
    if used > MEMORY:
        wrong.append(f"has {used:.0f} MB")
    return [f"seed {seed}: {each}" for each in wrong], used


def _memory(process: int) -> float:
    """Return the most megabytes that a process has had."""
    try:
        status = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    except OSError:
        return 0.0
    lines = [line for line in status.splitlines() if line.startswith("VmHWM")]
    return int(lines[0].split()[1]) / 1024 if lines else 0.0


def main() -> int:
    """Send the requested number of messages, 500 to each server."""
    number, first = [*map(int, sys.argv[1:]), *(10_000, 0)[len(sys.argv) - 1 :]][:2]
    wrong: list[str] = []
    most = 0.0
    for seed in range(first, first + max(1, number // 500)):
        found, used = converse(min(number, 500), seed)
        wrong, most = wrong + found, max(most, used)
        print(*found, sep="\n", end="\n" * bool(found), flush=True)
    print(f"{number} messages, {len(wrong)} faults, at most {most:.0f} MB")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
