/* @module_start
 * @module_name C
 * @Tag safety_critical
 * @Property latency_ms 2 ms
 * @Sense NotifyWhenReady
 */
struct image c(void);
/* @module_end */
