"""Runs that are paced, and the page that shows them while they go on."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPResponse
from urllib.parse import urlsplit

import pytest

from mars_asp.cli import run_here
from tests.support.browser import Browser, in_a_browser
from tests.support.documents import ROOT
from tests.support.fixtures import Captured
from tests.support.processes import HANGING

MARS = (sys.executable, "-m", "mars_asp")
WORDS = ["run", "examples/level1/config.mars", "--scenario", "examples/level1/scenario.toml"]


@contextmanager
def paced(duration: float) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Yield a command that runs at the speed of real time, and the address that it printed."""
    command = subprocess.Popen(
        [*MARS, *WORDS, "--duration", f"{duration}", "--speed", "1"],
        cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert command.stderr
        found = re.fullmatch(
            r"mars-asp: watch the run at (http://127\.0\.0\.1:\d+/[\w-]{32}/)\n",
            command.stderr.readline(),
        )
        assert found
        yield command, found[1]
    finally:
        command.kill()
        command.communicate()


def fetched(address: str, path: str = "", **headers: str) -> HTTPResponse:
    parts = urlsplit(address)
    connection = HTTPConnection(parts.netloc, timeout=HANGING)
    connection.request("GET", path or parts.path, headers=headers)
    return connection.getresponse()


def scenes(response: HTTPResponse) -> Iterator[dict[str, str | None]]:
    for line in response:
        if line.startswith(b"data: "):
            yield json.loads(line.removeprefix(b"data: "))


def test_a_client_sees_the_run_go_on_and_then_its_verdict() -> None:
    began = time.monotonic()
    with paced(3) as (command, address):
        page = fetched(address)
        text = page.read().decode()
        assert page.status == 200
        assert page.headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert "default-src 'none'" in text
        assert "unsafe" not in text
        entries = list(scenes(fetched(address, f"{urlsplit(address).path}events")))
        spent = time.monotonic() - began
        output, _ = command.communicate(timeout=HANGING)
    assert command.returncode == 0
    assert output.startswith("pass: ")
    # A person sees it move, and it is at most as fast as the clock.
    assert 3 < len(entries) < 40
    assert spent > 3
    instants = [float(re.search(r"([\d.]+) of 3 s", str(each["state"]))[1]) for each in entries]  # type: ignore[index]
    assert instants == sorted(instants)
    assert [each["verdict"] for each in entries] == [None] * (len(entries) - 1) + ["pass"]
    assert str(entries[-1]["state"]).startswith(
        "pass, after 3.0 of 3 s: 0 collisions, least clearance"
    )
    assert "pass: all 8 requirements hold" in str(entries[-1]["svg"])
    assert ">running: " in str(entries[0]["svg"])


def test_nothing_is_answered_without_the_path_or_to_other_sites() -> None:
    with paced(300) as (command, address):
        path = urlsplit(address).path
        assert fetched(address).status == 200
        for other in (
            "/",
            "/events",
            path[:-2],
            f"{path}x",
            # A token may end with any letter, so the wrong one is made from it.
            f"{path[:-2]}{'y' if path[-2] == 'x' else 'x'}/",
            f"{path}../../etc",
            "//",
        ):
            assert fetched(address, other).status == 404
        for item in ({"Host": "evil.example"}, {"Host": "localhost.evil.example"}):
            assert fetched(address, **item).status == 404
        for each in (path, f"{path}events"):
            assert fetched(address, each, Origin="http://evil.example").status == 404
        connection = HTTPConnection(urlsplit(address).netloc, timeout=HANGING)
        connection.request("POST", path, b"x" * 100)
        assert connection.getresponse().status == 501
        # Browsers that do not read, and too many of them, hold nothing up.
        idle = [fetched(address, f"{path}events") for _ in range(8)]
        assert fetched(address, f"{path}events").status == 503
        command.send_signal(signal.SIGINT)
        assert command.wait(HANGING) == 130
        assert all(each.status == 200 for each in idle)
        with pytest.raises(ConnectionRefusedError):
            fetched(address)


def test_a_paced_run_is_the_run_that_it_is_without(capsys: Captured) -> None:
    entries = []
    for speed in ([], ["--speed", "40"]):
        words = [*WORDS, "--duration", "12", "--format", "json", "--quiet"]
        assert run_here([*words, *speed]) == 0
        captured = capsys.readouterr()
        assert "watch the run" not in captured.err
        entries.append(captured.out)
    assert entries[0] == entries[1]


@pytest.mark.parametrize("speed", ["0", "-1", "nan", "inf", "fast"])
def test_an_invalid_speed_is_refused(speed: str, capsys: Captured) -> None:
    with pytest.raises(SystemExit) as raised:
        run_here([*WORDS, "--speed", speed])
    assert raised.value.code == 2
    assert "--speed" in capsys.readouterr().err


@in_a_browser
def test_a_browser_shows_the_run_and_the_verdict(browser: Browser) -> None:
    with paced(4) as (command, address):
        browser.visit(address)
        browser.wait("document.querySelector('#picture img')")
        state = "document.querySelector('#state').textContent"
        first = browser.run(state)
        browser.wait(f"{state} !== {json.dumps(first)}")
        assert re.match(r"[\d.]+ of 4 s: 0 collisions", first)
        browser.wait(f"{state}.startsWith('pass, after 4.0 of 4 s')")
        browser.wait("document.querySelector('#picture img').alt.startsWith('pass')")
        assert browser.run("document.querySelector('#picture img').naturalWidth") > 600
        assert browser.run("document.title").startswith("pass: scenario.toml, seed 1")
        command.communicate(timeout=HANGING)
    # It is still there when the command is gone.
    assert browser.run("document.querySelector('#picture img').complete")
    assert not browser.complaints
    assert {urlsplit(each).netloc for each in browser.fetched if "blob:" not in each} <= {
        urlsplit(address).netloc
    }


@in_a_browser
def test_a_browser_shows_that_a_run_was_ended(browser: Browser) -> None:
    with paced(300) as (command, address):
        browser.visit(address)
        browser.wait("document.querySelector('#picture img')")
        command.send_signal(signal.SIGINT)
        command.communicate(timeout=HANGING)
        browser.wait("document.querySelector('#state').textContent.startsWith('The run ended')")
