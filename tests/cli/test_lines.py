"""Long lines are shown around the place that matters."""

from mars_asp.cli.lines import MOST, shortened

NAMES = [f"Wheel{number}" for number in range(1000)]
LINE = f"@modules {', '.join(NAMES)}"


def test_a_short_line_stays_whole() -> None:
    assert shortened("  Wheel is_controlled_by Turn 2\n", 9) == "Wheel is_controlled_by Turn 2"


def test_every_place_of_a_long_line_shows_its_word_and_its_neighbours() -> None:
    for indent in ("", "    "):
        line = f"{indent}{LINE}\n"
        for before, name, after in zip(NAMES, NAMES[1:], NAMES[2:], strict=False):
            shown = shortened(line, line.index(f" {name},") + 2)
            assert f" {before}, {name}, {after}" in shown
            assert shown.startswith("@modules ")
            assert len(shown) <= MOST + len("@modules ... ") + len(" ...")


def test_the_ends_of_a_long_line_are_not_left_out() -> None:
    assert shortened(LINE, 1).startswith("@modules Wheel0, Wheel1,")
    assert shortened(LINE, len(LINE) - 1).endswith("Wheel998, Wheel999")


def test_a_word_without_end_is_cut() -> None:
    assert "y" in shortened("x" * 5000 + "y" + "x" * 5000, 5001)
    assert len(shortened("x" * 10000, 5001)) <= MOST + len("... ...") + 1
