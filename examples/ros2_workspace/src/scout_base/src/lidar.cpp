#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

namespace scout_base {

class Lidar : public rclcpp::Node {
 public:
  explicit Lidar(const rclcpp::NodeOptions& options) : Node("lidar", options) {
    scans_ = create_publisher<sensor_msgs::msg::LaserScan>("~/scan", 10);
    timer_ = create_wall_timer(std::chrono::milliseconds(100), std::bind(&Lidar::turn, this));
  }

 private:
  void turn() { scans_->publish(sensor_msgs::msg::LaserScan()); }
  rclcpp::Publisher<sensor_msgs::msg::LaserScan>::SharedPtr scans_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace scout_base

RCLCPP_COMPONENTS_REGISTER_NODE(scout_base::Lidar)
