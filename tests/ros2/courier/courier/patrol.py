from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Image


class Patrol(Node):
    def __init__(self):
        super().__init__("patrol")
        self.commands = self.create_publisher(Twist, "patrol/go", 10)
        self.create_subscription(Image, "image", self.look, 10)


def main():
    Patrol()
