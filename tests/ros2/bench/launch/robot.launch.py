from ament_index_python.packages import get_package_share_path, get_package_share_directory
import os
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.conditions import IfCondition
from launch.substitutions import EnvironmentVariable, EqualsSubstitution, LaunchConfiguration
from launch_ros.actions import LifecycleNode, Node, PushROSNamespace
from launch_ros.parameter_descriptions import ParameterFile
from nav2_common.launch import RewrittenYaml


def generate_launch_description():
    here = get_package_share_path("bench")
    bridge = os.path.join(get_package_share_directory("bench"), "config", "bridge.yaml")
    driver = Node(
        package="bench",
        executable="driver",
        remappings=[("cmd_vel", "/base/cmd_vel"), ("joint_states", "/base/joint_states")],
        parameters=[{"rate": 30.0}, str(here / "config" / "driver.yaml")],
    )
    jsp = Node(
        package="joint_state_publisher",
        executable="joint_state_publisher",
        parameters=[{"source_list": ["/base/joint_states"]}, {"rate": 30.0}],
    )
    helper = Node(
        package="bench",
        executable="helper",
        arguments=[
            "--ros-args",
            "-p",
            "out_topic:=/from_args",
            "--params-file",
            str(here / "config" / "h.yaml"),
        ],
    )
    gz = Node(
        package="ros_gz_bridge",
        executable="parameter_bridge",
        arguments=[
            "/cmd_vel@geometry_msgs/msg/Twist]gz.msgs.Twist",
            "/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan",
            "--ros-args",
            "-r",
            "/scan:=/front/scan",
        ],
    )
    gz2 = Node(
        package="ros_gz_bridge",
        executable="parameter_bridge",
        name="b2",
        arguments=["--ros-args", "-p", f"config_file:={bridge}"],
    )
    rl = Node(
        package="robot_localization",
        executable="ekf_node",
        name="ekf_filter_node",
        parameters=[os.path.join(here, "config", "ekf.yaml")],
        remappings=[("odometry/filtered", "odom2")],
    )
    worker = LifecycleNode(
        package="bench",
        executable="worker",
        name="worker",
        namespace="",
        parameters=[
            ParameterFile(
                RewrittenYaml(
                    source_file=str(here / "config" / "worker.yaml"),
                    root_key="",
                    param_rewrites={"in_topic": "/rewritten"},
                    convert_types=True,
                ),
                allow_substs=True,
            )
        ],
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "ns", default_value=EnvironmentVariable("ROBOT_NS", default_value="")
            ),
            driver,
            Node(package="bench", executable="wheels"),
            jsp,
            helper,
            gz,
            gz2,
            rl,
            GroupAction([PushROSNamespace(LaunchConfiguration("ns")), worker], scoped=True),
            Node(
                package="bench",
                executable="legacy",
                name="legacy",
                condition=IfCondition(EqualsSubstitution(LaunchConfiguration("ns"), "")),
            ),
        ]
    )
