"""The judgement of Gates and locks: random runs hold, and runs of a faulty executor do not."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from mars_asp.cli.run_json import speakers
from mars_asp.diagnostic import point
from mars_asp.execution.executor import arbitration, bounds, gate
from mars_asp.execution.gate_facts import gate_facts
from mars_asp.execution.judgement import _control, judge_facts, run_rulebook
from mars_asp.execution.trial import Trial
from tests.execution.test_timeline import finished_run
from tests.support.campaigns import seeds
from tests.support.fixtures import Patch
from tests.support.trials import BASE, DRIVE, HAND, trial, verdicts

#: The first seeds show each of the faults.
FIRST = 12


def violated(seed: int) -> set[str]:
    """Return the names of the violated requirements of a random run."""
    run = cast(Trial, SimpleNamespace(executor=finished_run(seed)))
    facts = [*gate_facts(run), *_control(run)]
    found = judge_facts(facts, (), run_rulebook(), point("run", 1, 1), True)
    return {each.name for each in found.requirements if each.holds is False}


@pytest.mark.parametrize("seed", seeds(4, 60))
def test_random_runs_respect_gates_and_locks(seed: int) -> None:
    assert violated(seed) <= {"one controller at a time"}


def longer(trigger: gate.Trigger, message: Any, now: int) -> None:
    HEAR(trigger, message, now)
    trigger.until += 60_000_000 * (trigger.until > now)


def open_gate(self: gate.Gate, *, in_circle: bool) -> None:
    return None


def passes_closed(self: gate.Gate) -> None:
    """Pass the messages of the line whether it is closed or not, after those of triggers."""
    taken, self.waiting = self.waiting, []
    SETTLE(self)
    for link, message, _ in taken:
        departed, closer = self.departed, self.closer(in_circle=False)
        self._pass(link, message)
        self.verdicts.append((self.schedule.now, closer, self.departed > departed))


HEAR, SETTLE = gate.Trigger.hear, gate.Gate.settle
FAULTS = {
    "every Gate is open": (gate.Gate, "closer", open_gate, "gates respected"),
    "a closed Gate passes": (gate.Gate, "settle", passes_closed, "gates respected"),
    "a Gate closes too long": (gate.Trigger, "hear", longer, "gates respected"),
    "nothing passes": (gate.Gate, "_pass", lambda *_: None, "gates respected"),
    "a lock does not lock": (
        arbitration.HierarchicalArbitration,
        "_may_pass",
        lambda *_: True,
        "priorities respected",
    ),
    "silence does not lock": (bounds.History, "silent", lambda *_: False, "priorities respected"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faults_of_the_executor_are_found(fault: str, monkeypatch: Patch) -> None:
    owner, name, wrong, requirement = FAULTS[fault]
    monkeypatch.setattr(owner, name, wrong)
    assert any(requirement in violated(seed) for seed in range(FIRST))


BOUNDED = """\
@specification
@modules P, C, L, S, ArbitrationNode, Gate1
P is_controlled_by ArbitrationNode
ArbitrationNode is_controlled_by C 1
Gate1 is_controlled_by L
Gate1 is_inhibited_by S 100
ArbitrationNode is_limited_by Gate1
@module_start
@module_name S
@Sense NotifyWhenReady
bool hit();
@module_end
"""
LOCKED = DRIVE.replace("C\nP is_controlled_by C", "C, S, ArbitrationNode") + (
    "P is_controlled_by ArbitrationNode\nArbitrationNode is_controlled_by C 1\n"
    "ArbitrationNode is_locked_by S\n"
)
BUMPER = '[devices.S]\nkind = "bumper"\n'


def test_gates_are_judged_wherever_there_are_side_lines() -> None:
    assert verdicts(trial(BASE + HAND + BUMPER, LOCKED))["gates respected"] is True
    assert "gates respected" not in verdicts(trial(BASE + HAND))


def test_a_limiter_without_control_sends_no_commands_to_modules() -> None:
    devices = BASE + HAND + HAND.replace("devices.C", "devices.L") + BUMPER
    assert {*speakers(trial(devices, BOUNDED))} == {"C"}
    # A suppressor with a Gate of its own sends commands to modules.
    lines = BOUNDED.replace("Gate1\nP", "Gate1, Gate2\nP").splitlines()
    lines[3:4] = ["ArbitrationNode is_controlled_by Gate2 1", "Gate2 is_controlled_by C"]
    lines[lines.index("ArbitrationNode is_limited_by Gate1")] = "Gate2 is_suppressed_by Gate1 50"
    assert {*speakers(trial(devices, "\n".join(lines)))} == {"C", "L"}
