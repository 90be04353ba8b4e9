"""Frames of mounted modules: exact quarter turns, chains, twists, Jacobians and their ranks.

Lengths are mm and angles degrees, as in the language. A pose is a 4x4 matrix that takes
coordinates of a module's frame to those of another. A twist is a column of six: the angular part
in radians, then the velocity of the frame's origin in mm (Lynch and Park, Modern Robotics, 3.3).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from mars_asp.model.declarations import MOTION_FUNCTIONS, Module, Mount, Transformation

Matrix: TypeAlias = NDArray[np.float64]

#: Below the microdegree that rules know, above what a thousand products of floats lose.
TOLERANCE = 1e-9
_QUARTERS = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
_AXES = {"x": 0, "y": 1, "z": 2}
_EYE = np.eye(4)


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint of a chain: the motion function `function` of `module`."""

    module: str
    function: str


@dataclass(frozen=True, slots=True)
class KinematicTree:
    """Mounted modules, each after its carrier in `order`.

    `carrier` maps a module to the one that it is mounted on, without the roots. `placement` is a
    module's pose in its carrier at rest, `joints` its motion functions in declared order: the
    first acts nearest to the carrier.
    """

    order: tuple[str, ...]
    carrier: Mapping[str, str]
    placement: Mapping[str, Matrix]
    joints: Mapping[str, tuple[Joint, ...]]

    def ancestors(self, name: str) -> tuple[str, ...]:
        """Return the modules that carry a module, nearest first."""
        found = []
        while name in self.carrier:
            name = self.carrier[name]
            found.append(name)
        return tuple(found)


@dataclass(frozen=True, slots=True)
class Posture:
    """A robot with values for its joints.

    `poses` are modules in the frame of their root, own joints at zero; `columns` the unit twists
    of a module's joints as 6xk, in the frame of the root and at these values.
    """

    poses: Mapping[str, Matrix]
    columns: Mapping[str, Matrix]


