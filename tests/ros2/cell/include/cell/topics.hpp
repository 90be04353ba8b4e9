#pragma once
#include <string>
namespace cell { namespace topics {
constexpr char CMD[] = "cmd_out";
constexpr const char * ODOM = "odom_c";
inline const std::string IMU = "imu_c";
static constexpr auto SCAN = "scan_c";
#define BATTERY_TOPIC "battery_c"
}}
