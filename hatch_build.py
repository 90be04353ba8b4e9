"""Makes the tables of the grammar and of the built-in rules, and the long description.

A wheel carries them; an editable installation has them beside the sources, where `python
hatch_build.py` makes them anew if a file that they depend on has changed. They hold what
explanations make of two robots that have something of all that rules can be given.

The long description is the README with absolute links, because an index of packages has no files
beside it.
"""

import hashlib
import re
import sys
from collections.abc import Iterable, Iterator
from importlib.metadata import version as version_of
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

ROOT = Path(__file__).parent
BESIDE = ROOT / "mars_asp" / "__tables__"
#: Holds the digest of the tables beside the sources, and of all that they depend on.
DIGEST = ROOT / "build" / "tables.digest"


#: The target of a link of Markdown that is a path, after `!` where it is a picture.
_RELATIVE = re.compile(r"(!?)(\[[^]]*\]\()(?![a-z]+:|#)([^)\s]+\))")


class ReadmeHook(MetadataHookInterface):
    """Takes the README as long description, with absolute links."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the long description."""
        readme = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        text = absolute_links(readme, metadata["urls"]["Source"])
        metadata["readme"] = {"content-type": "text/markdown", "text": text}


def absolute_links(text: str, source: str) -> str:
    """Return a text of Markdown whose links to files lead to the repository."""

    def absolute(link: re.Match[str]) -> str:
        folder = "raw" if link[1] else "blob"
        return f"{link[1]}{link[2]}{source}/{folder}/main/{link[3]}"

    return _RELATIVE.sub(absolute, text)


class TablesHook(BuildHookInterface[Any]):
    """Adds the tables to wheels; for an editable installation they stand beside the sources."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make the tables."""
        if self.target_name != "wheel":
            return
        if version == "editable":
            update()
            return
        folder = Path(mkdtemp())
        write(folder, beside() if is_current() else tables())
        # Beside the sources are the cases themselves.
        write(folder, example_tables(folder))
        for path in folder.iterdir():
            build_data["force_include"][str(path)] = f"mars_asp/__tables__/{path.name}"


def update() -> None:
    """Make the tables beside the sources, unless they are current."""
    if not is_current():
        made = dict(tables())
        BESIDE.mkdir(exist_ok=True)
        for path in BESIDE.iterdir():
            path.unlink()
        write(BESIDE, made.items())
        DIGEST.parent.mkdir(exist_ok=True)
        DIGEST.write_text(digest())


def is_current() -> bool:
    """Return whether the tables beside the sources would be the same if they were made anew."""
    return DIGEST.is_file() and DIGEST.read_text() == digest()


def digest() -> str:
    """Return the digest of the tables beside the sources, and of all that they depend on."""
    found = hashlib.sha256(f"{sys.version} {version_of('clingo')} {version_of('lark')}".encode())
    paths = [Path(__file__), *(ROOT / "mars_asp").rglob("*"), *(ROOT / "rules").rglob("*")]
    for path in sorted(path for path in paths if path.is_file() and path.suffix != ".pyc"):
        found.update(f"\n{path.relative_to(ROOT)}\n".encode() + path.read_bytes())
    return found.hexdigest()


def write(folder: Path, made: Iterable[tuple[str, bytes]]) -> None:
    """Write tables into a folder."""
    for name, content in made:
        (folder / name).write_bytes(content)


def beside() -> Iterator[tuple[str, bytes]]:
    """Yield the name and the file of each table beside the sources."""
    for path in BESIDE.iterdir():
        yield path.name, path.read_bytes()


def tables() -> Iterator[tuple[str, bytes]]:
    """Yield the name and the file of each table that every installation has."""
    sys.path.insert(0, str(ROOT))
    from mars_asp.asp import cache
    from mars_asp.asp.rules.computed import computations
    from mars_asp.asp.rules.dependencies import dependencies_of
    from mars_asp.asp.rules.premises import premises_of_rule, read_premises
    from mars_asp.asp.rules.statements import constants_of, statements_of
    from mars_asp.reasoning.facts.vocabulary import given_in
    from mars_asp.reasoning.questions.explain import explain
    from mars_asp.reasoning.rules import STAGES, load_rulebook, seal
    from mars_asp.reasoning.sample import sampled, samples
    from mars_asp.reasoning.session import Reasoner

    cache.forget(BESIDE / "none")
    whole = load_rulebook(stages=STAGES)
    texts = [rule.text for rule in whole.rules]
    for make in (statements_of, dependencies_of, constants_of, computations):
        make(texts)
    for _, text in whole.texts:
        read_premises(text)
    for rule in whole.rules:
        premises_of_rule(rule)
    seal()
    tuple(sampled())
    for stage in ("base", *STAGES):
        given_in(whole, stage)
    rulebook = load_rulebook(stages=("resolve", "account"))
    for project in samples():
        explain(Reasoner(project, rulebook))
    yield from cache.tables()


def example_tables(made: Path) -> Iterator[tuple[str, bytes]]:
    """Yield the table of sentences of examples, whose cases are not in the wheel.

    The other tables are those in the folder `made`.
    """
    sys.path.insert(0, str(ROOT))
    from mars_asp.asp import cache
    from mars_asp.cli.rules_example import table_examples
    from mars_asp.reasoning.rules import STAGES, load_rulebook

    cache.forget(made)
    table_examples(load_rulebook(stages=STAGES))
    yield from (table for table in cache.tables() if table[0] == "examples")


if __name__ == "__main__":
    update()
