"""Introduced nodes are transparent: a specification delivers the messages of ideal wires."""

from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from mars_asp.execution.executor import Behaviour, Executor
from mars_asp.execution.executor.schedule import SECOND
from mars_asp.language import parse_text
from mars_asp.model.declarations import Configuration, Module
from mars_asp.reasoning.analysis import analyse
from mars_asp.reasoning.facts.compile import configuration_facts
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.reasoning.synthesis.synthesise import synthesise
from tests.support.execute_builders import counter, data_out, sensor, sink

RULEBOOK = load_rulebook()
REQUESTED = [
    "",
    "NotifyAtFrequency 37",
    "NotifyAtFrequency 10",
    "NotifyOnChange(2)",
    "RequestWhenReady",
]


def deliveries(
    configuration: Configuration, modules: dict[str, Module]
) -> dict[str, list[tuple[int, Any]]]:
    """Run for a second; return the messages of each client, with times."""
    got: dict[str, list[tuple[int, Any]]] = {}
    running: list[Executor] = []

    def receiver(name: str) -> Behaviour:
        def call(value: Any) -> Any:
            got.setdefault(name, []).append((running[0].schedule.now, value))
            return value

        return Behaviour(call)

    behaviours = {name: Behaviour(counter()) if name == "S" else receiver(name) for name in modules}
    running.append(Executor(configuration, modules, behaviours))
    running[0].step_until(SECOND)
    return got


@given(
    st.lists(st.sampled_from(REQUESTED), min_size=1, max_size=5),
    st.lists(st.sampled_from(REQUESTED[:4]), max_size=3),
)
@settings(max_examples=15, deadline=None)
def test_a_specification_delivers_as_its_relationships_do(
    first: list[str], second: list[str]
) -> None:
    modules = {"S": sensor("S", "NotifyAtFrequency", 100)}
    lines = []
    for k, requested in enumerate(first):
        name = f"C{k}"
        # A client that requests needs a clock of its own.
        clocked = requested == "RequestWhenReady"
        modules[name] = data_out(name, "NotifyAtFrequency", 20) if clocked else sink(name)
        lines.append(f"{name} uses_data_from S {requested}")
    modules["M"] = data_out("M")
    lines.append("M uses_data_from S NotifyAtFrequency 50")
    for k, requested in enumerate(second):
        modules[f"D{k}"] = sink(f"D{k}")
        lines.append(f"D{k} uses_data_from M {requested if 'Frequency' not in requested else ''}")
    text = "\n".join(["@configuration", "@modules " + ", ".join(modules), *lines])
    configuration = parse_text(text, "x.mars").configuration
    facts = configuration_facts(configuration, modules)
    analysis = analyse(facts, RULEBOOK, configuration.span)
    found = synthesise(Project(configuration, modules, ()), analysis, RULEBOOK)
    assert found is not None
    specified = deliveries(found.specification.configuration, modules)
    assert specified == deliveries(configuration, modules)
    assert set(specified) >= {"M", "C0"}
