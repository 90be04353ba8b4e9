"""Starts the robot."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    base = PathJoinSubstitution([FindPackageShare("scout_base"), "launch", "base.launch.xml"])
    muxed = PathJoinSubstitution([FindPackageShare("scout_drive"), "config", "twist_mux.yaml"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("docking", default_value="true"),
            IncludeLaunchDescription(AnyLaunchDescriptionSource(base)),
            Node(
                package="teleop_twist_joy",
                executable="teleop_node",
                remappings=[("cmd_vel", "joy_vel")],
            ),
            Node(package="joy", executable="joy_node"),
            Node(
                package="scout_drive",
                executable="patrol",
                remappings=[("cmd_vel", "nav_vel")],
            ),
            Node(
                package="scout_drive",
                executable="follow",
                parameters=[{"out": "nav_vel"}],
            ),
            Node(
                package="twist_mux",
                executable="twist_mux",
                parameters=[muxed],
                remappings=[("cmd_vel_out", "cmd_vel_raw")],
            ),
            Node(
                package="nav2_velocity_smoother",
                executable="velocity_smoother",
                remappings=[("cmd_vel", "cmd_vel_raw"), ("cmd_vel_smoothed", "cmd_vel")],
            ),
            Node(
                package="scout_drive",
                executable="dock",
                condition=IfCondition(LaunchConfiguration("docking")),
            ),
        ]
    )
