#include "cell/driver.hpp"
using namespace std::chrono_literals;
using std::placeholders::_1;
namespace cell {
Driver::Driver(const rclcpp::NodeOptions & options) : Node("driver", options)
{
  const auto qos = rclcpp::SensorDataQoS();
  odom_pub_ = create_publisher<nav_msgs::msg::Odometry>(topics::ODOM, rclcpp::QoS(10).reliable());
  cmd_pub_ = this->create_publisher<Twist>(cmd_topic_, 10);
  auto p1 = create_publisher<Twist>(topics::CMD, 10);
  auto p2 = create_publisher<sensor_msgs::msg::BatteryState>(BATTERY_TOPIC, 1);
  std::string prefix = declare_parameter<std::string>("prefix", "front");
  auto p3 = create_publisher<sensor_msgs::msg::Imu>(prefix + "/imu", 1);
  auto imu_topic = declare_parameter("imu_topic", std::string("imu/raw"));
  auto s1 = create_subscription<sensor_msgs::msg::Imu>(imu_topic, qos, std::bind(&Driver::imu, this, _1));
  this->declare_parameter<std::string>("scan_topic", "scan");
  std::string scan_topic;
  this->get_parameter("scan_topic", scan_topic);
  auto s2 = create_subscription<sensor_msgs::msg::LaserScan>(scan_topic, qos, [this](const sensor_msgs::msg::LaserScan::ConstSharedPtr msg) { (void)msg; });
  auto s3 = create_subscription<std_msgs::msg::Bool>(get_parameter("estop_topic").as_string(), 1, [this](std_msgs::msg::Bool::UniquePtr m) {});
  for (const auto & side : {"left", "right"}) {
    pubs_.push_back(create_publisher<std_msgs::msg::Float64>(std::string("wheel/") + side, 1));
  }
  for (size_t i = 0; i < 2; ++i) {
    subs_.push_back(create_subscription<std_msgs::msg::Int32>("enc" + std::to_string(i), 1, cb));
  }
  auto s4 = rclcpp::create_subscription<std_msgs::msg::String>(this, "free_fn", 1, cb);
  auto s5 = rclcpp::create_publisher<std_msgs::msg::String>(*this, "free_pub", 1);
  timer_ = create_wall_timer(20ms, [this]() { loop(); });
  timer2_ = rclcpp::create_timer(this, get_clock(), rclcpp::Duration::from_seconds(0.1), std::bind(&Driver::slow, this));
  it_pub_ = image_transport::create_publisher(this, "camera/image");
  cam_pub_ = image_transport::create_camera_publisher(this, "arm/image_raw");
  it_sub_ = image_transport::create_subscription(this, "camera/in", cb, "raw");
  sync_a_.subscribe(this, "sync/left", rmw_qos_profile_sensor_data);
  sync_b_ = std::make_shared<message_filters::Subscriber<sensor_msgs::msg::Image>>(this, "sync/right");
  rt_pub_ = std::make_shared<realtime_tools::RealtimePublisher<Twist>>(p1);
}
void Driver::loop() { odom_pub_->publish(nav_msgs::msg::Odometry()); }
void Driver::slow() { cmd_pub_->publish(Twist()); }
}
