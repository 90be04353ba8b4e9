// @module_start
// @module_name Go
// @Tag safety_critical
// @Property latency_ms 6
// @Sense NotifyWhenReady
func Go() Image { return Image{} }

// @module_end
