"""Sample robots that together have facts of nearly every predicate, to try rule packs on.

Their facts are made when the package is built: to read the robots takes as long as to read a pack.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

from mars_asp.asp.cache import memoized
from mars_asp.asp.solve.atoms import Fact
from mars_asp.diagnostic import Span
from mars_asp.model.declarations import MissingFile, Muxed
from mars_asp.reasoning.project import Project, load_project, project_facts


def samples() -> tuple[Project, ...]:
    """Return the sample robots as projects."""
    ranked, flat, ports, gates = (
        load_project(
            f"{name}.mars",
            text=Path(__file__).with_name(f"sample_{name}.mars").read_text(encoding="utf-8"),
        )
        for name in ("ranked", "flat", "ports", "gates")
    )
    # Only foreign files have muxes, missing files and nodes that were not read.
    mux = Muxed("Platform", "twist_mux", ranked.configuration.span)
    node = ranked.configuration.modules[0]
    read = replace(ranked.configuration, muxes=(mux,), opaque=(node,), format="twist_mux")
    missing = MissingFile(node.text, "path", "./camera.py", node.span, builds=True)
    read = replace(read, origin="twist_mux", missing=(missing,))
    muxed = replace(ranked, configuration=read)
    return muxed, flat, ports, gates


def sampled() -> Iterator[tuple[tuple[Fact, ...], Span]]:
    """Yield the facts of each robot with the location of its configuration."""
    for number in range(_COUNT):
        yield memoized("samples", _makers(), [number], _sampled)[number]


#: How many robots there are.
_COUNT = 4


def _sampled(number: int) -> tuple[tuple[Fact, ...], Span]:
    project = samples()[number]
    return project_facts(project), project.configuration.span


@cache
def _makers() -> tuple[Path, ...]:
    """Return the source files that determine the facts of the samples."""
    package = Path(__file__).parents[1]
    folders = ("annotations", "kinematics", "language", "model", "reasoning/facts")
    found = [path for folder in folders for path in (package / folder).rglob("*.py")]
    return tuple(sorted((*found, *Path(__file__).parent.glob("*.*"))))
