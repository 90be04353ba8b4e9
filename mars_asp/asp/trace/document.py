"""Traces for programs: JSON values, and lines of JSON with one step in each line."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.signature import plain
from mars_asp.asp.trace.premise_order import PremiseOrder
from mars_asp.asp.trace.tree import (
    Absent,
    Derived,
    Given,
    NearMiss,
    Trace,
    Underivable,
    Unexplained,
    is_pseudo,
)
from mars_asp.diagnostic import Span

FORMAT, VERSION = "mars-trace", 2

_Json: TypeAlias = dict[str, object]
_Step: TypeAlias = Trace | NearMiss


def trace_json(
    trace: Trace,
    depth: int | None = None,
    chosen: Callable[[Derived], Mapping[str, object]] | None = None,
) -> _Json:
    """Return one trace with the keys of the command line's contract, as a separate document.

    `chosen` returns further keys for a step that a choice gives.
    """
    return TraceDocument(chosen).trace(trace, depth)


def traces_json(traces: Iterable[Trace]) -> list[_Json]:
    """Return several traces with the keys of the command line's contract, as one document."""
    document = TraceDocument()
    return [document.trace(trace) for trace in traces]


class TraceDocument:
    """Numbers the steps of several traces, so that a repeated step is a reference.

    A repeated step has `"shared": true` and the number of the first occurrence as `ref`, without
    premises. The other derivations of an atom are its `others`, each with its own premises.
    """

    def __init__(self, chosen: Callable[[Derived], Mapping[str, object]] | None = None) -> None:
        """Begin without steps; `chosen` returns further keys for a step that a choice gives."""
        self._numbers: dict[object, int] = {}
        self._rules: dict[int, _Json] = {}
        self._chosen = chosen
        self._order = PremiseOrder()

    def trace(self, trace: Trace, depth: int | None = None) -> _Json:
        """Return a trace as JSON; steps at `depth` are `folded`."""
        root: _Json = {}
        stack: list[tuple[_Step, _Json, int]] = [(trace, root, 0)]
        while stack:
            step, target, level = stack.pop()
            inside = _inside(step, self._order)
            key = _step_key(step)
            if key in self._numbers:
                kind, message = _step_kind(step), _message(step)
                target |= {"shared": True, "ref": self._numbers[key]}
                target |= {"atom": plain(step.atom), "message": message, "kind": kind}
                continue
            target |= self._step(step)
            if inside and depth is not None and level >= depth:
                target["folded"] = True
                continue
            target["id"] = self._numbers[key] = len(self._numbers) + 1
            premises: list[_Json] = [{} for _ in inside]
            target["premises"] = premises
            below = list(zip(inside, premises, strict=True))
            if isinstance(step, Derived) and step.others:
                others: list[_Json] = [{} for _ in step.others]
                target["others"] = others
                below += zip(step.others, others, strict=True)
            stack += [(premise, entry, level + 1) for premise, entry in reversed(below)]
        return root

    def _step(self, step: _Step) -> _Json:
        entry: _Json = {
            "atom": plain(step.atom),
            "message": _message(step),
            "kind": _step_kind(step),
        }
        entry |= {"rule": None, "bindings": {}, "location": None, "premises": []}
        match step:
            case Given(_, _, origin):
                place = _leaf_location(step)
                entry["location"] = place
                if origin == "computed":
                    entry["computed_from"] = [] if place is None else [place]
                if origin == "observed":
                    entry["at_s"] = step.seconds
            case Underivable() if not step.followed:
                entry["folded"] = True
            case Derived() | NearMiss():
                entry["bindings"] = _bindings(step)
                entry["rule"] = self._rules.get(id(step.rule)) or self._rules.setdefault(
                    id(step.rule), rule_json(step.rule)
                )
                if isinstance(step, Derived) and step.chosen and self._chosen is not None:
                    entry |= self._chosen(step)
                if isinstance(step, NearMiss):
                    value = None if step.value is None else str(step.value)
                    entry |= {"fails": step.fails, "value": value}
            case _:
                pass
        return entry


def trace_lines(
    subject: str | None, topics: Iterable[tuple[Mapping[str, object], Trace]]
) -> Iterator[str]:
    """Yield traces as lines of JSON, premises before conclusions, numbers instead of copies.

    Each topic has the keys `title`, `sort`, `name` and `resolves`. Each step has exactly one line,
    and a number is defined in an earlier line than its uses.
    """
    yield json.dumps({"format": FORMAT, "version": VERSION, "subject": subject})
    lines = _JsonLines()
    count = 0
    for count, (topic, trace) in enumerate(topics, 1):
        yield from lines.below(trace)
        others = trace.others if isinstance(trace, Derived) else ()
        why = [lines.number(each) for each in (trace, *others)]
        yield json.dumps({"topic": count, **topic, "why": why})
    yield json.dumps({"end": True, "steps": lines.steps, "topics": count})


