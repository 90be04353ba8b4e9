// The same in C.
/* @module_start
   @module_name Base
 * @Trans_Z
 */
void drive(double);
/** @module_end */

/* retired: the old pan unit
// @module_start
// @module_name Pan
 * // @Rotn_Y -90 90 60
 * * @Rotn_X
void pan(double);
//! @module_end
*/

/* // @module_start */
// // @module_start
/// // @module_start
// * @module_start
/* /* @module_start */

/* @module_start
   @module_name Bumper */
/* @Sense NotifyWhenReady,
 * NotifyOnChange */
Contact touched();
/*
@module_end
*/
