"""Lines that are read without the grammar: as the grammar reads them, and most lines are."""

from typing import TypeAlias

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp.language.grammar import parsed
from mars_asp.language.lines import read_lines
from mars_asp.language.statements import Raw, Word

_Placed: TypeAlias = tuple[str, list["tuple[str, int, int] | _Placed | None"]]
WORDS = (
    *("A", "B_1", "Äb", "bÄ", "hold", "root", "split", "period", "flat", "allocation", "10Hz"),
    *("uses_data_from", "is_controlled_by", "is_mounted_on", "hierarchical", "allocation root"),
    *("@configuration", "@specification", "@modules", "@sources", "@Modules", "NotifyOnMax(3)"),
    *("1", "+2", "-3", "4.5", ".5", "6.", "7e3", "8e", "٣", "1.2.3", ",", "(", ")", "=", "NotifyX"),
    *("is_suppressed_by", "is_inhibited_by", "is_reset_by", "is_locked_by", "is_limited_by"),
    *("is_arbitrated_by", "latest", "weighted", "300", "hold 50", "period 9"),
    *("every", "every 3 s", "C.o", ".i", '."a b"', "Notify-X", '"a b"', "7e3NotifyX"),
)
GAPS = ("", " ", "  ", "\t", "\xa0", "\x0b", "\u2028", "\n")
LINES = (
    "A uses_data_from B",
    "A uses_data_from B NotifyAtFrequency 10",
    "A uses_data_from B 2.5",
    "A.in uses_data_from B.out NotifyOnChange",
    "A is_controlled_by B",
    "A is_controlled_by B 3 hold 50 allocation split",
    "A 1 is_mounted_on B 2",
    "A is_suppressed_by B 300",
    "A.o is_inhibited_by B.o 20",
    "A is_locked_by B.stop 200 hold 500",
    "A is_locked_by B",
    "@configuration hierarchical period 50",
    "@modules A, B ,C",
)


@pytest.mark.parametrize("line", LINES)
def test_common_lines_are_left_to_no_grammar(line: str) -> None:
    ((begin, end, raw),), rest = read_lines(f" {line}\t\n")
    assert (begin, end, rest) == (0, len(line) + 2, None)
    assert [_placed(raw)] == _by_grammar(f" {line}\t\n")


@pytest.mark.parametrize(
    "line",
    [
        "A uses_data_from B NotifyOnMax(3)",
        "A is_controlled_by B, C",
        "A is_mounted_on B (0, 0, 1)",
        "@sources a/*.cpp",
        "@configuration circular",
        "A uses_data_from",
        "A uses_data_from B 7e3NotifyAtFrequency 10",
        "A uses_data_from B every 10",
        "A uses_data_from B Notify-Me",
        "A is_reset_by B.done",
        "A is_limited_by B hold 30",
        "A is_arbitrated_by flat period 50",
        "A is_suppressed_by B",
    ],
)
def test_all_else_is_left_to_the_grammar(line: str) -> None:
    text = f"A uses_data_from B\n{line}\n@modules A, B\n"
    read, rest = read_lines(text)
    assert [raw[0] for _, _, raw in read] == ["data", "modules"]
    assert rest == f"{' ' * 18}\n{line}\n{' ' * 13}\n"


@given(st.lists(st.tuples(st.sampled_from(WORDS), st.sampled_from(GAPS)), max_size=12))
def test_the_grammar_agrees_with_the_parser(pieces: list[tuple[str, str]]) -> None:
    text = "".join(f"{word}{gap}" for word, gap in pieces) + "\n"
    _check(text)


@given(
    st.sampled_from(LINES),
    st.lists(st.tuples(st.integers(0, 40), st.sampled_from((*WORDS, *GAPS))), max_size=3),
)
def test_so_are_common_lines_that_something_is_put_into(
    line: str, put: list[tuple[int, str]]
) -> None:
    for at, word in put:
        line = f"{line[:at]}{word}{line[at:]}"
    _check(f"{line}\n")


def _check(text: str) -> None:
    for begin, end, raw in read_lines(text)[0]:
        # Blanks in front keep its offsets.
        alone = " " * begin + text[begin:end] + "\n"
        assert _by_grammar(alone) == [_placed(raw)], text


def _by_grammar(text: str) -> list[_Placed]:
    found = parsed(text)
    assert isinstance(found, list), f"{text!r}: {found}"
    return [_placed(raw) for raw in found]


def _placed(raw: Raw) -> _Placed:
    name, children = raw
    return name, [
        (str(each), each.begin, each.end)
        if isinstance(each, Word)
        else each
        if each is None
        else _placed(each)
        for each in children
    ]
