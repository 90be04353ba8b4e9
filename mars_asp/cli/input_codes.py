"""The codes of messages on reading, which `input_codes.toml` lists, and their meanings."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files


@dataclass(frozen=True, slots=True)
class InputCode:
    """The meaning of a code that messages on reading have, and whether `--ignore` takes it."""

    meaning: str
    can_be_ignored: bool


@cache
def input_codes() -> Mapping[str, InputCode]:
    """Return all codes: those of errors, then those and the kinds of warnings and notes."""
    # Most commands need no code.
    import tomllib

    text = (files(__package__) / "input_codes.toml").read_text(encoding="utf-8")
    return {
        name: InputCode(meaning, table == "warnings")
        for table, meanings in tomllib.loads(text).items()
        for name, meaning in meanings.items()
    }


def ignorable_codes() -> frozenset[str]:
    """Return the codes and kinds of messages on reading that `--ignore` takes."""
    return frozenset(name for name, code in input_codes().items() if code.can_be_ignored)


def is_input_error(name: str) -> bool:
    """Whether a name is the code of an error of the input, which cannot be ignored."""
    code = input_codes().get(name)
    return code is not None and not code.can_be_ignored
