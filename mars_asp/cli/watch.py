"""A live view of a run: a page that is served to browsers of this machine.

The path of the page is unguessable, and only requests that name this server as their host are
answered. The page takes no input, so requests cannot affect the run.
"""

import json
import secrets
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from html import escape
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING, Any

from mars_asp.draw.page import whole_page
from mars_asp.output import counted, visible

if TYPE_CHECKING:
    from mars_asp.execution.judgement import Judgement
    from mars_asp.execution.trial import Trial

#: At most so many browsers are served at a time.
_MOST = 8
#: Seconds that a browser has to receive data, and seconds for all browsers at the end.
_PATIENCE, _LAST = 5.0, 1.0
#: Seconds between two checks whether the server must end.
_BEAT = 0.05
#: Drawing takes at most this share of the time.
_SHARE = 0.2


class Stage:
    """The state of a page that shows a run; browsers wait for its changes."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._latest, self._number, self._over = b"", 0, False
        self._watching, self._resting = 0, 0.0

    def show(self, trial: "Trial", judgement: "Judgement | None" = None) -> None:
        """Replace the state by that of a run; with a judgement, the run has ended."""
        if judgement is None and (not self._watching or time.monotonic() < self._resting):
            return
        from mars_asp.execution.recording.picture import plot_run

        began = time.monotonic()
        entries = {
            "svg": plot_run(trial, judgement),
            "state": _state(trial, judgement),
            "verdict": judgement and judgement.verdict,
        }
        latest = json.dumps(entries).encode()
        ended = time.monotonic()
        self._resting = ended + (ended - began) * (1 / _SHARE - 1)
        with self._changed:
            self._latest, self._number = latest, self._number + 1
            self._over = judgement is not None
            self._changed.notify_all()

    def close(self) -> None:
        """End the page after every browser has received the last state, or is too slow."""
        with self._changed:
            self._over = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: not self._watching, _LAST)

    @contextmanager
    def watched(self) -> Iterator[bool]:
        """Count a browser while the block runs; yield False if there are too many."""
        with self._changed:
            room = self._watching < _MOST and not self._over
            self._watching += room
        try:
            yield room
        finally:
            with self._changed:
                self._watching -= room
                self._changed.notify_all()

    def scenes(self) -> Iterator[bytes]:
        """Yield the state as JSON whenever it changes; empty bytes after a long pause."""
        number, over = 0, False
        while not over:
            before = number
            with self._changed:
                if self._number == before and not self._over:
                    self._changed.wait(_PATIENCE / 2)
                number, latest, over = self._number, self._latest, self._over
            if number > before or not over:
                yield latest if number > before else b""


@contextmanager
def watched(title: str) -> Iterator[Stage | None]:
    """Yield the stage of a page that shows a run, and print its address; None if serving fails."""
    stage, path = Stage(), f"/{secrets.token_urlsafe(24)}/"
    try:
        server = _WatchServer(stage, path, _page(title).encode())
        threading.Thread(target=server.serve, daemon=True).start()
    except (OSError, RuntimeError) as error:
        print(f"mars-asp: the run cannot be shown in a browser: {error}", file=sys.stderr)
        yield None
        return
    address = f"http://{server.host}{path}"
    print(f"mars-asp: watch the run at {address}", file=sys.stderr, flush=True)
    try:
        yield stage
    finally:
        stage.close()
        server.shutdown()
        server.server_close()


def _page(title: str) -> str:
    style = (files("mars_asp.execution.recording") / "replay.css").read_text("utf-8")
    body, script = (
        (files("mars_asp.cli") / f"watch.{end}").read_text("utf-8") for end in ("html", "js")
    )
    body = Template(body).substitute(title=escape(visible(title)))
    return whole_page(title, style, body, script, allowed=("connect-src 'self'", "img-src blob:"))


def _state(trial: "Trial", judgement: "Judgement | None") -> str:
    """Return the state of a run as a sentence that screen readers can read out."""
    clearance = trial.clearance
    near = f", least clearance {clearance:.0f} mm" if clearance < float("inf") else ""
    spent = f"{trial.executor.schedule.now / 1e9:.1f} of {trial.scenario.duration:g} s"
    text = f"{spent}: {counted(trial.collisions, 'collision')}{near}"
    return text if judgement is None else f"{judgement.verdict}, after {text}"


class _WatchServer(ThreadingHTTPServer):
    """A server of a page and of the states of a stage that only this machine can reach."""

    daemon_threads = True

    def __init__(self, stage: Stage, path: str, page: bytes) -> None:
        super().__init__(("127.0.0.1", 0), _Answer)
        self.stage, self.path, self.page = stage, path, page
        self.host = f"127.0.0.1:{self.server_address[1]}"

    def serve(self) -> None:
        """Serve until the server is closed."""
        # Code that a run imports may close the socket; the run continues.
        with suppress(OSError, ValueError):
            self.serve_forever(_BEAT)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore browsers that went away."""


class _Answer(BaseHTTPRequestHandler):
    server: _WatchServer
    timeout = _PATIENCE

    def do_GET(self) -> None:
        """Send the page, or the states of its stage as they change."""
        path = self.path.encode("utf-8", "replace")
        host = self.server.host
        ours = self.headers.get("Host") == host
        ours = ours and self.headers.get("Origin", f"http://{host}") == f"http://{host}"
        if ours and secrets.compare_digest(path, self.server.path.encode()):
            self._begin_response("text/html; charset=utf-8", len(self.server.page))
            self.wfile.write(self.server.page)
        elif ours and secrets.compare_digest(path, f"{self.server.path}events".encode()):
            with self.server.stage.watched() as room:
                if not room:
                    self.send_error(503)
                    return
                self._begin_response("text/event-stream")
                for scene in self.server.stage.scenes():
                    self.wfile.write(b"data: %b\n\n" % scene if scene else b":\n\n")
        else:
            self.send_error(404)

    def _begin_response(self, kind: str, length: int | None = None) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        for name, value in (
            ("Cache-Control", "no-store"),
            ("Referrer-Policy", "no-referrer"),
            ("X-Content-Type-Options", "nosniff"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Content-Security-Policy", "frame-ancestors 'none'"),
        ):
            self.send_header(name, value)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Log no requests."""
