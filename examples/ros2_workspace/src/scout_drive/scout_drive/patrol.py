"""Drives from place to place."""

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan


class Patrol(Node):
    def __init__(self):
        super().__init__("patrol")
        self.commands = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.see, 10)
        self.create_subscription(Odometry, "odometry", self.count, 10)
        self.create_timer(0.1, self.drive)

    def see(self, scan):
        self.scan = scan

    def count(self, odometry):
        self.odometry = odometry

    def drive(self):
        self.commands.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(Patrol())
