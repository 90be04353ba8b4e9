// @module_start
// @module_name Rust
// @Tag safety_critical
// @Property latency_ms 5
// @Sense NotifyWhenReady
fn rust() -> Image {}
// @module_end
