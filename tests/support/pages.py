"""Pages as elements, read more strictly than a browser does."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from html.parser import HTMLParser

#: Elements without content.
VOID = ("br", "input", "link", "meta")


@dataclass
class Element:
    """An element of a page, with its content."""

    name: str
    attributes: dict[str, str]
    inside: list["Element"] = field(default_factory=list)
    text: str = ""

    def all(self, name: str = "", of: str = "") -> Iterator["Element"]:
        """Yield the elements of a name and class inside, in their order."""
        for each in self.inside:
            if name in ("", each.name) and (not of or of in each.attributes.get("class", "")):
                yield each
            yield from each.all(name, of)


class Page(HTMLParser):
    """A strict parser of pages: it refuses faults that a browser would repair."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.top = Element("", {})
        self._open = [self.top]
        self.feed(text)
        self.close()
        assert self._open == [self.top], "an element is not closed"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        made = Element(tag, {name: value or "" for name, value in attrs})
        self._open[-1].inside.append(made)
        if tag not in VOID:
            self._open.append(made)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop().name == tag, self.getpos()

    def handle_data(self, data: str) -> None:
        for each in self._open:
            each.text += data

    def by_id(self) -> dict[str, Element]:
        """Return the elements that have an id, which no two share."""
        named = [each for each in self.top.all() if "id" in each.attributes]
        ids = {each.attributes["id"]: each for each in named}
        assert len(ids) == len(named)
        return ids
