#! /usr/bin/env python3
import rclpy
from rclpy.node import Node
from rclpy.executors import MultiThreadedExecutor
from rclpy.qos import qos_profile_sensor_data
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState, BatteryState, Imu
from geometry_msgs.msg import Twist
from std_msgs.msg import String
from .diag import Diag
from trajectory_msgs.msg import JointTrajectory


class Traj(Node):
    def __init__(self, node, rate):
        super().__init__("traj_action")
        self.create_subscription(JointTrajectory, "traj", self.cb, 1)


class Driver(Node):
    def __init__(self):
        super().__init__("base_driver")
        self.setup()

    def setup(self):
        self.odom_pub = self.create_publisher(Odometry, "odom", 1)
        self.power_pub = self.create_publisher(
            BatteryState, self.declare_parameter("battery_topic", "battery").value, 1
        )
        self.create_subscription(Twist, "cmd_vel", self.cb, 1, callback_group=None)
        self.declare_parameter("rate", 30.0)
        self.rate = self.get_parameter("rate").value
        self.joint_pub = self.create_publisher(
            msg_type=JointState, topic="joint_states", qos_profile=1
        )
        self.diagnostics = Diag(self, None)
        period = 1.0 / self.rate
        self.timer = self.create_timer(period, self.loop)
        self.timer2 = self.create_timer(
            timer_period_sec=0.5, callback=lambda: self.power_pub.publish(BatteryState())
        )

    def loop(self):
        self.joint_pub.publish(JointState())
        self.odom_pub.publish(Odometry())


def main():
    rclpy.init()
    node = Driver()
    action = Traj(node, node.rate)
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    executor.add_node(action)
    executor.spin()


if __name__ == "__main__":
    main()
