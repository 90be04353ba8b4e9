"""The `[[links]]` of a scenario: faults of links, and those of links that do not exist."""

from collections import defaultdict
from collections.abc import Iterator
from math import inf

from mars_asp.diagnostic import Diagnostic
from mars_asp.execution.executor.channel import LinkFault
from mars_asp.execution.executor.plan import Plan
from mars_asp.execution.executor.schedule import MILLISECOND, SECOND
from mars_asp.execution.scenario.read import Scenario
from mars_asp.spelling import suggestion


def link_faults(scenario: Scenario) -> tuple[LinkFault, ...]:
    """Return the faults of links."""
    return tuple(
        LinkFault(
            table["from"],
            table["to"],
            float(table.get("loss", 0.0)),
            round(table.get("delay", 0) * MILLISECOND),
            round(table.get("jitter", 0) * 1000),
            round(table.get("since", 0) * SECOND),
            table["until"] * SECOND if "until" in table else inf,
        )
        for table in scenario.links
    )


def absent_links(plan: Plan, scenario: Scenario) -> Iterator[Diagnostic]:
    """Yield an error for each entry whose link is not in the specification."""
    clients = defaultdict[str, dict[str, None]](dict)
    for link in plan.links:
        clients[link.source][link.client] = None
    for number, table in enumerate(scenario.links):
        source, client = table["from"], table["to"]
        if client in clients.get(source, ()):
            continue
        key, word, known = ("to", client, clients[source]) if source in clients else (
            "from", source, clients
        )  # fmt: skip
        message = f"there is no link `{source} -> {client}`"
        help_text = suggestion(word, known, f"one of {', '.join(sorted(known))}")
        place = scenario.places[f"links.{number}.{key}"]
        yield Diagnostic("scenario", "error", message, place, (), help_text if known else None)
