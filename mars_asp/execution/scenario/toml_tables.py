"""The tables of a TOML text, and the place of what makes it none."""

import re
import tomllib
from typing import Any

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point

#: A key of so many parts is none of ours, and takes its reader a time that grows as their square.
_DEEP = re.compile(r"(?<![\w.\"'-])(?:(?:[\w-]++|\"[^\"\n]*+\"|'[^'\n]*+')[ \t]*+\.[ \t]*+){100}")


def read_tables(text: str, path: str, code: str) -> dict[str, Any]:
    """Return the tables of a TOML text; `code` is that of what is wrong with it.

    Raises:
        MarsError: it is no TOML.
    """
    deep = _DEEP.search(text)
    if deep is not None:
        line = text.count("\n", 0, deep.start()) + 1
        raise _wrong(point(path, line, 1), "a key with more than 100 parts", code)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line, column = (int(place[1]), int(place[2])) if place else (text.count("\n") + 1, 1)
        raise _wrong(point(path, line, column), str(error).split(" (at")[0], code) from None
    except RecursionError:
        message = "its lists and tables are nested too deep"
        raise _wrong(point(path, 1, 1), message, code) from None
    except ValueError as error:  # a number of more digits than Python reads
        raise _wrong(point(path, 1, 1), str(error).split(";")[0], code) from None


def _wrong(span: Span, message: str, code: str) -> MarsError:
    return MarsError([Diagnostic(code, "error", message, span)])
