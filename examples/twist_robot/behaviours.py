"""What the nodes of the robot do. A command names rates: mm/s to drive, degrees/s to turn."""

Ranges = list[float]
Bool = bool


# @module_start
# @module_name navigation
# @ControlOut Trans_Z, Rotn_Y
def navigate(ranges: Ranges) -> dict[str, float]:
    """Drive ahead, and turn while driving slower where something is near, as one twist."""
    ahead = min(ranges[0], ranges[1], ranges[-1])
    return {"Trans_Z": 200} if ahead > 900 else {"Trans_Z": 80, "Rotn_Y": 40}


# @module_end
# @module_start
# @module_name watchdog
# @Sense NotifyAtFrequency 10
def alive() -> Bool:
    """Report that nothing is wrong: the lock stays open as long as this comes."""
    return False


# @module_end
