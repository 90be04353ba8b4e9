"""Edits of texts, by lines of the original, against the same edits made by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mars_asp.language.text_edits import ConflictError, Draft, LineEdit, apply_lines

texts = st.text(alphabet="ab ,\n", min_size=1, max_size=60).map(lambda text: f"x{text}x\n")


@given(texts, st.data())
def test_stretches_put_otherwise_are_the_lines_that_change(text: str, data: st.DataObject) -> None:
    draft = Draft("robot.mars", text)
    places = sorted(data.draw(st.sets(st.integers(0, len(text) - 1), max_size=6)))
    expected, last = "", 0
    for begin, end in zip(places[::2], places[1::2], strict=False):
        if "\n" in text[begin:end]:
            continue
        draft.put(begin, end, "<new>")
        expected, last = expected + text[last:begin] + "<new>", end
    expected += text[last:]
    found = apply_lines(text, draft.lines())
    # An edit may lose blanks at the end of a changed line.
    assert [line.rstrip() for line in found.split("\n")] == [
        line.rstrip() for line in expected.split("\n")
    ]
    assert all(text.split("\n")[edit.line - 1] == edit.old for edit in draft.lines())


def test_stretches_that_overlap_exclude_each_other() -> None:
    draft = Draft("robot.mars", "A uses_data_from B\n")
    draft.put(0, 5, "C")
    draft.put(3, 8, "D")
    with pytest.raises(ConflictError):
        draft.lines()


def test_lines_are_inserted_on_the_requested_side() -> None:
    draft = Draft("robot.mars", "a\nb\n")
    draft.insert(1, "behind", ["c", "d"])
    draft.insert(1, "behind", ["e"])
    draft.insert(2, "before", ["f"])
    assert draft.lines() == (
        LineEdit("robot.mars", 1, 1, None, "c\nd\ne", "behind"),
        LineEdit("robot.mars", 2, 1, None, "f", "before"),
    )
    assert apply_lines("a\nb\n", draft.lines()) == "a\nc\nd\ne\nf\nb\n"


def test_lines_are_in_the_order_of_the_text() -> None:
    draft = Draft("robot.mars", "a\nb\n")
    draft.insert(2, "behind", ["d"])
    draft.put(2, 3, "B")
    draft.insert(2, "before", ["c"])
    draft.put(0, 1, "A")
    assert [(edit.line, edit.where, edit.new) for edit in draft.lines()] == [
        (1, None, "A"),
        (2, "before", "c"),
        (2, None, "B"),
        (2, "behind", "d"),
    ]


def test_edits_of_another_text_are_refused() -> None:
    edits = [LineEdit("robot.mars", 1, 1, "a", "b")]
    assert apply_lines("a\n", edits) == "b\n"
    with pytest.raises(ConflictError):
        apply_lines("c\n", edits)


def test_a_stretch_may_go_on_over_lines() -> None:
    text = "a(1,  // one\n2,\n  3) b\n"
    draft = Draft("robot.mars", text)
    draft.put(1, text.index(")") + 1, "")
    assert apply_lines(text, draft.lines()) == "a\n b\n"


def test_a_line_inserted_beside_a_deleted_one_replaces_it() -> None:
    draft = Draft("robot.mars", "a\nb\nc\n")
    draft.delete(2)
    draft.insert(2, "behind", ["d", "e"])
    assert draft.lines() == (
        LineEdit("robot.mars", 2, 1, "b", "d"),
        LineEdit("robot.mars", 2, 1, None, "e", "behind"),
    )


def test_a_comment_is_deleted_with_its_entry_and_stays_beside_others() -> None:
    text = "@modules A,  // first\n    B  // second\n"
    draft = Draft("robot.mars", text)
    draft.put(10, 11, "")
    draft.put(26, 27, "")
    assert apply_lines(text, draft.lines()) == "@modules A  // first\n"
