"""The facts of a run, and the requirements that the rules of `rules/run` judge by them."""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import pairwise
from math import dist
from pathlib import Path
from typing import Any, Literal

from mars_asp.asp.rules.declarations import declarations
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Atom, Fact, fact_at
from mars_asp.asp.trace import Trace
from mars_asp.asp.units import measured
from mars_asp.diagnostic import Span
from mars_asp.execution.executor.arbitration import HierarchicalArbitration
from mars_asp.execution.executor.link import Failures
from mars_asp.execution.executor.schedule import MILLISECOND
from mars_asp.execution.gate_facts import gate_facts, reasons
from mars_asp.execution.observed import milliseconds, rounded, seen
from mars_asp.execution.promises import promises
from mars_asp.execution.scenario.read import ScenarioRobot
from mars_asp.execution.simulator.approach import least_approach
from mars_asp.execution.simulator.body import THING, Body
from mars_asp.execution.trial import Trial
from mars_asp.model.declarations import GRASP
from mars_asp.output import visible
from mars_asp.reasoning.analysis import Analysis, Consequence, analyse
from mars_asp.reasoning.attributes import AttributeKind
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.project import Project, project_facts, with_brought
from mars_asp.reasoning.rules import GIVEN_TO_RUNS, load_rulebook
from mars_asp.reasoning.session import Evidence

#: Requirements of all runs, each with the kind of consequence that violates it.
ALWAYS = {
    "services delivered": "undelivered_service",
    "one controller at a time": "shared_control",
    "priorities respected": "priority_breach",
    "commands within limits": "limit_breach",
    "commanded functions exist": "missing_function",
    "no module failed": "module_failure",
}
#: The requirement of runs with gate, lock, limit or reset lines, with the kind that violates it.
GATED = {"gates respected": "gate_breach"}
#: The kinds of consequences by which `reasons_of` explains a run.
REASONS = ("gate_passage", "gate_loss", "lock_stop")
ON_REQUEST = {
    "no_collision": "collision",
    "clearance": "clearance",
    "reach": "reach",
    "exclusive": "exclusive",
    "coverage": "coverage",
}
#: Requirements, each with the kind of consequence by which a run is too short to decide it.
UNDECIDED = {"services delivered": "undecided_service", "reach": "undecided_reach"}
#: Kinds of consequences that weaken the verdict of a run.
WARNINGS = ("module_never_ran", "input_never_came", "requirement_in_vain", "goal_in_obstacle")
#: The unit of a number of occurrences.
_TIMES = "times"
#: Maximal length of an exception's text in messages.
_LONGEST = 200


@dataclass(frozen=True, slots=True)
class Requirement:
    """A requirement with the findings that violate it, or that leave it undecided.

    `undecided` are findings that the run ended too early to decide it.
    """

    name: str
    violations: tuple[Consequence, ...]
    undecided: tuple[Consequence, ...] = ()

    @property
    def holds(self) -> bool | None:
        """Return whether the requirement holds, or None if the run ended too early."""
        return None if self.undecided and not self.violations else not self.violations

    @property
    def message(self) -> str:
        """Return at most three reasons why it was violated or not decided."""
        reasons = self.violations or self.undecided
        more = " ..." if len(reasons) > 3 else ""
        return "; ".join(c.message for c in reasons[:3]) + more


@dataclass(frozen=True)
class Judgement:
    """The requirements, those that always apply first, and the warnings of a run."""

    requirements: tuple[Requirement, ...]
    warnings: tuple[Consequence, ...]
    analysis: Analysis
    facts: tuple[Fact, ...]
    rulebook: Rulebook

    @property
    def verdict(self) -> Literal["pass", "fail", "not decided"]:
        """Return `fail` if a requirement was violated, `pass` if all requirements hold."""
        held = {requirement.holds for requirement in self.requirements}
        return "fail" if False in held else "not decided" if None in held else "pass"

    def traces(self) -> tuple[tuple[Consequence, Trace], ...]:
        """Return each violation and warning with its trace to lines of scenario and robot.

        Observed facts have a time, if any, instead of a line.
        """
        explainer = Evidence(self.rulebook, self.facts, self.analysis).explainer
        found = [c for requirement in self.requirements for c in requirement.violations]
        found += self.warnings
        traces = explainer.why(dict.fromkeys(c.atom for c in found))
        return tuple((c, traces[c.atom]) for c in found)


