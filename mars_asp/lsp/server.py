"""The language server: requests of editors over stdio, passed to functions without the protocol.

Requests about locations in open texts are answered at once. Workers analyse, so the server keeps
answering; a result that an edit has overtaken is dropped.
"""

import asyncio
import logging
import os
import sys
from collections.abc import Callable, Coroutine, Iterable, Iterator
from contextlib import suppress
from functools import partial
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path

from mars_asp import __version__
from mars_asp.lsp.actions import actions_at, fix_actions, spelling_actions
from mars_asp.lsp.client_errors import BoundedInput, CheckedProtocol, ClientError, strict_converter
from mars_asp.lsp.completion import Completions, completion, rule_completion
from mars_asp.lsp.hover import hover, hover_rules
from mars_asp.lsp.lenses import lenses
from mars_asp.lsp.occurrences import is_configuration, language_of
from mars_asp.lsp.places import START, Place, Position, Range, Text
from mars_asp.lsp.protocol import (
    Protocol,
    hover_of,
    items_of,
    path_of,
    place_of,
    position_of,
    range_of,
    symbol_of,
)
from mars_asp.lsp.questions import CheckedFile, Failed, LintedFile, Question, Sort, Survey
from mars_asp.lsp.references import definition, references
from mars_asp.lsp.rename import RefusedError, rename, renamed_range
from mars_asp.lsp.robot import EditorFinding, EditorRobot
from mars_asp.lsp.rule_text import is_rules
from mars_asp.lsp.rules import Rules, predicate_definition, predicate_mentions
from mars_asp.lsp.symbols import module_symbols, predicate_symbols, workspace_symbols
from mars_asp.lsp.workers import Workers
from mars_asp.lsp.workspace import EditorWorkspace

#: Seconds without a keystroke after which an analysis begins.
PAUSE = 0.25
#: Seconds that a hover waits for the trace of a finding.
_TRACE_SECONDS = 5.0
EXPLAIN = "mars-asp.explain"
_NOTHING = Completions((), START)


def serve(workers: Workers) -> None:
    """Answer an editor over standard input and output until it disconnects."""
    given, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    # Other code that reads or prints must not touch the protocol.
    nothing = os.open(os.devnull, os.O_RDWR)
    os.dup2(nothing, 0)
    os.dup2(nothing, 1)
    # Errors in messages of the client are reported to the client, not the terminal.
    logging.getLogger("pygls").setLevel(logging.CRITICAL)
    server = _Server(workers)
    # pygls sets attributes of handlers, which methods do not have.
    for method, handler, options in server.handlers():
        server.feature(method, options)(partial(handler))
    server.command(EXPLAIN)(partial(server.explain))
    try:
        server.start_io(BoundedInput(given), answers)  # type: ignore[arg-type]
    finally:
        workers.end()


