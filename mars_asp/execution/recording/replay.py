"""The replay of a run as one HTML page, which fetches no other file."""

import json
from collections.abc import Iterator
from html import escape
from importlib.resources import files
from string import Template
from typing import Any

from mars_asp.draw.page import whole_page
from mars_asp.execution.executor.arbitration import HierarchicalArbitration
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.execution.judgement import Judgement
from mars_asp.execution.recording.frame import MARGIN
from mars_asp.execution.recording.picture import framed, plot_run
from mars_asp.execution.trial import Trial
from mars_asp.output import visible


def replay_page(trial: Trial, judgement: Judgement, title: str) -> str:
    """Return the replay as an HTML page that runs only its own script, whatever names it has."""
    body = Template(_part("html")).substitute(
        title=escape(visible(title)), picture=plot_run(trial, judgement)
    )
    run = json.dumps(replay_json(trial, judgement), separators=(",", ":"), allow_nan=False)
    return whole_page(title, _part("css"), body, _part("js"), {"run": run})


def _part(ending: str) -> str:
    part = files("mars_asp.execution.recording") / f"replay.{ending}"
    return part.read_text(encoding="utf-8")


def replay_json(trial: Trial, judgement: Judgement) -> dict[str, Any]:
    """Return the data of the page: times in seconds, lengths in mm, positions in pixels."""
    frame, world = framed(trial, judgement)[0], trial.bodies[0].world
    return {
        "duration": trial.scenario.duration,
        "view": {
            "corner": frame.corner,
            "scale": frame.scale,
            "left": MARGIN,
            "top": frame.ceiling,
        },
        "lanes": {
            "left": frame.left,
            "wide": frame.wide,
            "top": frame.top,
            "bottom": frame.bottom,
        },
        "robots": [
            {
                "called": robot.name if len(trial.bodies) > 1 else "The robot",
                "poses": [
                    [_rounded(at), *map(_rounded, (pose.forward, pose.side, pose.heading))]
                    for at, pose in body.way
                ],
                "contacts": body.contacts,
                "commands": [
                    [since, origin, command] for since, _, origin, command in trial.commands(robot)
                ],
            }
            for robot, body in trial.robots
        ],
        "moving": [{"round": c.round, "speed": c.speed} for c in world.moving],
        "arbiters": list(_arbiters(trial)),
    }


def _rounded(value: float) -> float:
    return round(value, 4)


def _arbiters(trial: Trial) -> Iterator[dict[str, Any]]:
    for name, arbiter in trial.executor.arbiters.items():
        if isinstance(arbiter, HierarchicalArbitration):
            holdings = [[h.since / SECOND, h.holder, h.through, h.why] for h in arbiter.holdings]
            inputs = [
                {
                    "name": link.source,
                    "priority": link.priority,
                    "in_force": [[since / SECOND, until / SECOND] for since, until in stretches],
                }
                for link, stretches in arbiter.in_force
            ]
            yield {"node": name, "holdings": holdings, "inputs": inputs}
        else:
            yield {"node": name, "period_ms": arbiter.period / MILLISECOND}
