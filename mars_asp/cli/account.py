"""Accounts as text: a title with the answer, cited lines of the user's files, and notes."""

from collections.abc import Iterator, Sequence

from mars_asp.cli.lines import line_at, located_line_json
from mars_asp.cli.wrapping import wrapped
from mars_asp.output import visible
from mars_asp.reasoning.questions.account import Account, Cited
from mars_asp.reasoning.questions.explain import Topic

#: The indents of text below a title, and of continuation lines.
BELOW, FURTHER = "    ", "  "
#: Between a cited line and its label.
_GAP = "   "


def account_lines(topic: Topic, account: Account, width: int) -> Iterator[str]:
    """Yield the lines of a topic's account, its title first, wrapped at `width`."""
    severity = f", {topic.severity}" if topic.severity in ("warning", "error") else ""
    yield from explanation_lines(f"{topic.name}{severity}:", account, topic.rule, width)
    if topic.resolves:
        resolves = f"Resolves {', '.join(topic.resolves)}."
        yield from wrapped(resolves, width, BELOW, BELOW + FURTHER)


def explanation_lines(of: str, account: Account, rule: str | None, width: int) -> Iterator[str]:
    """Yield the lines of an explanation: the answer with its rule, cited lines, and notes."""
    ending = f"  [{rule}]" if rule else ""
    answer = (account.answer or "").rstrip(".")
    yield from wrapped(f"{of} {answer}.{ending}", width, "", FURTHER)
    yield from _cited(account.cites, width)
    for note in account.notes:
        yield from wrapped(note, width, BELOW, BELOW + FURTHER)


def account_json(account: Account) -> dict[str, object]:
    """Return an account with the keys of the contract: its answer, labelled lines and notes."""
    lines = [{**located_line_json(each.span), "label": each.label} for each in account.cites]
    return {"answer": account.answer, "lines": lines, "notes": list(account.notes)}


def _cited(cites: Sequence[Cited], width: int) -> Iterator[str]:
    """Yield the cited lines with their locations, each label beside its line or below it."""
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
