"""The elements of an XML document with their locations."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NoReturn
from xml.parsers import expat

from mars_asp.diagnostic import Diagnostic, MarsError, Span, point

#: A robot, its links and joints, and the direct children of these; geometry is deeper.
_DEEPEST = 3
#: Errors that the end of an open element avoids.
_UNCLOSED = frozenset(
    {
        expat.errors.XML_ERROR_NO_ELEMENTS,
        expat.errors.XML_ERROR_UNCLOSED_TOKEN,
        expat.errors.XML_ERROR_TAG_MISMATCH,
    }
)


@dataclass(frozen=True, slots=True)
class XmlElement:
    """An element: its name, attributes, location (of its `<`), child elements and text.

    `pieces` are the fragments of its text, each with its line and the number of columns before it.
    """

    name: str
    attributes: Mapping[str, str]
    span: Span
    children: list["XmlElement"] = field(default_factory=list)
    pieces: list[tuple[int, int, str]] = field(default_factory=list)

    def named(self, name: str) -> Iterator["XmlElement"]:
        """Yield the child elements with a name."""
        return (child for child in self.children if child.name == name)


def read_elements(
    text: str, path: str, deepest: int = _DEEPEST, *, whole: bool = False, code: str = "urdf"
) -> XmlElement:
    """Return the root of a document with the elements of its upper levels.

    Document types are refused: they declare entities, which no robot needs. With `whole`, text is
    kept, and elements deeper than `deepest` are errors and not ignored; `code` is that of errors.

    Raises:
        MarsError: the text is not XML, has a document type, or (with `whole`) is nested too deep.
    """
    parser = expat.ParserCreate()
    open_elements: list[XmlElement] = []
    open_names: list[str] = []
    root: XmlElement | None = None

    def here() -> Span:
        return point(path, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal root
        open_names.append(name)
        if len(open_names) > deepest:
            if whole:
                message = f"elements are nested deeper than {deepest}"
                help_text = "nothing of a robot is so deep: take levels away"
                raise MarsError((Diagnostic(code, "error", message, here(), help=help_text),))
            return
        element = XmlElement(name, attributes, here())
        if open_elements:
            open_elements[-1].children.append(element)
        else:
            root = element
        open_elements.append(element)

    def end(_: str) -> None:
        if len(open_names) <= deepest:
            open_elements.pop()
        open_names.pop()

    def refuse(*_: object) -> NoReturn:
        # The parser calls this at the end of the name, and its index counts bytes.
        before = text.encode()[: parser.CurrentByteIndex]
        lines = before.rpartition(b"<!DOCTYPE")[0].decode().split("\n")
        place = point(path, len(lines), len(lines[-1]) + 1)
        found = "a document type, which is refused: it could declare entities"
        raise MarsError((Diagnostic(code, "error", found, place, help="delete it"),))

    def characters(text: str) -> None:
        if open_elements and len(open_names) <= deepest:
            piece = (parser.CurrentLineNumber, parser.CurrentColumnNumber, text)
            open_elements[-1].pieces.append(piece)

    parser.StartElementHandler = start
    if whole:
        parser.CharacterDataHandler = characters
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        place = point(path, error.lineno, error.offset + 1)
        reason = expat.errors.messages[error.code]
        is_open = open_names and reason in _UNCLOSED
        expected = f", expected `</{open_names[-1]}>`" if is_open else ""
        message = f"the file is not XML: {reason}{expected}"
        raise MarsError((Diagnostic(code, "error", message, place),)) from None
    assert root is not None  # expat refuses a document without a root
    return root
