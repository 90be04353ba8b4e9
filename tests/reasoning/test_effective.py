"""Effective control against a plain reading of the language reference, section 5.

Random robots of translations and quarter turns are judged twice: by the rules, and by a Python
version of the reference that uses no rule. To try more robots by hand:

    python -m tests.reasoning.test_effective FIRST LAST
"""

import random
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import pytest
from clingo import Symbol

from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.project import load_project, project_facts
from mars_asp.reasoning.rules import load_rulebook
from tests.support.campaigns import seeds

#: Kind, subject, participants and, where the kind tells them apart, a priority or a function.
Finding: TypeAlias = tuple[str, str, frozenset[str], str]
Vector: TypeAlias = tuple[int, int, int]
TRANSLATIONS: Mapping[str, Vector] = {
    "Trans_X": (1, 0, 0),
    "Trans_Y": (0, 1, 0),
    "Trans_Z": (0, 0, 1),
}
MOST = 2147483647


@dataclass(frozen=True)
class Line:
    """A controller of a module, with the priority that the line gives, if any."""

    module: str
    controller: str
    priority: int | None
    listed: bool


@dataclass(frozen=True)
class Robot:
    """A random robot.

    `mounts` leads from a module to what carries it, with the axis of a quarter turn; `named` has
    the functions that controllers name.
    """

    architecture: str
    own: Mapping[str, frozenset[str]]
    undescribed: frozenset[str]
    filters: frozenset[str]
    mounts: Mapping[str, tuple[str, str]]
    named: Mapping[str, frozenset[str]]
    lines: Sequence[Line] = field(default_factory=tuple)

    def text(self) -> str:
        """Return the robot as a configuration."""
        texts = [f"@configuration {self.architecture}"]
        texts.append(f"@modules {', '.join([*self.own, *self.named])}")
        for module, (carrier, axis) in self.mounts.items():
            turn = f" ({axis},90,_,_,_,_,_)" if axis else ""
            texts.append(f"{module} is_mounted_on {carrier}{turn}")
        lists: dict[str, list[Line]] = defaultdict(list)
        for line in self.lines:
            if line.listed:
                lists[line.module].append(line)
            else:
                rank = "" if line.priority is None else f" {line.priority}"
                texts.append(f"{line.module} is_controlled_by {line.controller}{rank}")
        for module, lines in lists.items():
            names = ", ".join(line.controller for line in lines)
            texts.append(f"{module} is_controlled_by {names}")
        for module, functions in self.own.items():
            if module not in self.undescribed:
                texts += ["@module_start", f"@module_name {module}"]
                texts += [f"@{function}" for function in sorted(functions)]
                texts += ["@ControlOut", "Cmd hand_on();"] if module in self.filters else []
                if not functions and module not in self.filters:
                    texts += ["@Sense NotifyWhenReady", "Image look();"]
                texts.append("@module_end")
        for controller, functions in self.named.items():
            texts += ["@module_start", f"@module_name {controller}"]
            texts += [f"@ControlOut {', '.join(sorted(functions))}", "Cmd act();", "@module_end"]
        return "\n".join(texts)


def random_robot(seed: int) -> Robot:
    """Return a robot of up to seven modules and five controllers."""
    rng = random.Random(seed)
    modules = [f"M{index}" for index in range(rng.randint(1, 7))]
    controllers = [f"C{index}" for index in range(rng.randint(1, 5))]
    functions = list(TRANSLATIONS)
    own = {m: frozenset(rng.sample(functions, rng.choice((0, 0, 1, 1, 2, 3)))) for m in modules}
    riding = rng.random() < 0.4
    if riding:  # One carries all others, which only inherit.
        own = {m: frozenset(functions if m == modules[0] else ()) for m in modules}
    mounts = {
        module: (rng.choice(modules[:index]), rng.choice(("", "", "x", "y", "z")))
        for index, module in enumerate(modules)
        if index and rng.random() < 0.85
    }
    named = {
        c: frozenset(
            rng.sample(
                [*functions, "Rotn_X"], rng.choice((0, 0, 1, 1, 2) if not riding else (0, 0, 0, 1))
            )
        )
        for c in controllers
    }
    priorities: tuple[int | None, ...] = rng.choice(
        (
            (0, 1, 2, 3, 4),
            tuple(range(20)),
            (None, 0, 1),
            (1, 1, 2, MOST),
            (None,),
            (0, 7, 50000),
        )
    )
    lines = []
    for module in modules:
        chosen = rng.sample(controllers, rng.randint(0, len(controllers)))
        if len(chosen) > 1 and rng.random() < 0.2:
            lines += [Line(module, name, rank, True) for rank, name in enumerate(chosen)]
        else:
            lines += [Line(module, name, rng.choice(priorities), False) for name in chosen]
            if chosen and rng.random() < 0.1:
                lines.append(Line(module, chosen[0], rng.choice(priorities), False))
    rare = rng.choice((0.0, 0.0, 0.15))
    return Robot(
        rng.choice(("flat", "hierarchical")),
        {m: frozenset() if rare and rng.random() < 0.1 else own[m] for m in modules},
        frozenset(m for m in modules if rng.random() < rare),
        frozenset(m for m in modules if rng.random() < rare),
        mounts,
        named,
        tuple(lines),
    )


