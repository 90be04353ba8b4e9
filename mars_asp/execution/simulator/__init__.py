"""A planar kinematic simulator; knows nothing of ASP. Lengths in mm, angles in degrees.

The plane is seen from above: `forward` and `side` coordinates, a heading that grows from forward
towards side, which is to the left. With y up these are z and x, with z up x and y
(`planar_functions`).
"""

from mars_asp.execution.simulator.body import Body
from mars_asp.execution.simulator.devices import (
    JointDevice,
    bumper,
    joystick,
    lidar,
    marks,
    odometry,
    sonar,
)
from mars_asp.execution.simulator.fleet import Fleet
from mars_asp.execution.simulator.motion import MotionSegment, Pose, move
from mars_asp.execution.simulator.ramp import Ramp
from mars_asp.execution.simulator.world import Circle, Mark, World

__all__ = [
    "Body",
    "Circle",
    "Fleet",
    "JointDevice",
    "Mark",
    "MotionSegment",
    "Pose",
    "Ramp",
    "World",
    "bumper",
    "joystick",
    "lidar",
    "marks",
    "move",
    "odometry",
    "sonar",
]
