/// What moves, and the joysticks that say how.
#pragma once

/// Degrees or mm per second for each motion function that is commanded.
struct MotionData {
    double rotnX = 0;
    double rotnY = 0;
    double transZ = 0;
};

/* @module_start
 * @module_name PanTiltHead
 * @Rotn_Y -170 170 120
 * @Rotn_X  -60  60  60
 */
void look(const MotionData &motion);
/* @module_end */

/* @module_start
 * @module_name MobilePlatform
 * @Rotn_Y
 * @Trans_Z _ _ 800 -- as fast as it brakes within its own length
 */
void drive(const MotionData &motion);
/* @module_end */

namespace head {

// @module_start
// @module_name OperatorJoystick1
// @ControlOut
MotionData polljoystick(void);
// @module_end

}  // namespace head

namespace platform {

// @module_start
// @module_name OperatorJoystick2
// @ControlOut
MotionData polljoystick(void);
// @module_end

}  // namespace platform
