"""Conversion between the values of this package and of the language server protocol."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from lsprotocol import types
from pygls.uris import to_fs_path

from mars_asp.lsp.actions import QuickFix
from mars_asp.lsp.completion import Completions
from mars_asp.lsp.hover import Hover
from mars_asp.lsp.places import Place, Position, Range, TextEdit
from mars_asp.lsp.robot import EditorFinding
from mars_asp.lsp.symbols import Sort, Symbol

_SEVERITIES = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "note": types.DiagnosticSeverity.Information,
}
_COMPLETIONS = {
    "keyword": types.CompletionItemKind.Keyword,
    "module": types.CompletionItemKind.Module,
    "port": types.CompletionItemKind.Field,
    "mode": types.CompletionItemKind.EnumMember,
    "function": types.CompletionItemKind.Function,
    "predicate": types.CompletionItemKind.Function,
    "annotation": types.CompletionItemKind.Keyword,
}
_SYMBOLS = {"module": types.SymbolKind.Module, "predicate": types.SymbolKind.Function}


@dataclass(frozen=True)
class Protocol:
    """Converts values with paths, which the protocol names by their URIs."""

    uri: Callable[[str], str]

    def location(self, place: Place) -> types.Location:
        """Return the location of a range in a file."""
        return types.Location(self.uri(place.path), range_of(place.range))

    def locations(self, places: Iterable[Place]) -> list[types.Location]:
        """Return the locations of several ranges in files."""
        return [self.location(each) for each in places]

    def symbol(self, name: str, sort: Sort, place: Place) -> types.SymbolInformation:
        """Return a symbol with its file, as in the list of all symbols of the workspace."""
        return types.SymbolInformation(self.location(place), name, _SYMBOLS[sort])

    def diagnostic(self, finding: EditorFinding) -> types.Diagnostic:
        """Return a finding as a diagnostic of the protocol."""
        parts = (finding.message, finding.effect, finding.help and f"help: {finding.help}")
        return types.Diagnostic(
            range_of(finding.place.range),
            "\n".join(filter(None, parts)),
            severity=_SEVERITIES[finding.severity],
            code=finding.code,
            source="mars-asp",
            related_information=[
                types.DiagnosticRelatedInformation(self.location(place), label or "also here")
                for place, label in finding.related
            ],
        )

    def action(self, finding: EditorFinding, action: QuickFix) -> types.CodeAction:
        """Return a quick fix of a finding as a code action."""
        return types.CodeAction(
            action.title,
            kind=types.CodeActionKind.QuickFix,
            diagnostics=[self.diagnostic(finding)],
            edit=self.workspace_edit(action.edits),
            is_preferred=action.is_sole,
        )

    def workspace_edit(self, edits: Sequence[TextEdit]) -> types.WorkspaceEdit:
        """Return edits grouped by file."""
        changes: dict[str, list[types.TextEdit]] = {}
        for each in edits:
            edit = types.TextEdit(range_of(each.place.range), each.text)
            changes.setdefault(self.uri(each.place.path), []).append(edit)
        return types.WorkspaceEdit(changes)


def path_of(uri: str) -> str | None:
    """Return the path of a URI, or None if the URI does not name a file."""
    try:
        path = to_fs_path(uri) if uri.startswith("file:") else None
    except ValueError:
        path = None
    return None if path is None or "\0" in path else path


def place_of(params: types.TextDocumentPositionParams | Any) -> tuple[str, Position]:
    """Return the path and the position in the parameters of a request."""
    return path_of(params.text_document.uri) or "", position_of(params.position)


def position_of(position: types.Position) -> Position:
    """Return a position of the protocol as one of this package."""
    return Position(position.line, position.character)


def range_of(found: Range) -> types.Range:
    """Return a range of this package as one of the protocol."""
    return types.Range(types.Position(*found.start), types.Position(*found.end))


def hover_of(found: Hover | None) -> types.Hover | None:
    """Return a hover text as one of the protocol, or None if there is none."""
    if found is None:
        return None
    text = types.MarkupContent(types.MarkupKind.Markdown, found.markdown)
    return types.Hover(text, None if found.range is None else range_of(found.range))


def symbol_of(found: Symbol) -> types.DocumentSymbol:
    """Return a symbol of a file as one of the protocol."""
    return types.DocumentSymbol(
        found.name, _SYMBOLS[found.sort], range_of(found.whole), range_of(found.place), found.detail
    )


def items_of(found: Completions) -> types.CompletionList:
    """Return completion items as a list of the protocol."""
    items = [
        types.CompletionItem(
            each.label,
            kind=_COMPLETIONS[each.sort],
            documentation=each.detail or None,
            filter_text=each.text,
            text_edit=types.TextEdit(range_of(found.typed), each.text),
        )
        for each in found.items
    ]
    return types.CompletionList(not found.is_whole, items)
