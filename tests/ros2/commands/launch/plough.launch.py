from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument("field", default_value="north"),
            ExecuteProcess(
                cmd=["ros2", "run", "teleop_twist_keyboard", "teleop_twist_keyboard"]
                + ["--ros-args", "-r", "cmd_vel:=cmd_vel_key"]
            ),
            # All words in one, for a shell.
            ExecuteProcess(cmd=["ros2 run joy joy_node"], shell=True),
            ExecuteProcess(
                cmd=["ros2", "launch", "plough", "share.launch.xml"]
                + [["name:=", LaunchConfiguration("field")]]
            ),
            Node(
                package="controller_manager",
                executable="ros2_control_node",
                parameters=[{"blade.type": "forward_command_controller/ForwardCommandController"}],
            ),
            ExecuteProcess(
                cmd=["ros2", "control", "load_controller", "--set-state", "active", "blade"]
            ),
            # No node.
            ExecuteProcess(cmd=["ros2", "bag", "record", "-a"]),
        ]
    )
