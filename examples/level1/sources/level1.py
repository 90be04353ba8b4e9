"""Figure 21: wander about, in the place of Brooks' level 1."""

from random import Random

#: The seed of the run; the executor puts its own here.
SEED = globals().get("SEED", 0)
_random = Random(f"{SEED}/wander")
_left = [0, 0.0]


# @module_start
# @module_name Wander
# @ControlOut
def wander() -> tuple[str, float]:
    """Turn for up to two seconds at random, then drive for five."""
    if _left[0] <= 0:
        _left[0], _left[1] = 70, _random.uniform(-60, 60)
    _left[0] -= 1
    if _left[0] >= 50:
        return "Rotn_Y", _left[1]
    return "Trans_Z", 200.0
# @module_end
