"""The tutorial on rule packs, step by step in an empty folder: its files, its commands, its output.

A block with a title is a file that the reader writes, a console block has the next commands.
"""

import re
from pathlib import Path

import pytest

from tests.support.documents import ROOT, run

PAGE = ROOT / "docs/tutorial/packs.md"
BLOCK = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)


def test_each_step_works(tmp_path: Path, update_golden: bool) -> None:
    page = PAGE.read_text(encoding="utf-8")

    def worked(match: re.Match[str]) -> str:
        sort, title, text = match.groups()
        if sort == "console":
            commands = re.findall(r"^\$ (.*)$", text, re.MULTILINE)
            return "".join(
                ("```console\n", *(f"$ {each}\n{run(each, tmp_path)}" for each in commands), "```")
            )
        path = tmp_path / title
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return match[0]

    found = BLOCK.sub(worked, page)
    if update_golden:
        PAGE.write_text(found, encoding="utf-8")
    assert found == page


@pytest.mark.parametrize("sort", ["console", "toml", "clingo", "mars"])
def test_the_page_has_steps_of_each_sort(sort: str) -> None:
    assert sort in {match[1] for match in BLOCK.finditer(PAGE.read_text(encoding="utf-8"))}
