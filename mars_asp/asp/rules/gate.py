"""Checks of a rule file before clingo reads it.

Each check prevents a hang, a crash or a wrong reading of the solver: a scripted or included file, a
byte that kills its logger, a term so deep that its parser overflows.
"""

import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from mars_asp.diagnostic import Diagnostic, MarsError, point
from mars_asp.reading import WallError, overlay_bytes, read_file

MOST_BYTES = 8 * 1024 * 1024
MOST_STATEMENTS = 100_000
MOST_STATEMENT = 64 * 1024
MOST_NESTING = 200
MOST_OPERATORS = 4096
#: The maximal number of refusals that are reported for one file.
_MOST_REFUSALS = 20
_REFUSED = re.compile(r"#\s*(include|script|theory|program|external|edge|heuristic)\b")
#: For the caller's own files, in which included files are resolved already.
_REFUSED_OWN = re.compile(r"#\s*(include|script|theory|edge|heuristic)\b")
#: Strings, comments, and `#include`.
_INCLUDING = re.compile(r'"(?:[^"\\\n]|\\["\\n])*"|%\*|%[^\n]*|#\s*include\b')
_INCLUDE = re.compile(r'#include\s*"([^"\\\n]+)"\s*\.')
#: Relevant tokens of clingo's scanner: strings, comments, ends of statements, brackets, operators.
_TOKEN = re.compile(
    r'"(?:[^"\\\n]|\\["\\n])*"|%\*|%[^\n]*|\.\.?|[()\[\]{},;:]|[-+*/\\&?^|~]|[^\t\n\r -~]+'
)
#: The marks in a block comment, where `%` begins a comment to the end of its line.
_COMMENTED = re.compile(r"%\*|\*%|%[^\n]*")


def gate_text(path: Path, shown: str) -> str:
    """Return the text of a rule file.

    Raises:
        MarsError: the file cannot be read, or clingo must not read it.
    """
    text = read_text(path, shown)
    check_text(text, shown)
    return text


class IncludedFile(NamedTuple):
    """A statement `#include`: the path in it, and the location of its begin."""

    path: str
    begin: tuple[int, int]


def included(text: str, shown: str) -> tuple[str, list[IncludedFile], list[Diagnostic]]:
    """Return a text with `#include` statements blanked, these statements, and errors in them.

    All other text keeps its location. Also in comments the word is masked, so that clingo cannot
    read a file if it ends a comment differently.
    """
    found: list[IncludedFile] = []
    wrong: list[Diagnostic] = []
    parts: list[str] = []
    at = kept = 0
    while match := _INCLUDING.search(text, at):
        begin, at = match.span()
        if match[0].startswith("%"):
            at = _closed(text, at) if match[0] == "%*" else at
            parts += (text[kept:begin], text[begin:at].replace("#include", " include"))
            kept = at
        elif match[0].startswith("#"):
            line = text.count("\n", 0, begin) + 1
            column = begin - text.rfind("\n", 0, begin)
            statement = _INCLUDE.match(text, begin)
            if statement is None:
                advice = 'write `#include "file.lp".`, with `/` in the path'
                wrong.append(_refusal(shown, line, column, "`#include` names no file", advice))
            else:
                at = statement.end()
                found.append(IncludedFile(statement[1], (line, column)))
            parts += (text[kept:begin], re.sub(r"[^\n]", " ", text[begin:at]))
            kept = at
    return "".join((*parts, text[kept:])), found, wrong


def read_text(path: Path, shown: str) -> str:
    """Return the text of a regular file of limited size; errors call it `shown`.

    Raises:
        MarsError: the file cannot be read.
    """
    try:
        held = overlay_bytes(path)
        if held is None and not stat.S_ISREG(path.stat().st_mode):
            raise _refusal_error(shown, "no regular file", "name a file or a folder of `.lp` files")
        raw = read_file(path, MOST_BYTES) if held is None else held
        if len(raw) > MOST_BYTES:
            raise _refusal_error(shown, f"larger than {MOST_BYTES} bytes", "split it by topic")
        text = raw.decode("utf-8")
    except WallError as error:
        advice = error.advice or "put the rules themselves there"
        raise _refusal_error(shown, str(error.strerror), advice) from None
    except OSError as error:
        raise _refusal_error(shown, str(error.strerror), "make the file readable") from None
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise _refusal_error(shown, "not UTF-8", "save it as UTF-8", line) from None
    return text


