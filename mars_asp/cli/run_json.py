"""The result of a run as JSON, with the keys of the command line's contract."""

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mars_asp.execution.executor import Link
    from mars_asp.execution.executor.link import Failures
    from mars_asp.execution.judgement import Judgement
    from mars_asp.execution.scenario.read import ScenarioRobot
    from mars_asp.execution.simulator import Body
    from mars_asp.execution.trial import Trial


def run_json(trial: "Trial", judgement: "Judgement") -> dict[str, object]:
    """Return the result of a run as JSON, with the keys of the command line's contract."""
    executor, times = trial.executor, trial.control_time
    return {
        "verdict": judgement.verdict,
        "requirements": [
            {"name": r.name, "holds": r.holds, "message": r.message} for r in judgement.requirements
        ],
        "warnings": [
            {"kind": each.kind, "subject": each.subject, "message": each.message}
            for each in judgement.warnings
        ],
        "seconds": trial.scenario.duration,
        "seed": trial.scenario.seed,
        "events": executor.schedule.events,
        "messages": sum(link.delivered for link in executor.links),
        "collisions": trial.collisions,
        "min_clearance_mm": _millimetres(trial.clearance),
        # A controller that was never in control is listed with 0.
        "control_time": {
            name: round(times.get(name, 0.0), 6) for name in sorted({*times, *speakers(trial)})
        },
        "driven_mm": round(sum(body.driven for body in trial.bodies), 3),
        "turn_while_driving_s": round(sum(body.both for body in trial.bodies), 6),
        "robots": [_robot_json(trial, *each) for each in trial.robots],
        "links": links_json(trial),
        "control": [
            {"seconds": h.since / 1e9, "node": h.node, "holder": h.holder or None, "why": h.why}
            for arbiter in executor.arbiters.values()
            for h in arbiter.holdings
        ],
        "failures": [_failures_json(*each) for each in executor.failures.items()],
    }


def _millimetres(clearance: float) -> float | None:
    return round(clearance, 3) if clearance < float("inf") else None


def _robot_json(trial: "Trial", robot: "ScenarioRobot", body: "Body") -> dict[str, object]:
    reached = None if robot.reach is None else trial.reached(robot)
    missing = None if robot.reach is None else trial.nearest(robot)[0]
    return {
        "name": robot.name,
        "module": robot.module,
        "collisions": [
            {"seconds": at, "with": other or None}
            for at, other in zip(body.contacts, body.struck, strict=True)
        ],
        "min_clearance_mm": _millimetres(body.clearance),
        "nearest": body.beside or None,
        "reached_s": None if reached is None else round(reached, 6),
        "nearest_to_place_mm": None if missing is None else round(missing, 3),
        "control_time": {
            name: round(seconds, 6)
            for name, seconds in sorted(trial.times_in_control(robot).items())
        },
        "driven_mm": round(body.driven, 3),
        "turn_while_driving_s": round(body.both, 6),
    }


def links_json(trial: "Trial") -> list[dict[str, Any]]:
    """Return each link as JSON, with required and actual rate (Hz) and ages (ms)."""
    from mars_asp.execution.promises import promises

    rates = {each.number: each.hz for each in promises(trial)}
    now = trial.executor.schedule.now
    # Without lines of gates, resets, locks and limits, the kind is evident.
    sided = trial.executor.plan.sided
    return [
        ({"kind": link.kind} if sided else {})
        | _link_json(trial, link, rates.get(number, 1e9 * link.before(Fraction(now)) / now))
        for number, link in enumerate(trial.executor.links)
    ]


def _link_json(trial: "Trial", link: "Link", hz: float) -> dict[str, Any]:
    required = trial.executor.plan.carried(link)[1] if link.kind == "data" else None
    return {
        "source": link.source,
        "client": link.client,
        "asked_hz": None if required is None else float(required),
        "got_hz": round(hz, 6),
        "oldest_ms": link.oldest / 1e6,
        "delivered": link.delivered,
        "dropped": dict(link.dropped),
        "stale": link.stale,
        "faulty": link.faulty,
        "fault": link.fault or None,
    }


def _failures_json(name: str, failures: "Failures") -> dict[str, object]:
    from mars_asp.execution.judgement import raised_at

    path, line = raised_at(failures)
    first = {"first": failures.first, "path": path, "line": line, "seconds": failures.at / 1e9}
    return {"name": name, "count": failures.count, **first, "inputs": list(failures.inputs)}


def speakers(trial: "Trial") -> Iterator[str]:
    """Yield the controllers whose commands reach modules, once for each link from them."""
    plan = trial.executor.plan
    for link in trial.executor.links:
        after = [link]
        for each in after:  # the loop appends to it
            if each.kind in ("control", "suppress") and plan.is_node(each.client):
                after += (k for k in plan.control_out[each.client] if k not in after)
        if plan.kind(link.source) == "control_out" and any(
            each.kind == "control" and not plan.is_node(each.client) for each in after
        ):
            yield link.source
