"""Metadata: the comments above the rules of a file.

Comments `%! key: text` directly above a rule give it an `id`, a `because` (its message, with
`{Variable}` holes), an `effect` (its outcome, a sentence with holes), a `help`, and `fits` (the
reason why its arithmetic fits into 32 bits). `why` describes the subject and its importance,
`example` is the path of a case. `allow: CODE REASON` switches a lint off for the rule. Keys of a
host expand to further rules (see `expansions`). A line whose text is indented by four or more
blanks continues the line before. `%*! predicate(Arguments) ... *%` documents a predicate.

An id begins with the name of its file: `data/link` in `data.lp`, `resolve/data/edge` in that of the
stage `resolve`. A rule without an id is named by its line, `data:17`. If several of these begin in
one line, all except the first are named by their column as well: `data:17:30`.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from mars_asp.asp.rules.expansions import Expansions, expanded, wrong
from mars_asp.asp.rules.rule import HOLE, Allow, Rule
from mars_asp.asp.rules.statements import Piece, bound_variables
from mars_asp.asp.units import UNITS
from mars_asp.diagnostic import Diagnostic, Span, point
from mars_asp.spelling import nearest

KEYS = ("id", "because", "effect", "help", "fits", "why", "example")
#: The key of a line that allows a lint, which can be repeated.
_ALLOW = "allow"
_METADATA = re.compile(r"%!\s*([A-Za-z_-]+)\s*:\s*(.*)")
_CONTINUED = re.compile(r"%!\s{4,}(\S.*)")


def file_name(shown: str, stage: str) -> str:
    """Return the first component of the ids of a file's rules: `STAGE/STEM`, or `STEM`."""
    stem = Path(shown).stem
    return stem if stage in ("base", stem) else f"{stage}/{stem}"


def rules_of(
    written: Iterable[Piece],
    shown: str,
    stage: str,
    problems: list[Diagnostic],
    strict: bool,
    expansions: Expansions,
) -> Iterator[Rule]:
    """Yield the rules of a file with their metadata; add errors in the metadata to `problems`.

    Each rule is followed by the rules that its metadata expand to, by `expansions`. If `strict`,
    these are checked, and left out if they have errors.
    """
    name = file_name(shown, stage)
    lines: set[int] = set()
    pending: dict[str, tuple[str, Span]] = {}
    last_line = 0
    for piece in written:
        if piece.sort == "comment":
            match = _METADATA.match(piece.text)
            if match:
                keys = (*KEYS, _ALLOW, *expansions)
                _note_metadata(pending, match, point(shown, *piece.begin), keys, problems)
                last_line = piece.begin[0]
            elif (more := _CONTINUED.match(piece.text)) and piece.begin[0] == last_line + 1:
                for key in list(pending)[-1:]:
                    text, place = pending[key]
                    pending[key] = (f"{text} {more[1].strip()}", place)
                last_line = piece.begin[0]
            continue
        if piece.sort != "rule":
            problems += _unbound(pending)
            pending = {}
            continue
        span = Span(shown, *piece.begin, *piece.end)
        if pending and span.line != last_line + 1:
            problems += _unbound(pending)
            pending = {}
        where = f"{span.line}:{span.column}" if span.line in lines else f"{span.line}"
        if "id" not in pending:
            lines.add(span.line)
        lists = {key: pending[key] for key in expansions if key in pending}
        rule = _make_rule(pending, span, piece.text, stage, f"{name}:{where}", lists)
        problems += _wrong_id(rule, pending, name)
        pending = {}
        yield rule
        for key, (listed, place) in lists.items():
            line = (rule, key, listed, place, expansions[key])
            found = tuple(wrong(*line)) if strict else ()
            problems += found
            yield from () if found else expanded(*line)
    problems += _unbound(pending)