class _Server(LanguageServer):
    """Connects the protocol to the workspace, and runs at most one analysis of each file."""

    def __init__(self, workers: Workers) -> None:
        super().__init__(
            "mars-asp",
            __version__,
            text_document_sync_kind=types.TextDocumentSyncKind.Full,
            protocol_cls=CheckedProtocol,
            converter_factory=strict_converter,
        )
        self._workers = workers
        self._workspace = EditorWorkspace()
        self._uris: dict[str, str] = {}
        self._protocol = Protocol(self._uri)
        self._versions: dict[str, int] = {}
        #: Running analyses by their files.
        self._running: dict[str, asyncio.Task[None]] = {}
        #: Files whose findings are about an older text.
        self._stale: set[str] = set()
        #: Answers, some pending, that no edit has overtaken.
        self._answers: dict[tuple[str, str, str], asyncio.Task[Any]] = {}

    def handlers(self) -> Iterator[tuple[str, Callable[[Any], Any], Any]]:
        """Yield (message, handler, options or None) for each message of the protocol."""
        triggers = types.CompletionOptions(trigger_characters=["@", ".", " ", ","])
        kinds = types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix])
        yield types.INITIALIZED, self.begin, None
        yield types.TEXT_DOCUMENT_DID_OPEN, self.opened, None
        yield types.TEXT_DOCUMENT_DID_CHANGE, self.changed, None
        yield types.TEXT_DOCUMENT_DID_CLOSE, self.closed, None
        yield types.TEXT_DOCUMENT_DID_SAVE, self.saved, None
        yield types.WORKSPACE_DID_CHANGE_WATCHED_FILES, self.changed_elsewhere, None
        yield types.TEXT_DOCUMENT_HOVER, self.hover, None
        yield types.TEXT_DOCUMENT_DEFINITION, self.definition, None
        yield types.TEXT_DOCUMENT_REFERENCES, self.references, None
        yield types.TEXT_DOCUMENT_DOCUMENT_SYMBOL, self.symbols, None
        yield types.WORKSPACE_SYMBOL, self.workspace_symbols, None
        yield types.TEXT_DOCUMENT_PREPARE_RENAME, self.prepare_rename, None
        yield types.TEXT_DOCUMENT_CODE_LENS, self.lenses, None
        yield types.TEXT_DOCUMENT_FORMATTING, self.format, None
        yield types.TEXT_DOCUMENT_COMPLETION, self.completion, triggers
        yield types.TEXT_DOCUMENT_RENAME, self.rename, types.RenameOptions(prepare_provider=True)
        yield types.TEXT_DOCUMENT_CODE_ACTION, self.actions, kinds

    def report_server_error(self, error: Exception, source: type[Exception]) -> None:
        """Report errors of the client to the client, and internal ones on standard error."""
        if isinstance(error, ClientError):
            self._refuse(error)
        elif isinstance(error, RecursionError | MemoryError):
            code = types.LSPErrorCodes.RequestFailed
            self._refuse(ClientError(None, code, "a message is nested too deep, or too large"))
        elif source is JsonRpcException and isinstance(error, ValueError):
            message = f"a message is not JSON: {error!s:.200}"
            self._refuse(ClientError(None, types.ErrorCodes.ParseError, message))
        # A refused request was answered with its error.
        elif not isinstance(error, JsonRpcException):
            text = f"internal error, please report it: {error!r:.300}"
            print(f"mars-asp lsp: {text}", file=sys.stderr, flush=True)

    def _refuse(self, error: ClientError) -> None:
        """Report an error of a message: in reply to its request, or else as a line of the log."""
        if error.request is None:
            about = types.LogMessageParams(types.MessageType.Error, f"mars-asp: {error.message}")
            self.window_log_message(about)
        if error.request is not None or error.code == types.ErrorCodes.ParseError:
            found = types.ResponseError(int(error.code), error.message)
            self.protocol._send_response(error.request, None, found)  # type: ignore[arg-type]

    # ---- Open files ------------------------------------------------------------------------------

    async def begin(self, params: types.InitializedParams) -> None:
        """Start the workers."""
        self._workers.warm_up()

    def opened(self, params: types.DidOpenTextDocumentParams) -> None:
        """Store an opened text."""
        document = params.text_document
        path = path_of(document.uri)
        if path is not None:
            self._uris[path] = document.uri
            self._take(path, document.version, document.text, 0.0)

    def changed(self, params: types.DidChangeTextDocumentParams) -> None:
        """Store a changed text."""
        path = path_of(params.text_document.uri)
        if path in self._workspace.texts and params.content_changes:
            text = params.content_changes[-1].text
            self._take(path, params.text_document.version, text, PAUSE)

    def closed(self, params: types.DidCloseTextDocumentParams) -> None:
        """Delete a closed text, and the results of robots without an open file."""
        path = path_of(params.text_document.uri)
        if path not in self._workspace.texts:
            return
        self._overtake(path)
        del self._workspace.texts[path]
        gone = set(self._workspace.idle())
        for queried in gone:
            self._stop(queried)
            self._publish(self._workspace.evict(queried) | {queried})
        for queried in self._workspace.queried_files(path):
            if queried in self._workspace.found:
                self._analyse(queried, PAUSE)
        self._workspace.owners.pop(path, None)
        self._uris.pop(path, None)

    def saved(self, params: types.DidSaveTextDocumentParams) -> None:
        """Analyse a saved file: other files may have changed with it."""
        path = path_of(params.text_document.uri)
        if path in self._workspace.texts:
            # Any robot may use the saved rules.
            self._again(tuple(self._workspace.texts) if is_rules(path) else (path,))

    def changed_elsewhere(self, params: types.DidChangeWatchedFilesParams) -> None:
        """Analyse all open files, as files on the disk have changed."""
        self._again(tuple(self._workspace.texts))

    def _again(self, paths: Iterable[str]) -> None:
        queried = {each for path in paths for each in self._workspace.queried_files(path)}
        for path in paths:
            self._overtake(path)
        for each in sorted(queried):
            self._analyse(each, PAUSE)

    def _take(self, path: str, version: int, text: str, delay: float) -> None:
        self._workspace.texts[path] = text
        self._versions[path] = version
        self._overtake(path)
        needs_owners = language_of(path) is not None and path not in self._workspace.owners
        if needs_owners and not any(r.path != path for r in self._workspace.robots_of(path)):
            self._start_analysis(path, self._find_owners(path, delay))
            return
        for queried in self._workspace.queried_files(path):
            self._analyse(queried, delay)

    # ---- Analyses --------------------------------------------------------------------------------

    def _analyse(self, queried: str, delay: float) -> None:
        self._start_analysis(queried, self._analysed(queried, delay))

    def _start_analysis(self, queried: str, work: Coroutine[Any, Any, None]) -> None:
        """Start an analysis of a file, and cancel a running one."""
        self._stop(queried)
        self._stale.add(queried)
        self._running[queried] = asyncio.get_running_loop().create_task(work)

    def _stop(self, queried: str) -> None:
        before = self._running.pop(queried, None)
        if before is not None:
            before.cancel()

    async def _find_owners(self, path: str, delay: float) -> None:
        """After `delay` seconds, analyse the configurations of a source, else the source itself."""
        await asyncio.sleep(delay)
        folders = [path_of(each.uri) or "" for each in self.workspace.folders.values()]
        inside = [each for each in folders if path.startswith(f"{each}/")]
        limit = max(inside, key=len, default="")
        found = await self._workers.ask(Question("owners", path, self._workspace.overlay(), limit))
        self._workspace.owners[path] = () if isinstance(found, Failed) else found
        for queried in self._workspace.queried_files(path):
            if queried != path:
                self._analyse(queried, 0.0)
            else:
                await self._analysed(queried, 0.0)

    async def _analysed(self, queried: str, delay: float) -> None:
        """After `delay` seconds, analyse a robot, source or rules, and publish the findings."""
        await asyncio.sleep(delay)
        sort: Sort = (
            "check" if is_configuration(queried) else "lint" if is_rules(queried) else "source"
        )
        answer = await self._workers.ask(Question(sort, queried, self._workspace.overlay()))
        robot: EditorRobot | None = None
        match answer:
            case CheckedFile():
                found, robot = answer
            case LintedFile():
                found, self._workspace.rules[queried] = answer
            case _:
                text = f"this was not analysed: {getattr(answer, 'reason', answer)}"
                found = (EditorFinding(Place(queried, START), "warning", "lsp", text),)
        self._stale.discard(queried)
        self._publish(self._workspace.store(queried, found, robot))
        if robot is not None and sort == "check":
            survey = await self._workers.ask(Question("survey", queried, self._workspace.overlay()))
            if isinstance(survey, Survey):
                self._workspace.update(queried, survey)
                await self._refresh_lenses()

    async def _refresh_lenses(self) -> None:
        workspace = self.client_capabilities.workspace
        if workspace is not None and workspace.code_lens is not None:
            if workspace.code_lens.refresh_support:
                with suppress(JsonRpcException):
                    await self.workspace_code_lens_refresh_async(None)

    def _publish(self, paths: Iterable[str]) -> None:
        for path in sorted(paths):
            found = [self._protocol.diagnostic(each) for each in self._workspace.findings(path)]
            version = self._versions.get(path) if path in self._workspace.texts else None
            result = types.PublishDiagnosticsParams(self._uri(path), found, version)
            self.text_document_publish_diagnostics(result)

    async def _shared_answer(self, question: Question) -> Any:
        """Return the answer to a question, shared by requests until an edit outdates it.

        Cancelling a request does not cancel the question.
        """
        key = question.sort, question.path, question.about
        task = self._answers.get(key)
        if task is None:
            task = asyncio.get_running_loop().create_task(self._workers.ask(question))
            self._answers[key] = task
            task.add_done_callback(lambda done: self._drop_failed(key, done))
        try:
            return await asyncio.shield(task)
        except asyncio.CancelledError:
            if task.cancelled():
                return Failed("a change has overtaken it")
            raise

    def _drop_failed(self, key: tuple[str, str, str], done: asyncio.Task[Any]) -> None:
        is_failed = done.cancelled() or done.exception() or isinstance(done.result(), Failed)
        if is_failed and self._answers.get(key) is done:
            del self._answers[key]

    def _overtake(self, path: str) -> None:
        """Discard answers that an edit at `path` outdates, and cancel pending questions."""
        queried = {path, *(robot.path for robot in self._workspace.robots_of(path))}
        for key, task in tuple(self._answers.items()):
            if key[1] in queried:
                del self._answers[key]
                task.cancel()

    # ---- Requests of the editor ------------------------------------------------------------------

    async def hover(self, params: types.HoverParams) -> types.Hover | None:
        """Return the hover text at a location, or None without one."""
        path, position = self._request_place(params)
        rules_here = self._workspace.rule_text(path)
        if rules_here is not None:
            found = [f for f in self._workspace.findings(path) if f.place.range.holds(position)]
            return hover_of(hover_rules(rules_here, self._rules(path), position, found))
        scene = self._workspace.context(path)
        if scene is None:
            return None
        traces: dict[str, str] = {}
        for each in scene.found_at(position):
            if each.title is not None:
                traces |= await self._trace(path, each.title)
        return hover_of(hover(scene, position, traces))

    async def _trace(self, path: str, title: str) -> dict[str, str]:
        """Return the trace of a finding by its title, or {} if it takes too long or is outdated."""
        for robot in self._workspace.robots_of(path):
            if robot.path not in self._stale or ("trace", robot.path, title) in self._answers:
                question = Question("trace", robot.path, self._workspace.overlay(), title)
                with suppress(TimeoutError):
                    answer = await asyncio.wait_for(self._shared_answer(question), _TRACE_SECONDS)
                    if isinstance(answer, str):
                        return {title: answer}
        return {}

    def definition(self, params: types.DefinitionParams) -> list[types.Location]:
        """Return the definitions of the name at a location."""
        path, position = self._request_place(params)
        rules_here = self._workspace.rule_text(path)
        if rules_here is not None:
            found = predicate_definition(
                rules_here, self._rules(path), self._workspace.texts, position
            )
            return self._protocol.locations(found)
        scene = self._workspace.context(path)
        return [] if scene is None else self._protocol.locations(definition(scene, position))

    def references(self, params: types.ReferenceParams) -> list[types.Location]:
        """Return the references of the module or predicate at a location."""
        path, position = self._request_place(params)
        with_own = params.context.include_declaration
        rules_here = self._workspace.rule_text(path)
        if rules_here is not None:
            mention = rules_here.at(position)
            if mention is None:
                return []
            named = predicate_mentions(
                rules_here, self._rules(path), self._workspace.texts, mention.key
            )
            return self._protocol.locations(
                place for place, each in named if with_own or not each.is_head
            )
        scene = self._workspace.context(path)
        found = () if scene is None else references(scene, position)
        return self._protocol.locations(
            place for place, each in found if with_own or each.role != "annotated"
        )

    def symbols(self, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        """Return the symbols that a text declares."""
        path = path_of(params.text_document.uri) or ""
        rules_here = self._workspace.rule_text(path)
        if rules_here is not None:
            return [symbol_of(each) for each in predicate_symbols(rules_here)]
        scene = self._workspace.context(path)
        return [] if scene is None else [symbol_of(each) for each in module_symbols(scene.here)]

    def workspace_symbols(
        self, params: types.WorkspaceSymbolParams
    ) -> list[types.SymbolInformation]:
        """Return the modules of open robots and the predicates of open rules by their names."""
        scenes = filter(None, map(self._workspace.context, self._workspace.texts))
        rules = filter(None, map(self._workspace.rule_text, self._workspace.texts))
        found = workspace_symbols(scenes, rules, params.query)
        return [self._protocol.symbol(*each) for each in found]

    def prepare_rename(self, params: types.PrepareRenameParams) -> types.Range | None:
        """Return the range of the module name at a location, or None if there is none."""
        path, position = self._request_place(params)
        scene = self._workspace.context(path)
        found = None if scene is None else renamed_range(scene, position)
        return None if found is None else range_of(found)

    def rename(self, params: types.RenameParams) -> types.WorkspaceEdit | None:
        """Return the edits that rename a module, or None if it cannot be renamed."""
        path, position = self._request_place(params)
        scene = self._workspace.context(path)
        if scene is None:
            return None
        try:
            return self._protocol.workspace_edit(rename(scene, position, params.new_name))
        except RefusedError as refused:
            raise JsonRpcException(str(refused), types.LSPErrorCodes.RequestFailed) from None

    def completion(self, params: types.CompletionParams) -> types.CompletionList:
        """Return the completion items at a location."""
        path, position = self._request_place(params)
        rules_here = self._workspace.rule_text(path)
        scene = self._workspace.context(path)
        if rules_here is not None:
            return items_of(rule_completion(rules_here, self._rules(path), position))
        found = _NOTHING if scene is None else completion(scene, position)
        return items_of(found)

    def lenses(self, params: types.CodeLensParams) -> list[types.CodeLens]:
        """Return the lenses above modules."""
        scene = self._workspace.context(path_of(params.text_document.uri) or "")
        return [
            types.CodeLens(
                range_of(each.range),
                types.Command(each.title, EXPLAIN, arguments=[each.robot, each.module]),
            )
            for each in (() if scene is None else lenses(scene))
        ]

    async def actions(self, params: types.CodeActionParams) -> list[types.CodeAction]:
        """Return the quick fixes of the findings in a range."""
        path = path_of(params.text_document.uri) or ""
        text = self._workspace.texts.get(path)
        if text is None:
            return []
        ends = map(position_of, (params.range.start, params.range.end))
        stretch = Range(*map(Text(path, text).clamp, ends))
        found = [each for each in self._workspace.findings(path) if each.place.range.meets(stretch)]
        scene = self._workspace.context(path)
        here = self._workspace.rule_text(path) if scene is None else scene.here
        chosen = [] if here is None else [*fix_actions(found), *spelling_actions(here.text, found)]
        if any(each.title for each in found):
            for robot in self._workspace.robots_of(path):
                question = Question("repairs", robot.path, self._workspace.overlay())
                answer = await self._shared_answer(question)
                chosen += () if isinstance(answer, Failed) else actions_at(answer, found)
        if self._workspace.texts.get(path) != text:
            return []
        return [self._protocol.action(*each) for each in chosen]

    async def format(self, params: types.DocumentFormattingParams) -> list[types.TextEdit]:
        """Return the changes of `mars-asp fmt` as one edit of the whole text, or no edit."""
        path = path_of(params.text_document.uri) or ""
        written = self._workspace.texts.get(path)
        if written is None or not is_configuration(path):
            return []
        answer = await self._shared_answer(Question("format", path, self._workspace.overlay()))
        if (
            isinstance(answer, Failed)
            or answer == written
            or self._workspace.texts.get(path) != written
        ):
            return []
        end = Text(path, written).last_position
        return [types.TextEdit(range_of(Range(Position(0, 0), end)), answer)]

    async def explain(self, robot: str, module: str | None) -> str:
        """Show the consequences and nodes of a module, or of the robot if `module` is None."""
        known = self._workspace.robots.get(robot)
        if known is None:
            return ""
        names = known.consequences.keys() if module is None else (module,)
        lines = dict.fromkeys(each for name in names for each in known.consequences.get(name, ()))
        nodes = known.nodes or {}
        lines |= dict.fromkeys(node for name in names for node in nodes.get(name, ()))
        text = "\n".join(lines)
        self.window_show_message(types.ShowMessageParams(types.MessageType.Info, text))
        return text

    def _request_place(
        self, params: types.TextDocumentPositionParams | Any
    ) -> tuple[str, Position]:
        """Return the path and position of a request, clamped to the text."""
        path, position = place_of(params)
        return path, Text(path, self._workspace.texts.get(path, "")).clamp(position)

    def _rules(self, path: str) -> Rules:
        return self._workspace.rules.get(path, Rules())

    def _uri(self, path: str) -> str:
        return self._uris.get(path) or from_fs_path(path) or path
