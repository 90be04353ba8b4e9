"""Traces as text of 80 columns and as JSON, without recursion."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple, TypeAlias

import clingo

from mars_asp.asp.messages import shown
from mars_asp.asp.trace.absence_text import attempt_text, failure, nearest
from mars_asp.asp.trace.tree import Absent, Attempt, Derived, Given, Missing, Trace, Unexplained
from mars_asp.diagnostic import Span

WIDTH = 80
#: Deep enough for a reason, short enough to read.
DEPTH = 4
#: What `textwrap` counts as white space.
_SPACE = re.compile(r"[\t\n\x0b\x0c\r]")
#: Among so many steps below a premise it is looked for what need not be said beside it.
NEAR = 200


def traces_text(
    topics: Sequence[tuple[str, Trace]],
    line_at: Callable[[Span], str],
    depth: int | None = DEPTH,
    width: int = WIDTH,
    folded: bool = True,
) -> Iterator[str]:
    """Yield the lines of several traces, each under its title: messages, rules and places.

    What has no message is `folded` into what it supports, else told by its atom, as facts are then.
    What is shared stands once; where it is needed again, it is referred to by a number. Several
    derivations of an atom stand one below the other, each with its number.
    """
    opened: set[int] = set()
    again: set[int] = set()
    near: _Near = {}
    entries = [
        entry
        for topic in topics
        for entry in _entries(*topic, line_at, depth, folded, opened, again, near)
    ]
    numbers: dict[int, int] = {}
    for level, line, step in entries:
        if step is None:
            yield from wrapped(line, level, width)
            continue
        key, text = id(step), _said(step)
        if key in numbers:
            yield from wrapped(f"{text}, as in ({numbers[key]})", level, width)
        else:
            mark = ""
            if key in again:
                numbers[key] = len(numbers) + 1
                mark = f"({numbers[key]}) "
            span = step.rule.span
            place = f"[{step.rule.id}] {span.path}:{span.line}"
            yield from wrapped(f"{mark}{text}{line}  {place}", level, width)


#: What stands near below steps, by their `id`: steps, and places of facts.
_Near: TypeAlias = dict[int, tuple[frozenset[int], frozenset[Span | None]]]


class _Entry(NamedTuple):
    """One line to be: a title or leaf, or what a step says and what is added to that.

    What a step says is written when it is printed, for there are many.
    """

    level: int
    line: str
    step: Derived | Attempt | None = None


def _said(step: Derived | Attempt) -> str:
    return attempt_text(step) if isinstance(step, Attempt) else step.message or step.atom


def _entries(
    title: str,
    trace: Trace,
    line_at: Callable[[Span], str],
    depth: int | None,
    folded: bool,
    opened: set[int],
    again: set[int],
    near: _Near,
) -> Iterator[_Entry]:
    """Yield the lines of one trace.

    What a step in `opened` rests on was told before; one that comes once more is put in `again`.
    """
    yield _Entry(0, title)
    stack: list[tuple[Trace | Attempt | str, int]] = [(trace, 1)]
    said_of: dict[int, str] = {}
    #: The leaves told at each level since the last step above it.
    said: list[set[str]] = []
    while stack:
        step, level = stack.pop()
        if isinstance(step, Derived | Attempt):
            del said[level + 1 :]
            if id(step) in opened:
                again.add(id(step))
                yield _Entry(level, "", step)
                continue
            opened.add(id(step))
        below: Sequence[Trace | Attempt | str]
        match step:
            case Missing() if step.attempts:
                stack += [(attempt, level) for attempt in reversed(nearest(step))]
                continue
            case Derived():
                remark = ", chosen as the cheapest" if step.chosen else ""
                if step.others:
                    said_of |= _numbered(step)
                    stack += [(other, level) for other in reversed(step.others)]
                if id(step) in said_of:
                    remark += f", {said_of[id(step)]}"
                yield _Entry(level, remark, step)
                below = _interesting(step.premises, level == 1 or depth is None, folded, near)
                if depth is not None and level >= depth:
                    below = leaves_of(step) if any(isinstance(p, Derived) for p in below) else below
            case Attempt():
                yield _Entry(level, "", step)
                below = failure(step, depth is None or level < depth)
                below = (*below, *_interesting(step.held, False, folded, near))
            case _:
                line = step if isinstance(step, str) else _leaf(step, line_at, folded)
                said += (set[str]() for _ in range(len(said), level + 1))
                if line is not None and line not in said[level]:
                    said[level].add(line)
                    yield _Entry(level, line)
                continue
        stack += [(premise, level + 1) for premise in reversed(below)]


def _numbered(step: Derived) -> dict[int, str]:
    """Return what is said of a step and of its others, by their `id`: `derivation 1 of 2`.

    Where the same rule says the same in several, the values that are not the same in all of these
    follow.
    """
    every = (step, *step.others)
    alike: dict[tuple[int, str | None], list[Derived]] = {}
    for one in every:
        alike.setdefault((id(one.rule), one.message), []).append(one)
    values: dict[int, str] = {}
    for group in alike.values():
        bindings = [one.bindings for one in group]
        names = [name for name in bindings[0] if _differs(name, bindings)]
        for one, bound in zip(group, bindings, strict=True):
            pairs = [f"{name} = {shown(bound[name])}" for name in names]
            values[id(one)] = f" for {', '.join(pairs)}" if pairs else ""
    return {
        id(one): f"derivation {number} of {len(every)}{values[id(one)]}"
        for number, one in enumerate(every, 1)
    }


def _differs(name: str, bindings: Sequence[Mapping[str, clingo.Symbol]]) -> bool:
    return len({bound.get(name) for bound in bindings}) > 1


def trace_json(trace: Trace, depth: int | None = None) -> dict[str, object]:
    """Return a trace with the keys of the command line's contract.

    What is shared stands once; elsewhere it has `"shared": true` and no premises. The other
    derivations of an atom are its `others`, each with premises of its own.
    """
    root: dict[str, object] = {}
    shown: set[int] = set()
    stack: list[tuple[Trace | Attempt, dict[str, object], int]] = [(trace, root, 0)]
    while stack:
        step, target, level = stack.pop()
        target.update(_step_json(step))
        inside = _inside(step)
        if not inside:
            continue
        if id(step) in shown:
            target["shared"] = True
            continue
        if depth is not None and level >= depth:
            target["folded"] = True
            continue
        shown.add(id(step))
        premises: list[dict[str, object]] = [{} for _ in inside]
        target["premises"] = premises
        below = list(zip(inside, premises, strict=True))
        if isinstance(step, Derived) and step.others:
            others: list[dict[str, object]] = [{} for _ in step.others]
            target["others"] = others
            below += zip(step.others, others, strict=True)
        stack += [(premise, entry, level + 1) for premise, entry in reversed(below)]
    return root


def _inside(step: Trace | Attempt) -> Sequence[Trace | Attempt]:
    match step:
        case Derived():
            return step.premises
        case Missing(_, attempts):
            return attempts
        case Attempt():
            return (*(() if step.cause is None else (step.cause,)), *step.held)
        case _:
            return ()


def _step_json(step: Trace | Attempt) -> dict[str, object]:
    atom = step.atom
    entry: dict[str, object] = {"atom": atom, "message": atom, "kind": "given"}
    entry |= {"rule": None, "bindings": {}, "location": None, "premises": []}
    match step:
        case Given(_, span, origin) if span is not None:
            place = {"path": span.path, "line": span.line, "column": span.column}
            entry["location"] = place
            if origin != "stated":
                entry["kind"] = origin
            if origin == "computed":
                entry["computed_from"] = [place]
        case Absent(atom):
            entry |= {"kind": "absent", "message": f"no {atom}"}
        case Missing():
            entry |= {"kind": "absent", "message": f"no {step.atom}"}
            if not step.followed:
                entry["folded"] = True
        case Unexplained(_, reason):
            entry |= {"message": reason}
        case Derived():
            entry["kind"] = "chosen" if step.chosen else "derived"
            entry["message"] = step.message or step.atom
            entry |= _instance_json(step)
        case Attempt():
            value = None if step.value is None else str(step.value)
            entry |= {"kind": "absent", "atom": step.atom, "message": attempt_text(step)}
            entry |= {"fails": step.fails, "value": value}
            entry |= _instance_json(step)
        case _:
            pass
    return entry


def _instance_json(step: Derived | Attempt) -> dict[str, object]:
    span = step.rule.span
    return {
        "bindings": {name: str(value) for name, value in step.bindings.items()},
        "rule": {
            "id": step.rule.id,
            "path": span.path,
            "line": span.line,
            "text": step.rule.text,
        },
    }


def _near(step: Trace) -> tuple[frozenset[int], frozenset[Span | None]]:
    """Return what stands near below a step: the steps by their `id`, and the places of facts."""
    _, *below = _below(step, NEAR)
    places = (part.span for part in below if isinstance(part, Given))
    return frozenset(map(id, below)), frozenset(places)


def _interesting(
    premises: Sequence[Trace], absences: bool, folded: bool, near: _Near
) -> list[Trace]:
    """Return the premises that say something of their own.

    `near` has what was found near below steps, for many premises support several steps. Those
    without a message give way to their premises; what another premise leads to as well is
    left to that one. Beside a message an absence says nothing that the message leaves out.
    """
    if not folded:
        told_once = {id(each): each for each in premises}.values()
        return [each for each in told_once if absences or not isinstance(each, Absent)]
    found: list[Trace] = []
    stack = list(reversed(premises))
    seen: set[int] = set()
    while stack:
        premise = stack.pop()
        if id(premise) in seen:
            continue
        seen.add(id(premise))
        if isinstance(premise, Derived) and premise.rule.because is None and not premise.others:
            stack += reversed(premise.premises)
        elif absences or not isinstance(premise, Absent):
            found.append(premise)
    steps = [premise for premise in found if isinstance(premise, Derived)]
    if not steps or len(found) == 1:
        return found
    told: set[int] = set()
    places: set[Span | None] = set()
    for step in steps:
        if id(step) not in told:
            steps_below, places_below = near.get(id(step)) or near.setdefault(id(step), _near(step))
            told |= steps_below
            places |= places_below
    return [
        premise
        for premise in found
        if id(premise) not in told
        and not isinstance(premise, Absent)
        and not (isinstance(premise, Given) and premise.span in places)
    ]


def _below(step: Trace, most: int | None = None) -> list[Trace]:
    """Return a step and everything that supports it, the nearest first; so many at most."""
    found: list[Trace] = [step]
    seen = {id(step)}
    for part in found:
        if isinstance(part, Derived):
            for premise in part.premises:
                if id(premise) not in seen:
                    seen.add(id(premise))
                    found.append(premise)
        if most is not None and len(found) >= most:
            return found[:most]
    return found


def leaves_of(trace: Trace) -> Sequence[Given]:
    """Return the facts that a trace rests on, one for each place, in their order."""
    found: dict[Span, Given] = {}
    for part in _below(trace):
        if isinstance(part, Given) and part.span is not None:
            found.setdefault(part.span, part)
    return [found[span] for span in sorted(found)]


def _leaf(step: Trace, line_at: Callable[[Span], str], folded: bool) -> str | None:
    match step:
        case Given(atom, span) if span is not None and not folded:
            return f"{atom}  {span.path}:{span.line}"
        case Given(_, span) if span is not None:
            return f"{span.path}:{span.line}: {line_at(span)}"
        case Given():
            return None
        case Absent(atom) | Missing(atom):
            return f"no {atom}"
        case Unexplained(atom, reason):
            return f"{atom}: not traced, for {reason}"
        case _:
            return None


def wrapped(text: str, level: int, width: int = WIDTH) -> Sequence[str]:
    """Return a text's lines, indented by its level, what goes on further."""
    indent = "  " * min(level, 20)
    if not text.isprintable():
        text = _SPACE.sub(" ", text.expandtabs())
    text = text.strip(" ")
    if len(indent) + len(text) <= width:
        return (indent + text,) if text else ()
    return tuple(_lines(text, indent, width))


def _lines(text: str, indent: str, width: int) -> Iterator[str]:
    """Yield the lines of a text, as `textwrap` does at many times the cost."""
    further = indent + "    "
    while text:
        end = len(text)
        if len(indent) + end > width:
            end = text.rfind(" ", 0, width - len(indent) + 1)
            if end < 0:
                # A word that is longer than a line has one of its own.
                end = len(text.partition(" ")[0])
        line = indent + text[:end].rstrip(" ")
        # An atom has no spaces; it goes on behind one of its commas.
        while len(line) > width and (comma := line.rfind(",", len(further), width) + 1):
            yield line[:comma]
            line = further + line[comma:]
        yield line
        text, indent = text[end:].lstrip(" "), further
