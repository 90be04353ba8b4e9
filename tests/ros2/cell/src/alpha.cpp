#include <ros/ros.h>
int main(int argc, char** argv) {
  ros::init(argc, argv, "alpha");
  ros::NodeHandle nh; ros::NodeHandle pnh("~"); ros::NodeHandle arm(nh, "arm");
  std::string topic; pnh.param<std::string>("topic", topic, "chatter");
  ros::Publisher p = nh.advertise<std_msgs::String>(topic, 10);
  ros::Publisher q = pnh.advertise<std_msgs::String>("priv", 10);
  ros::Subscriber s = arm.subscribe<sensor_msgs::JointState>("joints", 1, cb);
  ros::Subscriber s2 = nh.subscribe("cmd_vel", 1, &cmdCb);
  ros::Timer t = nh.createTimer(ros::Duration(0.1), cb2);
}
