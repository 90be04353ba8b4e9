/**
 * @module_start
 * @module_name Camera
 */

/* @Sense NotifyAtFrequency 25 -- what the device does by itself
 */
Image grab();
// @module_end
