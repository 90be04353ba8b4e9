"""Edits of statements that list names: `@modules A, B` and `M is_controlled_by A, B`."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from mars_asp.language.text_edits import Draft
from mars_asp.language.tokens import Token


@dataclass(eq=False, slots=True)
class Member:
    """One entry of a list: a name with the words after it, and its edits.

    `new` is another name, `rank` another priority (the list is then split into lines). `plain` is
    whether the stated priority is removed, `gone` whether the entry is.
    """

    tokens: tuple[Token, ...]
    comma: Token | None
    new: str | None = None
    rank: int | None = None
    plain: bool = False
    gone: bool = False

    @property
    def name(self) -> Token:
        """Return its first token, which is the name."""
        return self.tokens[0]

    @property
    def priority(self) -> Token | None:
        """Return the token of the stated priority, or None."""
        second = self.tokens[1:2]
        return second[0] if second and second[0].text.lstrip("+-").isdigit() else None

    def written(self, place: int | None = None, name: str | None = None) -> str:
        """Return the edited text; `place` is the default priority, `name` replaces the name."""
        priority = self.priority
        rest = [token.text for token in self.tokens[1:] if token is not priority]
        declared = place if self.rank is None else self.rank
        if self.rank is None and priority is not None and not self.plain:
            declared = int(priority.text)
        words = [name or self.new or self.name.text, *([] if declared is None else [str(declared)])]
        # `left: Camera`, an instance in `@modules`.
        return " ".join([*words, *rest]) if rest[:1] != [":"] else f"{words[0]}: {rest[1]}"


@dataclass
class ListEdit:
    """The edits of a statement that lists names."""

    tokens: tuple[Token, ...]
    indent: str
    head: str = field(init=False)
    members: Sequence[Member] = field(init=False)
    _added: list[str] = field(default_factory=list)
    _width: int = 0

    def __post_init__(self) -> None:
        """Split the statement into its head and members."""
        self.head = self.tokens[0].text
        members: list[Member] = []
        piece: list[Token] = []
        for token in self.tokens[self._heads :]:
            if token.text == ",":
                members.append(Member(tuple(piece), token))
                piece = []
            else:
                piece.append(token)
        self.members = (*members, Member(tuple(piece), None))

    @property
    def _heads(self) -> int:
        return 1 if self.tokens[0].text == "@modules" else 2

    def add(self, name: str, width: int) -> None:
        """Append a name, on a new line if the last one would exceed `width`."""
        if name not in self._added:
            self._added.append(name)
        self._width = width

    def write(self, draft: Draft, keep_ranks: bool) -> None:
        """Write the edits into a draft.

        With `keep_ranks` no rank in a list may change, because others are compared with it: then,
        and if a member gets another priority, each controller gets a line of its own.
        """
        kept = [member for member in self.members if not member.gone]
        left = [*(member.written() for member in kept), *self._added]
        if not left:
            for line in self._tokens_by_line(draft):
                draft.delete(line)
            return
        listed = self._heads == 2 and len(self.members) > 1
        shifted = bool(kept) and any(m.gone for m in self.members[: self.members.index(kept[-1])])
        apart = listed and (any(m.rank is not None for m in kept) or (keep_ranks and shifted))
        unchanged = ListEdit(self.tokens, self.indent)
        before = unchanged._rendered(draft, unchanged.members, apart=False)
        after = self._rendered(draft, kept, apart)
        for line, tokens in self._tokens_by_line(draft).items():
            if before.get(line) != after.get(line):
                draft.put(draft.offset(line, 1), tokens[-1].end, after.get(line, ""))
        if self._added:
            self._append(draft, kept)

    def _tokens_by_line(self, draft: Draft) -> dict[int, list[Token]]:
        """Return the statement's tokens by the number of their line."""
        lines: dict[int, list[Token]] = {}
        for token in self.tokens:
            lines.setdefault(draft.line_at(token.begin), []).append(token)
        return lines

    def _rendered(
        self, draft: Draft, members: Sequence[Member], apart: bool, more: bool = False
    ) -> dict[int, str]:
        """Return the text of each line that contains members, by line number.

        With `apart` each member has a whole statement; with `more` a comma follows the last one.
        """
        head = f"{self.head} " if self._heads == 1 else f"{self.head} is_controlled_by "
        lines: dict[int, str] = {}
        for place, member in enumerate(members):
            line = draft.line_at(member.name.begin)
            if apart:
                number = self.members.index(member)
                text = f"{self.indent}{head}{member.written(number)}"
                lines[line] = f"{lines[line]}\n{text}" if line in lines else text
                continue
            blanks = draft.blanks(line) if place else self.indent + head
            comma = "," if more or place + 1 < len(members) else ""
            text = f"{member.written()}{comma}"
            lines[line] = f"{lines[line]} {text}" if line in lines else f"{blanks}{text}"
        return lines

    def _append(self, draft: Draft, kept: Sequence[Member]) -> None:
        """Append the added names after the last of the `kept` members."""
        if not kept:
            line = draft.line_at(self.tokens[0].begin)
            end = self._tokens_by_line(draft)[line][-1].end
            text = f"{self.indent}{self.head} {', '.join(self._added)}"
            draft.put(draft.offset(line, 1), end, text)
            return
        line = draft.line_at(kept[-1].name.begin)
        end = self._tokens_by_line(draft)[line][-1].end
        text = self._rendered(draft, kept, apart=False, more=True)[line]
        alone = line > draft.line_at(self.tokens[0].begin) and text.count(",") == 1
        whole = f"{text} {', '.join(self._added)}"
        if not alone and len(whole) <= self._width:
            draft.put(draft.offset(line, 1), end, whole)
            return
        draft.put(draft.offset(line, 1), end, text)
        blanks = draft.blanks(line) if alone else f"{self.indent}    "
        names = [f"{blanks}{name}," for name in self._added]
        draft.insert(line, "behind", [*names[:-1], names[-1].removesuffix(",")])
