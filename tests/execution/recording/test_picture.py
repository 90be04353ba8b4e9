"""A run as a picture."""

from mars_asp.execution.recording.picture import plot_run
from tests.support.trials import BASE, HAND, WALL, trial


def test_a_plot_names_who_held_control() -> None:
    assert ">C</text>" in plot_run(trial(BASE + HAND + WALL))
