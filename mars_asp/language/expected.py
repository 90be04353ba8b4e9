"""Diagnostics of statements that do not parse, with the expected words."""

import re
from decimal import Decimal

from lark import UnexpectedInput

from mars_asp.diagnostic import Diagnostic
from mars_asp.language.layout import Layout
from mars_asp.model.declarations import GATING, VERBS
from mars_asp.model.names import UNSEEN
from mars_asp.spelling import suggestion

KEYWORDS = (
    "@configuration",
    "@specification",
    "@modules",
    "@sources",
    "@include",
    *VERBS,
    "@Tag",
    "@Property",
)
_WORDS = (
    "flat",
    "hierarchical",
    "period",
    "hold",
    "forever",
    "every",
    "allocation",
    "root",
    "split",
    "latest",
    "weighted",
)
_GATE = "write the milliseconds: `{} 300`"
#: Advice on side lines; `{}` is such a line up to its source.
_FORMS = {
    **dict.fromkeys(GATING.values(), _GATE),
    "is_reset_by": "write one line for each source: `{}`",
    "is_locked_by": "write one line for each source, with a priority and a time in ms if needed: "
    "`{} 200 hold 500`",
    "is_limited_by": "write one line for each source, with a time in ms if needed: `{} hold 500`",
    "is_arbitrated_by": "write the strategy, and for a mean its period in ms: `{} flat period 100`",
}
_SIDE_LINE = re.compile(rf'\s*(.+?\s({"|".join(_FORMS)})(?!\w))\s*("[^"]*"[^\s,]*|[^\s,]*)')
_RELATIONSHIPS = frozenset(f"_{verb.upper()}" for verb in VERBS) | {"SIGN"}
#: The texts of terminals in messages; that of a keyword has the keyword's name.
_SHOWN = {
    **{f"_{word.lstrip('@').upper()}": f"`{word}`" for word in (*KEYWORDS, *_WORDS)},
    "NAME": "a module name",
    "NUMBER": "a number",
    "PORT": "`.` and the name of a port",
    "UNIT": "`ms` or `s`",
    "COLON": "`:`",
    "MODE": "a delivery mode",
    "SLOT": "an axis, a number or `_`",
    "PATH": "a path",
    "ARCHITECTURE": "`flat` or `hierarchical`",
    "KIND": "`@configuration`",
    "COMMA": "`,`",
    "LPAR": "`(`",
    "RPAR": "`)`",
    "_NEWLINE": "the end of the line",
    "$END": "the end of the line",
    "STRATEGY": "`hierarchical`, `latest`, `flat` or `weighted`",
    "FOREVER": "`forever`",
    "PROVIDER": "`root` or `split`",
    "VALUE": "a value",
}
_WORD = re.compile(r"@?[^\s,()]+|\S")
_NUMBER = r"[0-9]+\.?[0-9]*|\.[0-9]+"
_UNIT = re.compile(rf"({_NUMBER})?(ms|s|Hz)", re.IGNORECASE)
_UNSEEN_HELP = "a name contains no control characters and no marks of direction"
_UNSEEN_NAME = re.compile(rf'\.?"[^"]*[{UNSEEN}]')


def describe(layout: Layout, base: int, piece: str, error: UnexpectedInput) -> Diagnostic:
    """Return the syntax error of the statement `piece`, which begins at offset `base`."""
    at = min(max(error.pos_in_stream or 0, 0), len(piece))
    match = _WORD.search(piece, at)
    found = f"`{match[0]}`" if match else "the end of the line"
    begin, end = match.span() if match else (len(piece.rstrip()), len(piece.rstrip()) + 1)
    terminals = getattr(error, "accepts", None) or getattr(error, "expected", None)
    terminals = terminals or getattr(error, "allowed", None) or ()
    names = set(map(str, terminals))
    hint = (
        _UNSEEN_HELP
        if _UNSEEN_NAME.match(piece, begin)
        else _unit_hint(piece[:begin].split(), match[0] if match else "")
        or _hint(piece, match[0] if match else "", "_IS_CONTROLLED_BY" not in names)
    )
    if "_IS_CONTROLLED_BY" in names:
        # Where any relationship may follow, the help lists them.
        names = names - _RELATIONSHIPS | {"a relationship"}
    if "SIGN" in names:
        names = names - {"SIGN"} | {f"`{verb}`" for verb in GATING.values()}
    wanted = sorted({_SHOWN.get(name, name) for name in names})
    if not wanted or not piece[:begin].strip():
        wanted = [
            "a relationship",
            "`@configuration`",
            "`@include`",
            "`@modules`",
            "`@sources`",
        ]
    expected = (
        f"expected {', '.join(wanted[:-1])} or {wanted[-1]}"
        if wanted[1:]
        else f"expected {wanted[0]}"
    )
    span = layout.span(base + begin, base + end)
    return Diagnostic(
        "syntax",
        "error",
        f"found {found}, {expected}",
        span,
        help=hint,
        excerpt=layout.line(span.line).rstrip(" "),
    )


def _unit_hint(before: list[str], found: str) -> str | None:
    """Return advice on `found`, a unit or a number with one, after the words `before`, or None."""
    match = _UNIT.fullmatch(found)
    if not match or len(before) < 2:
        return None
    number, unit = match[1], match[2].lower()
    if "every" in before[-2:]:
        separate = number and unit != "hz"
        return f"leave a blank before the unit: `{number} {unit}`" if separate else None
    timed = (before if number else before[:-1])[-1] in ("hold", "period")
    full = number or before[-1]
    if not re.fullmatch(_NUMBER, full):
        return None
    if unit != "hz" and (timed or before[1] in GATING.values()):
        text = full if unit == "ms" else f"{Decimal(full) * 1000:.0f}"
        return f"write `{text}`: such times are in ms and have no unit"
    if unit == "hz" and before[1] == "uses_data_from":
        return f"write `{full}`: rates are in Hz and have no unit"
    return None


def _hint(piece: str, found: str, is_after_verb: bool) -> str | None:
    """Return advice on a syntax error at the word `found`, or None if there is no likely cause."""
    if found in KEYWORDS and "," in piece[: piece.rfind(found)]:
        return "the `,` before it continues the list; drop it where the list ends"
    words = [found, *_WORD.findall(piece)]
    for word in words:
        vocabulary = (*KEYWORDS, *_WORDS) if word == found and is_after_verb else KEYWORDS
        if word in vocabulary or len(word) < 3:
            continue
        if advice := suggestion(word.lower(), vocabulary, None, 0.75):
            return advice
    if not piece.lstrip().startswith("@") and not any(word in words for word in KEYWORDS):
        listed = [f"`{verb}`" for verb in VERBS]
        return f"a line relates modules by {', '.join(listed[:-1])} or {listed[-1]}"
    if line := _SIDE_LINE.match(piece):
        source = "" if line[2] == "is_arbitrated_by" else f" {line[3] or 'MODULE'}"
        return _FORMS[line[2]].format(line[1] + source)
    return None
