"""The picture of a campaign: one point with its interval for each cell."""

import re
from xml.etree import ElementTree

from mars_asp.execution.campaign.picture import campaign_picture, plotted_axis
from mars_asp.execution.campaign.summary import Cell, Share
from mars_asp.execution.scenario.vary import Axis

RADIUS = Axis("robot.radius", (100, 200, 400))
SWITCH = Axis("modules.C", ("on", "off"))
CELLS = [
    Cell({"robot.radius": radius, "modules.C": switch}, Share(held, 10), {}, {}, {}, {})
    for radius, held in ((100, 10), (200, 5), (400, 0))
    for switch in ("on", "off")
]


def points(svg: str) -> list[tuple[float, float, str]]:
    """Return the position and the title of each point."""
    found = re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)" r="4" fill="\S+"><title>(.*?)<', svg)
    return [(float(x), float(y), text) for x, y, text in found]


def test_points_are_to_scale_and_better_ones_higher() -> None:
    svg = campaign_picture(CELLS[::2], [RADIUS], "a < b")
    ElementTree.fromstring(svg)
    shown = points(svg)
    (x1, y1, text), (x2, y2, _), (x3, y3, _) = shown
    assert x3 - x1 == 3 * (x2 - x1)
    assert y1 < y2 < y3
    assert y2 - y1 == y3 - y2
    assert text == "10 of 10 (72.2-100.0 %)"
    assert "<title>a &lt; b</title>" in svg


def test_each_further_value_is_a_series_with_its_name() -> None:
    svg = campaign_picture(CELLS, [SWITCH, RADIUS], "t")
    assert len(points(svg)) == 6
    assert "modules.C=on</text>" in svg
    assert "modules.C=off</text>" in svg
    assert len(set(re.findall(r'r="4" fill="(\S+)"', svg))) == 2


def test_values_shared_by_all_cells_are_written_once() -> None:
    cells = [cell._replace(vary={"duration": 20, **cell.vary}) for cell in CELLS]
    svg = campaign_picture(cells, [Axis("duration", (20,)), SWITCH, RADIUS], "t")
    assert svg.count("duration=20") == 1
    assert "modules.C=on</text>" in svg


def test_numbers_are_drawn_along_before_words() -> None:
    assert plotted_axis([SWITCH, RADIUS]) == RADIUS
    assert plotted_axis([Axis("duration", (1,)), SWITCH]) == SWITCH
    svg = campaign_picture(
        [Cell({"modules.C": value}, Share(1, 2), {}, {}, {}, {}) for value in ("on", "off")],
        [SWITCH],
        "t",
    )
    assert len(points(svg)) == 2
    assert "polyline" not in svg


def test_a_cell_of_an_earlier_grid_is_left_out() -> None:
    cells = [
        *CELLS[::2],
        Cell({}, Share(1, 2), {}, {}, {}, {}),
        Cell({"robot.radius": 7}, Share(1, 2), {}, {}, {}, {}),
    ]
    assert len(points(campaign_picture(cells, [RADIUS], "t"))) == 3
