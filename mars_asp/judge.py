"""What a run was like, as facts, and the requirements that `rules/run` judges by them."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from mars_asp.analysis import analyse
from mars_asp.atom import Atom, Fact, Term
from mars_asp.execute.arbitration import HierarchicalArbitration
from mars_asp.execute.schedule import MILLISECOND, last_tick
from mars_asp.rulebook import Rulebook, load_rulebook
from mars_asp.source import Span
from mars_asp.trial import Trial

#: Requirement and the kind of consequence that says it was violated.
ALWAYS = {
    "services delivered": "undelivered_service",
    "one controller at a time": "shared_control",
    "priorities respected": "priority_breach",
    "commands within limits": "limit_breach",
}
ON_REQUEST = {
    "no_collision": "collision",
    "clearance": "clearance",
    "reach": "reach",
    "exclusive": "exclusive",
    "coverage": "coverage",
}
_MOST = 2**31 - 1


@dataclass(frozen=True, slots=True)
class Requirement:
    """A requirement, whether it held, and if not, why."""

    name: str
    holds: bool
    message: str


def run_rulebook() -> Rulebook:
    """Return the rules that judge a run, and no others."""
    every = load_rulebook(stages=("run",))
    rules = tuple(replace(rule, stage="base") for rule in every.rules if rule.stage == "run")
    return Rulebook(rules, tuple(("base", text) for stage, text in every.texts if stage == "run"))


def judge(trial: Trial, rulebook: Rulebook | None = None) -> tuple[Requirement, ...]:
    """Return every requirement with its verdict, those that always apply first."""
    span = trial.scenario.span
    facts = [Fact(atom, span) for atom in run_atoms(trial)]
    return judge_facts(facts, tuple(_asked(trial)), rulebook or run_rulebook(), span)


def judge_facts(
    facts: Iterable[Fact], asked: Sequence[str], rulebook: Rulebook, span: Span
) -> tuple[Requirement, ...]:
    """Judge facts of a run; `asked` are the requirements of the scenario."""
    found = analyse(facts, rulebook, span).consequences
    named = {**ALWAYS, **{name: ON_REQUEST[name] for name in asked}}
    return tuple(
        Requirement(name, not why, "; ".join(why[:3]) + (" ..." if len(why) > 3 else ""))
        for name, kind in named.items()
        for why in [[c.message for c in found if c.kind == kind]]
    )


def run_atoms(trial: Trial) -> Iterator[Atom]:
    """Yield what `rules/run` is given about a run."""
    yield from _services(trial)
    yield from _control(trial)
    yield from _limits(trial)
    body, asked = trial.body, trial.scenario.requirements
    yield from (_atom("asked", Atom(name)) for name in _asked(trial))
    yield from (_atom("collided", round(at * 1000)) for at in body.contacts)
    if "clearance" in asked:
        yield _atom("clearance", _whole(body.clearance * 1000), _whole(asked["clearance"] * 1000))
    if "reach" in asked and trial.reached is None:
        within = asked["reach"].get("within", trial.scenario.duration)
        yield _atom("never_reached", _whole(within * 1000))
    for first, second in asked.get("exclusive", ()):
        yield _atom("together", first, second, _whole(trial.together(first, second) * 1000))
    if "coverage" in asked:
        yield _atom("coverage", _whole(trial.coverage * 1000), _whole(asked["coverage"] * 1000))


def _asked(trial: Trial) -> Iterator[str]:
    return (name for name, value in trial.scenario.requirements.items() if value is not False)


def _services(trial: Trial) -> Iterator[Atom]:
    plan = trial.executor.plan
    for number, link in enumerate(trial.executor.links):
        if link.kind != "data":
            continue
        mode, hz = plan.carried(link)
        yield _atom("delivered", number, link.delivered)
        if mode.name == "NotifyAtFrequency" and hz is not None:
            count = last_tick(trial.executor.schedule.now, hz) + 1
            yield _atom("promised", number, link.source, link.client, count)


def _control(trial: Trial) -> Iterator[Atom]:
    plan, now = trial.executor.plan, trial.executor.schedule.now
    for link in trial.executor.links:
        if link.kind == "control" and link.delivered and link.client in trial.executor.effectors:
            yield _atom("commanded_by", link.client, link.source)
        if link.client in trial.executor.arbiters and link.kind == "control":
            yield _atom("ranked", link.client, link.source, link.priority)
    for name, arbiter in trial.executor.arbiters.items():
        if not isinstance(arbiter, HierarchicalArbitration):
            continue
        changes = [(h.since, h.through) for h in arbiter.holdings] + [(now, "")]
        for (since, holder), (until, _) in pairwise(changes):
            if holder and until > since:
                yield _atom("held", name, holder, since // MILLISECOND, until // MILLISECOND)
        for link in plan.control_in[name]:
            own = [(f.since, f.until) for f in arbiter.forces if f.controller == link.source]
            for since, until in _merged(own):
                yield _atom(
                    "in_force", name, link.source, since // MILLISECOND, until // MILLISECOND
                )


def _merged(stretches: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Join a controller's stretches of time; a later message replaces the one before."""
    joined: list[tuple[int, int]] = []
    for since, until in sorted(stretches):
        if joined and since <= joined[-1][1]:
            joined[-1] = joined[-1][0], until
        else:
            joined.append((since, until))
    return joined


def _limits(trial: Trial) -> Iterator[Atom]:
    for name, effector in trial.executor.effectors.items():
        peaks: dict[str, float] = {}
        for _, _, command in effector.applied:
            for function, rate in command.items():
                peaks[function] = max(peaks.get(function, 0.0), abs(rate))
        for function, rate in peaks.items():
            yield _atom("peak", name, function, _whole(rate * 1000))
        for function, rate in trial.limits.get(name, {}).items():
            yield _atom("limit", name, function, _whole(rate * 1000))


def _whole(number: float) -> int:
    """Round to what clingo can hold: beyond 32 bits the greatest stands for more."""
    return int(max(-_MOST, min(_MOST, round(number) if abs(number) < _MOST else number)))


def _atom(name: str, *arguments: Term) -> Atom:
    return Atom(name, arguments)