class _JsonLines:
    """Writes traces as lines of JSON; each rule, file and step before its first use."""

    def __init__(self) -> None:
        self._numbers: dict[object, int] = {}
        self._rules: dict[int, int] = {}
        self._files: dict[str, int] = {}
        #: The number of the first derivation of the atom, by the `id` of each other derivation.
        self._other_of: dict[int, int] = {}
        self._order = PremiseOrder()

    @property
    def steps(self) -> int:
        """Return the number of written steps."""
        return len(self._numbers)

    def number(self, step: _Step) -> int:
        """Return the number of a step whose line was written already."""
        return self._numbers[_step_key(step)]

    def below(self, trace: Trace) -> Iterator[str]:
        """Yield the lines of a trace that were not written yet.

        Other derivations of an atom can rest on steps that rest on the atom, so they follow it.
        """
        waiting: list[Derived | Trace] = [trace]
        for root in waiting:
            for step in self._premises_first(root):
                yield from self._step(step)
                if isinstance(step, Derived) and step.others:
                    waiting += step.others
                    for other in step.others:
                        self._other_of[id(other)] = self.number(step)

    def _premises_first(self, root: _Step) -> Iterator[_Step]:
        """Yield the new steps of a derivation, premises first and its root last."""
        stack: list[tuple[_Step, bool]] = [(root, False)]
        while stack:
            step, are_written = stack.pop()
            if _step_key(step) in self._numbers:
                continue
            inside = _inside(step, self._order)
            if are_written or not inside:
                yield step
                continue
            stack.append((step, True))
            stack += [(each, False) for each in reversed(inside)]

    def _step(self, step: _Step) -> Iterator[str]:
        at = rule = None
        place = step.span if isinstance(step, Given) and _leaf_location(step) is not None else None
        if place is not None:
            if place.path not in self._files:
                self._files[place.path] = len(self._files) + 1
                yield json.dumps({"file": self._files[place.path], "path": place.path})
            at = [self._files[place.path], place.line, place.column]
        if isinstance(step, Derived | NearMiss):
            if id(step.rule) not in self._rules:
                self._rules[id(step.rule)] = len(self._rules) + 1
                yield json.dumps({"rule": len(self._rules), **rule_json(step.rule)})
            rule = self._rules[id(step.rule)]
        number = self._numbers[_step_key(step)] = len(self._numbers) + 1
        entry: _Json = {"step": number, "kind": _step_kind(step), "atom": plain(step.atom)}
        entry |= {"says": _message(step), "at": at, "rule": rule}
        entry["with"] = _bindings(step) if isinstance(step, Derived | NearMiss) else {}
        entry["from"] = [self.number(each) for each in _inside(step, self._order)]
        match step:
            case Given(_, _, "computed"):
                entry["computed_from"] = [] if at is None else [at]
            case Given(_, _, "observed"):
                entry["at_s"] = step.seconds
            case NearMiss():
                entry["fails"] = step.fails
            case Derived() if id(step) in self._other_of:
                entry["other_of"] = self._other_of[id(step)]
            case _:
                pass
        yield json.dumps(entry)


def _step_key(step: _Step) -> object:
    """Return the identity of a step: type and atom of a leaf, `id` of other steps."""
    return (type(step), step.atom) if isinstance(step, Given | Absent) else id(step)


def _inside(step: _Step, order: PremiseOrder) -> Sequence[_Step]:
    match step:
        case Derived():
            return order.of(step)
        case Underivable(_, attempts):
            return attempts
        case NearMiss():
            return (*(() if step.cause is None else (step.cause,)), *step.held)
        case _:
            return ()


def _step_kind(step: _Step) -> str:
    match step:
        case Given(_, _, origin):
            return "given" if origin == "stated" else origin
        case Derived():
            return "chosen" if step.chosen else "derived"
        case Unexplained():
            return "given"
        case _:
            return "absent"


def _message(step: _Step) -> str | None:
    """Return the sentence of a step, or None if no rule states one."""
    match step:
        case Absent(_, _, external) if external is not None:
            return plain(step.message)
        case Absent() | Underivable() | NearMiss():
            return None if step.sentence is None else plain(step.sentence)
        case Unexplained():
            return step.reason
        case _:
            return step.message


def _leaf_location(leaf: Given) -> _Json | None:
    """Return the location of a fact as JSON, or None if it is in no file."""
    span: Span | None = leaf.span
    if span is None or is_pseudo(span):
        return None
    return {"path": span.path, "line": span.line, "column": span.column}


def _bindings(step: Derived | NearMiss) -> dict[str, str]:
    if isinstance(step, Derived):
        return step.values_written
    return {name: str(value) for name, value in step.bindings.items()}


def rule_json(rule: Rule) -> _Json:
    """Return a rule with its location as JSON values."""
    span = rule.span
    return {"id": rule.id, "path": span.path, "line": span.line, "text": plain(rule.text)}
