"""Each lint with its purpose and reason, a rule that it reports and a rule that it accepts."""

import re
import tomllib
from importlib import resources
from typing import NamedTuple

#: A place for a shared declaration in a file of the catalogue.
_DECLARED = re.compile(r"@(\w+)\s")


class Page(NamedTuple):
    """The documentation of a lint; `bad` is reported, `good` is not. Both are whole files.

    `fixed` describes the text that `--fix` writes, if there is a safe fix.
    """

    code: str
    title: str
    what: str
    why: str
    bad: str
    good: str
    fixed: str = ""


def _pages() -> tuple[Page, ...]:
    text = resources.files(__package__).joinpath("catalogue.toml").read_text(encoding="utf-8")
    pages = tomllib.loads(text)
    declarations = pages.pop("declarations")
    for page in pages.values():
        for key in ("bad", "good"):
            page[key] = _DECLARED.sub(lambda match: declarations[match[1]], page[key])
    return tuple(Page(code, **page) for code, page in pages.items())


PAGES = _pages()
#: The codes of all lints.
CODES = frozenset(page.code for page in PAGES)
