"""Accounts as text: who and what, then lines of the user's files, then what follows."""

from collections.abc import Iterator, Sequence

from mars_asp.cli.layout import wrapped
from mars_asp.cli.lines import line_at
from mars_asp.output import visible
from mars_asp.reasoning.questions.account import Account, Cited
from mars_asp.reasoning.questions.explain import Topic

#: What is below the title is indented by more than what continues a line.
BELOW, FURTHER = "    ", "  "
#: Between a line and what is said of it.
_GAP = "   "


def account_lines(topic: Topic, account: Account, width: int) -> Iterator[str]:
    """Yield the lines of an account, its title first."""
    severity = f", {topic.severity}" if topic.severity in ("warning", "error") else ""
    rule = f"  [{topic.rule}]" if topic.rule else ""
    answer = (account.answer or "").rstrip(".")
    yield from wrapped(f"{topic.name}{severity}: {answer}.{rule}", width, "", FURTHER)
    yield from _cited(account.cites, width)
    resolves = [f"Resolves {', '.join(topic.resolves)}."] if topic.resolves else []
    for note in (*account.notes, *resolves):
        yield from wrapped(note, width, BELOW, BELOW + FURTHER)


def _cited(cites: Sequence[Cited], width: int) -> Iterator[str]:
    """Yield lines of the user's with their places, each in its column where that is narrow."""
    places = [visible(each.place) for each in cites]
    lines = [visible(line_at(each.span)) for each in cites]
    before = len(BELOW) + max(map(len, places), default=0) + len(FURTHER)
    longest = max((len(each.label) for each in cites), default=0)
    # A label that finds no room beside its line is written below it.
    room = width - before - len(_GAP) - longest
    column = max((len(line) for line in lines if len(line) <= room), default=0)
    for place, line, each in zip(places, lines, cites, strict=True):
        head = f"{BELOW}{place}".ljust(before)
        text = f"{line:{column}}{_GAP}{each.label}" if each.label else line
        if not each.label or before + len(text) <= width:
            yield head + text
        else:
            yield head + line
            yield from wrapped(each.label, width, BELOW * 2, BELOW * 2 + FURTHER)
