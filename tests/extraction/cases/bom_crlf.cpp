// @module_start
// @module_name A
/* @Sense NotifyAtFrequency
 */
X f(
  Y y);
/*
	* @DataOut NotifyWhenReady 5
 */
X g(Y y);
// @module_end
