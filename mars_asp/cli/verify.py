"""Judge whether a specification realises a configuration, and whether it is minimal.

With `--without`, the minimal specification of CONFIG is judged without one of its nodes.
"""

import argparse
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.arguments import misuse
from mars_asp.cli.diagnostic_text import report, report_unrealisable
from mars_asp.cli.encode import print_result
from mars_asp.cli.inputs import (
    analyse_project,
    beside,
    check_inputs,
    read_project,
    read_specification,
    rulebook_for,
)
from mars_asp.cli.lines import located_lines, location_json, rule_location_json
from mars_asp.cli.progress import progress_bar
from mars_asp.cli.wrapping import columns, wrapped
from mars_asp.diagnostic import Diagnostic, Span, whole_file
from mars_asp.model.declarations import NODE_NAMES, Configuration, Module
from mars_asp.output import visible
from mars_asp.reasoning.analysis import findings
from mars_asp.reasoning.budget import Budget
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import by_name
from mars_asp.reasoning.session import Reasoner
from mars_asp.reasoning.synthesis.synthesise import synthesise
from mars_asp.reasoning.verification import (
    Caution,
    Verification,
    Violation,
    judge_specification,
    written_cost,
)

if TYPE_CHECKING:
    from mars_asp.reasoning.questions.without import ViolatedClause

#: The text shows at most so many lines of a violation; JSON has all.
_MOST_LINES = 10
_BELOW = "      "


@dataclass(frozen=True, slots=True)
class SpecificationComparison:
    """The cost of a specification and the minimal cost, by name; None if the time limit ended it.

    `fault` reports a contradiction: a specification that costs less than the minimal one. Packs
    cause it (`of_packs`) if they introduce nodes that none of their rules requires. `errors` are
    those of the configuration, which every specification has as well.
    """

    cost: Mapping[str, int] | None
    least: Mapping[str, int] | None
    minimal: bool | None
    in_time: bool
    fault: str | None = None
    of_packs: bool = False
    errors: tuple[Diagnostic, ...] = ()


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("specification", metavar="SPEC", nargs="?")
    parser.add_argument("file", metavar="CONFIG")
    parser.add_argument("--without", metavar="NODE")


def run(arguments: argparse.Namespace) -> int:
    """Print the violations; return 1 if there are any, 3 if time was too short to compare costs.

    A specification that costs less than the minimal one is a fault of this tool or of packs: 1.
    """
    if arguments.without is not None:
        return _run_without(arguments)
    modules: Mapping[str, Module] = {}
    if arguments.specification is None:
        project = read_project(arguments, arguments.file)
        if project.format is None:
            alone = "only files of other formats are judged alone"
            return misuse(
                "verify", f"SPEC and CONFIG are needed, or --without NODE CONFIG; {alone}"
            )
        from mars_asp.exchange.lift import has_glue, lifted

        if not has_glue(project.configuration):
            message = "no mux or relay was read, so nothing adds to what the nodes publish"
            help_text = "`mars-asp check` judges nodes that publish commands on one topic"
            place = whole_file(project.configuration.path)
            report([Diagnostic("launch", "note", message, place, help=help_text)], arguments)
        # The wiring of foreign files is judged against the configuration that it realises.
        specification = lifted(project.configuration)
    else:
        paths = arguments.specification, arguments.file
        check_inputs(*paths)
        read = read_specification(beside(arguments, *paths), arguments.specification)
        specification, modules = read.configuration, read.modules
        project = read_project(beside(arguments, *paths[::-1]), arguments.file)
        # SPEC mostly repeats blocks of CONFIG, which also describes the other modules.
        known = {(each.code, each.message) for each in project.diagnostics}
        own = (each for each in read.diagnostics if each.code != "annotations-missing")
        report((each for each in own if (each.code, each.message) not in known), arguments)
    if (specification.kind, project.configuration.kind) == ("configuration", "specification"):
        return misuse("verify", "SPEC comes first, then its CONFIG")
    verification, compared = judge_wiring(specification, modules, project, arguments)
    violations = verification.violations
    report(compared.errors, arguments)
    print_result(
        arguments,
        lambda: verification_json(verification, compared),
        verification_lines(verification, compared, columns(sys.stdout)),
    )
    if not compared.in_time:
        print("mars-asp: the time limit ended the proof of what is minimal", file=sys.stderr)
        return 3
    if compared.fault is not None:
        cause = "a fault of rule packs" if compared.of_packs else "internal error, please report it"
        print(f"mars-asp: {cause}: {compared.fault}", file=sys.stderr)
    return int(bool(violations) or compared.fault is not None)


def judge_wiring(
    specification: Configuration,
    modules: Mapping[str, Module],
    project: Project,
    arguments: argparse.Namespace,
) -> tuple[Verification, SpecificationComparison]:
    """Return the violations of a specification; without any, also its cost and the minimal cost.

    `modules` are described by the sources of the specification.

    Raises:
        MarsError: rule packs are wrong, or clingo refuses rules.
    """
    rulebook = rulebook_for(arguments, ("resolve", "verify", "cost"))
    verification = judge_specification(
        specification, project, rulebook, modules=modules, cited=True
    )
    if verification.violations:
        return verification, SpecificationComparison(None, None, None, in_time=True)
    return verification, _compare(arguments, verification, project, rulebook)


def verification_json(
    verification: Verification, compared: SpecificationComparison
) -> dict[str, object]:
    """Return a verification with the keys of the contract."""
    return {
        "realises": not verification.violations,
        "minimal": compared.minimal,
        "violations": [_violation_json(each, each.locations) for each in verification.violations],
        "warnings": [_finding_json(caution) for caution in verification.cautions],
        "cost": compared.cost,
        "least": compared.least,
        **({} if compared.fault is None else {"fault": compared.fault}),
    }


