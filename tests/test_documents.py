"""Every command in the documentation prints what the documentation shows."""

from pathlib import Path

import pytest

from tests.documents import ROOT, commands, refresh, run

DOCUMENTS = [
    ROOT / "README.md",
    *sorted(ROOT.glob("docs/*.md")),
    *sorted(ROOT.glob("examples/*/README.md")),
]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_commands_print_what_is_shown(document: Path, update_golden: bool) -> None:
    if update_golden:
        refresh(document)
    for command, shown in commands(document):
        assert run(command) == shown, command


@pytest.mark.parametrize("folder", sorted(ROOT.glob("examples/*/")), ids=lambda path: path.name)
def test_every_example_shows_a_command(folder: Path) -> None:
    assert list(commands(folder / "README.md"))
