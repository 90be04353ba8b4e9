"""Findings in a picture: each box and line that one is about has its number."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace

from mars_asp.diagnostic import Span
from mars_asp.draw.picture import NumberedFinding, Picture
from mars_asp.model.names import read_end
from mars_asp.output import visible
from mars_asp.reasoning.analysis import Consequence


def number_findings(
    consequences: Iterable[Consequence],
) -> list[tuple[NumberedFinding, Consequence]]:
    """Return the errors and then the warnings among consequences, numbered from 1."""
    found = sorted(
        (each for each in consequences if each.severity != "note"),
        key=lambda each: each.severity != "error",
    )
    return [
        (NumberedFinding(number, each.severity, visible(f"{each.message} [{each.kind}]")), each)
        for number, each in enumerate(found, 1)
    ]


def marked(picture: Picture, findings: Sequence[tuple[NumberedFinding, Consequence]]) -> Picture:
    """Return a diagram with each finding added to its boxes and lines.

    Its boxes are those of the subject and the participants. Its lines have one of its locations,
    and end at such a box.
    """
    box_of = {box.name: index for index, box in enumerate(picture.boxes)}
    lines_at: dict[Span | None, list[int]] = defaultdict(list)
    for index, line in enumerate(picture.lines):
        lines_at[line.span].append(index)
    boxes: dict[int, list[NumberedFinding]] = defaultdict(list)
    lines: dict[int, list[NumberedFinding]] = defaultdict(list)
    for finding, found in findings:
        ends = {found.subject, *found.participants}
        # A finding about a port is about its module.
        ends |= {module for module, _ in filter(None, map(read_end, ends))}
        names = (visible(" ".join(end.split())) for end in ends)
        about = {box_of[name] for name in names if name in box_of}
        for box in about:
            boxes[box].append(finding)
        for index in {index for span in found.spans for index in lines_at.get(span, ())}:
            line = picture.lines[index]
            if not about.isdisjoint((line.tail, line.head)):
                lines[index].append(finding)
    return replace(
        picture,
        boxes=tuple(
            replace(box, findings=tuple(boxes.get(index, ())))
            for index, box in enumerate(picture.boxes)
        ),
        lines=tuple(
            replace(line, findings=tuple(lines.get(index, ())))
            for index, line in enumerate(picture.lines)
        ),
    )
