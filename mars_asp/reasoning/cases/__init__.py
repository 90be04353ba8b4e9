"""Cases for the rules of MARS: facts with their answer sets, and configurations.

A configuration is a case if its comments contain expectations:

    # expect: warning unwatched_effector(Platform) at 4
    # only: unwatched_effector
    # never: control_cycle
    # expect nodes: Watchdog 1, DataSplitter 0
    # expect cost: nodes 1, conversion 0
    # expect: no specification
    # expect findings: error 0, warning 1
    # expect order: Base: Drive < Avoid
"""

from mars_asp.reasoning.cases.places import FoundCase, cases_of, pack_of_case
from mars_asp.reasoning.cases.run import run_case, stages_of

__all__ = ["FoundCase", "cases_of", "pack_of_case", "run_case", "stages_of"]
