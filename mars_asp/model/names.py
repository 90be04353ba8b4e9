r"""Names of modules: how a configuration writes them.

Words of letters, digits, `_` and inner `-`, joined by `/`, with or without a leading `/`, are
written as they are; every other name stands in double quotes, where `\"` is a quote and `\\` a
backslash.
"""

import re

#: A name as it is, which is no number: `Camera`, `dora-camera`, `/robot1/base`.
BARE = r"/?(?=[\w/-]*[^\W\d])\w+(?:-+\w+)*(?:/\w+(?:-+\w+)*)*"
#: A name in quotes, in one line.
QUOTED = r'"(?:[^"\\\n]|\\["\\])+"'
_BARE = re.compile(BARE)
_NAME = re.compile(f"{BARE}|{QUOTED}")
#: What would be read as a number where one may stand.
_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
_ESCAPED = re.compile(r"\\(.)")


def written(name: str) -> str:
    """Return a name as a configuration writes it."""
    if _BARE.fullmatch(name) and not _NUMBER.fullmatch(name):
        return name
    inside = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{inside}"'


def read_name(text: str) -> str | None:
    """Return the name that a text writes; `None` where it writes none."""
    return plain(text) if _NAME.fullmatch(text) else None


def plain(text: str) -> str:
    """Return the name that a word of a configuration writes."""
    return _ESCAPED.sub(r"\1", text[1:-1]) if text.startswith('"') else text
