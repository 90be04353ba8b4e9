"""A fast reader of simple one-line statements, without the grammar.

It returns the same values as the grammar, which a test checks; all other statements are left.
"""

import re
from itertools import accumulate
from typing import TypeAlias

from mars_asp.language.statements import Raw, Word
from mars_asp.model.names import BARE

#: The offsets at which a line's statement begins and ends, and the statement.
Read: TypeAlias = tuple[int, int, Raw]
_BLANK = r"[^\S\n]"
_NAME = BARE
_MODE = r"(?!every(?!\w))[A-Za-z_]\w*+"
_NUMBER = r"[+-]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)(?:[eE][+-]?[0-9]++)?"
_VALUE = r"[^\s\",()]++"
_GAP = f"{_BLANK}++"
#: The groups of each alternative are the children of the grammar's rule.
_LINE = re.compile(
    rf"""^{_BLANK}*+(?:
      ({_NAME})(?:\.({_NAME}))?{_GAP}uses_data_from{_GAP}({_NAME})(?:\.({_NAME}))?
        (?:{_GAP}({_MODE}))?(?:{_GAP}({_NUMBER}))?
    | ({_NAME}){_GAP}is_controlled_by{_GAP}({_NAME})
        (?:{_GAP}({_NUMBER}))?(?:{_GAP}hold{_GAP}({_NUMBER}|forever))?
        (?:{_GAP}allocation{_GAP}(root|split))?
    | ({_NAME})(?:{_GAP}({_NUMBER}))?{_GAP}is_mounted_on{_GAP}({_NAME})
        (?:{_GAP}({_NUMBER}))?
    | (@configuration|@specification)
        (?:{_GAP}(flat|hierarchical))?(?:{_GAP}period{_GAP}({_NUMBER}))?
    | ({_NAME})(?:\.({_NAME}))?{_GAP}(is_suppressed_by|is_inhibited_by)
        {_GAP}({_NAME})(?:\.({_NAME}))?{_GAP}({_NUMBER})
    | ({_NAME}){_GAP}is_locked_by{_GAP}({_NAME})(?:\.({_NAME}))?
        (?:{_GAP}({_NUMBER}))?(?:{_GAP}hold{_GAP}({_NUMBER}))?
    | ({_NAME}){_GAP}@Tag{_GAP}({_NAME})
    | ({_NAME}){_GAP}@Property{_GAP}({_NAME}){_GAP}({_VALUE})
    | @modules{_GAP}({_NAME}(?:{_BLANK}*+,{_BLANK}*+{_NAME})*+)
    ){_BLANK}*+$""",
    re.MULTILINE | re.VERBOSE,
)
_RULES = (
    *(("data", 6), ("control", 5), ("mount", 4), ("header", 3)),
    *(("gating", 6), ("lock", 5)),
    *(("tag", 2), ("property", 3), ("modules", 1)),
)
#: The rule and its groups, by the last group that matched.
_BY_GROUP = {
    first + number: (rule, range(first, first + count))
    for (rule, count), first in zip(
        _RULES, accumulate((count for _, count in _RULES), initial=1), strict=False
    )
    for number in range(count)
}
_NAMES = re.compile(_NAME)


def read_lines(text: str) -> tuple[list[Read], str | None]:
    """Return simple statements as (begin, end, raw), and the remaining text, None if blank.

    Offsets refer to `text`; statements are blanked in the remaining text.
    """
    read = [_read_match(match) for match in _LINE.finditer(text)]
    at = 0
    pieces: list[str] = []
    for begin, end, _ in read:
        pieces += (text[at:begin], " " * (end - begin))
        at = end
    pieces.append(text[at:])
    return read, "".join(pieces) if any(piece.strip() for piece in pieces[::2]) else None


def _read_match(match: re.Match[str]) -> Read:
    assert match.lastindex is not None
    rule, groups = _BY_GROUP[match.lastindex]
    begin, end = match.span()
    if rule == "modules":
        names = _NAMES.finditer(match.string, *match.span(match.lastindex))
        return begin, end, (rule, [Word(name[0], *name.span()) for name in names])
    words: list[Word | Raw | None] = [
        None if match[group] is None else Word(match[group], *match.span(group)) for group in groups
    ]
    if rule == "control":
        return begin, end, (rule, [words[0], ("controller", words[1:])])
    if rule == "mount":
        words.append(None)
    return begin, end, (rule, words)
