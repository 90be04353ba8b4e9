from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            Node(package="nav2_map_server", executable="map_server", name="map_server"),
            Node(
                package="nav2_lifecycle_manager",
                executable="lifecycle_manager",
                name="manager",
                parameters=[{"node_names": ["map_server", "amcl"]}],
            ),
        ]
    )
