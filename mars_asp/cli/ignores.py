"""Comments that hide findings: `mars: ignore[KIND, KIND] reason`, in the syntax of their file.

Such a comment hides findings whose first location is on its own line.
"""

import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from mars_asp.annotations.languages import LANGUAGES
from mars_asp.diagnostic import FileText, Span
from mars_asp.language.parse import MOST_BYTES, plain_lines
from mars_asp.model.names import QUOTED
from mars_asp.reading import decoded, overlay_bytes, read_file

# Few files have such comments, so no other pattern is compiled without this one.
#: The mark of a file with such comments, in single bytes and in both orders of UTF-16.
_MARK = rb"m\0?a\0?r\0?s\0?:[ \t\0]*i\0?g\0?n\0?o\0?r\0?e"
_DIRECTIVE = (
    r"(?<![\w.:-])mars:[ \t]*ignore(?:[ \t]*\[(?P<kinds>[^\]\n]*)\](?P<reason>[^\n]*)|(?![\w-]))"
)
_KIND = r"[^\s,](?:[^,]*[^\s,])?"
#: The opening of a comment, and the end of one after the reason.
_OPENING = r"(?://+|/\*+|#+|%+\{?|<!--)[!\s*]*"
_CLOSING = r"[ \t]*(?:\*/|-->|%\})?[ \t]*$"
_LINE, _BLOCK = r"//[^\n]*+", r"/\*[\s\S]*?(?:\*/|\Z)"
_STRING = r'"(?:\\[\s\S]|[^"\\\n])*+"?'
#: Comments of languages without annotated sources; matches without a group are other texts.
_COMMENTS = {
    # A path of `@sources` may hold what would open a comment elsewhere.
    "mars": (
        rf"(?m:^)[ \t]*+@sources(?:[^/#\n]|/(?!/))*+|(?P<comment>{_LINE}|\#[^\n]*+|{_BLOCK})"
        rf"|{QUOTED}|{_STRING}"
    ),
    "dot": rf"(?P<comment>(?m:^)\#[^\n]*+|{_LINE}|{_BLOCK})|{_STRING}",
    "xml": r"(?P<comment><!--[\s\S]*?(?:-->|\Z))|<!\[CDATA\[[\s\S]*?(?:\]\]>|\Z)",
}
_SUFFIXES = {
    **LANGUAGES,
    **dict.fromkeys((".yaml", ".yml"), "yaml"),
    **dict.fromkeys((".xml", ".urdf", ".xacro", ".launch", ".sdf"), "xml"),
    **dict.fromkeys((".dot", ".gv"), "dot"),
    ".mars": "mars",
}


class Ignore(NamedTuple):
    """A comment that hides findings: kinds with locations, reason, and its own location."""

    kinds: tuple[tuple[str, Span], ...]
    reason: str
    span: Span


def ignores_in(path: str, text: str, language: str | None = None) -> Iterator[Ignore]:
    r"""Yield the comments of a text that hide findings, in its order.

    `text` has `\n` for every line end. By default path and text determine the `language`.
    """
    if "mars:" not in text or re.search(_DIRECTIVE, text) is None:
        return
    directive, opens = re.compile(_DIRECTIVE), re.compile(_OPENING)
    file = FileText(path, text)
    for begin, end in _comments(text, language or _language_of(path, text)):
        for match in directive.finditer(text, begin, end):
            at = match.start()
            if match["kinds"] is None:
                # A sentence may mention ignoring something.
                opening = opens.match(text, begin, end)
                if opening is None or opening.end() != at:
                    continue
            first = match.start("kinds")
            kinds = tuple(
                (kind[0], file.span(first + kind.start(), first + kind.end()))
                for kind in re.finditer(_KIND, match["kinds"] or "")
            )
            reason = re.sub(_CLOSING, "", match["reason"] or "").strip()
            named = match.end("kinds") + 1 if match["kinds"] is not None else match.end()
            yield Ignore(kinds, reason, file.span(at, named))


def ignores_of(path: str) -> Iterator[Ignore]:
    """Yield the comments of a file that hide findings; none if it cannot be read."""
    raw = overlay_bytes(Path(path))
    if raw is None:
        try:
            raw = read_file(path, MOST_BYTES, path)
        except (OSError, ValueError):
            return
    if re.search(_MARK, raw) is not None:
        yield from ignores_in(path, plain_lines(decoded(raw)))


def _language_of(path: str, text: str) -> str:
    """Return the language of a file by its suffix, else by its first characters."""
    found = _SUFFIXES.get(Path(path).suffix.lower())
    if found is not None:
        return found
    if text.lstrip().startswith("<"):
        return "xml"
    return "dot" if re.match(r"\s*(?:strict\s+)?(?:di)?graph\b", text) else "yaml"


def _comments(text: str, language: str) -> Iterable[tuple[int, int]]:
    """Return the ranges (begin, end) of the comments in a text."""
    if language == "yaml":
        return _yaml_comments(text)
    if language in _COMMENTS:
        found = re.finditer(_COMMENTS[language], text)
        return (match.span() for match in found if match["comment"] is not None)
    from mars_asp.annotations.comments import tokens

    return ((begin, end) for begin, end, kind in tokens(language, text) if kind == "comment")


def _yaml_comments(text: str) -> Iterator[tuple[int, int]]:
    """Yield the ranges of the comments with `mars:`; none if the text is not YAML."""
    import yaml

    scalars: list[tuple[int, int]] = []
    try:
        for token in yaml.scan(text, Loader=yaml.SafeLoader):
            if isinstance(token, yaml.ScalarToken):
                begin, end = token.start_mark.index, token.end_mark.index
                # A comment may follow the indicator that opens a block.
                block = token.style in ("|", ">")
                scalars.append((text.find("\n", begin) if block else begin, end))
    except yaml.YAMLError:
        return
    starts = [begin for begin, _ in scalars]
    for line in re.finditer(r"[^\n]*mars:[^\n]*", text):
        for mark in re.finditer(r"(?<!\S)#", line[0]):
            begin = line.start() + mark.start()
            before = bisect_right(starts, begin) - 1
            if before < 0 or scalars[before][1] <= begin:
                yield begin, line.end()
                break
