#include <nodelet/nodelet.h>
#include <pluginlib/class_list_macros.h>

namespace old {
class Safety : public nodelet::Nodelet {
  void onInit() override {
    ros::NodeHandle& nh = getNodeHandle();
    laser_ = nh.subscribe("scan", 1, &Safety::see, this);
    stop_ = nh.advertise<std_msgs::Bool>("stop", 1);
    again_ = nh.createTimer(ros::Duration(0.25), [this](const ros::TimerEvent&) { tell(); });
  }
  void see(const sensor_msgs::LaserScan::ConstPtr& scan) {}
  void tell() { stop_.publish(std_msgs::Bool()); }
};
}  // namespace old
PLUGINLIB_EXPORT_CLASS(old::Safety, nodelet::Nodelet)
