"""The errors that leave a configuration without a specification, and a sentence with them."""

from mars_asp.output import listing
from mars_asp.reasoning.analysis import Analysis, Consequence, read_consequences

#: So many errors are named; of more, the first, and how many others there are.
_MOST_NAMED = 3


def obstacles(analysis: Analysis) -> tuple[Consequence, ...]:
    """Return the errors that leave a configuration without a specification, by location."""
    prevented = {tuple(atom.arguments) for atom in analysis.grounding.symbols("prevents", 3)}
    return tuple(
        each
        for each in read_consequences(analysis, participants=False, notes=False)
        if (each.atom.arguments[0], *each.atom.arguments[2:]) in prevented
    )


def unrealised(analysis: Analysis, configuration: str = "this configuration") -> str:
    """Return the sentence that no specification realises a configuration, with the reasons."""
    found = obstacles(analysis)
    named = [
        f"`{each.kind}({each.subject})` ({each.spans[0].path}:{each.spans[0].line})"
        for each in found
    ]
    if len(named) > _MOST_NAMED:
        named = [*named[: _MOST_NAMED - 1], f"{len(named) - _MOST_NAMED + 1} more errors"]
    message = f"no specification realises {configuration}"
    if not named:
        return message
    return f"{message}: {listing(named)} prevent{'s' * (len(named) == 1)} it"
