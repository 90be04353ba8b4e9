import rclpy
from rclpy.node import Node
from std_msgs.msg import String
from sensor_msgs.msg import Imu
import message_filters
from functools import partial

from . import names


class Helper(Node):
    TOPIC = "const/topic"
    SIDES = ("left", "right")

    def __init__(self, **kwargs):
        super().__init__("helper", **kwargs)
        self.declare_parameters(
            namespace="",
            parameters=[("out_topic", "out"), ("in_topic", "in"), ("ns.sub", "nested")],
        )
        out = self.get_parameter("out_topic").get_parameter_value().string_value
        self.pub = self.create_publisher(String, out, 10)
        self.sub = self.create_subscription(
            String, self.get_parameter("in_topic").value, self.cb, 10
        )
        self.p2 = self.create_publisher(String, self.TOPIC, 10)
        self.pubs = {}
        for i, side in enumerate(self.SIDES):
            self.pubs[side] = self.create_publisher(String, f"/{side}/{i}/cmd", 10)
        self.subs = [
            self.create_subscription(String, "wheel_%d/state" % n, partial(self.cb, n), 10)
            for n in range(2)
        ]
        self.a = message_filters.Subscriber(self, Imu, "sync/a")
        self.b = message_filters.Subscriber(self, Imu, "sync/b")
        self.ts = message_filters.ApproximateTimeSynchronizer([self.a, self.b], 10, 0.1)
        self.far = self.create_publisher(String, names.FAR, 1)
        self.near = self.create_publisher(String, names.Near.HAND, 1)
        self.subs.extend(
            self.create_subscription(String, "{}/{}".format(names.SPACE, part), self.cb, 1)
            for part, _ in names.PARTS.items()
        )
        self.n = self.create_publisher(String, "/".join([self.get_name(), "status"]), 1)
        self.m = self.create_publisher(String, self.get_namespace() + "ns_status", 1)


def main(args=None):
    rclpy.init(args=args)
    node = Helper()
    rclpy.spin(node)
