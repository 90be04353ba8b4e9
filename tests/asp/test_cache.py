"""A stored table has the content of a new one, or is not used."""

import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from mars_asp.asp import cache
from mars_asp.asp.rules import statements
from mars_asp.asp.rules.computed import computations
from mars_asp.asp.rules.dependencies import dependencies_of
from mars_asp.asp.rules.statements import Statement, constants_of, statements_of
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic, point
from tests.support.fixtures import Patch

FACT = "reach(X) :- start(X)."


@dataclass(frozen=True)
class Outside:
    number: int


class Counted:
    """Makes the square of a number, and counts how often."""

    def __init__(self, maker: Path) -> None:
        self.maker, self.calls = maker, 0

    def of(self, *numbers: int) -> list[int]:
        return list(cache.memoized("squares", [self.maker], numbers, self._make).values())

    def _make(self, number: int) -> int:
        self.calls += 1
        return number * number


@pytest.fixture
def squares(tables: Path) -> Counted:
    maker = tables / "maker.py"
    maker.write_text("one")
    return Counted(maker)


def build(tables: Path) -> bytes:
    """Write the table of squares, and clear the cache of this process."""
    content = dict(cache.tables())["squares"]
    (tables / "squares").write_bytes(content)
    cache.forget(tables)
    return content


def test_values_of_a_table_are_not_computed(tables: Path, squares: Counted) -> None:
    assert squares.of(2, 3) == [4, 9]
    build(tables)
    assert squares.of(3, 4, 2) == [9, 16, 4]
    assert squares.calls == 3


def test_nothing_is_written_when_values_are_made(tables: Path, squares: Counted) -> None:
    squares.of(2)
    assert [path.name for path in tables.iterdir()] == ["maker.py"]
    assert (squares.of(2), squares.calls) == ([4], 1)


def test_a_table_of_other_makers_is_not_believed(tables: Path, squares: Counted) -> None:
    squares.of(2)
    build(tables)
    squares.maker.write_text("another")
    cache.forget(tables)
    squares.of(2)
    assert squares.calls == 2


def test_a_table_with_a_flipped_bit_is_not_believed(tables: Path, squares: Counted) -> None:
    squares.of(*range(5))
    whole = build(tables)
    torn = [whole[:size] for size in range(len(whole))]
    for bit in range(8 * len(whole)):
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << bit % 8
        torn.append(bytes(flipped))
    for number, content in enumerate(torn, 1):
        (tables / "squares").write_bytes(content)
        cache.forget(tables)
        assert squares.of(3) == [9]
        assert squares.calls == 5 + number


def test_values_that_many_others_replaced_are_computed_again(squares: Counted) -> None:
    squares.of(*range(6000))
    assert squares.of(7) == [49]
    assert squares.calls == 6001


def test_values_of_built_in_classes_come_back_with_computed_fields(tables: Path) -> None:
    (read,) = statements_of([FACT])[FACT]
    assert read.derives == {Signature("reach", 1)}  # from now on it has this field
    found = Diagnostic("code", "error", "told", point("a.lp", 1, 2), ((point("b", 3, 4), "c"),))
    value = (read, found, {"a": frozenset({("p", 1)})})
    cache.memoized("squares", [], [1], lambda _: value)
    build(tables)
    back: tuple[object, ...] = cache.memoized("squares", [], [1], lambda _: ())[1]
    assert back == value
    assert isinstance(back[0], Statement)
    assert "derives" not in vars(Statement) or back[0].__dict__ == read.__dict__


@pytest.mark.parametrize("make", [statements_of, dependencies_of, constants_of, computations])
def test_values_made_of_rules_survive_a_table(make: object, tables: Path) -> None:
    assert callable(make)
    rules = [FACT, "{ a(X) : b(X,Y), not c(Y) } :- d(X+Y,f(Z),Z), X = #sum { W,V : e(V,W*X) }."]
    first = make(rules)
    for name, content in cache.tables():
        (tables / name).write_bytes(content)
    cache.forget(tables)
    assert make(rules) == first


def test_a_value_of_a_class_that_is_gone_is_made_again(
    tables: Path, squares: Counted, monkeypatch: Patch
) -> None:
    squares.of(2)
    cache._known["squares"][2] = Outside(1)
    build(tables)
    monkeypatch.delattr(sys.modules[__name__], "Outside")
    assert squares.of(2) == [4]


def test_more_rules_than_are_remembered_are_all_read(monkeypatch: Patch) -> None:
    monkeypatch.setattr(statements, "_MOST", 20)
    texts = [f"p{n}(X) :- q(X)." for n in (*range(40), *range(5))]
    for count in (10, 30, 45):
        assert set(statements_of(texts[:count])) == set(texts[:count])
