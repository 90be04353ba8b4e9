"""What stands behind an annotation's word: modes, bounds, costs, vertices."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from typing import TypeAlias

from mars_asp.model import GRASP, MOTION_FUNCTIONS, Mode, Transformation
from mars_asp.modes import ModeProblem, parse_mode, parse_number
from mars_asp.spelling import nearest
from mars_asp.tuples import read_transformation

FUNCTIONS = (*MOTION_FUNCTIONS, GRASP)
_PERIODIC = "NotifyAtFrequency"
_HIGHEST_HZ = 2_000_000
_MODES = "write delivery modes, such as `NotifyWhenReady` or `NotifyAtFrequency 25`"
_HZ = "write a positive number of Hz without a unit, such as `NotifyAtFrequency 25`"
_BOUNDS = "write `MIN MAX` or `MIN MAX RATE` as numbers, `_` for an open bound"
_RATE = "write the speed without its direction, in degrees or mm per second"

_BRACKETS = re.compile(r"[<([{>)\]}]")

Bounds: TypeAlias = tuple[Decimal | None, Decimal | None, Decimal | None]


@dataclass(frozen=True, slots=True)
class Wrong:
    """What is wrong with what stands behind a word.

    `begin` and `end` count the characters of the text; where `begin` is `None` it is the annotation
    as a whole that is wrong.
    """

    code: str
    message: str
    help: str
    begin: int | None = None
    end: int = 0


def read_commands(text: str) -> tuple[str, ...] | Wrong:
    """Read the functions that a `@ControlOut` commands."""
    words = list(re.finditer(r"[^,\s]+", text))
    for word in words:
        if word[0] not in FUNCTIONS:
            near = nearest(word[0], FUNCTIONS, 0.84)
            expected = f"did you mean `{near}`?" if near else f"one of {', '.join(FUNCTIONS)}"
            return Wrong("MARS114", f"`{word[0]}` is no function", expected, *word.span())
    return tuple(word[0] for word in words)


def read_cost(text: str) -> int | Wrong:
    """Read `[COST]` of a `@Converts`."""
    if not text:
        return 1
    if re.fullmatch(r"[0-9]{1,10}", text) and 0 < int(text) < 2**31:
        return int(text)
    return Wrong("MARS115", f"`{text}` is no cost", "write a positive whole number", 0, len(text))


def read_delivery(text: str) -> tuple[tuple[Mode, ...], Decimal | None] | Wrong:
    """Read `MODES [HZ]`."""
    modes: list[Mode] = []
    hz: tuple[Decimal, int, int] | None = None
    for begin, part in parts(text):
        words = re.fullmatch(r"\s*([^\W\d]\w*\s*(?:\([^()]*\))?)\s*(.*)", part)
        if words is None:
            return _no_mode(part.strip(), begin + len(part) - len(part.lstrip()))
        mode = parse_mode(words[1])
        if isinstance(mode, ModeProblem):
            at = begin + words.start(1)
            end = at + len(words[1].strip())
            return Wrong("MARS111", mode.message, mode.help, at + mode.offset, end)
        modes.append(mode)
        if words[2]:
            at = begin + words.start(2)
            value = parse_number(words[2].strip())
            end = at + len(words[2].strip())
            if value is not None and hz is not None:
                message = f"a second frequency, `{words[2].strip()}`"
                return Wrong(
                    "MARS113", message, f"one belongs to `{_PERIODIC}`, drop the other", at, end
                )
            if value is None or not 0 < value <= _HIGHEST_HZ:
                return Wrong("MARS113", f"`{words[2].strip()}` is no frequency", _HZ, at, end)
            hz = value, at, end
    periodic = any(mode.name == _PERIODIC for mode in modes)
    if periodic and hz is None:
        message = f"`{_PERIODIC}` without a frequency"
        return Wrong("MARS112", message, f"write its number of Hz: `{_PERIODIC} 25`")
    if hz is not None and not periodic:
        return Wrong("MARS113", f"a frequency without `{_PERIODIC}`", _HZ, *hz[1:])
    return tuple(modes), hz[0] if hz else None


def _no_mode(found: str, at: int) -> Wrong:
    if not found:
        return Wrong("MARS111", "no delivery mode is stated", _MODES)
    code = "MARS113" if re.match(r"[-+.\d]", found) else "MARS111"
    return Wrong(code, f"`{found}` is no delivery mode", _MODES, at, at + len(found))


def read_bounds(text: str) -> Bounds | Wrong:
    """Read `[MIN MAX [RATE]]`."""
    words = list(re.finditer(r"\S+", text))
    values = [None if word[0] == "_" else parse_number(word[0]) for word in words]
    for word, value in zip(words, values, strict=True):
        if value is None and word[0] != "_":
            return Wrong("MARS116", f"`{word[0]}` is no bound", _BOUNDS, *word.span())
    if len(values) not in (0, 2, 3):
        return Wrong("MARS116", f"`{text}` are no bounds", _BOUNDS, 0, len(text))
    low, high, rate = (*values, None, None, None)[:3]
    if low is not None and high is not None and low > high:
        message = f"bounds in the wrong order: MIN is `{words[0][0]}`, MAX is `{words[1][0]}`"
        help_text = f"swap them: `{words[1][0]} {words[0][0]}`"
        return Wrong("MARS116", message, help_text, words[0].start(), words[1].end())
    if rate is not None and rate <= 0:
        message = f"RATE is `{words[2][0]}`, which is not above 0"
        return Wrong("MARS116", message, _RATE, *words[2].span())
    return low, high, rate


def read_vertex(text: str) -> tuple[int, Transformation] | Wrong:
    """Read `N [TRANSFORMATION]`."""
    match = re.fullmatch(r"([0-9]{1,6})\s*(?:\((.*)\))?", text)
    transformation: Transformation | tuple[int, str, str] = Transformation()
    if match and match[2] is not None:
        transformation = read_transformation([slot.strip() for slot in match[2].split(",")])
    if match is None or isinstance(transformation, tuple):
        expected = "write a number and a tuple: `@Vertex 1 (_,_,_,_,0,0,100)`"
        return Wrong("MARS118", f"`{text}` is no vertex", expected, 0, len(text))
    return int(match[1]), transformation


def parts(text: str) -> Iterator[tuple[int, str]]:
    """Yield what commas outside of brackets part, and where each begins."""
    if not _BRACKETS.search(text):
        begin = 0
        for part in text.split(","):
            yield begin, part
            begin += len(part) + 1
        return
    depth = begin = 0
    for index, character in enumerate(text):
        depth += (character in "<([{") - (character in ">)]}")
        if character == "," and depth <= 0:
            yield begin, text[begin:index]
            begin, depth = index + 1, 0
    yield begin, text[begin:]
