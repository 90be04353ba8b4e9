"""Builders of mounted modules and random chains for the tests of frames and motions."""

import random
from collections.abc import Sequence
from decimal import Decimal

from mars_asp.diagnostic import point
from mars_asp.model.declarations import (
    MOTION_FUNCTIONS,
    Configuration,
    Function,
    Module,
    Mount,
    Name,
    Service,
    Transformation,
    Vertex,
)

HERE = point("robot.mars", 1, 1)
RIGHT_ANGLES = (-270, -180, -90, 0, 90, 180, 270, 360, 450)


def placed(rotations: Sequence[tuple[str, object]] = (), *shift: object) -> Transformation:
    turns = tuple((axis, Decimal(str(degrees))) for axis, degrees in rotations)
    x, y, z = (Decimal(str(length)) for length in (shift or (0, 0, 0)))
    return Transformation(turns, (x, y, z))


def module(name: str, *functions: str, sensor: bool = False, **vertices: Transformation) -> Module:
    return Module(
        name,
        HERE,
        (Service("Sense", HERE),) if sensor else (),
        tuple(Function(function, HERE) for function in functions),
        tuple(Vertex(int(number[1:]), at, HERE) for number, at in vertices.items()),
    )


def robot(mounts: Sequence[Mount], modules: Sequence[Module]) -> Configuration:
    names = dict.fromkeys(name for mount in mounts for name in (mount.mounting, mount.mounted))
    return Configuration(
        "robot.mars",
        HERE,
        modules=tuple(Name(name, HERE) for name in names),
        relationships=tuple(mounts),
        declared=tuple(modules),
    )


def random_placement(random_: random.Random, oblique: bool) -> Transformation:
    turns = [
        (
            random_.choice("xyz"),
            random_.uniform(-180, 180) if oblique else random_.choice(RIGHT_ANGLES),
        )
        for _ in range(random_.randrange(3))
    ]
    return placed(turns, *(random_.choice((0, 0, 50, -120, 300)) for _ in range(3)))


def random_chain(random_: random.Random, prefix: str = "M", oblique: float = 0.3) -> Configuration:
    """Return a sensor `M0` on up to eight modules with random functions, mounts and vertices.

    `oblique` is the share of mounts at other than right angles.
    """
    depth = random_.randint(1, 8)
    modules = [module(f"{prefix}0", sensor=True)]
    mounts = []
    for level in range(1, depth + 1):
        functions = random_.sample(MOTION_FUNCTIONS, random_.choice((0, 1, 1, 1, 2, 3)))
        vertex = random_placement(random_, False)
        modules.append(module(f"{prefix}{level}", *functions, v1=vertex))
        at = random_placement(random_, random_.random() < oblique)
        on = random_.choice((None, 1))
        mounts.append(Mount(f"{prefix}{level - 1}", f"{prefix}{level}", HERE, None, on, at))
    return robot(mounts, modules)
