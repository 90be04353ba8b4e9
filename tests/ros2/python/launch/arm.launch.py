import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    GroupAction,
    OpaqueFunction,
    RegisterEventHandler,
    SetEnvironmentVariable,
    TimerAction,
)
from launch.conditions import IfCondition, UnlessCondition
from launch.event_handlers import OnProcessExit
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LoadComposableNodes, Node, PushRosNamespace, SetRemap
from launch_ros.descriptions import ComposableNode

LIDARS = ["left", "right"]


def lidar(side, **more):
    return Node(package="rplidar_ros", executable="rplidar_node", name=f"{side}_lidar", **more)


def setup(context, *args, **kwargs):
    robot = LaunchConfiguration("robot").perform(context)
    common = [("scan", "/" + robot + "/scan")]
    nodes = [lidar(side, remappings=common) for side in LIDARS]
    nodes += [lidar("rear", remappings=common + [("no", "matter")])]
    return nodes


def generate_launch_description():
    share = get_package_share_directory("arm")
    ld = LaunchDescription()
    ld.add_action(DeclareLaunchArgument("robot", default_value="arm"))
    ld.add_action(OpaqueFunction(function=setup))
    composed = LaunchConfiguration("composed")
    ld.add_action(
        GroupAction(
            [
                PushRosNamespace(LaunchConfiguration("robot")),
                SetRemap(src="cmd_vel", dst="/base/cmd_vel"),
                Node(
                    package="nav2_collision_monitor",
                    executable="collision_monitor",
                    name="monitor",
                    parameters=[os.path.join(share, "config", "values.yaml")],
                    condition=UnlessCondition(composed),
                ),
                LoadComposableNodes(
                    target_container="box",
                    condition=IfCondition(composed),
                    composable_node_descriptions=[
                        ComposableNode(
                            package="nav2_collision_monitor",
                            plugin="nav2_collision_monitor::CollisionMonitor",
                            name="monitor",
                            parameters=[{"cmd_vel_in_topic": "raw"}],
                        )
                    ],
                ),
            ]
        )
    )
    first = Node(package="joy", executable="joy_node")
    ld.add_action(first)
    teleop = Node(
        package="teleop_twist_joy",
        executable="teleop_node",
        arguments=["--ros-args", "-r", "cmd_vel:=/arm/raw"],
    )
    ld.add_action(
        RegisterEventHandler(OnProcessExit(target_action=first, on_exit=[TimerAction(period=1.0, actions=[teleop])]))
    )
    ld.add_action(SetEnvironmentVariable("X", "1"))
    Node(package="arm", executable="forgotten")
    ld.add_action(Node(package="arm", executable=os.environ["WHICH"], name="chosen"))
    return ld