def run_rulebook(packs: Sequence[Path] = ()) -> Rulebook:
    """Return the rules that judge a run: built-in ones and those of packs.

    Raises:
        MarsError: a pack has errors.
    """
    every = load_rulebook(packs, stages=("run",))
    declared = _configuration_signatures(every)
    rules = tuple(replace(rule, stage="base") for rule in every.rules if rule.stage == "run")
    texts = tuple(("base", text) for stage, text in every.texts if stage == "run")
    texts += (("base", "".join(f"#defined {each}.\n" for each in sorted(declared))),)
    documented = tuple(
        file._replace(
            stage="base",
            docstrings=tuple(
                each
                for each in file.docstrings
                if file.stage == "run"
                or any(one.signature in declared for one in declarations((each,), file.path, []))
            ),
        )
        for file in every.documented
        if file.stage in ("base", "run")
    )
    return Rulebook(rules, texts, documented=documented, brought=every.brought)


def _configuration_signatures(rulebook: Rulebook) -> frozenset[Signature]:
    """Return the predicates of configuration facts that rules on runs may use."""
    kinds = (each for each in rulebook.brought if isinstance(each, AttributeKind))
    own = (each.declaration.signature._replace(name=each.predicate) for each in kinds)
    return frozenset((*GIVEN_TO_RUNS, *own))


def judge(trial: Trial, rulebook: Rulebook | None = None) -> Judgement:
    """Return the verdict on each requirement of a run, and its warnings."""
    rulebook = rulebook or run_rulebook()
    plan = trial.executor.plan
    project = with_brought(Project(plan.configuration, plan.modules, ()), rulebook.brought)
    wanted = frozenset(each.name for each in _configuration_signatures(rulebook))
    facts = (*run_facts(trial), *project_facts(project, wanted=wanted))
    requested = tuple(_judged_parts(trial))
    return judge_facts(facts, requested, rulebook, trial.scenario.span, plan.sided)


def judge_facts(
    facts: Iterable[Fact], requested: Sequence[str], rulebook: Rulebook, span: Span, sided: bool
) -> Judgement:
    """Return the judgement of facts of a run; `requested` are the scenario's requirements.

    The run is `sided` if it has lines to Gates, locks, limits or resets.
    """
    facts = tuple(facts)
    analysis = analyse(facts, rulebook, span)
    named = {**ALWAYS, **(GATED if sided else {}), **{name: ON_REQUEST[name] for name in requested}}
    # Each kind of consequence of a pack is a requirement with its name.
    built_in = {*ALWAYS.values(), *GATED.values(), *ON_REQUEST.values(), *UNDECIDED.values()}
    built_in |= {*WARNINGS, *REASONS}
    named |= {kind: kind for kind in sorted(consequence_kinds(rulebook) - built_in)}

    def found(kind: str | None) -> tuple[Consequence, ...]:
        return tuple(c for c in analysis.consequences if c.kind == kind)

    requirements = tuple(
        Requirement(name, found(kind), found(UNDECIDED.get(name))) for name, kind in named.items()
    )
    warnings = tuple(each for kind in WARNINGS for each in found(kind))
    return Judgement(requirements, warnings, analysis, facts, rulebook)


def reasons_of(trial: Trial, *, losses: bool) -> tuple[tuple[Consequence, Span], ...]:
    """Return explanations of what Gates let pass and locks stopped, or of losses, by time.

    Each reason has the location of the line that states it.
    """
    facts = (*gate_facts(trial), *reasons(trial, losses=losses))
    found = analyse(facts, run_rulebook(), trial.scenario.span).consequences
    timed: list[tuple[int, int, Consequence]] = []
    for consequence in found:
        if consequence.kind in REASONS:
            link, at, *_ = consequence.atom.arguments[3].arguments
            timed.append((at.number, link.number, consequence))
    timed.sort(key=lambda row: row[:2])
    return tuple((each, trial.executor.links[link].span) for _, link, each in timed)


