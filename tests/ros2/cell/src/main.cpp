#include "cell/driver.hpp"
int main(int argc, char ** argv) { rclcpp::init(argc, argv); rclcpp::spin(std::make_shared<cell::Driver>()); return 0; }
