"""What `explain --alternatives` prints: why nothing costs less, and what costs as much or more."""

import argparse
import sys
from collections.abc import Iterator

from mars_asp.asp.trace.text import wrapped
from mars_asp.cli.encode import encoded
from mars_asp.cli.reason import rulebook_for
from mars_asp.output import visible
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.questions.alternatives import Alternative, Alternatives, alternatives
from mars_asp.reasoning.rules import COSTS, by_name
from mars_asp.reasoning.session import Reasoner


def run_alternatives(project: Project, arguments: argparse.Namespace, subject: str | None) -> int:
    """Print alternatives; 1 where nothing realises the configuration, 3 where no time was left."""
    most: int = arguments.alternatives
    found = alternatives(
        Reasoner(project, rulebook_for(arguments), Budget(arguments.time_limit)), subject, most
    )
    if found is None:
        print("mars-asp: nothing realises this configuration; see `check`", file=sys.stderr)
        return 1
    if arguments.format == "json":
        print(encoded({"subject": subject, **_json(found)}))
    else:
        for line in _text(found):
            print(visible(line))
    return int(found.analysis.has_errors)


def _text(found: Alternatives) -> Iterator[str]:
    cost = ", ".join(f"{name} {found.synthesis.cost(level)}" for name, level in COSTS.items())
    resolution = found.synthesis.resolution
    state = "proven least" if resolution.proven else "best found"
    count = resolution.count
    many = "" if count is None else f"; {count} specification{'s' * (count != 1)} of that cost"
    yield from wrapped(f"cost: {cost}; {state}{many}", 0)
    if found.forced:
        yield from wrapped(f"every realisation has {', '.join(found.forced)}", 0)
    for need in found.needs:
        ours = f"  ({', '.join(need.names)})" if need.names else ""
        which = "at least one of these" if len(need.words) > 1 else "this"
        yield f"every realisation has {which}{ours}"
        for words in need.words:
            yield from wrapped(words, 1)
    if found.open > len(found.needs):
        yield from wrapped(
            f"{found.open} nodes are taken where {len(found.needs)} needs without a node in common "
            "ask for: that fewer do not suffice was found by search",
            0,
        )
    for number, other in enumerate(found.others, 1):
        yield ""
        yield f"{number}. {_price(other)}"
        yield from (f"     - {line}" for line in other.removed)
        yield from (f"     + {line}" for line in other.added)
    if found.others:
        yield ""
    yield "no other realisation, but for additions" if found.complete else "there are more"


def _price(other: Alternative) -> str:
    more = [f"{other.extra.get(level, 0):+} {name}" for name, level in COSTS.items()]
    changed = [text for text in more if not text.startswith("+0")]
    return f"costs {', '.join(changed)}" if changed else "costs the same"


def _json(found: Alternatives) -> dict[str, object]:
    return {
        "cost": {name: found.synthesis.cost(level) for name, level in COSTS.items()},
        "proven_minimal": found.synthesis.resolution.proven,
        "optimal_count": found.synthesis.resolution.count,
        "forced": list(found.forced),
        "needs": [{"nodes": list(n.words), "taken": list(n.names)} for n in found.needs],
        "alternatives": [
            {"extra_cost": by_name(o.extra), "added": list(o.added), "removed": list(o.removed)}
            for o in found.others
        ],
        "complete": found.complete,
    }
