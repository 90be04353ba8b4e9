#if 0
// @module_start
// @module_name Dead
#else
// @module_start
#endif
// @module_name A
const char *s = "// @module_end"; char q = '"'; int million = 1'000'000;
const char *r = R"(
// @module_end
)";
/** @module_start: a list of things
 * @module_start(3) is a function
 * mail me @module_start.com
 * @Sense(NotifyWhenReady)
 * @DataOut : none
 */
/// @Sense NotifyWhenReady
//! @DataOut RequestWhenReady -- a second service
[[nodiscard]] inline ImageFormat grab() { return {}; } // @module_end
