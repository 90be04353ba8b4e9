#include <rclcpp/rclcpp.hpp>
int main(int argc, char* argv[]) {
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("second_node");
  auto pub = node->create_publisher<geometry_msgs::msg::Twist>("cmd_vel", 10);
  rclcpp::Rate rate(5.0);
  /* auto dead = node->create_publisher<geometry_msgs::msg::Twist>("dead", 10); */
#if 0
  auto dead2 = node->create_publisher<geometry_msgs::msg::Twist>("dead2", 10);
#endif
  while (rclcpp::ok()) { pub->publish(m); rclcpp::spin_some(node); rate.sleep(); }
}
