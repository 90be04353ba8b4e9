"""Follows a person."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Follow(Node):
    def __init__(self):
        super().__init__("follow")
        self.declare_parameter("out", "cmd_vel")
        self.commands = self.create_publisher(Twist, self.get_parameter("out").value, 10)
        self.create_subscription(LaserScan, "scan", self.see, 10)

    def see(self, scan):
        self.commands.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(Follow())
