"""The file of the mutants that are known to be equivalent."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

from tests.support.documents import ROOT

SURVIVORS = ROOT / "tests" / "mutants.toml"


@dataclass(frozen=True, slots=True)
class Survivor:
    """A mutant that no test can notice, and why."""

    path: str
    before: str
    after: str
    reason: str

    @property
    def key(self) -> tuple[str, str, str]:
        """Return the path and both texts, which identify the mutant."""
        return self.path, self.before, self.after


def known_survivors(path: Path = SURVIVORS) -> tuple[Survivor, ...]:
    """Return the mutants that are known to be equivalent."""
    read = tomllib.loads(path.read_text(encoding="utf-8"))
    return tuple(
        Survivor(entry["file"], entry["before"], entry["after"], entry["reason"])
        for entry in read.get("survivor", ())
    )
