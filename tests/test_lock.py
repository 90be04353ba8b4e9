"""The lock file has a version of each requirement of developers, within its bounds."""

import re
import tomllib
from collections.abc import Iterator
from typing import Any

import pytest
from packaging.markers import default_environment
from packaging.requirements import Requirement

from tests.support.documents import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
LOCK = (ROOT / "requirements-dev.txt").read_text(encoding="utf-8")
PYTHONS = ["3.11", "3.13", "3.14"]


def requirements() -> Iterator[Requirement]:
    """Yield the requirements of the package, of each extra and of the group `dev`."""
    project = PROJECT["project"]
    lists = [project["dependencies"], *project["optional-dependencies"].values()]
    yield from (Requirement(line) for lines in lists for line in lines)
    yield from group("dev")


def group(name: str) -> Iterator[Requirement]:
    entry: Any
    for entry in PROJECT["dependency-groups"][name]:
        if isinstance(entry, str):
            yield Requirement(entry)
        else:
            yield from group(entry["include-group"])


def locked(python: str) -> dict[str, str]:
    environment = {**default_environment(), "python_version": python, "python_full_version": python}
    found = (Requirement(line) for line in re.findall(r"(?m)^([a-z].*?) *\\$", LOCK))
    return {
        each.name: next(iter(each.specifier)).version
        for each in found
        if each.marker is None or each.marker.evaluate({k: str(v) for k, v in environment.items()})
    }


@pytest.mark.parametrize("python", PYTHONS)
def test_every_requirement_is_locked_within_its_bounds(python: str) -> None:
    versions = locked(python)
    wrong = [str(r) for r in requirements() if not r.specifier.contains(versions.get(r.name, ""))]
    assert wrong == [], "`make lock`"


def test_every_version_has_a_hash() -> None:
    entries = re.split(r"(?m)^(?=[a-z])", LOCK)
    assert all("--hash=sha256:" in entry for entry in entries if entry.strip())
