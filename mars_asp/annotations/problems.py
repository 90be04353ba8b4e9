"""The problems of one source, as diagnostics with locations."""

from mars_asp.annotations.arguments import ArgumentProblem
from mars_asp.annotations.directives import MOST_CHARACTERS, Directive
from mars_asp.annotations.sources import Source
from mars_asp.diagnostic import Diagnostic, Severity, Span


class Problems:
    """Collects diagnostics; `errors` counts those that are errors."""

    def __init__(self, source: Source) -> None:
        """Begin without problems in a source."""
        self.source = source
        self.found: list[Diagnostic] = []
        self.errors = 0

    def span(self, begin: int, end: int) -> Span:
        """Return the span between two offsets."""
        return self.source.span(begin, max(begin, end))

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
        """Add a diagnostic with this code and message for the text between two offsets."""
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
        """Add a diagnostic at the `@` of an annotation."""
        self.note(code, directive.offset, directive.end, message, help_text, labels=labels)

    def note_wrong(self, directive: Directive, *wrong: ArgumentProblem) -> None:
        """Report problems with the arguments of an annotation, or with the whole annotation."""
        for each in wrong:
            begin, end = directive.offset, directive.end
            if each.begin is not None:
                begin = directive.place(each.begin)
                end = directive.place(each.end)
            self.note(each.code, begin, end, each.message, each.help)

    def note_twice(self, directive: Directive, what: str, earlier: Span | None = None) -> None:
        """Report that the annotation `what` occurs twice in a module, `earlier` first."""
        message = f"`{what}` occurs twice in one module"
        labels = () if earlier is None else ((earlier, "first here"),)
        self.note_word("MARS117", directive, message, "keep one of the two", labels)

    def is_too_long(self, directive: Directive) -> bool:
        """Whether an annotation was cut off for its length, which is then reported."""
        if len(directive.rest) <= MOST_CHARACTERS:
            return False
        message = f"`@{directive.word}` with more than {MOST_CHARACTERS} characters after it"
        self.note_word(
            "MARS214", directive, message, "after a comma, it continues on the next line"
        )
        return True
