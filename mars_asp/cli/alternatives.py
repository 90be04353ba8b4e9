"""The output of `explain --alternatives`: why the cost is minimal, and other specifications."""

import argparse
import sys
from collections.abc import Iterator, Sequence

from mars_asp.cli.diagnostic_text import report_unrealisable
from mars_asp.cli.encode import print_result
from mars_asp.cli.inputs import rulebook_for
from mars_asp.cli.lines import location_json
from mars_asp.cli.selection import Selection
from mars_asp.cli.suggested_commands import command_on_one
from mars_asp.cli.wrapping import cells, columns, compared, wrapped
from mars_asp.model.declarations import Connection, Control, ends_of
from mars_asp.output import counted, visible
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.alternatives import (
    MOST_CONVERSIONS,
    Alternatives,
    CertificateEntry,
    alternatives,
)
from mars_asp.reasoning.questions.needs import places
from mars_asp.reasoning.rules import CONVERSION, COSTS, RELATIONSHIPS, by_name
from mars_asp.reasoning.session import Reasoner

#: The text lists at most so many needs; JSON contains all.
_MOST_NEEDS = 20
#: The text lists at most so many nodes of a need.
_MOST_NODES = 3
#: Between the columns of the needs.
_GAP = "  "
#: A blank at which no line is broken, until the text is wrapped.
_KEPT = "\0"


def run_alternatives(project: Project, arguments: argparse.Namespace, subject: str | None) -> int:
    """Print alternatives; return 1 if no specification exists or an error is reported."""
    most: int = arguments.alternatives
    rulebook = rulebook_for(arguments, ("resolve", "account"))
    selection = Selection(arguments, rulebook)
    reasoner = Reasoner(project, rulebook, Budget(arguments.time_limit))
    most_needs = None if arguments.format == "json" else _MOST_NEEDS
    found = alternatives(reasoner, subject, most, most_needs)
    if found is None:
        report_unrealisable(project.configuration.path, reasoner.analysis, arguments)
        return 1
    lines = alternatives_lines(found, arguments, columns(sys.stdout))
    print_result(arguments, lambda: alternatives_json(found, subject), lines)
    return int(selection.has_errors(project, found.analysis))


def alternatives_lines(
    found: Alternatives, arguments: argparse.Namespace, width: int
) -> Iterator[str]:
    """Yield the lines about certificate entries, costs and alternatives, safe to print."""
    return map(visible, _alternative_lines(found, arguments, width))


def _alternative_lines(
    found: Alternatives, arguments: argparse.Namespace, width: int
) -> Iterator[str]:
    yield from wrapped(_head(found), width)
    yield from _needs_table(found.needs[:_MOST_NEEDS], width)
    if len(found.needs) > _MOST_NEEDS:
        yield f"{_GAP}and {counted(len(found.needs) - _MOST_NEEDS, 'more need')}"
    text = " ".join(_levels(found))
    if text:
        yield from wrapped(text, width)
    yield from _example(found, arguments, width)
    for number, other in enumerate(found.others, 1):
        yield ""
        yield f"{number}. {compared(by_name(other.extra))}"
        yield from (f"     - {line}" for line in other.removed)
        yield from (f"     + {line}" for line in other.added)
    yield ""
    further = " further" if found.others else ""
    yield (
        f"There is no{further} alternative other than adding nodes."
        if found.complete
        else "There are more alternatives."
    )


def _head(found: Alternatives) -> str:
    """Return the sentence with the number of nodes, and why fewer do not suffice."""
    nodes, needs = found.nodes, len(found.needs)
    if not nodes:
        return "No node is needed."
    are = f"{'' if found.levels else 'In this part '}{counted(nodes, 'node')} is"
    if not found.synthesis.resolution.proven:
        common = " that have no node in common" if needs > 1 else ""
        return f"{are} the best found; there are {counted(needs, 'need')}{common}:"
    if needs == nodes:
        why = "this need" if needs == 1 else f"these {needs} needs have no node in common"
        return f"{are} the least, because {'of ' if needs == 1 else ''}{why}:"
    searched = (
        f"No set of fewer than {nodes} nodes exists among these {found.candidates} candidates, "
        "proved by search."
    )
    if not needs:
        return f"{are} the least. {searched}"
    have = "1 need" if needs == 1 else f"{needs} needs that have no node in common"
    return f"{are} the least. {searched} There {'is' if needs == 1 else 'are'} {have}:"


