"""Function annotations and overrides, kept until their declaration is read."""

from collections.abc import Callable, Sequence

from mars_asp.annotations.arguments import ArgumentProblem, read_commands, read_cost, read_delivery
from mars_asp.annotations.declarations import NoFunction, SourceDeclaration
from mars_asp.annotations.directives import Directive
from mars_asp.annotations.following import (
    MOST_DECLARED,
    Endless,
    Following,
    following,
    signature_declaration,
)
from mars_asp.annotations.overrides import Overrides, read_overrides
from mars_asp.annotations.problems import Problems
from mars_asp.annotations.services import ServiceSignature, read_signature
from mars_asp.diagnostic import Severity, Span
from mars_asp.model.declarations import SERVICE_KINDS, Mode, Service

#: The maximal number of annotations on one declaration.
MOST_ANNOTATIONS = 500
_MOST_SHOWN = 80
_COMPLETED = (Mode("NotifyWhenReady", text="NotifyWhenReady"),)
#: How the function of a `@Done` or `@Reset` is called, and how many inputs it has, by the most.
_CALLED = ("without arguments", "without arguments, or with the message of the reset")
_INPUTS = (("inputs", "none"), ("several inputs", "at most one"))
_BEFORE = (
    "put the annotation before its function, or state the function with `@Signature DECLARATION`"
)


