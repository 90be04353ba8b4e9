"""Hover texts: the finding, the module, the port, the predicate or the keyword at a location.

The texts are Markdown.
"""

import re
from collections.abc import Mapping
from typing import NamedTuple

from mars_asp.lsp.keyword_docs import ANNOTATIONS, METADATA, MODES, STATEMENTS, KeywordDoc
from mars_asp.lsp.occurrences import Occurrence, is_configuration
from mars_asp.lsp.places import Position, Range, Text
from mars_asp.lsp.robot import Described, DocumentContext, EditorFinding
from mars_asp.lsp.rule_text import RuleText
from mars_asp.lsp.rules import Rules
from mars_asp.output import fenced, markdown

_WORD = re.compile(r"@?[A-Za-z_]\w*")
_METADATA = re.compile(r"\s*%!\s*([a-z]+)\s*:")


class Hover(NamedTuple):
    """The text about a location, and its range."""

    markdown: str
    range: Range | None


def hover(scene: DocumentContext, position: Position, traces: Mapping[str, str]) -> Hover | None:
    """Return the hover text at a location of a `.mars` file or a source, or None.

    `traces` are the known short explanations of findings, by their titles.
    """
    mention = scene.here.at(position)
    parts = [finding_text(each, traces) for each in scene.found_at(position)]
    place = None
    if mention is not None:
        place = mention.range
        module, consequences = module_texts(scene, mention, position)
        parts = [*filter(None, (module, *parts, consequences))]
    else:
        word = _word_at(scene.here.text, position)
        if word is not None:
            text, place = word
            found = _word(scene, text, place)
            parts += [] if found is None else [word_text(found)]
    return Hover("\n\n---\n\n".join(parts), place) if parts else None


def hover_rules(
    here: RuleText, rules: Rules, position: Position, found: list[EditorFinding]
) -> Hover | None:
    """Return the hover text at a location of a file of rules, or None."""
    parts = [finding_text(each, {}) for each in found]
    mention = here.at(position)
    place = None
    if mention is not None:
        place = mention.range
        for each in rules.predicates.get(mention.key, ()):
            parts.append(f"{fenced(each.written, 'text')}\n\n{markdown(each.words)}".rstrip())
    else:
        line, column = here.text.column(position)
        match = _METADATA.match(here.text.lines[line - 1])
        if match and match.start(1) <= column - 1 <= match.end(1) and match[1] in METADATA:
            place = here.text.within(line, *match.span(1))
            parts.append(word_text(METADATA[match[1]]))
    return Hover("\n\n---\n\n".join(parts), place) if parts else None


def word_text(word: KeywordDoc) -> str:
    """Return the documentation of a keyword."""
    return f"{fenced(word.written, 'text')}\n\n{word.meaning}"


def finding_text(finding: EditorFinding, traces: Mapping[str, str]) -> str:
    """Return the text of a finding, with its short trace if that is known."""
    lines = [f"**{finding.severity}**: {markdown(finding.message)} `[{finding.code}]`"]
    texts = (finding.effect, finding.help and f"help: {finding.help}")
    lines += [markdown(each) for each in texts if each]
    trace = traces.get(finding.title or "")
    return "\n\n".join([*lines, *([fenced(trace)] if trace else [])])


def module_texts(
    scene: DocumentContext, mention: Occurrence, position: Position
) -> tuple[str, str]:
    """Return the text about a module's annotations or port, and that about its consequences."""
    robot, file = next(scene.own_files(), (None, None))
    if robot is None or file is None:
        return "", ""
    name = file.name_of(mention)
    described = robot.modules.get(mention.described or name) or robot.modules.get(name)
    port = mention.port
    text = ""
    if described is None:
        if mention.role != "annotated":
            text = f"`{name}`: no annotation describes this module"
    elif port is not None and port.range.holds(position):
        text = _port_text(described, port.name, port.is_output)
    else:
        text = fenced("\n".join(described.lines))
    about = robot.consequences.get(name, ())
    return text, "\n".join(f"- {markdown(each)}" for each in about)


def _port_text(described: Described, name: str, is_output: bool | None) -> str:
    if is_output is None:
        is_output = name in described.outputs or name not in described.inputs
    ports = described.outputs if is_output else described.inputs
    sort = "output" if is_output else "input"
    if name in ports:
        return f"{sort} `{name}` of\n\n{fenced(chr(10).join(described.lines), 'text')}"
    known = ", ".join(f"`{each}`" for each in ports) or "none"
    return f"no {sort} `{name}`; there are: {known}"


def _word(scene: DocumentContext, text: str, place: Range) -> KeywordDoc | None:
    """Return the documentation of the keyword at a range, or None if it is not one there."""
    is_inside = any(
        first <= place.start.line + 1 <= last for first, last in scene.here.blocks
    ) or not is_configuration(scene.here.text.path)
    if text.startswith("@"):
        return ANNOTATIONS.get(text[1:]) or (None if is_inside else STATEMENTS.get(text))
    line = scene.here.text.lines[place.start.line]
    if is_inside:
        # Outside of annotations, the word is code of another language.
        is_ours = re.search(r"@[A-Za-z]", line[: place.start.character]) is not None
        named = ANNOTATIONS.get(text) if re.match(r"(?:Rotn|Trans)_|Grasp", text) else None
        return (MODES.get(text) or named) if is_ours else None
    return STATEMENTS.get(text) or MODES.get(text)


def _word_at(text: Text, position: Position) -> tuple[str, Range] | None:
    line, column = text.column(position)
    for match in _WORD.finditer(text.lines[line - 1]):
        if match.start() <= column - 1 <= match.end():
            return match[0], text.within(line, *match.span())
    return None
