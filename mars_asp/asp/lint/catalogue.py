"""Each lint with its purpose and reason, a rule that it reports and a rule that it accepts."""

import re
import tomllib
from dataclasses import dataclass
from importlib import resources

#: A place for a shared declaration in a file of the catalogue.
_DECLARED = re.compile(r"@(\w+)\s")


@dataclass(frozen=True, slots=True)
class Page:
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
#: The documentation of each lint by its code.
CODES = {page.code: page for page in PAGES}


def page_text(page: Page) -> str:
    """Return the documentation of a lint as Markdown."""
    parts = [f"## {page.code}", f"**{page.title}.** {page.what}", f"Why: {page.why}"]
    parts += [f"`--fix` writes {page.fixed}."] if page.fixed else []
    parts += [f"Reported:\n\n```clingo\n{page.bad}```"]
    parts += [f"Not reported:\n\n```clingo\n{page.good}```"]
    return "\n\n".join(parts)
