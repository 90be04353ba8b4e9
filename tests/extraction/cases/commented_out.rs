//! @module_start
/// @module_name Gps
/// @Sense NotifyAtFrequency 5
fn read() -> Fix { todo!() }
// @module_end

/* Block comments nest, so this one was put around all of it.
/* @module_start
   @module_name Compass */
/// @Sense NotifyAtFrequency 5
fn turn() -> Heading { todo!() }
/* @module_end */
*/

// /// @module_start
/* // @module_start */
