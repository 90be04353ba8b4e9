"""Import ROS workspaces, packages and launch files: nodes, their topics and controls."""

from mars_asp.exchange.ros2.read import import_ros2

__all__ = ["import_ros2"]
