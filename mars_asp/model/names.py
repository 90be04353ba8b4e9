r"""Names of modules and ports: how a configuration writes them.

Words of letters, digits, `_` and inner `-`, joined by `/`, with or without a leading `/`, are
written as they are; every other name is in double quotes, where `\"` is a quote and `\\` a
backslash. After a name, a `.` and a further name are one of the module's ports.
"""

import re

#: A name without quotes, not a number: `Camera`, `dora-camera`, `/robot1/base`.
BARE = r"/?(?=[\w/-]*[^\W\d])\w+(?:-+\w+)*(?:/\w+(?:-+\w+)*)*"
#: What is not seen as it is: control characters but tabs, ends of lines, and marks of direction.
UNSEEN = r"\x00-\x08\n-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069"
#: A name in quotes, in one line.
QUOTED = rf'"(?:[^"\\{UNSEEN}]|\\["\\])+"'
_BARE = re.compile(BARE)
_NAME = re.compile(f"{BARE}|{QUOTED}")
#: A text that is read as a number if one is allowed.
_NUMBER = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")
#: A name with an optional port.
_END = re.compile(rf"({BARE}|{QUOTED})(?:\.({BARE}|{QUOTED}))?")
_ESCAPED = re.compile(r"\\(.)")


def written(name: str) -> str:
    """Return a name as configurations write it, in quotes if necessary."""
    if _BARE.fullmatch(name) and not _NUMBER.fullmatch(name):
        return name
    return quoted(name)


def quoted(name: str) -> str:
    """Return a name in quotes."""
    inside = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{inside}"'


def read_name(text: str) -> str | None:
    """Return the name that a text denotes, without quotes, or None if it is not a name."""
    return plain(text) if _NAME.fullmatch(text) else None


def end(name: str, port: str | None) -> str:
    """Return `MODULE` or `MODULE.PORT`, quoted as a configuration writes it."""
    return written(name) if port is None else f"{written(name)}.{written(port)}"


def read_end(text: str) -> tuple[str, str | None] | None:
    """Return module and port (None without one) of a text, or None if it is neither."""
    match = _END.fullmatch(text)
    if match is None:
        return None
    return plain(match[1]), None if match[2] is None else plain(match[2])


def plain(text: str) -> str:
    """Return a name without its quotes and escapes; a name without quotes is unchanged."""
    return _ESCAPED.sub(r"\1", text[1:-1]) if text.startswith('"') else text
