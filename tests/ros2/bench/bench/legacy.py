import rclpy
from std_msgs.msg import String
from geometry_msgs.msg import Twist


def main():
    rclpy.init()
    node = rclpy.create_node("legacy")
    pub = node.create_publisher(Twist, "cmd_vel", 10)
    node.create_subscription(String, "teleop", lambda m: pub.publish(Twist()), 10)
    rate = node.create_rate(20)
    while rclpy.ok():
        pub.publish(Twist())
        rate.sleep()
