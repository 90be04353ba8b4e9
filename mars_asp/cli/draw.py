"""Draw a configuration or specification."""

import argparse
import sys
from collections.abc import Mapping
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from mars_asp.cli.arguments import add_flags, add_output, misuse
from mars_asp.cli.deliver import write_result
from mars_asp.cli.diagnostic_text import report
from mars_asp.cli.inputs import (
    JUDGING,
    add_file,
    judge_project,
    read_project,
    report_reading,
    rulebook_for,
)
from mars_asp.cli.selection import Selection, add_selection
from mars_asp.cli.suggested_commands import way_to_install
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.diagnostic import Diagnostic, refusal, whole_file
from mars_asp.model.declarations import ends_of, ports_of
from mars_asp.model.names import end, read_end
from mars_asp.output import visible
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    from mars_asp.draw import Picture
    from mars_asp.draw.picture import LineKind
    from mars_asp.reasoning.project import Project

FORMATS = ("svg", "png", "dot", "mmd")


#: The formats that are laid out here; other programs lay out the others.
_PAINTED = ("svg", "png")
#: Kinds of relationships, by the words of the command line.
_KINDS: "Mapping[str, LineKind]" = {
    "data": "data",
    "control": "control",
    "mounts": "mount",
    "resets": "reset",
    "locks": "lock",
    "limits": "limit",
}
_DEPTH = 1


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_file(parser)
    add_output(parser)
    parser.add_argument("--as", dest="kind", choices=FORMATS)
    parser.add_argument("--about", metavar="NAME")
    parser.add_argument(
        "--depth",
        metavar="N",
        type=_depth,
        help=f"how many relationships lead away from NAME at most (default {_DEPTH})",
    )
    parser.add_argument(
        "--only",
        metavar="KIND,...",
        type=relationship_kinds,
        help=f"draw relationships of these kinds alone: {', '.join(_KINDS)}; "
        "suppress and inhibit lines are data or control, as the line that they close",
    )
    add_flags(parser, "--whole", "--classes")
    parser.add_argument("--layout", choices=("own", "dot"), default="own")
    add_selection(parser, writes=False)


def run(arguments: argparse.Namespace) -> int:
    """Write the diagram."""
    ending = "svg" if arguments.output == "-" else Path(arguments.output).suffix[1:].lower()
    kind = arguments.kind or ending
    if kind not in FORMATS:
        text = (
            f"mars-asp draw: `{visible(arguments.output)}` does not show what to write; "
            f"end it in .{', .'.join(FORMATS)}, or add --as"
        )
        for line in wrapped(text, columns(sys.stderr), further="  "):
            print(line, file=sys.stderr)
        return 2
    if arguments.depth is not None and arguments.about is None:
        return misuse("draw", "--depth needs --about NAME")
    if arguments.layout == "dot" and kind not in _PAINTED:
        return misuse("draw", f"--layout has no effect on .{kind}: leave it out")
    if arguments.format == "json" and arguments.kind is None and arguments.output == "-":
        advice = "leave out `--format json`, or type `mars-asp analyse FILE --format json`"
        return misuse("draw", f"a picture has no JSON: {advice}")
    project = read_project(arguments, quietly=True)
    configuration = project.configuration
    picture, is_cut = _part(project, kind in _PAINTED, arguments)
    report_reading(project, arguments)
    if picture.remark:
        options = "--about NAME draws what is near a module, --only some kinds, --whole all of it"
        help_text = options if is_cut else None
        span = whole_file(configuration.path)
        report([Diagnostic("draw", "note", picture.remark, span, help=help_text)], arguments)
    content = _drawn(picture, kind, arguments.layout, configuration.path)
    write_result(arguments.output, content)
    return 0


def drawn(project: "Project", kind: str, arguments: argparse.Namespace) -> str | bytes:
    """Return the diagram of a project in the format `kind`.

    Raises:
        MarsError: `--about` names no module, or the diagram is too large.
    """
    picture, _ = _part(project, kind in _PAINTED, arguments)
    return _drawn(picture, kind, arguments.layout, project.configuration.path)


def _part(
    project: "Project", is_painted: bool, arguments: argparse.Namespace
) -> "tuple[Picture, bool]":
    """Return the requested part of a diagram, with a remark on omitted parts, and if it was cut.

    A picture that is cut is larger than a screen, and whole with `--whole`.

    Raises:
        MarsError: `--about` names no module.
    """
    from mars_asp.draw import depict
    from mars_asp.draw.marks import marked, number_findings
    from mars_asp.draw.part import about, fitting, left_out, of_kinds
    from mars_asp.draw.svg import drawn_width
    from mars_asp.exchange.lift import with_own_muxes

    rulebook = rulebook_for(arguments, JUDGING)
    selection = Selection(arguments, rulebook)
    analysis = judge_project(project, rulebook, arguments)
    found = number_findings(selection.among(project, analysis.consequences).shown)
    configuration = with_own_muxes(project.configuration)
    whole = marked(depict(configuration, project.modules, classes=arguments.classes), found)
    shown, name, port = whole, None, None
    if arguments.about is not None:
        name, port = _box_and_port(arguments.about, whole, project)
    if arguments.only is not None:
        shown = of_kinds(shown, arguments.only, name)
    if arguments.about is not None:
        shown = about(shown, name, _DEPTH if arguments.depth is None else arguments.depth, port)
    # Other programs lay out the other formats.
    is_fitted = is_painted and not arguments.whole
    fitted = fitting(shown, drawn_width, name) if is_fitted else shown
    remark = left_out(whole, fitted) or ""
    return replace(fitted, remark=remark), len(fitted.boxes) < len(shown.boxes)


