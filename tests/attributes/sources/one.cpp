// @module_start
// @module_name Cpp
// @Tag safety_critical
// @Property latency_ms 1
// @Sense NotifyWhenReady
Image cpp();
// @module_end
