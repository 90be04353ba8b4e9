"""An engine for explained answer sets: it reads rules, grounds and solves them, and says why.

>>> from mars_asp import asp
>>> answer = asp.Program.from_files("reach.lp").solve()
>>> print(answer.why("reach(d)").text())

It knows nothing of what rules are about; MARS uses it like anyone else. See its README.
"""

from mars_asp.asp.program import Answer, NotDerived, Program, Reason, Session, Unsatisfiable

__all__ = ["Answer", "NotDerived", "Program", "Reason", "Session", "Unsatisfiable"]
