"""The parameters of a mux in ROS 2 are those that a file has for its name."""

from pathlib import Path

import pytest

from mars_asp.exchange.ros2 import import_ros2
from tests.support.packages import write_package

LAUNCH = '<launch><node pkg="twist_mux" exec="twist_mux" name="{}">{}</node></launch>'
PARAMETERS = """{}:
  ros__parameters:
    topics:
      joy: {{topic: joy_vel, timeout: 0.5, priority: 10}}
"""


@pytest.mark.parametrize(
    ("node", "key", "is_mux"),
    [
        ("twist_mux", "twist_mux", True),
        ("twist_mux", "/**", True),
        ("twist_mux", "/*", True),
        ("base_mux", "twist_mux", False),
        ("base_mux", "/base_mux", True),
    ],
)
def test_a_mux_takes_the_parameters_for_its_name(
    node: str, key: str, is_mux: bool, tmp_path: Path
) -> None:
    given = '<param from="$(find-pkg-share mine)/config/mux.yaml"/>'
    files = {
        "launch/mux.launch.xml": LAUNCH.format(node, given),
        "config/mux.yaml": PARAMETERS.format(key),
    }
    write_package(files, tmp_path)
    [tree] = import_ros2([("", str(tmp_path))]).trees
    assert [each.name for each in tree.muxes] == [f"/{node}"] * is_mux
