"""Backs into the charger."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Dock(Node):
    def __init__(self):
        super().__init__("dock")
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_timer(0.05, self.back)

    def back(self):
        self.commands.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(Dock())
