"""The file of a campaign, as it is read again after any end."""

import json
from typing import Any

import pytest

from mars_asp.diagnostic import point
from mars_asp.execution.campaign.grid import Grid, Run
from mars_asp.execution.campaign.journal import (
    ended_run,
    header_of,
    in_order,
    read_journal,
    whole_text,
)
from mars_asp.execution.scenario.vary import read_axes
from tests.support.refusals import refusal

HEADER = header_of("c", "s", "1.0")
RESULT: dict[str, Any] = {
    "verdict": "pass",
    "requirements": [{"name": "r", "holds": True, "message": "none"}],
    "control_time": {"Turn": 1.5},
    "seed": 0,
}
LINES = [ended_run(Run(seed, {}), {**RESULT, "seed": seed}).line for seed in (3, 1, 2)]
WHOLE = HEADER + b"".join(LINES)


def test_a_line_begins_with_seed_and_keys_and_has_the_result() -> None:
    line = ended_run(Run(3, {"b": 1, "a": [2]}), {**RESULT, "seed": 3}).line
    assert line.startswith(b'{"seed": 3, "vary": {"a": [2], "b": 1}, "verdict": "pass"')
    assert json.loads(line) == {**RESULT, "seed": 3, "vary": {"b": 1, "a": [2]}}


def test_whatever_is_torn_off_the_lines_before_stay() -> None:
    for size in range(len(WHOLE) + 1):
        read = read_journal(WHOLE[:size], HEADER, "o.jsonl")
        whole = WHOLE[:size].count(b"\n")
        assert len(read.ended) == max(0, whole - 1)
        assert read.kept == (WHOLE.rfind(b"\n", 0, size) + 1)
        assert read.size == size


def test_a_summary_is_cut_off_torn_or_not() -> None:
    summary = b'{"runs": 3, "passed": 3}\n'
    for end in (summary, summary[:-1], summary[:5]):
        read = read_journal(WHOLE + end, HEADER, "o.jsonl")
        assert (len(read.ended), read.kept) == (3, len(WHOLE))


def test_a_file_put_in_order_is_read_as_it_was() -> None:
    read = read_journal(WHOLE, HEADER, "o.jsonl")
    runs = [*Grid((1, 2, 3)).runs()]
    ordered = in_order(runs, read.ended)
    assert [each.result["seed"] for each in ordered] == [1, 2, 3]
    text = whole_text(HEADER, ordered, {"runs": 3})
    again = read_journal(text, HEADER, "o.jsonl")
    assert again.ended == read.ended
    assert whole_text(HEADER, in_order(runs, again.ended), {"runs": 3}) == text


def test_runs_of_an_earlier_grid_follow() -> None:
    read = read_journal(WHOLE, HEADER, "o.jsonl")
    ordered = in_order(Grid((2,), read_axes(["duration=1"])).runs(), read.ended)
    assert [each.result["seed"] for each in ordered] == [3, 1, 2]


@pytest.mark.parametrize(
    ("raw", "line", "message"),
    [
        (b"seed = 1", 1, "this is not the file of a campaign"),
        (b"seed = 1\n", 1, "this is not the file of a campaign"),
        (b"\n", 1, "this is not the file of a campaign"),
        (b"[" * 100_000 + b"\n", 1, "this is not the file of a campaign"),
        (
            header_of("other", "s", "1.0"),
            1,
            "the runs in this file are of another configuration: its files or sources have changed",
        ),
        (
            header_of("c", "other", "1.0"),
            1,
            "the runs in this file are of another scenario: "
            "it or the code that it binds has changed",
        ),
        (
            header_of("c", "s", "1.1"),
            1,
            "the runs in this file are of another version of mars-asp",
        ),
        (
            HEADER.replace(b'"version": 1', b'"version": 2'),
            1,
            "this file has version 2 of its format, not 1",
        ),
        (WHOLE + b"\xff\n", 5, "this line is not a run"),
        (HEADER + LINES[0][:-9] + b"\n" + LINES[1], 2, "this line is not a run"),
        (HEADER + b'{"seed": 1}\n', 2, "this line is not a run"),
        (HEADER + LINES[0].replace(b"true", b"1"), 2, "this line is not a run"),
        (HEADER + LINES[0].replace(b"pass", b"PASS"), 2, "this line is not a run"),
        (HEADER + LINES[0].replace(b"1.5", b'"1.5"'), 2, "this line is not a run"),
        (HEADER + LINES[0].replace(b"control_time", b"x"), 2, "this line is not a run"),
        (HEADER + b'{"runs": 3}\n' + LINES[0], 2, "a summary is the last line"),
    ],
)
def test_a_file_of_something_else_is_refused(raw: bytes, line: int, message: str) -> None:
    found = refusal(read_journal, raw, HEADER, "o.jsonl")
    assert (found.span, found.message) == (point("o.jsonl", line, 1), message)
    assert "--fresh" in (found.help or "")
    assert (found.help or "").startswith("remove the line") is ("not a run" in message)