def run_facts(trial: Trial) -> Iterator[Fact]:
    """Yield the facts of a run for `rules/run`: stated ones and observed ones."""
    facts = tuple(_facts(trial))
    yield from facts
    yield from _written_numbers(facts)


def _facts(trial: Trial) -> Iterator[Fact]:
    yield from _services(trial)
    yield from _control(trial)
    yield from gate_facts(trial)
    yield from _limits(trial)
    modules = trial.executor.plan.modules
    for name in trial.executor.effectors:
        for function in modules[name].functions if name in modules else ():
            yield fact_at(function.span, "has_function", name, function.name)
        for moved in trial.moves.get(name, ()):
            yield seen("moves", name, moved)
    for name, failures in trial.executor.failures.items():
        first = failure_text(failures), failures.at // MILLISECOND
        yield seen("failed", name, failures.count, *first)
    scenario = trial.scenario
    requirements = scenario.requirements
    for name in _judged_parts(trial):
        place = next(
            (r.places["reach"] for r in scenario.robots if name in r.places), scenario.span
        )
        yield fact_at(scenario.places.get(name, place), "asked", Atom(name))
    yield from _robots(trial)
    yield from _at_work(trial)
    for first, second in requirements.get("exclusive", ()):
        for function in (first, second):
            if trial.is_active(function):
                yield seen("active", function)
        seconds, since = trial.together(first, second)
        yield seen("together", first, second, rounded(seconds * 1000), rounded(since * 1000))
    if "coverage" in requirements:
        at_start, covered = (rounded(share * 1000) for share in trial.coverages)
        yield seen("coverage", covered, rounded(requirements["coverage"] * 1000))
        yield seen("covered_at_start", at_start)


def _at_work(trial: Trial) -> Iterator[Fact]:
    """Yield facts with the number of runs of each module and of messages at its inputs."""
    executor, plan = trial.executor, trial.executor.plan
    for name, runs in executor.run_counts.items():
        described = plan.modules.get(name)
        moves = plan.control_in[name] or (described is not None and described.functions)
        if name in executor.effectors and not moves:
            continue  # a part that only carries others
        yield seen("obeyed_commands" if name in executor.effectors else "ran", name, runs)
        if plan.kind(name) in ("data_out", "control_out", "sink"):
            for link in (*plan.data_in[name], *plan.control_in[name]):
                port = plan.input_name(link)
                entry = "it" if port is None else f"its input `{port}`"
                yield fact_at(link.span, "came", name, entry, plan.origin_of(link), link.delivered)


def _robots(trial: Trial) -> Iterator[Fact]:
    """Yield the names, contacts, clearances and missed goals of robots, and obstacles."""
    scenario = trial.scenario
    yield seen("called", THING, "something")
    for robot in scenario.robots:
        yield seen("called", robot.name, scenario.called(robot))
    world = trial.bodies[0].world
    for kind, present in (("fixed", world.is_built), ("moving", bool(world.moving))):
        if present:
            yield fact_at(scenario.span, "solid", Atom(kind))
    for robot, body in trial.robots:
        yield from _contacts(trial, robot, body)
        if body.driven:
            yield seen("travelled", robot.name)
    if "clearance" in scenario.requirements:
        result = set[frozenset[str]]()
        for body in sorted(trial.bodies, key=lambda body: body.clearance):
            pair = frozenset({body.name, body.beside})
            if pair not in result:
                result.add(pair)
                least, required = least_approach(body), scenario.requirements["clearance"]
                numbers = body.clearance, required, least.at if least else 0.0
                whole = (rounded(number * 1000) for number in numbers)
                yield seen("clearance", body.name, body.beside, *whole)
    for robot in scenario.robots:
        if robot.reach is not None:
            yield from _place_facts(trial, robot, robot.reach)
            if trial.reached(robot) is None:
                yield from _missed(trial, robot, robot.reach)


