"""The muxes that launch files start, by the names of their topics in the robot.

Their defaults: https://github.com/ros-teleop/twist_mux,
https://github.com/yujinrobot/yujin_ocs (yocs_cmd_vel_mux),
https://github.com/kobuki-base/cmd_vel_mux, https://github.com/mit-racecar/racecar
(ackermann_cmd_mux).
"""

from collections.abc import Sequence

from mars_asp.exchange.ros2.launch import Started
from mars_asp.exchange.ros2.names import joined, renamed
from mars_asp.exchange.ros2.programs import RosProgram
from mars_asp.exchange.twist_mux.document import OUTPUT
from mars_asp.exchange.twist_mux.document import MuxParameters as Parameters
from mars_asp.model.graph import Mux, MuxInput

#: Nodes that hand on one of several commands, by their packages.
_PACKAGES = frozenset(
    {"twist_mux", "ackermann_mux", "yocs_cmd_vel_mux", "cmd_vel_mux", "ackermann_cmd_mux"}
)


def is_mux(program: RosProgram) -> bool:
    """Whether a program is a mux."""
    if program.executable.startswith(("joystick_relay", "twist_marker")):
        return False
    return program.package in _PACKAGES or program.executable.startswith("twist_mux")


def mux_of(started: Started, name: str, full: str, given: Sequence[Parameters]) -> Mux | None:
    """Return the mux that a node is, by the parameters that are for it, else by the first."""
    if not given:
        return None
    chosen = next((each for each in given if each.node.rpartition("/")[2] == name), given[0])
    return _mux_with_names(chosen, started, name, full)


def _mux_with_names(mux: Parameters, started: Started, name: str, full: str) -> Mux:
    # As a nodelet of ROS 1 it names its topics privately.
    is_private = mux.engine == "cmd_vel_mux" and started.plugin
    before = "~/" if is_private else ""
    output = mux.output
    if output == OUTPUT and mux.engine == "cmd_vel_mux":
        output = "output" if is_private else "cmd_vel"
    elif started.package == "ackermann_mux":
        output = "ackermann_cmd"

    def known(topic: str) -> str:
        written = topic if topic.startswith("/") else before + topic
        return renamed(written, started.namespace, name, started.remaps)

    inputs = tuple(
        MuxInput(each.name, known(each.topic), each.span, each.priority, each.hold_ms)
        for each in mux.inputs
    )
    return Mux(full, mux.engine, mux.span, known(output), inputs)


def unbound(mux: Parameters) -> Mux:
    """Return the mux of a file that no node is, named in the root namespace."""
    full = "/" + (mux.node or "twist_mux").lstrip("/")
    inputs = tuple(
        MuxInput(each.name, joined("/", each.topic), each.span, each.priority, each.hold_ms)
        for each in mux.inputs
    )
    return Mux(full, mux.engine, mux.span, joined("/", mux.output), inputs)
