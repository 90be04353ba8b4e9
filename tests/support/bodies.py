"""Robots without a scenario."""

from typing import Any

from mars_asp.execution.simulator import Body, Fleet, Pose, World


def alone(world: World, pose: Pose, radius: float, **settings: Any) -> Body:
    """Return a robot that moves among no others."""
    (body,) = Fleet([Body(world, pose, radius, **settings)]).bodies
    return body