def _note_metadata(
    pending: dict[str, tuple[str, Span]],
    match: re.Match[str],
    span: Span,
    keys: Sequence[str],
    problems: list[Diagnostic],
) -> None:
    key, value = match[1], match[2].strip()
    if key not in keys:
        near = nearest(key, keys)
        help_text = f"did you mean `{near}`?" if near else f"one of {', '.join(keys)}"
        problems.append(
            Diagnostic(
                "rule-metadata", "error", f"`{key}` is not a metadata key", span, help=help_text
            )
        )
    elif key == _ALLOW:
        # Each line has its own key.
        pending[f"{_ALLOW} {span.line}"] = (value, span)
    elif key in pending:
        problems.append(
            Diagnostic("rule-metadata", "error", f"`{key}` occurs twice above one rule", span)
        )
    else:
        pending[key] = (value, span)


def _make_rule(
    metadata: dict[str, tuple[str, Span]],
    span: Span,
    text: str,
    stage: str,
    unnamed: str,
    lists: Mapping[str, tuple[str, Span]],
) -> Rule:
    given = {key: value for key, (value, _) in metadata.items()}
    return Rule(
        given.get("id", unnamed),
        given.get("because"),
        given.get("help"),
        span,
        text,
        stage,
        given.get("fits"),
        given.get("why"),
        given.get("example"),
        tuple((key, listed) for key, (listed, _) in lists.items()),
        effect=given.get("effect"),
        allows=tuple(
            Allow(text.partition(" ")[0], text.partition(" ")[2].strip(), place)
            for key, (text, place) in metadata.items()
            if key.startswith(f"{_ALLOW} ")
        ),
        places=tuple((key, place) for key, (_, place) in metadata.items()),
    )


def _wrong_id(rule: Rule, metadata: dict[str, tuple[str, Span]], name: str) -> Iterator[Diagnostic]:
    if "id" in metadata and not rule.id.startswith(f"{name}/"):
        yield Diagnostic(
            "rule-metadata",
            "error",
            f"rule id `{rule.id}` does not start with its file's name",
            metadata["id"][1],
            help=f"write `{name}/...`",
        )


def wrong_holes(rule: Rule) -> Iterator[Diagnostic]:
    """Yield the holes of a rule's messages that no variable of its body fills."""
    if not rule.holes:
        return
    bound = bound_variables(rule.text)
    for hole in rule.holes:
        if hole not in bound:
            near = nearest(hole, bound)
            yield Diagnostic(
                "rule-metadata",
                "error",
                f"`{{{hole}}}` in the message of `{rule.id}` is not a variable of the rule's body",
                rule.place_of_hole(hole),
                help=f"did you mean `{{{near}}}`?" if near else None,
            )
    for key, text in rule.sentences:
        for hole, sort in HOLE.findall(text):
            if sort and sort not in UNITS:
                near = nearest(sort, UNITS)
                yield Diagnostic(
                    "rule-metadata",
                    "error",
                    f"`{{{hole}:{sort}}}` in the message of `{rule.id}` names no sort with a unit",
                    rule.place_of(key),
                    help=f"did you mean `{{{hole}:{near}}}`?"
                    if near
                    else "name a measure, such as `milliseconds`",
                )


def _unbound(metadata: dict[str, tuple[str, Span]]) -> list[Diagnostic]:
    return [
        Diagnostic(
            "rule-metadata",
            "error",
            f"`{key.partition(' ')[0]}` is not directly above a rule",
            span,
            help="put it on the line above the rule it belongs to",
        )
        for key, (_, span) in list(metadata.items())[:1]
    ]


def repeated_ids(
    rules: Iterable[Rule], known: Mapping[str, Span] = MappingProxyType({})
) -> Iterator[Diagnostic]:
    """Yield an error for each repeated id; `known` are the ids of other rules with locations."""
    first = dict(known)
    for rule in rules:
        # A rule made from metadata is named after the rule below the metadata.
        place = rule.place_of("id")
        earlier = first.setdefault(rule.id, place)
        if earlier is not place and rule.listed is None:
            yield Diagnostic(
                "rule-metadata",
                "error",
                f"rule id `{rule.id}` is used twice",
                place,
                ((earlier, "first used here"),),
                help="give each rule an id of its own",
            )
