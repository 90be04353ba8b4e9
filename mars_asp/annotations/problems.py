"""What is wrong in one source, as diagnostics at their places."""

from mars_asp.annotations.arguments import ArgumentProblem
from mars_asp.annotations.directives import MOST_CHARACTERS, Directive
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Diagnostic, Severity, Span


class Problems:
    """Collects what is found; `errors` counts those that are errors."""

    def __init__(self, source: Source) -> None:
        """Take the source that the places are in."""
        self.source = source
        self.found: list[Diagnostic] = []
        self.errors = 0

    def span(self, begin: int, end: int) -> Span:
        """Return the span of a stretch of offsets."""
        return Span(self.source.path, *self.source.positions(begin, max(begin, end)))

    def note(
        self,
        code: str,
        begin: int,
        end: int,
        message: str,
        help_text: str,
        severity: Severity = "error",
        labels: tuple[tuple[Span, str], ...] = (),
    ) -> None:
        """Report a stretch of the source."""
        span, excerpt = self.span(begin, end), self.source.excerpt(begin)
        self.found.append(Diagnostic(code, severity, message, span, labels, help_text, excerpt))
        self.errors += severity == "error"

    def note_word(
        self,
        code: str,
        directive: Directive,
        message: str,
        help_text: str,
        labels: tuple[tuple[Span, str], ...] = (),
    ) -> None:
        """Report an annotation at its `@`."""
        self.note(code, directive.offset, directive.end, message, help_text, labels=labels)

    def note_wrong(self, directive: Directive, *wrong: ArgumentProblem) -> None:
        """Report parts of what stands behind an annotation's word, or all of the annotation."""
        for each in wrong:
            begin, end = directive.offset, directive.end
            if each.begin is not None:
                begin = directive.place(self.source, each.begin)
                end = directive.place(self.source, each.end)
            self.note(each.code, begin, end, each.message, each.help)

    def note_twice(self, directive: Directive, what: str, earlier: Span | None = None) -> None:
        """Report an annotation that says again what another one of its module says."""
        message = f"`{what}` occurs twice in one module"
        labels = () if earlier is None else ((earlier, "first here"),)
        self.note_word("MARS117", directive, message, "keep one of the two", labels)

    def is_too_long(self, directive: Directive) -> bool:
        """Report an annotation that was cut for its length."""
        if len(directive.rest) <= MOST_CHARACTERS:
            return False
        message = f"`@{directive.word}` with more than {MOST_CHARACTERS} characters after it"
        self.note_word(
            "MARS214", directive, message, "after a comma, it continues on the next line"
        )
        return True
