"""Regression tests on answer sets: facts and the expected results of the rules, in one file.

An expectation is a line of comments; lines `%+ ...` below it continue it.

- `%= atom atom ...` is one whole answer set, restricted to the predicates in the `#show` lines of
  the case, or to findings if it has no such lines. Several such lines are several answer sets.
- `%has: atom ...` are atoms that each answer set has, `%not: atom ...` atoms that none has. In both
  `_` is any value.
- `%only: atom ...` are all the atoms of their sorts in each answer set: of the same predicate, and
  with the same first argument if this is a constant.
- `%> id: message` is the message of the rule with this id; if a case has such a line and a line
  `%=`, all messages of rules are compared that derive the shown predicates.
- `%~ 3@30 12@10` is the cost of the answer sets: each level with a cost, with its sum, the highest
  level first.

A line `%case: TITLE` begins a separate case, with the facts above the first such line and the facts
up to the next such line. A case without expectations expects that there is no answer set. In a
folder, only files with at least one of these lines are cases, such as `%case: no answer set`. A
case in a folder named after a stage (`resolve`) has the rules of that stage as well; of its answer
sets only the cheapest count.
"""

from mars_asp.asp.cases.outcomes import Check, Failure, Outcome
from mars_asp.asp.cases.run import case_texts, find_cases, run_case, stages_of

__all__ = ["Check", "Failure", "Outcome", "case_texts", "find_cases", "run_case", "stages_of"]
