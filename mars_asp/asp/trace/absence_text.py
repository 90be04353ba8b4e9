"""Sentences about rules that do not give an atom."""

import re
from collections.abc import Sequence

from mars_asp.asp.messages import shown
from mars_asp.asp.trace.tree import NearMiss, Trace, Underivable

_HOLE = re.compile(r"\{[^{}]*\}")
_VARIABLE = re.compile(r"(?<![\w'])_*[A-Z][\w']*")


def nearest(missing: Underivable) -> list[NearMiss]:
    """Return the attempts that say something; those without a message give way to their causes."""
    found: list[NearMiss] = []
    seen: set[int] = set()
    stack: list[NearMiss] = list(reversed(missing.attempts))
    while stack:
        attempt = stack.pop()
        if id(attempt) in seen:
            continue
        seen.add(id(attempt))
        cause = attempt.cause
        if attempt.message is None and isinstance(cause, Underivable) and cause.attempts:
            stack += reversed(cause.attempts)
        else:
            found.append(attempt)
    return found


def attempt_text(attempt: NearMiss) -> str:
    """Return that a rule does not give the atom; what is not bound is `...`.

    The message itself may well hold, of this atom or another: what is denied is the instance.
    """
    if attempt.message is None:
        return _short(attempt) if isinstance(attempt.cause, Underivable) else _test(attempt)
    return f"{attempt.atom} would hold because {_HOLE.sub('...', attempt.message)}, but"


def failure(attempt: NearMiss, go_on: bool) -> Sequence[Trace | NearMiss | str]:
    """Return the steps below a near miss: first the premise that fails, and why."""
    cause = attempt.cause
    if isinstance(cause, Underivable) and cause.attempts and (go_on or is_unspoken(cause)):
        return nearest(cause)
    if cause is not None:
        return (cause,) if go_on or not isinstance(cause, Underivable) else (cause.message,)
    return () if attempt.message is None else (_test(attempt),)


def is_unspoken(missing: Underivable) -> bool:
    """Return whether no rule tells what is missing, and each fails by what is there to be seen."""
    return all(
        attempt.message is None and not isinstance(attempt.cause, Underivable)
        for attempt in missing.attempts
    )


def _short(attempt: NearMiss) -> str:
    assert isinstance(attempt.cause, Underivable)
    return attempt.cause.message


def _test(attempt: NearMiss) -> str:
    if attempt.fails is None:
        return "it may be chosen, and is not"
    if attempt.value is not None:
        return f"`{attempt.fails}` fails: its value is {attempt.value}"
    names = dict.fromkeys(_VARIABLE.findall(attempt.fails))
    values = [f"{n} = {shown(attempt.bindings[n])}" for n in names if n in attempt.bindings]
    return f"`{attempt.fails}` fails{' for ' if values else ''}{', '.join(values)}"
