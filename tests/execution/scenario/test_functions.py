"""Python functions that a scenario names: how they are found, and that each run has its own."""

from pathlib import Path

import pytest

from mars_asp.diagnostic import MarsError
from tests.support.trials import BASE, trial


def test_module_state_does_not_leak_from_one_run_into_the_next(tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(
        "count = [0]\ndef go():\n    count[0] += 1\n    return 'Trans_Z', count[0]\n"
    )
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    driven = {trial(text, folder=tmp_path).bodies[0].driven for _ in range(2)}
    assert len(driven) == 1


@pytest.mark.parametrize(
    ("body", "failed"), [("def go():\n    exit(3)\n", 30), ("exit(3)\ndef go(): ...\n", None)]
)
def test_a_behaviour_cannot_end_the_program(body: str, failed: int | None, tmp_path: Path) -> None:
    (tmp_path / "b.py").write_text(body)
    text = BASE + '[bindings.C]\npython = "b.py:go"\nperiod = 100\n'
    if failed is None:
        with pytest.raises(MarsError, match="SystemExit: 3"):
            trial(text, folder=tmp_path)
    else:
        (link,) = trial(text, folder=tmp_path).executor.links
        assert abs(link.dropped["failed"] - failed) <= 1
        assert link.fault == "RuntimeError: it called `exit(3)`"


@pytest.mark.parametrize(
    ("binding", "place"),
    [
        ('[bindings.C]\nperiod = 9\npython = "b.py:go"\n', (6, 11)),
        ('[bindings]\nP = { period = 9 }\nC = { python = "b.py:go" }\n', (8, 1)),
        ('[bindings]\nC.python = "b.py:go"\n', (7, 1)),
        ('[devices.P]\nkind = "platform"\n[bindings."C"]\npython = "b.py:go"\n', (8, 11)),
    ],
)
def test_a_binding_to_what_is_not_there_is_reported_at_its_line(
    binding: str, place: tuple[int, int], tmp_path: Path
) -> None:
    (tmp_path / "b.py").write_text("")
    text = f"seed = 0\n\n{BASE}{binding}"
    with pytest.raises(MarsError) as raised:
        trial(text, folder=tmp_path)
    found = raised.value.diagnostics[0]
    assert found.message.endswith("b.py` defines no function `go`")
    assert (found.span.line, found.span.column) == place
