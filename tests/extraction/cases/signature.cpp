// @module_start
// @module_name A
// @DataOut RequestWhenReady
// @Signature Map build(const Scan & s, Imu i)
BUILDER(build, Map) { return {}; }
// @DataOut RequestWhenReady
// @Signature start_all(3);
X f();
// @Signature Map build(Scan s)
// @module_end
