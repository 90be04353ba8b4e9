from geometry_msgs.msg import Twist
from rclpy.node import Node


class Base(Node):
    def __init__(self):
        super().__init__("base")
        self.create_subscription(Twist, "wheels", self.drive, 10)


def main():
    Base()
