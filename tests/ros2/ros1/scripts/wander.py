#!/usr/bin/env python
import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import LaserScan


def wander():
    rospy.init_node("any")
    pub = rospy.Publisher("~out", Twist, queue_size=1)
    out = rospy.Publisher(rospy.get_param("~topic", "cmd_vel"), Twist, queue_size=1)
    rospy.Subscriber("scan", LaserScan, lambda scan: None)
    rospy.Subscriber("scan_%d" % 1, LaserScan, print)
    rate = rospy.Rate(8)
    while not rospy.is_shutdown():
        out.publish(Twist())
        rate.sleep()


if __name__ == "__main__":
    wander()
