"""Glue that launch files start: topic_tools, joy_teleop and `rostopic pub`, by their arguments.

Their arguments and defaults: https://github.com/ros-tooling/topic_tools,
https://github.com/ros/ros_comm (topic_tools), https://github.com/ros-teleop/teleop_tools,
https://github.com/ros-teleop/twist_mux (joystick_relay).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from mars_asp.exchange.ros2.interface import Interface, InterfaceTopic
from mars_asp.exchange.ros2.parameters import GivenParameter
from mars_asp.exchange.ros2.programs import RosProgram
from mars_asp.model.ranges import Problem
from mars_asp.model.rates import Rate, read_frequency

#: The input of a joystick's teleoperation, and the parameters for the types of its outputs.
_JOYSTICK = InterfaceTopic("joy", "sensor_msgs/msg/Joy")
_TYPES = ("interface_type", "message_type")
#: Suffixes that the default names of output topics add to those of input topics.
_ENDINGS = {"relay": "_relay", "throttle": "_throttle", "drop": "_drop", "delay": "_delay"}
_COMPONENTS = {
    f"topic_tools::{name.capitalize()}Node": name for name in (*_ENDINGS, "mux", "demux")
}
_NOT_SELECTED = "topics that a mux of topic_tools can select later"
_NONE = "__none"


@dataclass(frozen=True, slots=True)
class Forward:
    """The forwarding of a topic by a node: both topics as its program names them, maximal rate.

    `left_out` are its other effects, each a sort (in the plural) and a name.
    """

    source: str
    target: str
    hz: Rate | None = None
    left_out: tuple[tuple[str, str], ...] = ()


def handed_on(
    program: RosProgram, words: Sequence[str], values: Mapping[str, GivenParameter]
) -> Forward | None:
    """Return the forwarding that a program does, or None if it forwards no topic.

    `words` are its arguments, `values` its parameters.
    """
    if program.package == "twist_mux" and program.executable.startswith("joystick_relay"):
        left_out = (("topics of locks", "joy_priority"), ("topics of markers", "text_marker"))
        return Forward("joy_vel_in", "joy_vel_out", None, left_out)
    if program.package != "topic_tools":
        return None
    kind = _COMPONENTS.get(program.executable) if program.plugin else program.executable
    match kind:
        case "mux" | "demux":
            return _selected(kind, words, values)
        case str() if kind in _ENDINGS:
            return _copied(kind, words, values)
        case _:
            return None


def _copied(
    kind: str, words: Sequence[str], values: Mapping[str, GivenParameter]
) -> Forward | None:
    """Return the forwarding of a relay, throttle, drop or delay; None without an input topic."""
    sort, *words = words if kind == "throttle" and words else ("", *words)
    named = _one(values, "throttle_type") or sort or "messages"
    # The number of words between the input topic and the output topic.
    size = {"relay": 0, "throttle": 1 if named == "messages" else 2, "drop": 2, "delay": 1}[kind]
    source, *amounts = words[: 1 + size] or ("",)
    given = words[1 + size] if len(words) > 1 + size else ""
    source = _one(values, "input_topic") or source
    if not source:
        return None
    target = _one(values, "output_topic") or given or source + _ENDINGS[kind]
    hz, left_out = None, list[tuple[str, str]]()
    if kind == "throttle" and named == "messages":
        rate = read_frequency(_one(values, "msgs_per_sec") or next(iter(amounts), ""))
        if isinstance(rate, Problem):
            left_out.append(("rates of throttles", target))
        else:
            hz = rate
    elif kind != "relay":
        left_out.append(("amounts that are delayed, dropped or limited in bytes", target))
    return Forward(source, target, hz, tuple(left_out))


def _selected(
    kind: str, words: Sequence[str], values: Mapping[str, GivenParameter]
) -> Forward | None:
    """Return the initial forwarding of a mux or demux, or None; it may be changed in a run."""
    several, one = ("input", "output") if kind == "mux" else ("output", "input")
    named = values.get(f"{several}_topics")
    topics = (named and named.texts) or tuple(words[1:])
    default = "~/selected" if kind == "mux" else "~/input"
    fixed = _one(values, f"{one}_topic") or next(iter(words), default)
    first = _one(values, "initial_topic") or next(iter(topics), "")
    if first in ("", _NONE):
        return None
    others = tuple((_NOT_SELECTED, each) for each in topics if each != first)
    return Forward(*((first, fixed) if kind == "mux" else (fixed, first)), None, others)


def _one(values: Mapping[str, GivenParameter], name: str) -> str:
    return values[name].text if name in values else ""


def steered(
    program: RosProgram, words: Sequence[str], values: Mapping[str, GivenParameter]
) -> Interface | None:
    """Return the topics of joy_teleop or `rostopic pub`, or None for other programs.

    They are named by its parameters (`values`) or arguments (`words`) alone.
    """
    if program.package == "rostopic" and list(words[:1]) == ["pub"]:
        return _published(words[1:])
    if program.package != "joy_teleop" or not program.executable.startswith("joy_teleop"):
        return None
    return Interface(tuple(_steered(values)), (_JOYSTICK,), "joy_teleop")


def _published(words: Sequence[str]) -> Interface | None:
    """Return the topic of `rostopic pub` with type and rate; None if topic or type is missing."""
    given = iter(words)
    named: list[str] = []
    hz = None
    for word in given:
        if word in ("-r", "--rate"):
            rate = read_frequency(next(given, ""))
            hz = None if isinstance(rate, Problem) else rate
        elif word in ("-f", "--file"):
            next(given, None)
        elif not word.startswith("-"):
            named.append(word)
    match named:
        case [topic, kind, *_] if topic:
            return Interface((InterfaceTopic(topic, kind or None, hz=hz),))
        case _:
            return None


def _steered(values: Mapping[str, GivenParameter]) -> Iterator[InterfaceTopic]:
    for name, given in values.items():
        group, dot, last = name.rpartition(".")
        if dot and last == "topic_name" and _one(values, f"{group}.type") in ("", "topic"):
            kinds = [_one(values, f"{group}.{key}") for key in _TYPES]
            yield InterfaceTopic(given.text, next(filter(None, kinds), None), given.value.span)
