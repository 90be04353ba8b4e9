"""Parts of pages that hold all that they need, and whose text is written by others."""

from base64 import b64encode
from hashlib import sha256


def in_page(json_text: str) -> str:
    """Return JSON that can stand in an element of HTML: no text in it ends that element."""
    for mark in "&<>":
        json_text = json_text.replace(mark, f"\\u{ord(mark):04x}")
    return json_text


def policy_source(text: str) -> str:
    """Return how a page's security policy names a script or style of its own: by its hash."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