def _place_facts(trial: Trial, robot: ScenarioRobot, reach: Mapping[str, Any]) -> Iterator[Fact]:
    """Yield the gap of a goal to fixed obstacles, and whether the robot starts at it."""
    x, y = reach["at"]
    radius, place = reach.get("radius", 200.0), _reach_span(trial, robot)
    if dist((x, y), robot.start[:2]) <= radius:
        yield fact_at(place, "starts_there", robot.name, _place_text(x, y))
    gap = trial.bodies[0].world.without_moving().distance((x, y), 0.0)
    lengths = (rounded(length * 1000) for length in (gap, radius, robot.radius))
    yield fact_at(place, "place_gap", robot.name, _place_text(x, y), *lengths)


def _missed(trial: Trial, robot: ScenarioRobot, reach: Mapping[str, Any]) -> Iterator[Fact]:
    """Yield the deadline of a missed goal, and the minimal distance of the robot from it."""
    scenario = trial.scenario
    within = reach.get("within", scenario.duration)
    yield fact_at(_reach_span(trial, robot), "deadline", robot.name, rounded(within * 1000))
    ended = rounded(min(within, scenario.duration) * 1000)
    yield seen("never_reached", robot.name, ended)
    x, y = reach["at"]
    distance, at = trial.nearest(robot)
    # Messages are clearer with whole millimetres.
    result = rounded(round(distance) * 1000), rounded(at * 1000)
    yield seen("came_nearest", robot.name, _place_text(x, y), *result)


def _reach_span(trial: Trial, robot: ScenarioRobot) -> Span:
    return robot.places.get("reach") or trial.scenario.places["reach"]


def _place_text(x: float, y: float) -> str:
    return f"({x:g}, {y:g})"


def _written_numbers(facts: Iterable[Fact]) -> Iterator[Fact]:
    """Yield facts with texts of numbers whose unit depends on another argument."""
    numbers: dict[tuple[str, int], None] = {}
    for fact in facts:
        arguments = fact.atom.arguments
        if fact.atom.name in ("peak", "limit"):
            _, function, number, *_ = arguments
            numbers[str(function), int(str(number))] = None
        if fact.atom.name == "failed":
            numbers[_TIMES, int(str(arguments[1]))] = None
    for unit, number in numbers:
        yield seen(
            "written", Atom(unit) if unit == _TIMES else unit, number, in_words(unit, number)
        )


def in_words(unit: str, number: int) -> str:
    """Return a number in words: a count, or a rate or width of the function `unit`."""
    if unit == _TIMES:
        return {1: "once", 2: "twice"}.get(number, f"{number} times")
    if unit == GRASP:
        return measured(number, "micrometres")
    return f"{_decimal_text(number, 3)} {'degrees/s' if unit.startswith('Rotn') else 'mm/s'}"


def _decimal_text(number: int, decimals: int) -> str:
    """Return `number / 10 ** decimals` as text, without zeros at the end."""
    return f"{Decimal(number).scaleb(-decimals).normalize():f}"


def failure_text(failures: Failures) -> str:
    """Return the first exception of a module as text, with its line, time and inputs."""
    lines = [f"at {_decimal_text(failures.at // 1000, 6)} s"]
    if failures.raised is not None:
        lines.insert(0, "{}:{}".format(*raised_at(failures)))
    if failures.inputs:
        lines.append(f"given {', '.join(failures.inputs)}")
    first = " ".join(failures.first.split())
    return visible(f"{first[:_LONGEST]} ({', '.join(lines)[:_LONGEST]})")


def raised_at(failures: Failures) -> tuple[str | None, int | None]:
    """Return the file, relative to the current folder, and line of the first exception."""
    if failures.raised is None:
        return None, None
    path, line = Path(failures.raised[0]), failures.raised[1]
    here = path.is_absolute() and path.is_relative_to(Path.cwd())
    shown = path.relative_to(Path.cwd()) if here else path
    return (shown.name if shown.is_absolute() else shown.as_posix()), line


