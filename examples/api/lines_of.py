"""Print for each node of a specification the lines of the user's files that made it necessary.

    python lines_of.py CONFIG
"""

import sys
from collections.abc import Iterator

from mars_asp import (
    Derived,
    Given,
    MarsError,
    Reasoner,
    Span,
    Trace,
    explain,
    load_project,
    load_rulebook,
)


def places(trace: Trace) -> Iterator[Span]:
    """Yield where the given facts at the leaves of a trace were written."""
    waiting, seen = [trace], set()
    while waiting:
        step = waiting.pop()
        if isinstance(step, Given) and step.span is not None:
            yield step.span
        elif isinstance(step, Derived) and id(step) not in seen:
            seen.add(id(step))
            waiting.extend(step.premises)


def main(path: str) -> int:
    """Print the lines; return 2 where the configuration is wrong."""
    try:
        project = load_project(path)
        explanation = explain(Reasoner(project, load_rulebook()), only="nodes")
    except MarsError as error:
        for problem in error.diagnostics:
            print(f"{problem.span.path}:{problem.span.line}: {problem.message}", file=sys.stderr)
        return 2
    for topic in explanation.topics:
        print(topic.title.split()[0])
        for span in sorted(set(places(topic.trace))):
            print(f"    {span.path}:{span.line}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
