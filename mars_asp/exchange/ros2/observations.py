"""Topics that parameters of Nav2 name as sources: of the layers of a costmap, or of a monitor.

Sources: obstacle_layer.cpp, static_layer.cpp and range_sensor_layer.cpp in
`nav2_costmap_2d/plugins`, and `nav2_collision_monitor/src/collision_monitor_node.cpp`, of
ros-navigation/navigation2.
"""

from collections.abc import Iterator, Mapping

from mars_asp.exchange.ros2.interface import InterfaceTopic
from mars_asp.exchange.ros2.parameters import GivenParameter

_SCAN = "sensor_msgs/msg/LaserScan"
#: The message type of a source by its `data_type`, or by its `type` at a monitor.
_TYPES = {
    "LaserScan": _SCAN,
    "scan": _SCAN,
    "PointCloud2": "sensor_msgs/msg/PointCloud2",
    "pointcloud": "sensor_msgs/msg/PointCloud2",
    "range": "sensor_msgs/msg/Range",
}
#: What the parameter file of `nav2_bringup` names, which a robot without one of its own takes.
USUAL = InterfaceTopic("scan", _SCAN, optional=True)


def observed(values: Mapping[str, GivenParameter]) -> Iterator[InterfaceTopic]:
    """Yield the topics that a node's parameters name as sources of observation.

    `values` are the parameters by their dotted names. Only layers that `plugins` lists are loaded;
    a source without a topic has its own name as one.
    """
    known = {name: each for name, each in values.items() if each.is_known}
    layers = known["plugins"].texts if "plugins" in known else None
    for name, value in known.items():
        layer, _, last = name.rpartition(".")
        if layer and layers is not None and layer not in layers:
            continue
        if last == "observation_sources":
            for source in (word for text in value.texts for word in text.split()):
                yield _source(known, f"{layer}.{source}" if layer else source, source, value)
        elif last == "plugin" and value.text.endswith("::StaticLayer"):
            topic = known.get(f"{layer}.map_topic", value)
            called = "map" if topic is value else topic.text
            yield InterfaceTopic(called, "nav_msgs/msg/OccupancyGrid", topic.value.span)
        elif last == "topics" and _has_class(known, layer, "::RangeSensorLayer"):
            for text in value.texts:
                yield InterfaceTopic(text, "sensor_msgs/msg/Range", value.value.span)


def _source(
    known: Mapping[str, GivenParameter], start: str, source: str, listed: GivenParameter
) -> InterfaceTopic:
    """Return the topic of a source, whose parameters begin with `start`."""
    topic = known.get(f"{start}.topic")
    kind = known.get(f"{start}.data_type", known.get(f"{start}.type"))
    given = listed if topic is None else topic
    of = _SCAN if kind is None else _TYPES.get(kind.text)
    return InterfaceTopic(source if topic is None else topic.text, of, given.value.span)


def _has_class(known: Mapping[str, GivenParameter], layer: str, ending: str) -> bool:
    """Whether a layer is of the class with an ending."""
    plugin = known.get(f"{layer}.plugin")
    return plugin is not None and plugin.text.endswith(ending)
