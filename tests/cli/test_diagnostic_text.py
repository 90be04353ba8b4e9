"""Findings as people read them: the line, the caret, labels, and how wide all that is."""

import argparse
import io
from pathlib import Path

import pytest

from mars_asp.cli.diagnostic_text import colours, diagnostic_text
from mars_asp.cli.wrapping import cells, columns, wrapped
from mars_asp.diagnostic import Diagnostic, Span
from tests.support.fixtures import Patch


def shown(tmp_path: Path, text: str, *places: tuple[int, int, int], width: int = 80) -> list[str]:
    """Return how places of a file are shown: a line, the first column and the one after the last.

    The first is that of the finding, and each further one has its number for a label.
    """
    path = tmp_path / "c.mars"
    path.write_bytes(text.encode())
    first, *others = [Span(str(path), line, begin, line, end) for line, begin, end in places]
    labels = tuple((span, f"place {number}") for number, span in enumerate(others, 2))
    finding = Diagnostic("code", "error", "message", first, labels)
    lines = diagnostic_text(finding, width=width).split("\n")
    return [line for line in lines if "|" in line or "place" in line]


@pytest.mark.parametrize(
    ("text", "places", "expected"),
    [
        ("A b C\n", [(1, 3, 4)], ["    1 | A b C", "      |   ^"]),
        ("\tA\tb\n", [(1, 4, 5)], ["    1 |     A   b", "      |         ^"]),
        (
            "// 日本 e\u0301 b\n",
            [(1, 10, 11)],
            ["    1 | // 日本 e\u0301 b", "      |           ^"],
        ),
        ("日本\n", [(1, 1, 3)], ["    1 | 日本", "      | ^^^^"]),
        ("\u202eA b\r\n", [(1, 4, 5)], ["    1 | \\u202eA b", "      |         ^"]),
        ("A\n", [(1, 2, 2)], ["    1 | A", "      |  ^"]),
        ("\n", [(1, 1, 1)], []),
        ("A\n", [(9, 1, 1)], []),
        ("b b\n", [(1, 1, 2), (1, 3, 4)], ["    1 | b b", "      | ^", "      |   - place 2"]),
        # Marks are not repeated.
        ("b\n", [(1, 1, 2), (1, 1, 2)], ["    1 | b", "      | ^", "      |  place 2"]),
        (
            "\n" * 8 + "A\nB\n",
            [(9, 1, 2), (10, 1, 2)],
            ["     9 | A", "       | ^", "    10 | B", "       | - place 2"],
        ),
        (f"{'x' * 200} b\n", [(1, 202, 203)], [f"    1 | {'x' * 200} b", f"      | {' ' * 201}^"]),
    ],
)
def test_a_caret_is_under_the_location(
    text: str, places: list[tuple[int, int, int]], expected: list[str], tmp_path: Path
) -> None:
    assert shown(tmp_path, text, *places) == expected


def test_a_very_long_line_is_quoted_around_the_location(tmp_path: Path) -> None:
    line, marks = shown(tmp_path, f"{'a ' * 50_000}b{' a' * 50_000}\n", (1, 100_001, 100_002))
    assert len(line) < 300
    assert line[marks.index("^")] == "b"


def test_a_label_that_does_not_fit_is_below(tmp_path: Path) -> None:
    lines = shown(tmp_path, "b\nbbbbbbbb\n", (1, 1, 2), (2, 1, 9), width=20)
    assert lines[3:] == ["      | --------", "      | place 2"]


def test_places_of_another_file_are_named(tmp_path: Path) -> None:
    source = tmp_path / "a.py"
    source.write_text("# @Sense\n")
    there, gone = Span(str(source), 1, 3, 1, 9), Span("gone.py", 2, 1, 2, 1)
    finding = Diagnostic("code", "error", "m", Span("x", 1, 1, 1, 1), ((there, "s"), (gone, "g")))
    assert diagnostic_text(finding, width=200).split("\n") == [
        "x:1:1: error: m [code]",
        f"    {source}:1:3:",
        "    1 | # @Sense",
        "      |   ------ s",
        "    gone.py:2:1: g",
    ]


def test_only_quoted_lines_and_long_words_exceed_the_width() -> None:
    words = "`Base` and `Nav`, " * 20 + "x" * 60
    finding = Diagnostic("a/b", "warning", words, Span("p", 1, 1, 1, 1), (), words, effect=words)
    for width in (30, 80, 120):
        lines = diagnostic_text(finding, width=width).split("\n")
        assert all(cells(line) <= width or "xxx" in line for line in lines)
    assert wrapped("`a b` c `d e`", 9) == ["`a b` c", "`d e`"]
    # What is quoted may hold a backtick, so where the quote ends is not the third of them.
    quoted = "found ``7...`, expected a `b`, or `c` [syntax]"
    assert wrapped(quoted, 20) == ["found ``7...`,", "expected a `b`, or", "`c` [syntax]"]
    # A rule at the end is not alone, unless there is no room beside it.
    assert wrapped("aa bb cc [r/x]", 10) == ["aa bb", "cc [r/x]"]
    assert wrapped("aa bb \x1b[2m[r/x]\x1b[0m", 8, "", "") == ["aa", "bb \x1b[2m[r/x]\x1b[0m"]
    assert wrapped("aa bb [r/x]", 5) == ["aa bb", "[r/x]"]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("option", "environment", "terminal", "expected"),
    [
        ("auto", {}, True, True),
        ("auto", {}, False, False),
        ("auto", {"NO_COLOR": "1"}, True, False),
        ("auto", {"NO_COLOR": ""}, True, True),
        ("auto", {"FORCE_COLOR": "1"}, False, True),
        ("auto", {"FORCE_COLOR": ""}, False, False),
        ("auto", {"NO_COLOR": "1", "FORCE_COLOR": "1"}, True, False),
        ("auto", {"TERM": "dumb"}, True, False),
        ("auto", {"TERM": "dumb", "FORCE_COLOR": "1"}, True, True),
        ("always", {"NO_COLOR": "1", "TERM": "dumb"}, False, True),
        ("never", {"FORCE_COLOR": "1"}, True, False),
    ],
)
def test_colours_follow_option_environment_and_terminal(
    option: str, environment: dict[str, str], terminal: bool, expected: bool, monkeypatch: Patch
) -> None:
    monkeypatch.setenv("TERM", "xterm")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    stream = Terminal() if terminal else io.StringIO()
    assert colours(argparse.Namespace(color=option), stream) is expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [("120", 120), ("", 80), ("wide", 80), ("0", 80), ("-3", 80), ("5", 20)],
)
def test_columns_come_from_the_environment_or_are_80(
    value: str, expected: int, monkeypatch: Patch
) -> None:
    monkeypatch.setenv("COLUMNS", value)
    assert columns(io.StringIO()) == expected