def rotation(axis: str, degrees: Decimal | float) -> Matrix:
    """Return the 3x3 rotation about `x`, `y` or `z`, exact where it is a quarter turn."""
    first, second = (_AXES[axis] + 1) % 3, (_AXES[axis] + 2) % 3
    turn = degrees % 360
    if turn % 90 == 0:
        cosine, sine = _QUARTERS[int(turn // 90) % 4]
    else:
        cosine, sine = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = cosine
    matrix[first, second], matrix[second, first] = 0.0 - sine, sine
    return matrix


def transformation_matrix(transformation: Transformation | None) -> Matrix:
    """Return the 4x4 matrix of a tuple: its rotations in order about fixed axes, then its shift."""
    matrix = _EYE.copy()
    if transformation is None:
        return matrix
    for axis, degrees in transformation.rotations:
        matrix[:3, :3] = rotation(axis, degrees) @ matrix[:3, :3]
    matrix[:3, 3] = [float(length) for length in transformation.translation]
    return matrix + 0.0  # turns -0.0 into 0.0


def inverse(pose: Matrix) -> Matrix:
    """Return the inverse of a 4x4 pose; exact where the rotation is."""
    matrix = _EYE.copy()
    matrix[:3, :3] = pose[:3, :3].T
    matrix[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return matrix + 0.0


def mount_matrix(mount: Mount, modules: Mapping[str, Module]) -> Matrix:
    """Return the 4x4 pose of the mounting module in the mounted one.

    The transformation of the mount leads from the vertex of the mounted module to that of the
    mounting one; an undeclared vertex is the module's own frame.
    """
    at = _vertex(modules.get(mount.mounting), mount.mounting_vertex)
    on = _vertex(modules.get(mount.mounted), mount.mounted_vertex)
    return on @ transformation_matrix(mount.transformation) @ inverse(at) + 0.0


def build_robot(mounts: Sequence[Mount], modules: Mapping[str, Module]) -> KinematicTree:
    """Return the tree of modules that mounts connect; the first mount of a module counts.

    Modules that a cycle of mounts carries have no root and are left out.
    """
    mount_of: dict[str, Mount] = {}
    carries: dict[str, list[str]] = {}
    for mount in mounts:
        if mount.mounting not in mount_of:
            mount_of[mount.mounting] = mount
            carries.setdefault(mount.mounted, []).append(mount.mounting)
    order = [name for name in carries if name not in mount_of]
    for name in order:  # grows while it is read: breadth first
        order += carries.get(name, ())
    mounted = [name for name in order if name in mount_of]
    return KinematicTree(
        tuple(order),
        {name: mount_of[name].mounted for name in mounted},
        {name: mount_matrix(mount_of[name], modules) for name in mounted},
        {name: _joints(modules.get(name)) for name in order},
    )


def motion(function: str, value: float) -> Matrix:
    """Return the 4x4 motion of a function such as `Rotn_Y` by degrees or mm."""
    matrix = _EYE.copy()
    kind, axis = function.split("_")
    if kind == "Rotn":
        matrix[:3, :3] = rotation(axis.lower(), value)
    else:
        matrix[_AXES[axis.lower()], 3] = value
    return matrix


def unit_twist(function: str) -> Matrix:
    """Return the twist (6,) of a motion function in its own frame, one radian or mm."""
    twist = np.zeros(6)
    twist[MOTION_FUNCTIONS.index(function)] = 1.0
    return twist


def adjoint(pose: Matrix) -> Matrix:
    """Return the 6x6 matrix that transforms twists by a pose (Lynch and Park, 3.20)."""
    x, y, z = pose[:3, 3]
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    matrix = np.zeros((6, 6))
    matrix[:3, :3] = matrix[3:, 3:] = pose[:3, :3]
    matrix[3:, :3] = cross @ pose[:3, :3]
    return matrix + 0.0


def take_posture(robot: KinematicTree, values: Mapping[Joint, float] | None = None) -> Posture:
    """Return the forward kinematics of a robot; joints without a value, in degrees or mm, rest."""
    values = values or {}
    poses: dict[str, Matrix] = {}
    moved: dict[str, Matrix] = {}
    columns: dict[str, Matrix] = {}
    for name in robot.order:
        carrier = robot.carrier.get(name)
        pose = _EYE if carrier is None else moved[carrier] @ robot.placement[name] + 0.0
        poses[name] = pose
        twists = []
        for joint in robot.joints[name]:
            twists.append(adjoint(pose) @ unit_twist(joint.function))
            if joint in values:
                pose = pose @ motion(joint.function, values[joint]) + 0.0
        moved[name] = pose
        columns[name] = np.array(twists).T if twists else np.empty((6, 0))
    return Posture(poses, columns)


def generic_posture(robot: KinematicTree, seed: int) -> Posture:
    """Return a posture with random joint values: degrees within a turn, mm within 100."""
    generator = np.random.default_rng(seed)
    joints = [joint for name in robot.order for joint in robot.joints[name]]
    drawn = generator.uniform(-1.0, 1.0, len(joints))
    return take_posture(
        robot,
        {
            joint: float(value) * (180.0 if joint.function.startswith("Rotn") else 100.0)
            for joint, value in zip(joints, drawn, strict=True)
        },
    )


def jacobian(posture: Posture, name: str, providers: Sequence[str]) -> Matrix:
    """Return the twists (6xk) of the providers' joints in the frame of module `name`."""
    if not providers:
        return np.empty((6, 0))
    columns = np.hstack([posture.columns[provider] for provider in providers])
    twists: Matrix = adjoint(inverse(posture.poses[name])) @ columns + 0.0
    return twists


def scaled(columns: Matrix) -> Matrix:
    """Return columns (nxk) scaled to length one; lengths are in units of the longest lever arm.

    Directions stay; columns of zeros stay zero.
    """
    found: Matrix = columns.copy()
    turning = np.abs(found[:3]).max(axis=0) > TOLERANCE
    arms = np.abs(found[3:, turning])
    found[3:] /= max(1.0, float(arms.max())) if arms.size else 1.0
    lengths = np.linalg.norm(found, axis=0)
    found /= np.where(lengths > TOLERANCE, lengths, 1.0)
    return found


def _vertex(module: Module | None, number: int | None) -> Matrix:
    for vertex in module.vertices if module else ():
        if vertex.number == (number or 0):
            return transformation_matrix(vertex.transformation)
    return _EYE


def _joints(module: Module | None) -> tuple[Joint, ...]:
    functions = module.functions if module else ()
    names = dict.fromkeys(f.name for f in functions if f.name in MOTION_FUNCTIONS)
    return tuple(Joint(module.name, name) for name in names) if module else ()
