"""Checks for mutants that no case notices: random configurations against independent searches."""

import sys
from collections.abc import Callable
from dataclasses import dataclass

from mars_asp.asp.rules.rulebook import Rulebook
from tests.reasoning.synthesis.test_exhaustive import PARTS
from tests.reasoning.test_verification import carried, refuses_every_mutation


@dataclass(frozen=True, slots=True)
class Check:
    """A check of whole stages.

    Attributes:
        stages: those whose rules it looks at.
        seconds: what it takes of the processor at most; a mutant that takes more runs away.
        run: raises whatever it likes where it finds something wrong with a rulebook.
    """

    name: str
    stages: frozenset[str]
    seconds: float
    run: Callable[[Rulebook], None]


def judge_with(rulebook: Rulebook) -> None:
    """Let all tests of this process use a rulebook."""
    for name, module in list(sys.modules.items()):
        if name.startswith("tests.") and isinstance(getattr(module, "RULEBOOK", None), Rulebook):
            vars(module)["RULEBOOK"] = rulebook


def _costs_are_least(rulebook: Rulebook) -> None:
    judge_with(rulebook)
    for seed in range(30):
        assert PARTS["wiring"](seed) is None


def _supports_are_least(rulebook: Rulebook) -> None:
    judge_with(rulebook)
    for seed in range(15):
        assert PARTS["mounts"](seed) is None


def _changes_are_refused(rulebook: Rulebook) -> None:
    judge_with(rulebook)
    for seed in range(6):
        refuses_every_mutation(carried(seed), seed)


_REASONING = frozenset({"base", "resolve", "specify", "verify"})
CHECKS = (
    Check("exhaustive search", _REASONING, 60, _costs_are_least),
    Check("exhaustive search with mounts", _REASONING, 60, _supports_are_least),
    Check("changed specifications", _REASONING, 60, _changes_are_refused),
)
