/**
 * @module_start
 * @module_name Java
 * @Tag safety_critical
 * @Property latency_ms 0.004 s
 * @Sense NotifyWhenReady
 */
public Image java() { return null; } // @module_end
