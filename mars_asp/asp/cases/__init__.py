"""Regression tests on answer sets: facts and what the rules make of them, in one file.

A line of comments states what is expected; lines `%+ ...` below it continue it.

- `%= atom atom ...` is one whole answer set, restricted to the predicates that the case's own
  `#show` lines name, else to what rules find. Several such lines are several answer sets.
- `%has: atom ...` are atoms that each answer set has, `%not: atom ...` those that none has. In both
  `_` is any value.
- `%only: atom ...` are all the atoms that each answer set has of their sorts: of the same
  predicate, and with the same first argument where that is a constant.
- `%> id: message` is what the rule of that id says; where a case has one and a line `%=`, all is
  compared that is said by rules which derive what it shows.
- `%~ 3@30 12@10` is what the answer sets cost, each level that costs anything with its sum, the
  highest first.

A line `%case: TITLE` begins a case of its own, with the facts above the first such line and those
up to the next. A case without any of these lines expects that there is no answer set. Of a folder,
files with one of these lines at least are taken, such as `%case: no answer set`. A case in a
folder named after a stage (`resolve`) has the rules of that stage, too; of its answer sets the
least count.
"""

from mars_asp.asp.cases.outcomes import Check, Failure, Outcome
from mars_asp.asp.cases.run import case_texts, find_cases, run_case, stages_of

__all__ = ["Check", "Failure", "Outcome", "case_texts", "find_cases", "run_case", "stages_of"]
