"""Show why each consequence and node is there, down to lines of rules and configuration."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import chain
from typing import TYPE_CHECKING

from mars_asp.asp.trace.absence_text import is_unspoken
from mars_asp.asp.trace.text import DEPTH, WIDTH, trace_json, traces_text
from mars_asp.asp.trace.tree import Absent, Missing, Trace
from mars_asp.cli.account import account_lines
from mars_asp.cli.encode import encoded
from mars_asp.cli.lines import line_at
from mars_asp.cli.reason import add_file, read_project, rulebook_for
from mars_asp.cli.report import colours, paint
from mars_asp.output import visible
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.explain import Explanation, Topic, explain
from mars_asp.reasoning.rules import NODES, by_name
from mars_asp.reasoning.session import Reasoner

if TYPE_CHECKING:
    from mars_asp.reasoning.questions.why_not import WhyNot

MOST_ALTERNATIVES = 1000
#: Deep enough to say which premise fails; why that one does is the next question.
ABSENCE_DEPTH = 1
#: So deep is an absence followed at most, one grounding for each level.
_MOST_LEVELS = 60
#: Of what stands against every specification so many are shown.
_MOST_OBSTACLES = 3


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the verb."""
    add_file(parser)
    parser.add_argument(
        "subject", nargs="?", metavar="SUBJECT", help="a module, node, consequence kind or atom"
    )
    question = parser.add_mutually_exclusive_group()
    question.add_argument(
        "--all",
        dest="every",
        action="store_true",
        help="every derivation of each step, not only the shortest, each numbered `1 of 2`",
    )
    question.add_argument(
        "--repair", action="store_true", help="the smallest edits that remove each error"
    )
    question.add_argument(
        "--alternatives",
        nargs="?",
        const=5,
        type=_count,
        metavar="N",
        help="other realisations, in the order of their cost (default 5), and why none costs less",
    )
    question.add_argument(
        "--why-not", metavar="ATOM", help="which rules could give ATOM, and what each lacks"
    )
    parser.add_argument(
        "--only",
        choices=("consequences", "nodes"),
        help="these alone of everything or of a module; for consequences nothing is resolved",
    )
    parser.add_argument("--about", metavar="NAME", help="the same as SUBJECT")
    parser.add_argument(
        "--depth",
        metavar="N|all",
        default=argparse.SUPPRESS,
        type=_depth,
        help=f"how deep (default {DEPTH}, of what is absent {ABSENCE_DEPTH})",
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the traces; 3 where no time was left."""
    contradiction = _contradiction(arguments)
    if contradiction is not None:
        print(f"mars-asp explain: {contradiction}", file=sys.stderr)
        return 2
    project = read_project(arguments)
    subject = arguments.about if arguments.subject is None else arguments.subject
    if arguments.why_not is not None:
        return _why_not(project, arguments)
    if arguments.alternatives is not None:
        from mars_asp.cli.alternatives import run_alternatives

        return run_alternatives(project, arguments, subject)
    if arguments.repair:
        from mars_asp.cli.repair import run_repair

        return run_repair(project, arguments, subject)
    rulebook = rulebook_for(arguments, ("resolve", "account"))
    reasoner = Reasoner(project, rulebook, Budget(arguments.time_limit))
    traced = arguments.format == "json" or arguments.every or hasattr(arguments, "depth")
    answer = explain(reasoner, subject, arguments.every, arguments.only, traced)
    del reasoner
    topics, status = answer.topics, int(answer.analysis.has_errors)
    closing = () if arguments.quiet else tuple(_closing(answer, arguments))
    # The traces stand without what was grounded, which takes as much memory.
    del answer
    if arguments.format == "json":
        traces = [{"title": t.title, **trace_json(t.trace)} for t in topics if t.trace is not None]
        print(encoded({"subject": subject, "traces": traces}))
    else:
        lines = chain(_told(topics, traced, arguments), closing)
        sys.stdout.writelines(f"{line}\n" for line in lines)
    return status


def _contradiction(arguments: argparse.Namespace) -> str | None:
    """Return what arguments leave open or would be ignored."""
    has_subject = arguments.subject is not None
    if has_subject and arguments.about is not None:
        return "SUBJECT and --about say the same: give one of them"
    if arguments.why_not is not None and (has_subject or arguments.about is not None):
        subject = "SUBJECT" if has_subject else "--about"
        return f"--why-not asks about its ATOM alone: leave out {subject}, or --why-not"
    if arguments.why_not is not None and arguments.only is not None:
        return "--why-not asks about its ATOM alone: leave out --only, or --why-not"
    for option in ("repair", "alternatives"):
        if getattr(arguments, option) and arguments.only is not None:
            return f"--{option} prints no trace, so --only says nothing: leave it out"
        if getattr(arguments, option) and hasattr(arguments, "depth"):
            return f"--{option} prints no trace, so --depth says nothing: leave it out"
    return None


def _why_not(project: Project, arguments: argparse.Namespace) -> int:
    from mars_asp.reasoning.questions.why_not import why_not

    depth = getattr(arguments, "depth", ABSENCE_DEPTH)
    levels = _MOST_LEVELS if depth is None else 2 * depth
    reasoner = Reasoner(project, rulebook_for(arguments), Budget(arguments.time_limit))
    answer = why_not(reasoner, arguments.why_not, levels)
    if arguments.format == "json":
        trace = trace_json(answer.trace)
        extra = None if answer.extra is None else by_name(answer.extra)
        found = {"subject": answer.subject, "present": answer.present, "offered": answer.offered}
        obstacles = [trace_json(obstacle) for obstacle in answer.obstacles]
        found |= {"extra_cost": extra, "obstacles": obstacles, "traces": [trace]}
        print(encoded(found))
        return int(answer.analysis.has_errors)
    if answer.obstacles:
        for line in _obstacles(answer, depth, arguments):
            print(line)
        return int(answer.analysis.has_errors)
    title = f"{answer.subject}: yes, it holds" if answer.present else f"no {answer.subject}"
    if isinstance(answer.trace, Absent):
        print(f"{visible(title)}: no line says so, and no rule could give it")
    else:
        for line in _lines([(title, answer.trace)], depth, arguments):
            print(line)
    if not answer.present and answer.choosable and not arguments.quiet:
        print(_price(answer))
    if _goes_on(answer.trace) and depth == ABSENCE_DEPTH and not arguments.quiet:
        print(f"`--depth {depth + 1}` goes on to why")
    return int(answer.analysis.has_errors)


def _obstacles(answer: "WhyNot", depth: int | None, arguments: argparse.Namespace) -> Iterator[str]:
    """Yield why nothing realises the configuration, so that nothing of the kind is there."""
    title = f"no {answer.subject}: no specification realises this configuration"
    shown = answer.obstacles[:_MOST_OBSTACLES]
    titles = [title, *["and for another reason"] * len(shown[1:])]
    topics = list(zip(titles, shown, strict=True))
    yield from _lines(topics, depth, arguments)
    left = len(answer.obstacles) - len(shown)
    if left:
        yield f"and {left} more: see `mars-asp check`"
    if not arguments.quiet:
        yield "`mars-asp explain FILE --repair` looks for what would mend it"


def _goes_on(trace: Trace) -> bool:
    """Say whether what fails is itself absent by rules, which are not shown yet."""
    attempts = trace.attempts if isinstance(trace, Missing) else ()
    causes = (attempt.cause for attempt in attempts)
    return any(isinstance(c, Missing) and c.attempts and not is_unspoken(c) for c in causes)


def _price(answer: "WhyNot") -> str:
    if answer.extra is None:
        return "no realisation has it"
    more = [f"{count:+} {name}" for name, count in by_name(answer.extra).items() if count]
    price = f"costs {', '.join(more)}" if more else "costs no more, and is not taken for taste"
    return f"the cheapest realisation that has `{answer.offered}` {price}"


def _count(text: str) -> int:
    if text.isdigit() and 0 < int(text) <= MOST_ALTERNATIVES:
        return int(text)
    raise argparse.ArgumentTypeError(f"`{text}` is no number from 1 to {MOST_ALTERNATIVES}")


def _depth(text: str) -> int | None:
    if text == "all":
        return None
    if text.isdigit() and 0 < int(text) < 10**6:
        return int(text)
    raise argparse.ArgumentTypeError(f"`{text}` is no depth: write a number from 1, or `all`")


def _closing(answer: Explanation, arguments: argparse.Namespace) -> Iterator[str]:
    """Yield what is said below the traces."""
    if arguments.only == "nodes" and answer.synthesis is None:
        yield "no specification realises this configuration, so there is no node to explain"
    elif not answer.topics and arguments.only != "nodes":
        yield "nothing to resolve, so nothing to explain"
    if answer.synthesis is not None and answer.subject is None:
        yield _summary(answer)
    elif answer.subject is None and arguments.only is None:
        yield "no specification realises this configuration: `mars-asp check` says why not"


def _told(topics: Sequence[Topic], traced: bool, arguments: argparse.Namespace) -> Iterator[str]:
    """Yield the lines of topics: accounts, or traces where these are wanted or all there is."""
    coloured = colours(arguments, sys.stdout)
    if traced or any(topic.account is None for topic in topics):
        told = [(topic.title, topic.trace) for topic in topics]
        yield from _lines(told, getattr(arguments, "depth", DEPTH), arguments)
        return
    for topic in topics:
        if topic.account is not None:
            yield ""
            first, *others = account_lines(topic, topic.account, WIDTH)
            yield paint(first, "strong", coloured)
            yield from others
    yield ""


def _lines(
    topics: Sequence[tuple[str, Trace]], depth: int | None, arguments: argparse.Namespace
) -> Iterator[str]:
    coloured = colours(arguments, sys.stdout)
    for line in traces_text(topics, line_at, depth):
        title = not line.startswith(" ")
        if title:
            yield ""
        yield paint(visible(line), "strong", coloured) if title else visible(line)
    yield ""


def _summary(answer: Explanation) -> str:
    assert answer.synthesis is not None
    nodes = answer.synthesis.cost(NODES)
    resolution = answer.synthesis.resolution
    if not nodes:
        return "no node is needed"
    proof = "proven: no specification has fewer" if resolution.proven else "best found"
    count = resolution.count
    others = "" if count is None else f"; {count} such specification{'s' * (count != 1)}"
    return f"{nodes} node{'s' * (nodes > 1)}, {proof}{others}"
