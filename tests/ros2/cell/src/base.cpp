#include <rclcpp/rclcpp.hpp>
namespace cell {
template <typename MsgT> class Relay {
 public: Relay(rclcpp::Node * node, const std::string & in, const std::string & out) {
   pub_ = node->create_publisher<MsgT>(out, 1);
   sub_ = node->create_subscription<MsgT>(in, 1, [this](typename MsgT::SharedPtr m) { pub_->publish(*m); });
 }
};
class Base : public rclcpp::Node { public: Base(const rclcpp::NodeOptions & o) : rclcpp::Node("base_comp", o), pub_(create_publisher<std_msgs::msg::UInt8>("init_list", 1)) {
   relay_ = std::make_unique<Relay<std_msgs::msg::String>>(this, "r_in", "r_out"); } 
};
}
#include "rclcpp_components/register_node_macro.hpp"
RCLCPP_COMPONENTS_REGISTER_NODE(cell::Base)
