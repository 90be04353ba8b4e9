#pragma once
#include <rclcpp/rclcpp.hpp>
#include "cell/topics.hpp"
namespace cell {
using Twist = geometry_msgs::msg::Twist;
class Driver : public rclcpp::Node {
public:
  explicit Driver(const rclcpp::NodeOptions & options = rclcpp::NodeOptions());
private:
  void loop();
  std::string cmd_topic_{"cmd_member"};
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odom_pub_;
  rclcpp::Publisher<Twist>::SharedPtr cmd_pub_;
  rclcpp::TimerBase::SharedPtr timer_;
};
}