def _needs_table(needs: Sequence[CertificateEntry], width: int) -> Iterator[str]:
    """Yield certificate entries as a table if it fits into `width`, else as paragraphs."""
    rows = [_row(number, need) for number, need in enumerate(needs, 1)]
    margin = max((len(number) for number, *_ in rows), default=0)
    whats = max((cells(what) for _, what, _, _ in rows), default=0)
    whys = max((cells(why) for _, _, why, _ in rows), default=0)
    clauses = max((len(clause) for *_, clause in rows), default=0)
    beside = margin + whats + whys + clauses + 4 * len(_GAP) <= width
    for number, what, why, clause in rows:
        head = f"{_GAP}{number:>{margin}}{_GAP}"
        if beside:
            row = f"{head}{what:<{whats}}{_GAP}{why:<{whys}}{_GAP}{clause}"
            yield row.rstrip()
            continue
        further = " " * (len(head) + 2)
        yield from wrapped(what, width, head, further)
        if why:
            # A number is not parted from its word.
            text = f"{why} ({clause.replace(' ', _KEPT)})"
            for line in wrapped(text, width, further, further + _GAP):
                yield line.replace(_KEPT, " ")


def _row(number: int, need: CertificateEntry) -> tuple[str, str, str, str]:
    """Return the cells of a certificate entry: number, nodes, reason and clause."""
    # In a table names need no quotes.
    reasons = [(each.what.replace("`", ""), each) for each in need.reasons]
    if not reasons:
        return str(number), ", ".join(need.names), "", ""
    whats = [what for what, _ in reasons]
    what = whats[0]
    if len(need.nodes) > 1:
        more = f", or one of {len(need.nodes) - _MOST_NODES} more"
        what = f"{', or '.join(whats[:_MOST_NODES])}{more if len(need.nodes) > _MOST_NODES else ''}"
    first = reasons[0][1]
    here = "here " if len(need.nodes) > 1 else ""
    why = "" if first.why is None else f"{here}{first.why.replace('`', '')}"
    return str(number), what, why, "" if first.why is None else f"clause {first.clause}"


def _levels(found: Alternatives) -> Iterator[str]:
    """Yield sentences on the costs below the nodes, and on specifications of equal cost."""
    if not found.levels:
        return
    resolution = found.synthesis.resolution
    conversion, relationships = found.levels[CONVERSION], found.levels[RELATIONSHIPS]
    searched = "that less does not suffice was proved by search"
    text = f"Conversion {conversion.cost}: {_conversion_list(found)}"
    if conversion.cost and resolution.proven:
        is_met = conversion.bound == conversion.cost
        text += f"; {'no specification of as few nodes needs less' if is_met else searched}"
    yield f"{text}."
    text = f"Relationships {relationships.cost}: {_relationships(found)}"
    if resolution.proven and relationships.bound != relationships.cost:
        text += f"; {searched}"
    yield f"{text}."
    if not resolution.proven:
        yield "The time limit ended the proof that nothing costs less."
    elif resolution.count is None:
        yield "Other specifications that cost the same were not counted."
    elif resolution.count == 1:
        yield "No other specification costs the same."
    else:
        others = resolution.count - 1
        yield f"{counted(others, 'other specification')} cost{'s' * (others == 1)} the same."


def _conversion_list(found: Alternatives) -> str:
    if not found.conversions:
        nodes = found.synthesis.specification.nodes
        is_abstract = any(node.kind == "data_transformer" for node in nodes)
        return "no declared converter is applied" if is_abstract else "nothing is converted"
    nodes = found.synthesis.specification.nodes
    applied = sum(bool(node.conversion and node.conversion.converter) for node in nodes)
    more = applied - len(found.conversions)
    is_cut = len(found.conversions) == MOST_CONVERSIONS and more > 0
    result = (each.replace("`", "") for each in found.conversions)
    return ", ".join([*result, *([f"and {more} more"] if is_cut else [])])


