"""The muxes that launch files start, by the names of their topics in the robot.

Their defaults: https://github.com/ros-teleop/twist_mux,
https://github.com/yujinrobot/yujin_ocs (yocs_cmd_vel_mux),
https://github.com/kobuki-base/cmd_vel_mux, https://github.com/mit-racecar/racecar
(ackermann_cmd_mux).
"""

from collections.abc import Sequence
from dataclasses import replace

from mars_asp.exchange.ros2.launch import Started
from mars_asp.exchange.ros2.names import joined, renamed
from mars_asp.exchange.ros2.programs import RosProgram
from mars_asp.exchange.twist_mux.document import OUTPUT
from mars_asp.model.graph import Mux

#: Nodes that hand on one of several commands, by their packages.
_PACKAGES = frozenset(
    {"twist_mux", "ackermann_mux", "yocs_cmd_vel_mux", "cmd_vel_mux", "ackermann_cmd_mux"}
)
#: A topic of twist_mux that its parameters do not name.
_FURTHER = ("/diagnostics",)


def is_mux(program: RosProgram) -> bool:
    """Whether a program is one of the supported muxes of velocity commands, such as twist_mux."""
    if program.executable.startswith(("joystick_relay", "twist_marker")):
        return False
    return program.package in _PACKAGES or program.executable.startswith("twist_mux")


def mux_of(started: Started, name: str, full: str, given: Sequence[Mux]) -> Mux | None:
    """Return the mux that a started node is, with full topic names, or None without parameters.

    Of the muxes in `given` it is the one called `name`, else the first. `full` is the node's full
    name.
    """
    if not given:
        return None
    mux = next((each for each in given if each.name.rpartition("/")[2] == name), given[0])
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

    inputs = tuple(replace(each, topic=known(each.topic)) for each in mux.inputs)
    locks = tuple(replace(each, topic=known(each.topic)) for each in mux.locks)
    # Of other muxes not all topics are known.
    is_known = started.package == "twist_mux" and mux.engine == "twist_mux"
    topics = (output, *_FURTHER, *(each.topic for each in (*mux.inputs, *mux.locks)))
    names = frozenset(renamed(each, started.namespace, name, ()) for each in topics)
    return replace(
        mux,
        name=full,
        output=known(output),
        inputs=inputs,
        locks=locks,
        names=names if is_known else None,
        started=started.span,
    )


def unbound(mux: Mux) -> Mux:
    """Return a mux of a file that no started node uses, with names in the root namespace."""
    full = "/" + (mux.name or "twist_mux").lstrip("/")
    inputs = tuple(replace(each, topic=joined("/", each.topic)) for each in mux.inputs)
    locks = tuple(replace(each, topic=joined("/", each.topic)) for each in mux.locks)
    return replace(mux, name=full, output=joined("/", mux.output), inputs=inputs, locks=locks)
