import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    steering = os.path.join(get_package_share_directory("courier"), "config", "steering.yaml")
    mux = {
        "topics": {
            "joystick": {"topic": "joy/go", "timeout": 0.5, "priority": 100},
            "patrol": {"topic": "auto/go", "timeout": 0.5, "priority": 10},
        }
    }
    return LaunchDescription(
        [
            Node(package="courier", executable="base"),
            Node(package="courier", executable="camera"),
            Node(package="courier", executable="patrol"),
            Node(package="courier", executable="viewer"),
            Node(
                package="courier",
                executable="viewer",
                name="remote",
                remappings=[("picture", "image_slow")],
            ),
            Node(
                package="topic_tools",
                executable="throttle",
                name="slow",
                arguments=["messages", "image", "2.5", "image_slow"],
            ),
            Node(
                package="topic_tools",
                executable="relay",
                parameters=[{"input_topic": "image", "output_topic": "picture"}],
            ),
            Node(
                package="topic_tools",
                executable="mux",
                name="driver",
                parameters=[
                    {"output_topic": "auto/go", "input_topics": ["patrol/go", "dock/go"]}
                ],
            ),
            Node(package="joy", executable="joy_node"),
            Node(package="joy_teleop", executable="joy_teleop", parameters=[steering]),
            Node(
                package="twist_mux",
                executable="twist_mux",
                parameters=[steering, mux],
                remappings=[("cmd_vel_out", "muxed")],
            ),
            Node(
                package="topic_tools",
                executable="throttle",
                name="brake",
                arguments=["messages", "muxed", "10", "wheels"],
            ),
        ]
    )
