/* @module_end */
/* @module_name Alone */
/* @Sense NotifyWhenReady */
X f(void);
/* @module_end */
/* @module_start */
/* @module_name A */
/* @DataIn */
void show(X x);
/* @module_end */
/* @Rotn_Y -90 90 */
/* @rotn_x -90 90 */
/* @sense of humour */
/* @sense NotifyWhenReady */
