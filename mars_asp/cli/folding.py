"""Equal findings of modules that one block describes, or of a file included twice, shown as one."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from mars_asp.cli.results import Result
from mars_asp.diagnostic import Diagnostic, Span
from mars_asp.model.declarations import Configuration, Name
from mars_asp.output import listing

#: Of more than `_MOST_NAMED` instances only the first `_NAMED` are named.
_NAMED, _MOST_NAMED = 2, 4
#: Replaces the name of an instance to compare texts.
_ANY = "\0"


def fold(results: Iterable[Result], instances: Mapping[str, str]) -> list[Result]:
    """Return results; those that differ only in the name of an instance become one.

    `instances` maps each module to the name of its instance. Findings whose repairs edit different
    lines are not folded.
    """
    alike: dict[object, list[tuple[str, Result]]] = {}
    for number, result in enumerate(results):
        subject = "" if result.consequence is None else result.consequence.subject
        name = instances.get(subject) or instances.get(subject.rpartition(".")[0])
        lines = result.suggestion and result.suggestion.edits
        key = number if name is None else (_texts(result.diagnostic, name), lines)
        alike.setdefault(key, []).append((name or "", result))
    return [_name_instances(same) for same in alike.values()]


def instances_of(configuration: Configuration) -> Mapping[str, str]:
    """Return the name of the instance to which each module belongs, if it has twins.

    A module of an included file has one location, however often the file is included.
    """
    located: dict[Span, list[Name]] = {}
    for name in configuration.modules:
        located.setdefault(name.span, []).append(name)
    names: dict[str, str] = {}
    for same in located.values():
        if len(same) == 1:
            names.update({each.text: each.text for each in same if each.described is not None})
            continue
        parts = [each.text.split("/") for each in same]
        tail = 0
        while tail + 1 < min(map(len, parts)) and len({each[-tail - 1] for each in parts}) == 1:
            tail += 1
        for each, part in zip(same, parts, strict=True):
            names[each.text] = "/".join(part[: len(part) - tail])
    return names


def natural_order(text: str) -> tuple[object, ...]:
    """Return a key that sorts numbers within names by their value: robot2 before robot10."""
    parts = re.split(r"([0-9]+)", text)
    # Of numbers without leading zeros the longer is greater; `int` refuses very long ones.
    return tuple(
        (len(part.lstrip("0")), part.lstrip("0"), part) if at % 2 else part
        for at, part in enumerate(parts)
    )


def _texts(found: Diagnostic, name: str) -> object:
    """Return a key of a finding that is equal for findings that differ only in the name."""
    pattern = re.compile(rf"(?<=`){re.escape(name)}(?=[`./])")
    texts = (found.message, found.help, found.effect, *(text for _, text in found.labels))
    plain = tuple(text and pattern.sub(_ANY, text) for text in texts)
    return found.code, found.severity, found.span, tuple(at for at, _ in found.labels), plain


def _name_instances(same: Sequence[tuple[str, Result]]) -> Result:
    """Return one result for several equal ones; it lists the names of the instances."""
    if len(same) == 1:
        return same[0][1]
    names = sorted({name for name, _ in same}, key=natural_order)
    first = next(result for name, result in same if name == names[0])
    message = f"{first.diagnostic.message}, in {_instance_list(names)}"
    return first._replace(diagnostic=replace(first.diagnostic, message=message))


def _instance_list(names: Iterable[str]) -> str:
    shown = [f"`{name}`" for name in names]
    if len(shown) > _MOST_NAMED:
        shown = [*shown[:_NAMED], f"{len(shown) - _NAMED} more"]
    return listing(shown)
