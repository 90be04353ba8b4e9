// @module_start
// @module_name A
// @DataOut RequestWhenReady
void fill(const Scan & s, Map & out);
// @DataOut RequestWhenReady
rclcpp::Status read(Map * out);
// @DataOut RequestWhenReady
bool is_free(const Scan & s);
// @DataOut RequestWhenReady
auto guess(auto x, void * y, const auto & z);
// @DataOut RequestWhenReady
std::chrono::time_point<Clock> when(std::chrono::duration<double> d, rclcpp::Time t);
// @ControlOut
void nothing();
// @module_end
