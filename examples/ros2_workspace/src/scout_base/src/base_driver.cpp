#include <chrono>
#include <geometry_msgs/msg/twist.hpp>
#include <nav_msgs/msg/odometry.hpp>
#include <rclcpp/rclcpp.hpp>

using namespace std::chrono_literals;

// Drives the wheels and counts their turns.
class BaseDriver : public rclcpp::Node {
 public:
  BaseDriver() : Node("base_driver") {
    odometry_ = create_publisher<nav_msgs::msg::Odometry>("odom", 10);
    commands_ = create_subscription<geometry_msgs::msg::Twist>(
        "cmd_vel", 10, [this](geometry_msgs::msg::Twist::SharedPtr twist) { drive(*twist); });
    timer_ = create_wall_timer(20ms, [this]() { odometry_->publish(counted()); });
  }

 private:
  void drive(const geometry_msgs::msg::Twist& twist);
  nav_msgs::msg::Odometry counted() const;
  rclcpp::Publisher<nav_msgs::msg::Odometry>::SharedPtr odometry_;
  rclcpp::Subscription<geometry_msgs::msg::Twist>::SharedPtr commands_;
  rclcpp::TimerBase::SharedPtr timer_;
};
