"""An editor: pygls' client, with the language server as a process of its own over stdio."""

import asyncio
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls.lsp.client import LanguageClient

from tests.support.documents import ROOT

#: Longer than any answer takes, however busy the machine is.
SECONDS = 120.0
_LANGUAGES = {".mars": "mars", ".lp": "clingo"}


class Editor(LanguageClient):
    """A client that keeps published diagnostics and shown messages, and counts refreshes."""

    def __init__(self) -> None:
        super().__init__("tests", "1")
        self.published: dict[str, list[types.Diagnostic]] = {}
        self.versions: dict[str, int | None] = {}
        self.refreshed = 0
        self.shown: list[str] = []
        self.complaints: list[str] = []
        self._news = asyncio.Condition()

        @self.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)  # type: ignore[untyped-decorator]
        async def hear(params: types.PublishDiagnosticsParams) -> None:
            async with self._news:
                self.published[params.uri] = list(params.diagnostics)
                self.versions[params.uri] = params.version
                self._news.notify_all()

        @self.feature(types.WORKSPACE_CODE_LENS_REFRESH)  # type: ignore[untyped-decorator]
        async def refresh(params: None) -> None:
            async with self._news:
                self.refreshed += 1
                self._news.notify_all()

        @self.feature(types.WINDOW_SHOW_MESSAGE)  # type: ignore[untyped-decorator]
        def show(params: types.ShowMessageParams) -> None:
            self.shown.append(params.message)

    def report_server_error(self, error: Exception, source: Any) -> None:
        """Keep errors of the server for the test."""
        self.complaints.append(repr(error))

    def open(self, path: Path, text: str | None = None, version: int = 1) -> str:
        """Open a file, with a text that need not be on the disk; return its URI."""
        uri = path.as_uri()
        text = path.read_text(encoding="utf-8") if text is None else text
        language = _LANGUAGES.get(path.suffix, path.suffix.removeprefix("."))
        item = types.TextDocumentItem(uri, language, version, text)
        self.text_document_did_open(types.DidOpenTextDocumentParams(item))
        return uri

    def change(self, uri: str, text: str, version: int) -> None:
        """Put another text in the place of an open one."""
        document = types.VersionedTextDocumentIdentifier(version, uri)
        whole = types.TextDocumentContentChangeWholeDocument(text)
        self.text_document_did_change(types.DidChangeTextDocumentParams(document, [whole]))

    def close(self, uri: str) -> None:
        """Close a text."""
        document = types.TextDocumentIdentifier(uri)
        self.text_document_did_close(types.DidCloseTextDocumentParams(document))

    async def diagnostics(self, uri: str, version: int = 1) -> list[types.Diagnostic]:
        """Wait for the diagnostics of a version of a text; return them."""
        await self.until(lambda: self.versions.get(uri) == version)
        return self.published[uri]

    async def until(self, is_so: Callable[[], bool]) -> None:
        """Wait until messages of the server make a condition true."""
        async with asyncio.timeout(SECONDS), self._news:
            await self._news.wait_for(is_so)

    async def hover(self, uri: str, line: int, character: int) -> str:
        """Return the hover text at a location, empty if there is none."""
        found = await self.text_document_hover_async(types.HoverParams(*_at(uri, line, character)))
        if found is None:
            return ""
        assert isinstance(found.contents, types.MarkupContent)
        return found.contents.value


def _at(uri: str, line: int, character: int) -> tuple[types.TextDocumentIdentifier, types.Position]:
    return types.TextDocumentIdentifier(uri), types.Position(line, character)


@asynccontextmanager
async def editor(folder: Path, *options: str) -> AsyncIterator[Editor]:
    """Yield an editor with a folder open and the server begun; end both."""
    client = Editor()
    words = ("-m", "mars_asp", "lsp", "--stdio", *options)
    await client.start_io(sys.executable, *words, cwd=ROOT)
    lens = types.CodeLensWorkspaceClientCapabilities(refresh_support=True)
    capabilities = types.ClientCapabilities(
        workspace=types.WorkspaceClientCapabilities(code_lens=lens)
    )
    await client.initialize_async(
        types.InitializeParams(
            capabilities,
            workspace_folders=[types.WorkspaceFolder(folder.as_uri(), folder.name)],
        )
    )
    client.initialized(types.InitializedParams())
    try:
        yield client
    finally:
        async with asyncio.timeout(SECONDS):
            await client.shutdown_async(None)
            client.exit(None)
            await client.stop()  # type: ignore[no-untyped-call]
