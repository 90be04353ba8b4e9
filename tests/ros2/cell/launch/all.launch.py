from launch import LaunchDescription
from launch_ros.actions import Node, ComposableNodeContainer, LoadComposableNodes
from launch_ros.descriptions import ComposableNode
def generate_launch_description():
    container = ComposableNodeContainer(name='c', namespace='', package='rclcpp_components', executable='component_container_mt', composable_node_descriptions=[
        ComposableNode(package='cell', plugin='cell::Life', name='life', remappings=[('cmd_vel', '/safe/cmd_vel')], extra_arguments=[{'use_intra_process_comms': True}])])
    return LaunchDescription([container,
        LoadComposableNodes(target_container='c', composable_node_descriptions=[ComposableNode(package='cell', plugin='cell::Base', namespace='b')]),
        Node(package='cell', executable='cell_driver', parameters=[{'prefix': 'rear'}]),
        Node(package='cell', executable='second'),
        Node(package='cell', executable='alpha'),
    ])
