"""The arguments of annotations: modes, bounds, costs, vertices."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from typing import TypeAlias

from mars_asp.model.declarations import GRASP, MOTION_FUNCTIONS, Mode, Transformation
from mars_asp.model.modes import parse_mode
from mars_asp.model.ranges import BOUND, COST, FREQUENCY, PERIODS, RATE, VERTEX, Problem
from mars_asp.model.rates import Rate, every, read_frequency
from mars_asp.model.transformation import read_transformation
from mars_asp.spelling import suggestion

FUNCTIONS = (*MOTION_FUNCTIONS, GRASP)
_PERIODIC = "NotifyAtFrequency"
_PERIOD = re.compile(r"every\s+(\S+)\s+(ms|s)")
_RATE_POSITION = 2
_MODES = "write delivery modes, such as `NotifyWhenReady` or `NotifyAtFrequency 25`"

_BRACKETS = re.compile(r"[<([{>)\]}]")

Bounds: TypeAlias = tuple[Decimal | None, Decimal | None, Decimal | None]
#: Delivery modes, and the frequency of the periodic one.
Delivery: TypeAlias = tuple[tuple[Mode, ...], Fraction | None]


@dataclass(frozen=True, slots=True)
class ArgumentProblem:
    """A mistake in the arguments of an annotation.

    `begin` and `end` are indices of characters in the text; if `begin` is None, the whole
    annotation is wrong.
    """

    code: str
    message: str
    help: str
    begin: int | None = None
    end: int = 0


def read_commands(text: str) -> tuple[str, ...] | list[ArgumentProblem]:
    """Return the functions that a `@ControlOut` commands, or all problems with them."""
    wrong: list[ArgumentProblem] = []
    if text and not all(part.strip() for _, part in parts(text)):
        expected = "write a function after each comma"
        wrong.append(ArgumentProblem("MARS114", "a comma with no function beside it", expected))
    words = list(re.finditer(r"[^,\s]+", text))
    for word in words:
        if word[0] not in FUNCTIONS:
            expected = suggestion(word[0], FUNCTIONS, f"one of {', '.join(FUNCTIONS)}", 0.84)
            wrong.append(
                ArgumentProblem(
                    "MARS114",
                    f"`{word[0]}` is not a motion or grasp function",
                    expected,
                    *word.span(),
                )
            )
    return wrong or tuple(word[0] for word in words)


def read_cost(text: str) -> int | list[ArgumentProblem]:
    """Return the cost of `[COST]` of a `@Converts`, or its problem."""
    if not text:
        return 1
    cost = COST.read(text)
    if isinstance(cost, Problem):
        return [ArgumentProblem("MARS115", cost.message, cost.help, 0, len(text))]
    return int(cost)


def read_delivery(text: str) -> Delivery | list[ArgumentProblem]:
    """Return the modes and the frequency of `MODES [HZ]`, or all problems with them."""
    modes: list[Mode] = []
    hz: tuple[Fraction, int, int] | None = None
    wrong: list[ArgumentProblem] = []
    for begin, part in parts(text):
        words = re.fullmatch(r"\s*([^\W\d]\w*\s*(?:\([^()]*\))?)\s*(.*)", part)
        if words is None:
            wrong.append(_no_mode(part.strip(), begin + len(part) - len(part.lstrip())))
            continue
        mode = parse_mode(words[1])
        if isinstance(mode, Problem):
            at = begin + words.start(1)
            end = at + len(words[1].strip())
            wrong.append(ArgumentProblem("MARS111", mode.message, mode.help, at + mode.begin, end))
        else:
            modes.append(mode)
        written = words[2].strip()
        if written:
            at = begin + words.start(2)
            end = at + len(written)
            value = read_rate(written)
            if isinstance(value, Problem):
                wrong.append(ArgumentProblem("MARS113", value.message, value.help, at, end))
            elif hz is not None:
                help_text = f"`{_PERIODIC}` takes one frequency; drop the other"
                message = f"a second frequency, `{written}`"
                wrong.append(ArgumentProblem("MARS113", message, help_text, at, end))
            else:
                hz = value, at, end
    periodic = any(mode.name == _PERIODIC for mode in modes)
    if not wrong and periodic and hz is None:
        message = f"`{_PERIODIC}` without a frequency"
        wrong.append(
            ArgumentProblem("MARS112", message, f"write its frequency in Hz: `{_PERIODIC} 25`")
        )
    if not wrong and not periodic and hz is not None:
        message = f"a frequency without `{_PERIODIC}`"
        wrong.append(ArgumentProblem("MARS113", message, FREQUENCY.help, *hz[1:]))
    return wrong or (tuple(modes), hz[0] if hz else None)


@lru_cache(maxsize=1024)
def read_rate(text: str) -> Rate | Problem:
    """Return the rate of `HZ`, `every N ms` or `every N s`, or its problem."""
    period = _PERIOD.fullmatch(text)
    if period is None:
        return read_frequency(text)
    number = PERIODS[period[2]].read(period[1])
    return number if isinstance(number, Problem) else every(number, period[2])


def _no_mode(found: str, at: int) -> ArgumentProblem:
    if not found:
        return ArgumentProblem("MARS111", "no delivery mode is stated", _MODES)
    code = "MARS113" if re.match(r"[-+.\d]", found) else "MARS111"
    return ArgumentProblem(code, f"`{found}` is not a delivery mode", _MODES, at, at + len(found))


def read_bounds(text: str) -> Bounds | list[ArgumentProblem]:
    """Return the bounds of `[MIN MAX [RATE]]`, or all problems with them."""
    words = list(re.finditer(r"\S+", text))
    values: list[Decimal | None] = []
    wrong: list[ArgumentProblem] = []
    for position, word in enumerate(words):
        wanted = RATE if position == _RATE_POSITION else BOUND
        value = None if word[0] == "_" else wanted.read(word[0])
        if isinstance(value, Problem):
            wrong.append(ArgumentProblem("MARS116", value.message, value.help, *word.span()))
            value = None
        values.append(value)
    if not wrong and len(values) not in (0, 2, 3):
        wrong.append(
            ArgumentProblem("MARS116", f"expected bounds, found `{text}`", BOUND.help, 0, len(text))
        )
    low, high, rate = (*values, None, None, None)[:3]
    if low is not None and high is not None and low > high:
        message = f"bounds in the wrong order: MIN is `{words[0][0]}`, MAX is `{words[1][0]}`"
        help_text = f"swap them: `{words[1][0]} {words[0][0]}`"
        wrong.append(
            ArgumentProblem("MARS116", message, help_text, words[0].start(), words[1].end())
        )
    return wrong or (low, high, rate)


def read_vertex(text: str) -> tuple[int, Transformation] | list[ArgumentProblem]:
    """Return the number and transformation of `N [TRANSFORMATION]`, or all problems with them."""
    match = re.fullmatch(r"([-+.\w]+)\s*(?:\((.*)\))?", text)
    if match is None or not match[1].strip("+-.")[:1].isdecimal():
        expected = "write a number and a tuple: `@Vertex 1 (_,_,_,_,0,0,100)`"
        return [
            ArgumentProblem("MARS118", f"expected a vertex, found `{text}`", expected, 0, len(text))
        ]
    wrong: list[ArgumentProblem] = []
    number = VERTEX.read(match[1])
    if isinstance(number, Problem):
        wrong.append(ArgumentProblem("MARS118", number.message, number.help, *match.span(1)))
        number = Decimal(0)
    if match[2] is None:
        return wrong or (int(number), Transformation())
    slots: list[str] = []
    spans: list[tuple[int, int]] = []
    at = match.start(2)
    for part in match[2].split(","):
        begin = at + len(part) - len(part.lstrip())
        slots.append(part.strip())
        spans.append((begin, begin + len(slots[-1])))
        at += len(part) + 1
    found = read_transformation(slots)
    if isinstance(found, Transformation) and not wrong:
        return int(number), found
    for problem in () if isinstance(found, Transformation) else found:
        wrong.append(
            ArgumentProblem("MARS118", problem.message, problem.help, *spans[problem.begin])
        )
    return wrong


def parts(text: str) -> Iterator[tuple[int, str]]:
    """Yield offset and text between commas outside of brackets."""
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
