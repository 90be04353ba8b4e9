"""Draw a configuration or specification."""

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.cli.deliver import write_file
from mars_asp.cli.reason import add_file, read_project
from mars_asp.diagnostic import Diagnostic, MarsError
from mars_asp.output import visible

if TYPE_CHECKING:
    from mars_asp.diagnostic import Span
    from mars_asp.draw import Picture

FORMATS = ("svg", "png", "dot", "mmd")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)
    parser.add_argument(
        "-o",
        "--output",
        metavar="OUT",
        required=True,
        help=f"where to write it; its suffix chooses the form: .{', .'.join(FORMATS)}",
    )
    parser.add_argument(
        "--as",
        dest="kind",
        choices=FORMATS,
        help="what to write, if not by the suffix of OUT",
    )
    parser.epilog = (
        "A configuration is drawn as it is written. To see the nodes that resolve it, draw its "
        "specification: mars-asp synthesise FILE | mars-asp draw - -o OUT"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the picture."""
    kind = arguments.kind or _kind_of(arguments.output)
    if kind not in FORMATS:
        print(
            f"mars-asp draw: `{visible(arguments.output)}` does not show what to write; "
            f"end it in .{', .'.join(FORMATS)}, or add --as",
            file=sys.stderr,
        )
        return 2
    project = read_project(arguments)
    from mars_asp.draw import depict

    configuration = project.configuration
    picture = depict(configuration, project.modules)
    content = _drawn(picture, kind, configuration.span)
    if arguments.output != "-":
        write_file(arguments.output, content)
    elif isinstance(content, str):
        print(content, end="")
    else:
        sys.stdout.buffer.write(content)
    return 0


def _kind_of(output: str) -> str:
    return "svg" if output == "-" else Path(output).suffix.removeprefix(".").lower()


def _drawn(picture: "Picture", kind: str, span: "Span") -> str | bytes:
    if kind == "dot":
        from mars_asp.draw.dot import dot_text

        return dot_text(picture)
    if kind == "mmd":
        from mars_asp.draw.mermaid import mermaid_text

        return mermaid_text(picture)
    from mars_asp.draw.layered import TooLargeError
    from mars_asp.draw.svg import svg_text

    try:
        svg = svg_text(picture)
    except TooLargeError:
        raise MarsError((_too_large(picture, span),)) from None
    if kind == "svg":
        return svg
    from mars_asp.draw.png import png_bytes

    return png_bytes(svg, span)


def _too_large(picture: "Picture", span: "Span") -> Diagnostic:
    return Diagnostic(
        "draw",
        "error",
        f"{len(picture.boxes)} boxes with {len(picture.lines)} lines make too large a picture",
        span,
        help="write `.dot`, which other programs can show, or draw parts",
    )
