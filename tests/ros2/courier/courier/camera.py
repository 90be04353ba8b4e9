from rclpy.node import Node
from sensor_msgs.msg import Image


class Camera(Node):
    def __init__(self):
        super().__init__("camera")
        self.pictures = self.create_publisher(Image, "image", 10)
        self.create_timer(1 / 20, self.shoot)


def main():
    Camera()
