"""What a mutant is, and the file of those that are known to be equivalent."""

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from tests.support.documents import ROOT

#: What notices a mutant that takes more time or memory than it may.
RUNS_AWAY = "it runs away"
SURVIVORS = ROOT / "tests" / "mutants.toml"


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change of one statement; `before` and `after` are the statement, white space evened out.

    Attributes:
        path: the file, relative to the repository.
        line: where the statement begins, from 1.
        change: what was done, such as "drop `not p(X)`".
        place: where the statement stands in the list of those of the file.
    """

    path: str
    line: int
    change: str
    before: str
    after: str
    place: int

    @property
    def key(self) -> tuple[str, str, str]:
        """Return what identifies the mutant while its statement stays as it is."""
        return self.path, self.before, self.after

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.change}\n  - {self.before}\n  + {self.after}"


@dataclass(frozen=True, slots=True)
class Verdict:
    """What noticed a mutant; `None` where nothing did."""

    mutant: Mutant
    killer: str | None


@dataclass(frozen=True, slots=True)
class Survivor:
    """A mutant that no test can notice, and why."""

    path: str
    before: str
    after: str
    reason: str

    @property
    def key(self) -> tuple[str, str, str]:
        """Return what identifies the mutant."""
        return self.path, self.before, self.after


def drawn(mutants: Iterable[Mutant], number: int, seed: int) -> list[Mutant]:
    """Return so many mutants by chance, each of which stays drawn while others come and go."""
    return sorted(mutants, key=lambda m: sha256(f"{seed} {m.key}".encode()).digest())[:number]


def known_survivors(path: Path = SURVIVORS) -> tuple[Survivor, ...]:
    """Return the mutants that are known to be equivalent."""
    read = tomllib.loads(path.read_text(encoding="utf-8"))
    return tuple(
        Survivor(entry["file"], entry["before"], entry["after"], entry["reason"])
        for entry in read.get("survivor", ())
    )