def verification_lines(
    verification: Verification, compared: SpecificationComparison, width: int
) -> Iterator[str]:
    """Yield the lines about violations and warnings, or the line that there are no violations."""
    for violation in verification.violations:
        yield from _finding_text(f"clause {violation.clause}", violation, width)
        yield from located_lines(violation.locations, _BELOW, _MOST_LINES)
    for caution in verification.cautions:
        yield from _finding_text("warning", caution, width)
    if not verification.violations:
        text = f"the specification realises the configuration{_minimality(compared)}"
        yield from wrapped(text, width, "", "  ")


def _finding_text(head: str, found: Violation | Caution, width: int) -> Iterator[str]:
    result = visible(f"{head}: {found.message} [{found.rule.id}]")
    yield from wrapped(result, width, "", "  ")
    yield from wrapped(visible(found.help or ""), width, "    help: ", "          ")


def _run_without(arguments: argparse.Namespace) -> int:
    """Print the violations without a node; return 1 if there are any."""
    if arguments.specification is not None:
        return misuse("verify", "--without NODE judges CONFIG alone: leave out SPEC")
    from mars_asp.exchange.lift import realised_by
    from mars_asp.reasoning.questions.without import without

    project = read_project(arguments, arguments.file)
    rulebook = rulebook_for(arguments, ("resolve", "verify"))
    name = arguments.without
    reasoner = Reasoner(project, rulebook, Budget(arguments.time_limit))
    synthesis = reasoner.synthesis
    muxes = {} if synthesis is None else realised_by(synthesis.specification.configuration)
    # A mux of the user has a name of its own, and is a node of the specification.
    node = next((node for node, mux in muxes.items() if mux == name), name)
    found = without(node, reasoner)
    if found is None:
        report_unrealisable(project.configuration.path, reasoner.analysis, arguments)
        return 1
    violations = [
        _violation_json(each.violation, (line.span for line in each.relationships))
        for each in found
    ]
    document = {"realises": not found, "minimal": None, "violations": violations, "warnings": []}
    lines = _without_text(name, found, columns(sys.stdout))
    print_result(arguments, lambda: {**document, "without": name}, lines)
    return int(bool(found))


def _without_text(name: str, found: Sequence["ViolatedClause"], width: int) -> Iterator[str]:
    """Yield the lines about violations without the node `name`, and their premises."""
    if not found:
        yield f"without {name} the specification still realises the configuration"
        return
    yield f"Without {name}:"
    for broken in found:
        violation = broken.violation
        text = f"clause {violation.clause}: {violation.message}  [{violation.rule.id}]"
        yield from wrapped(visible(text), width, "  ", "    ")
        spans = (each.span for each in broken.relationships)
        yield from located_lines(spans, _BELOW, _MOST_LINES)


def _compare(
    arguments: argparse.Namespace, verification: Verification, project: Project, rulebook: Rulebook
) -> SpecificationComparison:
    """Return the cost of a verified specification and the minimal cost, found by synthesis."""
    seconds = arguments.time_limit
    deadline = None if seconds is None else time.monotonic() + seconds
    try:
        written = written_cost(verification, project, rulebook, deadline)
        analysis = analyse_project(project, rulebook, arguments)
        with progress_bar(arguments, "components") as progress:
            best = synthesise(project, analysis, rulebook, Budget(seconds, progress))
    except TimeoutError:
        return SpecificationComparison(None, None, None, in_time=False)
    cost = by_name(written.cost)
    if best is None:
        return SpecificationComparison(cost, None, None, in_time=True)
    least = by_name(best.resolution.cost)
    proven = written.proven and best.resolution.proven
    # Dictionaries keep the order of the levels, in which costs are compared.
    bound = by_name(best.resolution.bound)
    if list(cost.values()) < list(bound.values()):
        fault = (
            f"the specification costs {_in_words(cost)}, less than the least, {_in_words(least)}"
        )
        brought = [n.name for n in best.specification.nodes if n.kind not in NODE_NAMES]
        if brought:
            fault += (
                f"; no rule in `verify` asks for nodes that packs introduce, such as {brought[0]}"
            )
        return SpecificationComparison(
            cost, least, None, in_time=True, fault=fault, of_packs=bool(brought)
        )
    more = list(cost.values()) > list(least.values())
    minimal = not more if proven else False if more and written.proven else None
    errors = tuple(each for each in findings(analysis) if each.severity == "error")
    in_time = minimal is not None
    return SpecificationComparison(cost, least, minimal, in_time, errors=errors)


def _minimality(compared: SpecificationComparison) -> str:
    if compared.minimal is None or compared.cost is None or compared.least is None:
        return ""
    if compared.minimal:
        return " and is minimal"
    differing = [
        f"{compared.cost[name]} {word} where {compared.least[name]} suffice"
        for name, word in (
            ("nodes", "nodes"),
            ("conversion", "of conversion cost"),
            ("relationships", "relationships"),
        )
        if compared.cost[name] > compared.least[name]
    ]
    return f" but is not minimal: {differing[0]}"


def _in_words(cost: Mapping[str, int]) -> str:
    return ", ".join(f"{name} {value}" for name, value in cost.items())


def _violation_json(violation: Violation, spans: Iterable[Span]) -> dict[str, object]:
    locations = [location_json(span) for span in spans]
    return {"clause": violation.clause, **_finding_json(violation), "locations": locations}


def _finding_json(found: Violation | Caution) -> dict[str, object]:
    return {
        "message": found.message,
        "help": found.help,
        "rule": rule_location_json(found.rule),
    }
