from rclpy.node import Node
from sensor_msgs.msg import Image


class Viewer(Node):
    def __init__(self):
        super().__init__("viewer")
        self.create_subscription(Image, "picture", self.show, 10)


def main():
    Viewer()
