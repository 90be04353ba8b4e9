import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32


class Listen(Node):
    def __init__(self):
        super().__init__("listen")
        self.create_subscription(Int32, "chatter", print, 10)


rclpy.init()
rclpy.spin(Listen())
