"""Bridges to the simulator Gazebo, whose arguments name the topics that they forward.

How they are called: https://github.com/gazebosim/ros_gz (ros_gz_bridge, ros_gz_image).
"""

import re
from collections.abc import Iterator, Sequence
from itertools import takewhile

from mars_asp.diagnostic import Span
from mars_asp.exchange.ros2.interface import AT_RUN_TIME, Interface, InterfaceTopic
from mars_asp.exchange.ros2.programs import RosProgram
from mars_asp.exchange.unread import Unread
from mars_asp.exchange.yaml_document import Items, Node, Pairs, Scalar

#: The parameter that names a file with the forwarded topics of a bridge.
FILE = "config_file"
_BRIDGES = frozenset({"ros_gz_bridge", "ros_ign_bridge"})
_OF_IMAGES = frozenset({"ros_gz_image", "ros_ign_image"})
_IMAGE = "sensor_msgs/msg/Image"
#: A topic, its types on both sides, and between these the direction.
_HANDED = re.compile(r"(?P<topic>[^@]+)@(?P<type>[^@\[\]]+)(?P<way>[@\[\]]).+")
_WAYS = {
    "[": (True, False), "GZ_TO_ROS": (True, False),
    "]": (False, True), "ROS_TO_GZ": (False, True),
}  # fmt: skip


def is_bridge(program: RosProgram) -> bool:
    """Whether a program is a bridge between ROS and Gazebo."""
    return program.package in _BRIDGES | _OF_IMAGES


def bridged(
    program: RosProgram, arguments: Sequence[str], document: Node | None, span: Span
) -> Interface:
    """Return the topics of a bridge that is started at `span`, by its arguments and its file.

    `document` is the parsed YAML file of the bridge, or None without one.
    """
    words = takewhile(lambda word: word != "--ros-args", arguments)
    found = list(_of_file(document))
    unread: list[Unread] = []
    for word in words:
        match = _HANDED.fullmatch(word)
        if match:
            found.append((match["topic"], match["type"], match["way"], None))
        elif word and program.package in _OF_IMAGES:
            found.append((word, _IMAGE, "[", None))
        else:
            unread.append(Unread(AT_RUN_TIME, word or "arguments", span))
    ends = [
        (InterfaceTopic(topic, kind, at), *_WAYS.get(way, (True, True)))
        for topic, kind, way, at in found
    ]
    return Interface(
        tuple(topic for topic, is_sent, _ in ends if is_sent),
        tuple(topic for topic, _, is_heard in ends if is_heard),
        unread=tuple(unread),
    )


def _of_file(document: Node | None) -> Iterator[tuple[str, str, str, Span | None]]:
    """Yield topic, type, direction and location of each entry of a bridge's file."""
    for entry in document.nodes if isinstance(document, Items) else ():
        pairs = entry.pairs if isinstance(entry, Pairs) else ()
        entries = {key.text: value for key, value in pairs if isinstance(value, Scalar)}
        topic = (
            entries.get("ros_topic_name")
            or entries.get("topic_name")
            or entries.get("gz_topic_name")
        )
        kind, way = entries.get("ros_type_name"), entries.get("direction")
        if topic is not None and kind is not None:
            yield topic.text, kind.text, "" if way is None else way.text, topic.span
