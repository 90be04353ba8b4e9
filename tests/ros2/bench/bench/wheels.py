import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Wheel:
    def __init__(self, node, side, suffix="speed"):
        self.pub = node.create_publisher(Float64, f"wheel/{side}/{suffix}", 1)


class Wheels(Node):
    def __init__(self, name, stop_topic="stop"):
        super().__init__(name)
        self.wheels = [Wheel(self, "left"), Wheel(self, side="right", suffix="turn")]
        self.create_subscription(Float64, stop_topic, print, 1)


def main():
    rclpy.init()
    rclpy.spin(Wheels("wheels_node", stop_topic="halt"))