@dataclass(frozen=True)
class Input:
    """An input of a module: a controller, or the node through which a module's commands arrive.

    `spoken` maps each controller to its declared priority, `functions` to the functions of the
    module that it drives; `heard` are the controllers whose commands arrive by this input.
    """

    rank: int
    spoken: Mapping[str, int]
    functions: Mapping[str, frozenset[str]]
    through: str | None
    heard: frozenset[str]


class Reading:
    """The verdicts of the language reference on a robot, computed without the rules."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def known(self, module: str) -> frozenset[str]:
        """Return the functions that a module is described to have."""
        return frozenset() if module in self.robot.undescribed else self.robot.own[module]

    def carriers(self, module: str) -> Iterator[tuple[str, list[str]]]:
        """Yield each carrier of a module, nearest first, with the axes of the turns on the way."""
        turns: list[str] = []
        while module in self.robot.mounts:
            module, axis = self.robot.mounts[module]
            turns = [*turns, axis]
            yield module, turns

    def inherited(self, module: str) -> Mapping[str, tuple[str, str]]:
        """Return each inherited function with its nearest provider and the function there."""
        found: dict[str, tuple[str, str]] = {}
        if module in self.robot.undescribed or module in self.robot.filters:
            return found
        for carrier, turns in self.carriers(module):
            for function in self.known(carrier):
                direction = TRANSLATIONS[function]
                for axis in reversed(turns):
                    direction = back(direction, axis)
                seen = next(
                    name
                    for name, unit in TRANSLATIONS.items()
                    if list(map(abs, direction)) == list(unit)
                )
                found.setdefault(seen, (carrier, function))
        return found

    @cached_property
    def declared(self) -> Mapping[str, Mapping[str, int]]:
        """Return the controllers declared for each module; a pair counts once, at its highest."""
        found: dict[str, dict[str, int]] = defaultdict(dict)
        for line in self.robot.lines:
            ranks = found[line.module]
            ranks[line.controller] = max(line.priority or 0, ranks.get(line.controller, 0))
        return found

    def commanded(self, module: str, controller: str) -> frozenset[str]:
        """Return the functions of a module that a controller is taken to command."""
        return (
            self.robot.named[controller] or self.known(module) or frozenset(self.inherited(module))
        )

    def borrowed(self, module: str, controller: str) -> frozenset[str]:
        """Return the functions that it commands and the module only inherits."""
        inherits = frozenset(self.inherited(module)) - self.known(module)
        return self.commanded(module, controller) & inherits

    def inputs(self, module: str) -> list[Input]:
        """Return all ways by which commands arrive at a module."""
        found = []
        for controller, rank in self.declared[module].items():
            drives = self.commanded(module, controller)
            past = self.borrowed(module, controller) and not drives & self.known(module)
            heard = frozenset() if past else frozenset({controller})
            found.append(Input(rank, {controller: rank}, {controller: drives}, None, heard))
        for rider in self.robot.own:
            inherited = self.inherited(rider)
            borrowed = {c: self.borrowed(rider, c) for c in self.declared[rider]}
            passed = {c: p for c, p in self.declared[rider].items() if borrowed[c]}
            drives_here = {
                c: frozenset(
                    there for f in borrowed[c] for at, there in [inherited[f]] if at == module
                )
                for c in passed
            }
            spoken = {c: p for c, p in passed.items() if drives_here[c]}
            if spoken:
                rank = max(passed.values())
                found.append(Input(rank, spoken, drives_here, rider, frozenset(passed)))
        return found

    def findings(self) -> Iterator[Finding]:
        """Yield the findings that the reference requires."""
        for module in self.robot.own:
            inputs = self.inputs(module)
            everybody = frozenset(c for each in inputs for c in each.spoken)
            if len(everybody) > 1:
                yield "control_convergence", module, everybody, ""
            if self.robot.architecture == "hierarchical":
                yield from ties(module, inputs)
                yield from inversions(module, inputs)
            else:
                yield from means(module, inputs)
                declared = [
                    x
                    for x in self.robot.lines
                    if x.module == module and x.priority is not None and not x.listed
                ]
                if declared:
                    names = frozenset(x.controller for x in declared)
                    yield "ignored_priority", module, names, ""
            yield from self.missing(module)

    def missing(self, module: str) -> Iterator[Finding]:
        """Yield the functions that are commanded in vain."""
        known = self.known(module) | frozenset(self.inherited(module))
        unknown = {module, *(carrier for carrier, _ in self.carriers(module))}
        if not known or module in self.robot.filters or unknown & self.robot.undescribed:
            return
        for controller in self.declared[module]:
            for function in self.robot.named[controller] - known:
                yield "missing_function", module, frozenset({controller}), function


def back(direction: Vector, axis: str) -> Vector:
    """Turn a direction by minus 90 degrees about an axis: from a carrier's frame into a rider's."""
    x, y, z = direction
    return {"": (x, y, z), "x": (x, z, -y), "y": (-z, y, x), "z": (y, -x, z)}[axis]


def ties(module: str, inputs: Sequence[Input]) -> Iterator[Finding]:
    """Yield equal priorities of different controllers that arrive by different ways."""
    for rank in {each.rank for each in inputs}:
        tied = {
            name
            for one in inputs
            for other in inputs
            if one is not other and one.rank == other.rank == rank
            for name in one.spoken
            if set(other.spoken) - {name}
        }
        if tied:
            yield "ambiguous_priority", module, frozenset(tied), str(rank)


def inversions(module: str, inputs: Sequence[Input]) -> Iterator[Finding]:
    """Yield for each that loses to a lower priority the lowest to which it does."""
    lost: dict[str, list[tuple[int, str]]] = defaultdict(list)
    for one in inputs:
        for other in inputs:
            if one.through is not None and one.rank > other.rank:
                for winner, low in one.spoken.items():
                    for loser, high in other.spoken.items():
                        if low < high and winner != loser:
                            lost[loser].append((low, winner))
    for loser, winners in lost.items():
        yield "priority_inversion", module, frozenset({min(winners)[1], loser}), loser


def means(module: str, inputs: Sequence[Input]) -> Iterator[Finding]:
    """Yield functions of which a mean is taken, and means of means."""
    for function in [*TRANSLATIONS, "Rotn_X"]:
        averaged = {
            name
            for one in inputs
            for other in inputs
            if one is not other
            for name, drives in one.functions.items()
            if function in drives
            if any(function in d for n, d in other.functions.items() if n != name)
        }
        if averaged:
            yield "averaging_hazard", module, frozenset(averaged), function
    heard = [each for each in inputs if each.heard]
    if len(heard) > 1 and any(e.through is not None and len(e.heard) > 1 for e in heard):
        names = frozenset(name for each in heard for name in each.spoken)
        yield "averaging_hazard", module, names, "means"


RULEBOOK = load_rulebook()
KINDS = frozenset(
    "control_convergence ambiguous_priority priority_inversion averaging_hazard ignored_priority"
    " missing_function".split()
)


def found(robot: Robot) -> list[Finding]:
    """Return the sorted findings of the rules for a robot."""
    project = load_project("robot.mars", text=robot.text())
    analysis = analyse(project_facts(project), RULEBOOK, project.configuration.span)
    findings = []
    for each in analysis.consequences:
        if each.kind in KINDS:
            result = _result_of(each.kind, each.atom.arguments[3])
            findings.append((each.kind, each.subject, frozenset(each.participants), result))
    return sorted(findings, key=_key)


def _result_of(kind: str, case: Symbol) -> str:
    match kind:
        case "ambiguous_priority":
            return str(case.arguments[0])
        case "missing_function":
            return case.arguments[1].string
        case "averaging_hazard" | "priority_inversion":
            return str(case).strip('"')
    return ""


def _key(finding: Finding) -> tuple[str, str, list[str], str]:
    kind, subject, participants, result = finding
    return kind, subject, sorted(participants), result


def expected(robot: Robot) -> list[Finding]:
    """Return the sorted findings that the reference requires for a robot."""
    return sorted(Reading(robot).findings(), key=_key)


@pytest.mark.parametrize("first", [20 * each for each in seeds(1, 6)])
def test_findings_are_those_of_the_reference(first: int) -> None:
    for seed in range(first, first + 20):
        robot = random_robot(seed)
        assert found(robot) == expected(robot), f"seed {seed}\n{robot.text()}"


def test_every_kind_is_among_them() -> None:
    seen = {finding[0] for seed in range(60) for finding in expected(random_robot(seed))}
    assert seen == KINDS


def main(first: int, last: int) -> int:
    """Judge robots of the seeds from `first` to `last`; return how many were judged otherwise."""
    wrong: list[int] = []
    seen: Counter[str] = Counter()
    for seed in range(first, last + 1):
        robot = random_robot(seed)
        wanted = expected(robot)
        for finding in wanted:
            seen[finding[0]] += 1
        if found(robot) != wanted:
            wrong.append(seed)
    print(f"{last - first + 1} robots, {len(wrong)} judged otherwise: {wrong[:20]}")
    print(", ".join(f"{kind} {number}" for kind, number in sorted(seen.items())))
    return len(wrong)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2])) != 0)
