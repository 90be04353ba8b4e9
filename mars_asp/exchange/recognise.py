"""Which format a text is in, told by what it says."""

import re

#: The formats of robots that can stand where a `.mars` file does.
FORMATS = ("mars", "twist_mux")
_OURS = re.compile(r"^[ \t]*@(?:configuration|specification|modules|module_start)\b", re.MULTILINE)
#: A key that begins the parameters of a mux, dotted or not.
_MUX = re.compile(
    r"(?:^|[{,])[ \t{\"']*(?:- +)?(?:topics|locks|subscribers|ros__parameters)"
    r"(?:\.[^\s:]+)?[\"']?[ \t]*:",
    re.MULTILINE,
)


def recognised(text: str) -> str:
    """Return the format that a text is in, `mars` where it is no other that is known."""
    if _OURS.search(text):
        return "mars"
    return "twist_mux" if _MUX.search(text) else "mars"
