"""Pages in headless Chromium, where there is one, driven as its developer tools drive it.

The security policy of a page stays in force: expressions are evaluated beside its scripts, and keys
and clicks come from outside. Messages go through two pipes, so that no port is opened.
"""

import base64
import contextlib
import fcntl
import json
import os
import select
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
in_a_browser = pytest.mark.skipif(
    CHROMIUM is None, reason="no Chromium on this machine; `.ci/browser` installs one"
)
_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--remote-debugging-pipe",
)
#: A browser that does not answer within so many seconds has failed.
PATIENCE = 120
#: Resolves after focus, scrolling and events of newly opened elements have taken effect.
_FRAME = "new Promise((done) => requestAnimationFrame(() => setTimeout(done, 20)))"
#: The key codes of the browser for keys that write no character.
_KEYS = {"Tab": 9, "Enter": 13, " ": 32, "ArrowLeft": 37, "ArrowRight": 39, "ArrowDown": 40}


class Browser:
    """A browser that shows one page at a time, begun anew with a profile of its own."""

    def __init__(self, profile: Path) -> None:
        reading, self._to = os.pipe()
        self._from, writing = os.pipe()
        # The browser reads its third and writes to its fourth descriptor.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in (reading, writing)]

        def hand_over() -> None:
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self._process = subprocess.Popen(
            [str(CHROMIUM), *_OPTIONS, f"--user-data-dir={profile}"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=(3, 4),
            preexec_fn=hand_over,  # noqa: PLW1509 -- nothing else runs yet
        )
        for end in (reading, writing, *ends):
            os.close(end)
        self._last_id, self._buffer, self._session = 0, b"", ""
        self.events: list[dict[str, Any]] = []
        target = self("Target.createTarget", url="about:blank")["targetId"]
        attached = self("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Network", "Log"):
            self(f"{domain}.enable")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        # It ends its own processes, which write into the profile until then.
        self._session = ""
        with contextlib.suppress(AssertionError, OSError):
            self("Browser.close")
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._to)
        os.close(self._from)

    def __call__(self, method: str, **words: object) -> dict[str, Any]:
        """Call a method of the developer tools' protocol; return its result."""
        self._last_id += 1
        message = {"id": self._last_id, "method": method, "params": words}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._to, json.dumps(message).encode() + b"\0")
        for item in self._messages():
            if item.get("id") == self._last_id:
                assert "error" not in item, (method, item["error"])
                result: dict[str, Any] = item["result"]
                return result
            self.events.append(item)
        raise AssertionError(f"{method}: no answer")

    def show(self, path: Path, width: int = 1200, height: int = 800, dark: bool = False) -> None:
        """Show the page of a file in a window of a size in pixels."""
        self.visit(path.as_uri(), width, height, dark)

    def visit(self, address: str, width: int = 1200, height: int = 800, dark: bool = False) -> None:
        """Show the page of an address in a window of a size in pixels."""
        self.events.clear()
        self(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self("Emulation.setEmulatedMedia", features=[scheme])
        self("Page.navigate", url=address)
        if not any(each.get("method") == "Page.loadEventFired" for each in self.events):
            for item in self._messages():
                self.events.append(item)
                if item.get("method") == "Page.loadEventFired":
                    break
        self.run(_FRAME)

    def run(self, script: str) -> Any:
        """Return the value of an expression in the page, after its promise has resolved."""
        result = self("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in result, result["exceptionDetails"]
        return result["result"].get("value")

    def wait(self, script: str) -> None:
        """Wait until an expression is true in the page."""
        deadline = time.monotonic() + PATIENCE
        while not self.run(f"Boolean({script})"):
            assert time.monotonic() < deadline, script
            time.sleep(0.02)

    def press(self, key: str, times: int = 1) -> None:
        """Press a key, as a person does."""
        text = {"Enter": "\r", " ": " "}.get(key, "")
        words = {"key": key, "code": key.replace(" ", "Space"), "windowsVirtualKeyCode": _KEYS[key]}
        for _ in range(times):
            begin = {"type": "keyDown", "text": text} if text else {"type": "rawKeyDown"}
            self("Input.dispatchKeyEvent", **begin, **words)
            self("Input.dispatchKeyEvent", type="keyUp", **words)

    def write(self, text: str) -> None:
        """Write a text where the focus is."""
        self("Input.insertText", text=text)

    def click(self, selector: str) -> None:
        """Click the middle of an element, as a person does."""
        found = f"document.querySelector({json.dumps(selector)})"
        self.run(f"{found}.scrollIntoView({{ block: 'center', inline: 'center' }})")
        self.run(_FRAME)
        x, y = self.run(
            f"(({{ x, y, width, height }}) => [x + width / 2, y + height / 2])"
            f"({found}.getBoundingClientRect())"
        )
        for kind in ("mousePressed", "mouseReleased"):
            self("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)
        self.run(_FRAME)

    def spoken(self, role: str) -> list[str]:
        """Return how elements of a role are called by a screen reader."""
        nodes = self("Accessibility.getFullAXTree")["nodes"]
        return [
            node.get("name", {}).get("value", "")
            for node in nodes
            if not node["ignored"] and node["role"]["value"] == role
        ]

    def picture(self, path: Path) -> None:
        """Write the visible area of the page as PNG."""
        path.write_bytes(base64.b64decode(self("Page.captureScreenshot")["data"]))

    @property
    def complaints(self) -> list[str]:
        """Return messages logged and exceptions raised by the page, policy violations included."""
        entries = [each["params"] for each in self.events if "params" in each]
        logged = [each["entry"]["text"] for each in entries if "entry" in each]
        raised = [str(each["exceptionDetails"]) for each in entries if "exceptionDetails" in each]
        return logged + raised

    @property
    def fetched(self) -> list[str]:
        """Return the addresses that the page has fetched, without its own."""
        sent = [e for e in self.events if e.get("method") == "Network.requestWillBeSent"]
        return [each["params"]["request"]["url"] for each in sent][1:]

    def _messages(self) -> Iterator[dict[str, Any]]:
        deadline = time.monotonic() + PATIENCE
        while True:
            while b"\0" not in self._buffer:
                left = max(0, deadline - time.monotonic())
                assert select.select([self._from], [], [], left)[0], "the browser is silent"
                part = os.read(self._from, 1 << 20)
                assert part, "the browser has ended"
                self._buffer += part
            result, _, self._buffer = self._buffer.partition(b"\0")
            yield json.loads(result)
