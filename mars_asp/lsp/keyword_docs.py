"""The syntax and meaning, in a sentence, of each keyword of `.mars` files and annotations.

They are in `keyword_docs.toml`. A test ensures that all keywords of the language, of annotations
and of modes are listed there.
"""

import tomllib
from importlib.resources import files
from typing import NamedTuple


class KeywordDoc(NamedTuple):
    """A keyword: its syntax with arguments, and its meaning."""

    written: str
    meaning: str


_DOCUMENT = tomllib.loads((files(__package__) / "keyword_docs.toml").read_text(encoding="utf-8"))
#: The keywords of a `.mars` file; of annotations, without their `@`; delivery modes; keys of the
#: comments above rules.
STATEMENTS, ANNOTATIONS, MODES, METADATA = (
    {name: KeywordDoc(*texts) for name, texts in _DOCUMENT[table].items()}
    for table in ("statements", "annotations", "modes", "metadata")
)
