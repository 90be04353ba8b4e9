import rclpy
from rclpy.lifecycle import LifecycleNode as LN, State
from std_msgs.msg import String
from sensor_msgs.msg import LaserScan


class Worker(LN):
    def __init__(self):
        super().__init__("worker")
        self.declare_parameter("in_topic", "x")
        self.declare_parameter("sensors", ["a"])

    def on_configure(self, state):
        self.pub = self.create_lifecycle_publisher(String, "~/out", 10)
        self.sub = self.create_subscription(
            String, self.get_parameter("in_topic").value, self.cb, 10
        )
        for name in self.get_parameter("sensors").value:
            self.declare_parameter(f"{name}.topic", "")
            self.create_subscription(
                LaserScan, self.get_parameter(f"{name}.topic").value, self.cb, 10
            )
        return None


def main():
    rclpy.init()
    rclpy.spin(Worker())