class Pending:
    """The function annotations and overrides whose declaration was not read yet.

    `until` is the offset after the last annotation, where the declaration may begin.
    """

    def __init__(self, problems: Problems) -> None:
        """Begin without annotations; `problems` collects those of the source."""
        self.until = 0
        self._problems = problems
        self._source = problems.source
        #: None represents an unreadable annotation, which still has its declaration.
        self._services: list[tuple[Directive, Service | None]] = []
        self._overrides: list[Directive] = []

    def add(self, directive: Directive) -> None:
        """Add a function annotation or an override; report its problems."""
        if len(self._services) + len(self._overrides) >= MOST_ANNOTATIONS:
            message = f"more than {MOST_ANNOTATIONS} annotations on one declaration"
            help_text = "remove the repeated ones"
            self._problems.note_word("MARS213", directive, message, help_text)
        elif directive.word in SERVICE_KINDS:
            read = _read_service(directive, self._problems.span(directive.offset, directive.end))
            if isinstance(read, list):
                self._problems.note_wrong(directive, *read)
                self.add_unread(directive)
            else:
                self._services.append((directive, read))
        else:
            if not directive.rest:
                message = f"`@{directive.word}` with nothing after it"
                help_text = f"write it after `@{directive.word}`"
                self._problems.note_word("MARS108", directive, message, help_text)
            self._overrides.append(directive)

    def add_unread(self, directive: Directive) -> None:
        """Add an unreadable function annotation, so that the next declaration belongs to it."""
        self._services.append((directive, None))

    def settle(self, offset: int, closing: bool = False) -> list[Service]:
        """Return the services of the pending annotations if their declaration ends before `offset`.

        If a module closes at `offset`, no annotation stays pending.
        """
        if not self._services:
            if self._overrides:
                if closing or following(self._source, self.until, offset).over:
                    self._note_idle()
                    self._overrides = []
            return []
        after = self._following(offset)
        if not (after.over or closing):
            return []
        pending, self._services = self._services, []
        overrides, self._overrides = self._overrides, []
        if not isinstance(after.found, SourceDeclaration):
            self._note_missing(after, pending[0][0])
            return []
        written = [d for d in overrides if d.word != "Signature" and d.rest]
        result, wrong = read_overrides(written, after.found)
        for directive, problem in wrong:
            self._problems.note_wrong(directive, problem)
        services = [service for _, service in pending if service is not None]
        bound = self._bind(services, after.found, after.place, result)
        is_fed = any(each.inputs for each in bound if each.kind not in ("Done", "Reset"))
        for directive in written:
            if directive.word == "Window" and bound and not is_fed:
                message = f"`@Window` for a function without inputs: `{after.found.name}`"
                help_text = "drop it, or write it before the function that takes the messages"
                self._problems.note_word("MARS217", directive, message, help_text)
        return bound

    def _following(self, offset: int) -> Following:
        """Return the declaration of a `@Signature`, else the one before an offset."""
        signatures = [d for d in self._overrides if d.word == "Signature" and d.rest]
        for again in signatures[1:]:
            self._problems.note_word(
                "MARS210", again, "a second `@Signature`", "keep one of the two"
            )
        if signatures:
            return signature_declaration(self._source, signatures[0])
        return following(self._source, self.until, offset)

    def _note_idle(self) -> None:
        for directive in self._overrides:
            self._problems.note_word(
                "MARS203",
                directive,
                f"`@{directive.word}` has no function annotation to belong to",
                "write it beside `@Sense`, `@DataOut`, `@ControlOut`, `@DataIn` or `@Converts`,"
                " before the function",
            )

    def _note_missing(self, result: Following, first: Directive) -> None:
        """Report that no declaration follows `first`, the first of some annotations."""
        found = result.found
        if isinstance(found, NoFunction):
            # A string may have many lines.
            word = '"' if found.found.startswith('"') else found.found[:_MOST_SHOWN]
            begin, end = result.place(found.offset), result.place(found.offset + len(word))
            message = f"expected a function declaration, found `{word}`"
            self._problems.note("MARS202", begin, end, message, _BEFORE)
        elif isinstance(found, Endless):
            begin = result.place(found.offset)
            message = f"this declaration does not end within {MOST_DECLARED} bytes"
            help_text = "state it with `@Signature DECLARATION`"
            self._problems.note("MARS212", begin, begin, message, help_text)
        else:
            message = f"no function declaration follows `@{first.word}`"
            self._problems.note_word("MARS201", first, message, _BEFORE)

    def _bind(
        self,
        services: Sequence[Service],
        declaration: SourceDeclaration,
        place: Callable[[int], int],
        overrides: Overrides,
    ) -> list[Service]:
        """Return the services with the types and names of their declaration."""
        at = place(declaration.offset)
        bound: list[Service] = []
        signatures: dict[bool, ServiceSignature] = {}
        for service in services:
            delivers = service.kind in ("Sense", "DataOut", "Converts", "Done")
            if delivers not in signatures:
                signatures[delivers] = read_signature(declaration, overrides, delivers)
            signature = signatures[delivers]
            for code, message, help_text in signature.remarks:
                severity: Severity = "note" if code == "MARS207" else "warning"
                self._problems.note(code, at, at, message, help_text, severity)
            if service.kind == "Converts" and len(signature.inputs) != 1:
                message = f"a converter with {len(signature.inputs)} inputs"
                help_text = "a converter has one input; name it with `@Input TYPE`"
                self._problems.note("MARS208", at, at, message, help_text)
                continue
            most = {"Done": 0, "Reset": 1}.get(service.kind, len(signature.inputs))
            if len(signature.inputs) > most:
                found, allowed = _INPUTS[most]
                message = f"`{declaration.name}` has {found}, and a function with `@{service.kind}`"
                message += f" has {allowed}"
                help_text = f"it is called {_CALLED[most]}"
                self._problems.note("MARS216", at, at, message, help_text)
                continue
            bound.append(
                Service(
                    service.kind,
                    service.span,
                    declaration.name,
                    signature.output,
                    signature.inputs,
                    service.modes,
                    service.hz,
                    service.commands,
                    service.cost,
                    overrides.port,
                    signature.parameters,
                    overrides.window_ms,
                )
            )
        if declaration.conditional is not None and overrides.inputs is None:
            conditional = place(declaration.conditional)
            self._problems.note(
                "MARS204",
                conditional,
                conditional + 1,
                f"`#if` inside the declaration of `{declaration.name}`: all branches are read",
                "state its inputs: `@Input TYPE, TYPE`",
                "warning",
            )
        return bound


def _read_service(directive: Directive, span: Span) -> Service | list[ArgumentProblem]:
    """Return the service of a function annotation without declaration, or its problems."""
    kind = next(kind for kind in SERVICE_KINDS if kind == directive.word)
    if kind == "ControlOut":
        commands = read_commands(directive.rest)
        return commands if isinstance(commands, list) else Service(kind, span, commands=commands)
    if kind == "Converts":
        cost = read_cost(directive.rest)
        return cost if isinstance(cost, list) else Service(kind, span, cost=cost)
    if kind == "DataIn":
        return Service(kind, span)
    if kind in ("Done", "Reset"):
        if rest := directive.rest:
            message = f"expected nothing after `@{kind}`, found `{rest}`"
            help_text = f"write `@{kind}` alone on a line"
            return [ArgumentProblem("MARS126", message, help_text, 0, len(rest))]
        return Service(kind, span, modes=_COMPLETED if kind == "Done" else ())
    delivery = read_delivery(directive.rest)
    if isinstance(delivery, list):
        return delivery
    return Service(kind, span, modes=delivery[0], hz=delivery[1])
