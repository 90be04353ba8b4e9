"""Attributes of modules, `@Tag safety_critical` and `@Property latency_ms 60`, as they are written.

Rule packs declare the attributes and their values; this module only reads the syntax.
"""

import re
from dataclasses import dataclass

from mars_asp.diagnostic import Span
from mars_asp.model.names import BARE, QUOTED
from mars_asp.model.ranges import Problem

TAG, PROPERTY = "Tag", "Property"
WORDS = (TAG, PROPERTY)
_NAME = r"[A-Za-z_]\w*"
_NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)"
#: A number, with or without its unit.
_MEASURE = rf"({_NUMBER})\s*([^\W\d_]+(?:/[^\W\d_]+)?|%)?"
_VALUE = rf"{_MEASURE}|{BARE}|{QUOTED}"


@dataclass(frozen=True, slots=True)
class Attribute:
    """A tag or property; `value` is as written, with quotes, and None for a tag."""

    name: str
    span: Span
    value: str | None = None

    @property
    def word(self) -> str:
        """Return the keyword of the annotation: `Tag` or `Property`."""
        return TAG if self.value is None else PROPERTY


@dataclass(frozen=True, slots=True)
class Attributed:
    """A line that states an attribute of a module: `Camera @Tag safety_critical`."""

    module: str
    attribute: Attribute


def read_attribute(word: str, text: str) -> tuple[str, str | None] | Problem:
    """Return the name and the value after `@Tag` or `@Property`, or the error."""
    name, value = (*re.split(r"\s+", text.strip(), maxsplit=1), "")[:2]
    begin = len(text.rstrip()) - len(value)
    if not re.fullmatch(_NAME, name):
        found = f"found `{name}`" if name else "found nothing"
        help_text = f"write `{_attribute_form(word)}`, the name in letters, digits and `_`"
        return Problem(f"expected a name after `@{word}`, {found}", help_text, 0, len(name))
    if word == TAG:
        if value:
            message = f"expected nothing after `@Tag {name}`, found `{value}`"
            help_text = f"a tag has no value; write `@Property {name} VALUE` for one that has"
            return Problem(message, help_text, begin, len(text))
        return name, None
    if not value:
        message = f"`@Property {name}` without a value"
        help_text = f"write `{_attribute_form(word)}`, or `@Tag {name}` for what has no value"
        return Problem(message, help_text, 0, len(text))
    if not re.fullmatch(_VALUE, value):
        message = f"expected a value, found `{value}`"
        help_text = "write a number, a word, or text in double quotes"
        return Problem(message, help_text, begin, len(text))
    return name, value if value.startswith('"') else " ".join(value.split())


def read_measure(value: str) -> tuple[str, str] | None:
    """Return number and unit ("" if none) of a value such as `60 ms`, or None for other values."""
    match = re.fullmatch(_MEASURE, value)
    return None if match is None else (match[1], match[2] or "")


def _attribute_form(word: str) -> str:
    return "@Tag NAME" if word == TAG else "@Property NAME VALUE"