def _judged_parts(trial: Trial) -> Iterator[str]:
    for name, value in trial.scenario.requirements.items():
        if value is not False:
            yield name
    if any("reach" in robot.places for robot in trial.scenario.robots):
        yield "reach"


def _services(trial: Trial) -> Iterator[Fact]:
    for each in promises(trial):
        yield seen("delivered", each.number, rounded(each.delivered))
        if each.promised is not None:
            link, plan = each.link, trial.executor.plan
            clients = " and ".join(plan.targets_of(link)) or link.client
            ends = plan.origin_of(link), clients, rounded(each.promised)
            yield fact_at(link.span, "promised", each.number, *ends)


def _control(trial: Trial) -> Iterator[Fact]:
    now = trial.executor.schedule.now
    for link in trial.executor.links:
        if link.kind == "control" and link.delivered and link.client in trial.executor.effectors:
            yield fact_at(link.span, "commanded_by", link.client, link.source)
        arbiter = trial.executor.arbiters.get(link.client)
        if arbiter is not None and link.kind == "control":
            # The latest of all passes under `latest`.
            equal = isinstance(arbiter, HierarchicalArbitration) and arbiter.equal
            priority = 0 if equal else link.priority
            yield fact_at(link.span, "ranked", link.client, link.source, priority)
    for name, arbiter in trial.executor.arbiters.items():
        if not isinstance(arbiter, HierarchicalArbitration):
            continue
        yield from _arbitrated(name, arbiter, now)


def _arbitrated(name: str, arbiter: HierarchicalArbitration, now: int) -> Iterator[Fact]:
    """Yield the periods in which an arbiter obeyed one controller while another was in force.

    Both lists are ordered by time, so one pass finds the overlaps; rules would compare all pairs.
    """
    changes = [(h.since, h.through) for h in arbiter.holdings] + [(now, "")]
    held = [
        (since, until, holder)
        for (since, holder), (until, _) in pairwise(changes)
        if holder and until > since
    ]
    for link, stretches in arbiter.in_force:
        first = 0
        for since, until in stretches:
            while first < len(held) and held[first][1] <= since:
                first += 1
            for k in range(first, len(held)):
                start, end, holder = held[k]
                if start >= until:
                    break
                if holder != link.source:
                    both = milliseconds(max(start, since)), milliseconds(min(end, until))
                    yield seen("coincided", name, holder, link.source, *both)


def _contacts(trial: Trial, robot: ScenarioRobot, body: Body) -> Iterator[Fact]:
    """Yield each contact of a robot, and the command that it obeyed at that time."""
    commands = tuple(trial.commands(robot))
    starts = [since for since, *_ in commands]
    for at, other in zip(body.contacts, body.struck, strict=True):
        instant = rounded(at * 1000)
        yield seen("collided", robot.name, other, instant)
        number = bisect_left(starts, at) - 1
        if number < 0:
            continue
        since, until, origin, command = commands[number]
        for function in command:
            result = rounded(since * 1000), rounded(until * 1000)
            yield seen("obeyed", robot.name, instant, origin, function, *result)


def _limits(trial: Trial) -> Iterator[Fact]:
    modules = trial.executor.plan.modules
    places = {(m.name, f.name): f.span for m in modules.values() for f in m.functions}
    for robot in trial.scenario.robots:
        for function in robot.limits:
            places[robot.module, function] = robot.places[f"limits.{function}"]
    for name, effector in trial.executor.effectors.items():
        peaks: dict[str, tuple[float, int]] = {}
        for at, _, command in effector.applied:
            for function, rate in command.items():
                if function not in peaks or abs(rate) > peaks[function][0]:
                    peaks[function] = abs(rate), at // MILLISECOND
        for function, (rate, at) in peaks.items():
            yield seen("peak", name, function, rounded(rate * 1000), at)
        for function, rate in trial.limits.get(name, {}).items():
            place = places.get((name, function), trial.scenario.span)
            yield fact_at(place, "limit", name, function, rounded(rate * 1000))