def _relationships(found: Alternatives) -> str:
    """Return how the number of relationships is composed, in numbers that add up."""
    specification, declared = found.synthesis.specification, found.declared
    nodes = specification.nodes
    lines = [r for r in specification.configuration.relationships if isinstance(r, Connection)]
    stand_ins = {node.name for node in nodes if node.stands_for is not None}
    outputs = sum(isinstance(line, Control) and line.controller in stand_ins for line in lines)
    fanned = outputs - len(stand_ins)
    kinds = ((node.name, specification.configuration.pack_kind(node.name)) for node in nodes)
    listeners = {name for name, kind in kinds if kind is not None and kind.outputs == "none"}
    taken = (ends_of(r)[0] for r in lines)
    heard = sum(name in listeners for name in taken) - len(listeners)
    shared = declared + len(nodes) + fanned + heard - len(lines)
    if not declared:
        return "no data and no control is declared"
    first = f"the {declared} declared" if declared > 1 else "the one declared"
    repeated = found.written - declared
    texts = [f"{first} ({repeated} repeated aside)" if repeated else first]
    if nodes:
        texts.append("one more for each node" if len(nodes) > 1 else "one more for the node")
    if fanned:
        texts.append(f"{fanned} more from InheritanceNodes to further modules")
    if heard:
        texts.append(f"{heard} more to nodes that listen in several places")
    if shared < 0:
        texts.append(f"{-shared} more for what is commanded in two parts")
    if shared > 0:
        texts.append(f"{shared} fewer, because nodes share lines")
    if len(texts) == 1:
        return texts[0]
    return f"{', '.join(texts[:-1])}, and {texts[-1]}"


def _example(found: Alternatives, arguments: argparse.Namespace, width: int) -> Iterator[str]:
    """Yield a `verify --without` command that shows a certificate entry, and its clause."""
    for need in found.needs[:_MOST_NEEDS]:
        for reason in need.reasons:
            if reason.why is not None and reason.lines and need.names:
                path = found.analysis.configuration.path
                shown_command = command_on_one("verify", arguments, "--without", need.names[0])
                if shown_command is None:
                    return
                shown_command = f"See it break: {shown_command}"
                text = f"->  clause {reason.clause} at {places(reason.lines, path)}"
                # A command is not broken.
                if cells(shown_command) + len(_GAP) + cells(text) <= width:
                    yield f"{shown_command}{_GAP}{text}"
                else:
                    yield shown_command
                    yield from wrapped(text, width, _GAP, _GAP * 3)
                return


def alternatives_json(found: Alternatives, subject: str | None = None) -> dict[str, object]:
    """Return alternatives with the keys of the contract."""
    names = {level: name for name, level in COSTS.items()}
    return {
        "subject": subject,
        "cost": {name: found.synthesis.cost(level) for name, level in COSTS.items()},
        "proven_minimal": found.synthesis.resolution.proven,
        "optimal_count": found.synthesis.resolution.count,
        "forced": list(found.forced),
        "needs": [_need_json(need) for need in found.needs],
        "bound": {names[level]: each.bound for level, each in found.levels.items()},
        "alternatives": [
            {"extra_cost": by_name(o.extra), "added": list(o.added), "removed": list(o.removed)}
            for o in found.others
        ],
        "complete": found.complete,
    }


def _need_json(need: CertificateEntry) -> dict[str, object]:
    first = need.reasons[0] if need.reasons else None
    known = first is not None and first.why is not None
    return {
        "nodes": [reason.what for reason in need.reasons] or list(need.names),
        "taken": list(need.names),
        "clause": first.clause if first is not None and known else None,
        "why": first.why if first is not None else None,
        "locations": [location_json(s) for s in (first.lines if first is not None else ())],
    }
