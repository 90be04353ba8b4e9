"""The texts of files as an editor has them, and editor locations of spans in them."""

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from mars_asp.annotations.files import MOST_BYTES
from mars_asp.diagnostic import Diagnostic, Span, brief
from mars_asp.lsp.places import START, Place, Text, TextEdit
from mars_asp.lsp.robot import EditorFinding
from mars_asp.reading import decoded, overlay_bytes, read_file
from mars_asp.reasoning.rules import rules_directory


@dataclass(frozen=True)
class EditorFiles:
    """The current texts of files, and editor locations of spans in them.

    `root` is the file that shows findings without a location in a file.
    """

    root: str
    known: dict[str, Text] = field(default_factory=dict)

    def text(self, path: str) -> Text | None:
        """Return the text of a file, or None if it is not one."""
        path = os.path.abspath(path)  # noqa: PTH100 -- links stay as they are named
        if path not in self.known:
            raw = overlay_bytes(Path(path))
            try:
                raw = read_file(path, MOST_BYTES, path) if raw is None else raw
            except (OSError, ValueError):
                return None
            if len(raw) > MOST_BYTES:
                return None
            self.known[path] = Text(path, decoded(raw))
        return self.known[path]

    def place(self, span: Span) -> Place | None:
        """Return the editor location of a span, or None if its path is not a file."""
        try:
            text = self.text(_built_in(span.path) or span.path)
        except OSError:
            return None
        return None if text is None else text.place(span)

    def finding(
        self, found: Diagnostic, title: str | None = None, fixes: Iterable[tuple[Span, str]] = ()
    ) -> EditorFinding:
        """Return a diagnostic as a finding of an editor; `fixes` are (span, new text)."""
        short = brief(found)
        edits = [(self.place(span), text) for span, text in fixes]
        known = tuple(TextEdit(place, text) for place, text in edits if place is not None)
        placed = ((self.place(span), label) for span, label in short.labels)
        return EditorFinding(
            self.place(short.span) or Place(self.root, START),
            short.severity,
            short.code,
            short.message,
            short.help,
            short.effect,
            tuple((place, label) for place, label in placed if place is not None),
            title,
            known if len(known) == len(edits) else (),
        )


def _built_in(path: str) -> str | None:
    """Return the real path of a built-in rule file shown as `rules/...`, None for others."""
    own = rules_directory()
    if path.startswith("rules/") and not Path(path).is_file():
        return str(own / path.removeprefix("rules/"))
    return None
