#include <ros/ros.h>
#include <geometry_msgs/Twist.h>

/* n.subscribe("comment", 1, drive); */
void drive(const geometry_msgs::TwistConstPtr& twist) { (void)twist; }

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle n;
  ros::NodeHandle own("~");
  const std::string where = "odo" "metry";
  ros::Subscriber commands = n.subscribe("cmd_vel", 1, drive);
  ros::Publisher odom = n.advertise<nav_msgs::Odometry>("odom", 1);
  ros::Publisher state = own.advertise<std_msgs::String>("state", 1);
  ros::Rate rate(25);
  while (ros::ok()) {
    odom.publish(nav_msgs::Odometry());
    rate.sleep();
  }
}
