"""Checks of the messages of a client: errors are sent back, and sizes are limited."""

from collections import deque
from dataclasses import dataclass
from typing import Any, BinaryIO

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.protocol import LanguageServerProtocol, default_converter

#: Maximal bytes of a message, far above those of any text, and of a header line.
MOST_BYTES = 128 * 1024 * 1024
_MOST_LINE = 4096
_TOO_LARGE = b'"too large"'
_NO_LENGTH = b'"no length"'
_REASONS = {
    "too large": f"a message has more than {MOST_BYTES} bytes, so it was dropped",
    "no length": "a message begins with `Content-Length: N` and an empty line",
}
_HEADERS = (b"content-length:", b"content-type:")
_ABOUT_OPEN = (
    types.TEXT_DOCUMENT_DID_CHANGE,
    types.TEXT_DOCUMENT_DID_CLOSE,
    types.TEXT_DOCUMENT_DID_SAVE,
)


@dataclass(eq=False)
class ClientError(Exception):
    """An invalid message: the id of its request, or None, the error code and the reason."""

    request: int | str | None
    code: int
    message: str


class BoundedInput:
    """The input from a client; oversized messages are replaced by invalid ones."""

    def __init__(self, file: BinaryIO) -> None:
        """Set the file that messages are read from."""
        self._file = file
        self._lines: deque[bytes] = deque()
        self._body: bytes | None = None

    def readline(self) -> bytes:
        """Return the next header line, or an empty one at the end of the file."""
        if self._lines:
            return self._lines.popleft()
        line = self._file.readline(_MOST_LINE)
        name, _, value = line.lower().partition(b":")
        number = value.strip()
        if line.strip() and not line.lower().startswith(_HEADERS):
            return self._substitute(_NO_LENGTH)
        if name == b"content-length":
            if not (number.isdigit() and len(number) < 16 and int(number)):
                return self._substitute(_NO_LENGTH)
            # Normalise the case of the header.
            return b"Content-Length: %d\r\n" % int(number)
        return line if line.strip() else b"\r\n" * bool(line)

    def _substitute(self, body: bytes) -> bytes:
        self._body = body
        self._lines.append(b"\r\n")
        return b"Content-Length: %d\r\n" % len(body)

    def read_message(self, size: int) -> bytes:
        """Return a message, or the replacement of an invalid one."""
        if self._body is not None:
            body, self._body = self._body, None
            return body
        if size <= MOST_BYTES:
            return self._file.read(size)
        while size > 0 and (part := self._file.read(min(size, 1 << 20))):
            size -= len(part)
        return _TOO_LARGE

    #: The name that pygls calls.
    read = read_message


def strict_converter() -> Any:
    """Return pygls's converter, changed to reject numbers for texts and texts for numbers.

    Booleans are converted, because some clients send 0 and 1.
    """
    converter = default_converter()  # type: ignore[no-untyped-call]
    for kind in (int, str):
        converter.register_structure_hook(kind, _of_kind)
    return converter


def _of_kind(value: Any, kind: type) -> Any:
    """Return a value of a kind, or of an enumeration; raise TypeError for any other value."""
    is_whole = kind is int and isinstance(value, float) and value.is_integer()
    if kind in (int, str) and type(value) is not kind and not is_whole:
        raise TypeError(f"expected {kind.__name__}, found {type(value).__name__}")
    return kind(value)


class CheckedProtocol(LanguageServerProtocol):
    """Raises `ClientError` for messages that break the protocol."""

    _is_begun = False

    def structure_message(self, data: dict[str, Any]) -> Any:
        """Return a message of JSON as a value of the protocol."""
        if "jsonrpc" in data:
            identity, method = data.get("id", 0), data.get("method", "")
            if isinstance(identity, bool) or not isinstance(identity, int | str):
                message = "the `id` of a message is a number or a text"
                raise ClientError(None, types.ErrorCodes.InvalidRequest, message)
            if not isinstance(method, str):
                message = "the `method` of a message is a text"
                raise ClientError(identity, types.ErrorCodes.InvalidRequest, message)
        try:
            return super().structure_message(data)
        except (JsonRpcException, TypeError) as error:
            method = data.get("method")
            message = f"the message `{method!s:.100}` has not the form that the protocol gives it"
            code = types.ErrorCodes.InvalidParams
            raise ClientError(data.get("id"), code, message) from error

    def handle_message(self, message: Any) -> None:
        """Handle a message, or raise `ClientError` if the protocol forbids it now."""
        method, request = getattr(message, "method", None), getattr(message, "id", None)
        invalid = types.ErrorCodes.InvalidRequest
        if getattr(message, "jsonrpc", None) != self.VERSION:
            known = _REASONS.get(message) if isinstance(message, str) else None
            reason = known or 'a message is an object with `"jsonrpc": "2.0"`'
            raise ClientError(request, invalid, reason)
        if method == types.INITIALIZE:
            if self._is_begun:
                raise ClientError(request, invalid, "the server was initialized before")
            self._is_begun = True
        elif method is not None and method != types.EXIT and not self._is_begun:
            code = types.ErrorCodes.ServerNotInitialized
            raise ClientError(request, code, f"`{method!s:.100}` came before `initialize`")
        elif self._shutdown and request is not None and method is not None:
            raise ClientError(request, invalid, f"`{method!s:.100}` came after `shutdown`")
        if method == types.CANCEL_REQUEST and not isinstance(message.params.id, int | str):
            raise ClientError(None, invalid, "the `id` of a request is a number or a text")
        if method in _ABOUT_OPEN:
            uri = message.params.text_document.uri
            if uri not in self.workspace.text_documents:
                raise ClientError(None, invalid, f"`{method}`: `{uri:.300}` is not open")
        if method == types.WORKSPACE_EXECUTE_COMMAND:
            # Without a list, pygls does not count the arguments.
            message.params.arguments = message.params.arguments or []
        super().handle_message(message)
