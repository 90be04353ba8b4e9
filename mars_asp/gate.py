"""What a rule file must be before clingo sees it.

Each check answers a way to hang, crash or mislead the solver: a scripted or included file, a byte
that kills its logger, a term so deep that its parser overflows.
"""

import re
import stat
from pathlib import Path

from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.source import point

MOST_BYTES = 8 * 1024 * 1024
MOST_STATEMENT = 64 * 1024
MOST_NESTING = 200
MOST_OPERATORS = 4096
_REFUSED = re.compile(r"#\s*(include|script|theory|program|external|edge|heuristic)\b")
_BRACKET = re.compile(r"[()\[\]{}]")
_OPERATOR = re.compile(r"[-+*/\\&?^|]|\.\.")


def gate_text(path: Path, shown: str) -> str:
    """Return the text of a rule file.

    Raises:
        MarsError: the file cannot be read or may not be given to clingo.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise _refusal(shown, 1, 1, "no regular file", "name a file or a folder of `.lp` files")
        if path.stat().st_size > MOST_BYTES:
            raise _refusal(shown, 1, 1, f"larger than {MOST_BYTES} bytes", "split it by topic")
        raw = path.read_bytes()
        text = raw.decode("utf-8")
    except OSError as error:
        raise _refusal(shown, 1, 1, str(error.strerror), "make the file readable") from None
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise _refusal(shown, line, 1, "not UTF-8", "save it as UTF-8") from None
    check_text(text, shown)
    return text


def check_text(text: str, shown: str) -> None:
    """Refuse a text that may not be given to clingo.

    Raises:
        MarsError: with the first reason.
    """
    for sign, name in (("\ufeff", "a byte order mark"), ("\0", "a NUL character")):
        if sign in text:
            raise _refusal(shown, _line(text, text.index(sign)), 1, f"holds {name}", "remove it")
    if text.lstrip().startswith("asp "):
        raise _refusal(shown, 1, 1, "an intermediate format, no rules", "give the rules themselves")
    match = _REFUSED.search(text)
    if match:
        line = _line(text, match.start())
        column = match.start() - text.rfind("\n", 0, match.start())
        raise _refusal(shown, line, column, f"`#{match[1]}` is not allowed", "leave it out")
    nesting = statement = operators = 0
    for number, line_text in enumerate(text.split("\n"), 1):
        statement += len(line_text)
        operators += len(_OPERATOR.findall(line_text))
        for bracket in _BRACKET.findall(line_text):
            nesting += 1 if bracket in "([{" else -1
            if nesting > MOST_NESTING:
                raise _refusal(shown, number, 1, "nested too deep", f"at most {MOST_NESTING} deep")
        if "." in line_text:
            nesting = max(0, min(nesting, MOST_NESTING))
        if statement > MOST_STATEMENT or operators > MOST_OPERATORS:
            raise _refusal(shown, number, 1, "a statement too long", "split it")
        if line_text.rstrip().endswith((".", "*%")) or line_text.lstrip().startswith("%"):
            nesting = statement = operators = 0


def _line(text: str, offset: int) -> int:
    return text.count("\n", 0, offset) + 1


def _refusal(shown: str, line: int, column: int, what: str, help_text: str) -> MarsError:
    message = f"`{shown}` cannot be used as rules: {what}"
    return MarsError(
        (Diagnostic("rules-refused", "error", message, point(shown, line, column), help=help_text),)
    )
