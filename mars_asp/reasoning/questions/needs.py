"""Why nodes are needed: what each is, the clause that it satisfies, and for which lines.

The sentences are those of `rules/account/needs.lp`.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from mars_asp.asp.fragments import fact_fragment
from mars_asp.asp.messages import RenderedMessage, rendered_messages, saying
from mars_asp.asp.rules.premises import fragment_of
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.grounding import Grounding
from mars_asp.asp.solve.term_ids import TermId, arguments, as_symbol, text
from mars_asp.diagnostic import Span
from mars_asp.output import counted
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.account import TermNames, names_of, reads, telling, true_atoms
from mars_asp.reasoning.session import Evidence
from mars_asp.reasoning.synthesis import IntroducedNode

#: A node, a component of its reason, a clause or cost, an order and a thing.
NEED = Signature("need", 5)
#: The nodes in question.
_QUERIED = Signature("queried_node", 1)
#: The name under which the messages of the rules are read.
_STAGE = "needs"
#: Limits of the number of names, and of the ranges of lines, in a sentence.
_MOST_NAMED, _MOST_STRETCHES = 2, 4


@dataclass(frozen=True, slots=True)
class NodeReason:
    """The description of a node, the clause that would fail without it, and lines.

    `why` is `None`, and there are no lines, if the specification does not have the node;
    `cost` is a sentence on the conversion of a transformer. `rules` are the ids of the rules
    that derive it.
    """

    what: str
    clause: int
    why: str | None
    lines: tuple[Span, ...]
    cost: str | None = None
    rules: tuple[str, ...] = ()


def reasons(
    project: Project, evidence: Evidence, nodes: Iterable[IntroducedNode], queried: Iterable[str]
) -> Mapping[str, NodeReason]:
    """Return why nodes are needed, by the texts of their terms, if a rule derives a reason.

    `nodes` are those of the specification, `queried` the terms of nodes that it has or may have.

    Raises:
        MarsError: clingo refuses a rule.
    """
    rules = telling(evidence.rulebook, lambda rule: NEED in rule.heads)
    speaking = [rule for rule in rules if NEED in rule.heads]
    names = names_of(project, evidence.facts, nodes)
    read = sorted(reads(rules) - {_QUERIED})
    grounding = Grounding((), true_atoms(evidence, read))
    facts = fact_fragment("".join(f"queried_node({term}).\n" for term in queried), {_QUERIED.name})
    grounding.derive([facts, *map(fragment_of, rules), *saying(_STAGE, speaking)])
    found: dict[str, dict[str, list[RenderedMessage]]] = {}
    for each in rendered_messages(grounding.control, _STAGE, speaking):
        node, part, _, _, _ = arguments(each.head)
        found.setdefault(text(node), {}).setdefault(text(part), []).append(each)
    return {node: _reason(parts, names) for node, parts in found.items() if "what" in parts}


def _reason(parts: Mapping[str, Sequence[RenderedMessage]], names: TermNames) -> NodeReason:
    lines: dict[Span, dict[str, None]] = {}
    ordered = sorted(parts.get("lines", ()), key=lambda each: _order(each, names))
    for each in ordered:
        span = names.place(arguments(each.head)[4])
        lines.setdefault(span, {})[each.filled(each.rule.because, names.written) or ""] = None
    whats, whys, costs = (parts.get(part, ()) for part in ("what", "why", "cost"))

    def text_of(each: RenderedMessage) -> str:
        return each.filled(each.rule.because, lambda term: _term_text(term, names, lines)) or ""

    first = min(whats, key=lambda each: each.number)
    why = min(whys, key=lambda each: each.number) if whys else None
    clause = as_symbol(arguments((first if why is None else why).head)[2]).number
    return NodeReason(
        text_of(first),
        clause,
        None if why is None else text_of(why),
        tuple(sorted(lines)) if why is not None else (),
        text_of(costs[0]) if costs else None,
        tuple(dict.fromkeys(each.rule.id for part in parts.values() for each in part)),
    )


def _order(each: RenderedMessage, names: TermNames) -> tuple[object, ...]:
    *_, order, thing = arguments(each.head)
    return names.order(order), names.place(thing), each.number


def _term_text(term: TermId, names: TermNames, lines: Mapping[Span, Iterable[str]]) -> str:
    """Return a term in a sentence; `members(W)` are the modules on `lines`, by their locations."""
    symbol = as_symbol(term)
    if not symbol.match("members", 1):
        return names.written(term)
    spans_of: dict[str, list[Span]] = {}
    for span, labels in lines.items():
        for label in labels:
            spans_of.setdefault(label, []).append(span)
    path = names.configuration.path
    if len(spans_of) == 1 < len(lines):
        return f"{next(iter(spans_of))} over {len(lines)} lines ({places(lines, path)})"
    if len(spans_of) <= _MOST_NAMED:
        texts = [f"{label} ({places(spans, path)})" for label, spans in spans_of.items()]
        return " and ".join(texts)
    return f"{len(spans_of)} {symbol.arguments[0].string} ({places(lines, path)})"


def places(spans: Iterable[Span], path: str) -> str:
    """Return line numbers as `:3, :5-7`, with their files unless all are in `path`."""
    numbers = sorted({span[:2] for span in spans})
    stretches: list[tuple[str, int, int]] = []
    for file, line in numbers:
        if stretches and stretches[-1][0] == file and stretches[-1][2] == line - 1:
            stretches[-1] = (file, stretches[-1][1], line)
        else:
            stretches.append((file, line, line))
    entries = []
    alone = all(file == path for file, _, _ in stretches)
    for file, first, last in stretches[:_MOST_STRETCHES]:
        before = f"{'' if alone else file}:"
        far = f"-{last}" if last > first + 1 else f", {before}{last}" if last > first else ""
        entries.append(f"{before}{first}{far}")
    more = sum(last - first + 1 for _, first, last in stretches[_MOST_STRETCHES:])
    rest = f" and {counted(more, 'more line')}" if more else ""
    return f"{', '.join(entries)}{rest}"