def _box_and_port(
    written: str, picture: "Picture", project: "Project"
) -> tuple[str | None, str | None]:
    """Return the shown names of a box and its port (None without one) in `MODULE.PORT`.

    A topic of ROS is a port of any box: without a name of one.

    Raises:
        MarsError: there is no module, port or topic of that name.
    """
    from mars_asp.reasoning.project import port_names

    names = {box.name for box in picture.boxes}
    module, port = read_end(written) or (written, None)
    # A name may be written as the diagram shows it, and that of a node of ROS without its slash.
    for name in (visible(written), visible(module) if port is None else "", f"/{visible(written)}"):
        if name in names:
            return name, None
    outlets = {each.outlet for each in picture.lines if each.outlet is not None}
    topics = {each for each in outlets if each.startswith("/")}
    if written in topics:
        return None, written
    # A module without a description has the ports that relationships name.
    ends = {*port_names(project).values()}
    # Commands are of no port, but of a topic.
    for drawn in picture.lines:
        if drawn.kind == "control" and drawn.outlet is not None:
            ends |= {(picture.boxes[at].name, drawn.outlet) for at in (drawn.tail, drawn.head)}
    for line in project.configuration.relationships:
        both = zip(ends_of(line), ports_of(line), strict=True)
        ends |= {(of, name) for of, name in both if name is not None}
    ports = {end(*each): each for each in sorted(ends)}
    if (module, port) in ports.values() and visible(module) in names:
        return visible(module), port
    own = sorted(each for each, (of, _) in ports.items() if of == module)
    if port is not None and visible(module) in names:
        what, known = f"`{module}` has no port `{port}`", f"its ports are {', '.join(own)}"
        near, known = nearest(written, own), known if own else "no line joins a port of it"
    else:
        # A port alone means that of its first sender.
        tails = (picture.boxes[line.tail] for line in picture.lines if line.outlet == written)
        sent = (f"{box.name}.{written}" for box in tails)
        alone = [each for each, (_, name) in ports.items() if name == written]
        is_topic = alone and written.startswith("/")
        what = f"`{written}` {'joins no two modules' if is_topic else 'is not a module or port'}"
        known = "--about takes MODULE, MODULE.PORT or a topic"
        near = next(chain(sent, alone), None) or nearest(written, (*names, *ports, *topics))
    help_text = f"did you mean `{near}`?" if near else known
    raise refusal("draw", what, project.configuration.path, help_text)


def _depth(text: str) -> int:
    if text.isdigit() and int(text) < 10**6:
        return int(text)
    raise argparse.ArgumentTypeError(f"a depth is a number from 0, found `{text}`")


def relationship_kinds(text: str) -> "frozenset[LineKind]":
    """Return the kinds of relationships in a text like `data,control`."""
    words = [word.strip() for word in text.split(",") if word.strip()]
    unknown = [word for word in words if word not in _KINDS]
    if unknown or not words:
        near = nearest(unknown[0], _KINDS) if unknown else None
        advice = f"did you mean `{near}`?" if near else f"expected {', '.join(_KINDS)}"
        raise argparse.ArgumentTypeError(f"found `{unknown[0] if unknown else text}`: {advice}")
    return frozenset(_KINDS[word] for word in words)


def _drawn(picture: "Picture", kind: str, layout: str, path: str) -> str | bytes:
    if kind == "dot":
        from mars_asp.draw.dot import dot_text

        return dot_text(picture)
    if kind == "mmd":
        from mars_asp.draw.mermaid import mermaid_text

        return mermaid_text(picture)
    from mars_asp.draw.graphviz import NoGraphvizError, draw_by_dot
    from mars_asp.draw.layered import TooLargeError
    from mars_asp.draw.packing import draw_graph
    from mars_asp.draw.svg import svg_text

    try:
        svg = svg_text(picture, layout=draw_by_dot if layout == "dot" else draw_graph)
    except TooLargeError:
        size = f"{len(picture.boxes)} boxes with {len(picture.lines)} lines"
        advice = "write `.dot`, which other programs can show, or draw parts"
        raise refusal("draw", f"{size} make too large a picture", path, advice) from None
    except NoGraphvizError as error:
        advice = "install Graphviz, or leave out `--layout dot`"
        raise refusal("draw", str(error), path, advice) from None
    if kind == "svg":
        return svg
    from mars_asp.draw.png import png_bytes

    return png_bytes(svg, path, f"`{way_to_install('png')}`")