def check_text(text: str, shown: str, is_own: bool = False) -> None:
    """Raise MarsError if clingo must not read a text, with the first reasons.

    `is_own` relaxes the check for a caller's own text.

    Raises:
        MarsError: with the first reasons.
    """
    found: list[Diagnostic] = []
    for offset, what, advice in _forbidden_text(text, _REFUSED_OWN if is_own else _REFUSED):
        line = text.count("\n", 0, offset) + 1
        column = offset - text.rfind("\n", 0, offset)
        found.append(_refusal(shown, line, column, what, advice))
        if len(found) == _MOST_REFUSALS:
            break
    if found:
        raise MarsError(found)


def _forbidden_text(text: str, refused: re.Pattern[str]) -> Iterator[tuple[int, str, str]]:
    """Yield offset, description and advice for text that clingo must not read."""
    for sign, name in (("\ufeff", "a byte order mark"), ("\0", "a NUL character")):
        if sign in text:
            yield text.index(sign), f"holds {name}", "remove it"
            return
    if text.lstrip().startswith("asp "):
        yield 0, "an intermediate format, not rules", "pass the rules themselves"
    for match in refused.finditer(text):
        yield match.start(), f"`#{match[1]}` is not allowed", "leave it out"
    yield from _unfit(text)


def _unfit(text: str) -> Iterator[tuple[int, str, str]]:
    """Yield offset, description and advice: overlong or too deep statements, invalid characters.

    As in clingo, comments and strings do not count. The depth of a term is the number of open
    brackets and of the operators between two commas: `1+1+1` is `(1+1)+1`.
    """
    begin = commented = operators = statements = 0
    result = False
    # The number of operators so far in each open bracket.
    open_ = [0]
    depth = 0
    for at, end, token in _tokens(text):
        sign = token[0]
        if sign == "%":
            commented += end - at
        elif token == ".":
            statements += 1
            if statements > MOST_STATEMENTS:
                advice = f"a file holds at most {MOST_STATEMENTS}: split it"
                yield at, "too many statements", advice
                return
            begin, commented, operators, result, open_, depth = end, 0, 0, False, [0], 0
        elif sign in "([{":
            open_.append(0)
            depth += 1
        elif sign in ")]}":
            if len(open_) > 1:
                depth -= open_.pop() + 1
        elif sign in ",;:":
            depth -= open_[-1]
            open_[-1] = 0
        elif not " " <= sign <= "~":
            yield (
                at,
                f"`{token}` is outside of comments and strings",
                "names are of ASCII letters, digits and `_`; put any others in a string",
            )
        elif sign != '"':
            operators += 1
            open_[-1] += 1
            depth += 1
        if result:
            continue
        if depth > MOST_NESTING:
            result = True
            yield at, "nested too deep", f"at most {MOST_NESTING} brackets and operators deep"
        elif operators > MOST_OPERATORS or end - begin - commented > MOST_STATEMENT:
            result = True
            yield at, "a statement too long", "split it"


def _tokens(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield the begin, the end and the text of each relevant token; at last the end of the text."""
    at = 0
    while match := _TOKEN.search(text, at):
        begin, at = match.span()
        if match[0] == "%*":
            at = _closed(text, at)
        yield begin, at, match[0]
    yield len(text), len(text), '"'


def _closed(text: str, at: int) -> int:
    """Return the end of the block comment around an offset."""
    depth = 1
    while depth and (match := _COMMENTED.search(text, at)):
        at = match.end()
        depth += {"%*": 1, "*%": -1}.get(match[0], 0)
    return len(text) if depth else at


def _refusal_error(shown: str, what: str, advice: str, line: int = 0) -> MarsError:
    return MarsError((_refusal(shown, line, min(line, 1), what, advice),))


def _refusal(shown: str, line: int, column: int, what: str, advice: str) -> Diagnostic:
    message = f"`{shown}` cannot be used as rules: {what}"
    return Diagnostic("rules-refused", "error", message, point(shown, line, column), help=advice)
