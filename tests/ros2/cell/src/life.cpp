#include "rclcpp_lifecycle/lifecycle_node.hpp"
namespace cell {
class Life : public rclcpp_lifecycle::LifecycleNode {
public:
  explicit Life(const rclcpp::NodeOptions & o) : rclcpp_lifecycle::LifecycleNode("life", o) {}
  CallbackReturn on_configure(const rclcpp_lifecycle::State &) override {
    pub_ = create_publisher<std_msgs::msg::String>("~/status", rclcpp::QoS{1}.transient_local());
    sub_ = this->create_subscription<geometry_msgs::msg::TwistStamped>("cmd_vel", rclcpp::SystemDefaultsQoS(), [](auto) {});
    return CallbackReturn::SUCCESS;
  }
  rclcpp_lifecycle::LifecyclePublisher<std_msgs::msg::String>::SharedPtr pub_;
};
}
RCLCPP_COMPONENTS_REGISTER_NODE(cell::Life)
