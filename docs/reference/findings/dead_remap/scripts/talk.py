import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talk(Node):
    def __init__(self):
        super().__init__("talk")
        self.words = self.create_publisher(String, "chatter", 10)


rclpy.init()
rclpy.spin(Talk())
