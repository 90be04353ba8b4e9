"""Commands for a carried module, shared out to the motions that carry it.

The algebra is that of the facts: twists of `kinematics.frames`, shares of `kinematics.supports`.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mars_asp.kinematics.frames import (
    Joint,
    KinematicTree,
    Matrix,
    Posture,
    generic_posture,
    jacobian,
    take_posture,
)
from mars_asp.kinematics.supports import columns_with_share, fewest_groups, spanned
from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS, TAKING

#: From motion function to what it is commanded for one unit of a function of the module.
Shares = Mapping[str, float]
_SEED = 1


class Carrying:
    """How the motions of some modules, its carriers, move one module.

    `position` returns the present values of a module's motions in degrees and mm; missing ones are
    at rest.
    """

    def __init__(
        self,
        robot: KinematicTree,
        name: str,
        carriers: Sequence[str],
        position: Callable[[str], Mapping[str, float]],
    ) -> None:
        self.robot, self.name, self.carriers, self.position = robot, name, carriers, position
        self.rest = take_posture(robot)
        self.generic = generic_posture(robot, _SEED)
        self._supports: dict[str, tuple[Joint, ...]] = {}

    def alone(self, carrier: str, function: str) -> Shares:
        """Return the motions of a carrier that alone give a function at rest, with shares.

        The result is {} if they cannot. Of rotations only the angular part counts: they may move
        the module along an arc.
        """
        if function == GRASP:
            return {}
        joints = self.robot.joints[carrier]
        index = MOTION_FUNCTIONS.index(function)
        columns = jacobian(self.rest, self.name, [carrier])[: 3 if index < 3 else 6]
        return _shares(joints, columns, index)

    def shares(self, function: str, allocation: str | None) -> list[tuple[str, str, float]]:
        """Return the shares in one unit of a function: each a carrier, native function and rate.

        Of the carriers that can perform the function alone, the nearest does, with the allocation
        `root` the farthest, with `split` each an equal share. If none can, the joints of a minimal
        support share it at the present posture.
        """
        able = [(name, alone) for name in self.carriers if (alone := self.alone(name, function))]
        taking = able[TAKING[allocation]]
        if not taking:
            together = self.together(function)
            return [(joint.module, joint.function, share) for joint, share in together.items()]
        return [
            (name, native, share / len(taking))
            for name, alone in taking
            for native, share in alone.items()
        ]

    def anyone(self, function: str) -> bool:
        """Whether some carrier alone can give a function at rest."""
        return any(self.alone(carrier, function) for carrier in self.carriers)

    def together(self, function: str) -> dict[Joint, float]:
        """Return the joints that together give a function at the present posture, with their rates.

        Rates are in degrees or mm for each degree or mm of the function. The result is empty
        without a support, or if the posture is singular.
        """
        joints = self.support(function)
        if not joints:
            return {}
        values = {
            joint: found
            for name in self.robot.order
            for joint in self.robot.joints[name]
            if (found := self.position(name).get(joint.function)) is not None
        }
        present = take_posture(self.robot, values)
        index = MOTION_FUNCTIONS.index(function)
        columns = self._columns(present, joints)
        if not spanned(columns)[index]:
            return {}
        unit = np.eye(6)[index]
        lengths = np.linalg.norm(columns, axis=0)
        answer = np.linalg.lstsq(columns / lengths, unit, rcond=None)[0] / lengths
        turns = function.startswith("Rotn")
        return {
            joint: float(share) * _in_degrees(joint.function, turns)
            for joint, share in zip(joints, answer, strict=True)
        }

    def support(self, function: str) -> tuple[Joint, ...]:
        """Return the joints of the fewest carriers that together give a function, () if none do.

        Of several such sets it is the one whose carriers are nearest to this module.
        """
        if function == GRASP:
            return ()
        if function not in self._supports:
            index = MOTION_FUNCTIONS.index(function)
            groups = [jacobian(self.generic, self.name, [carrier]) for carrier in self.carriers]
            sets = fewest_groups(groups, [index]).get(index, [])
            above = self.robot.ancestors(self.name)
            named = [[self.carriers[place] for place in found] for found in sets]
            least = min(
                named, key=lambda s: (sum(above.index(b) for b in s), sorted(s)), default=[]
            )
            joints = [joint for carrier in least for joint in self.robot.joints[carrier]]
            columns = jacobian(self.generic, self.name, least)
            chosen = columns_with_share(columns, index)
            self._supports[function] = tuple(joints[place] for place in chosen)
        return self._supports[function]

    def _columns(self, posture: Posture, joints: Sequence[Joint]) -> Matrix:
        """Return the twists (6xk) of joints in the module's frame."""
        return np.hstack(
            [
                jacobian(posture, self.name, [joint.module])[
                    :, [self.robot.joints[joint.module].index(joint)]
                ]
                for joint in joints
            ]
        )


def _shares(joints: Sequence[Joint], columns: Matrix, index: int) -> Shares:
    chosen = list(columns_with_share(columns, index))
    if not chosen:
        return {}
    unit = np.eye(columns.shape[0])[index]
    answer = np.linalg.lstsq(columns[:, chosen], unit, rcond=None)[0]
    return {
        joints[place].function: float(share) for place, share in zip(chosen, answer, strict=True)
    }


def _in_degrees(function: str, turns: bool) -> float:
    """Return the factor for a share if one of joint and function turns and the other does not."""
    turned = function.startswith("Rotn")
    if turned == turns:
        return 1.0
    return float(np.degrees(1.0)) if turned else float(np.radians(1.0))
