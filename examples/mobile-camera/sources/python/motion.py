"""What moves, and the joysticks that say how."""

from dataclasses import dataclass


@dataclass(frozen=True)
class MotionData:
    """Degrees or mm per second for each motion function that is commanded."""

    rotn_x: float = 0
    rotn_y: float = 0
    trans_z: float = 0


# @module_start
# @module_name PanTiltHead
# @Rotn_Y -170 170 120
# @Rotn_X  -60  60  60
def look(motion: MotionData) -> None: ...
# @module_end


# @module_start
# @module_name MobilePlatform
# @Rotn_Y
# @Trans_Z _ _ 800 -- as fast as it brakes within its own length
def drive(motion: MotionData) -> None: ...
# @module_end


class Joystick:
    """An operator's stick: how far it is pushed to the right and forward, from -1 to 1."""

    def __init__(self) -> None:
        self.right = self.forward = 0.0


head, platform = Joystick(), Joystick()


# @module_start
# @module_name OperatorJoystick1
# @ControlOut
def look_around() -> MotionData:
    """Turn the head as fast as the stick is pushed."""
    return MotionData(rotn_x=60 * head.forward, rotn_y=120 * head.right)
# @module_end


# @module_start
# @module_name OperatorJoystick2
# @ControlOut
def drive_around() -> MotionData:
    return MotionData(rotn_y=90 * platform.right, trans_z=800 * platform.forward)
# @module_end
