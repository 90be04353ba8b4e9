"""Pages that hold all that they need, and whose text is written by others.

Nothing is fetched, and no style or script but a page's own has any effect in it.
"""

from base64 import b64encode
from collections.abc import Iterable, Mapping
from hashlib import sha256
from html import escape
from importlib.resources import files
from string import Template

from mars_asp.output import visible


def whole_page(
    title: str,
    style: str,
    body: str,
    script: str | None = None,
    data: Mapping[str, str] = {},
    allowed: Iterable[str] = (),
) -> str:
    """Return an HTML page; `title` is plain text, `body` is HTML.

    `script` finds each text of JSON in `data` in the element with its key as id. `allowed` are
    directives that the content security policy has beside those for the style and script.
    """
    policy = ["default-src 'none'", "base-uri 'none'", "form-action 'none'", *allowed]
    policy.append(f"style-src {_allowed(style)}")
    scripts = [
        f'<script type="application/json" id="{name}">{_in_page(json_text)}</script>\n'
        for name, json_text in data.items()
    ]
    if script is not None:
        policy.append(f"script-src {_allowed(script)}")
        scripts.append(f"<script>{script}</script>\n")
    frame = (files("mars_asp.draw") / "page.html").read_text(encoding="utf-8")
    return Template(frame).substitute(
        policy="; ".join(policy),
        title=escape(visible(title)),
        style=style,
        body=body,
        scripts="".join(scripts),
    )


def _in_page(json_text: str) -> str:
    """Return JSON in which `&`, `<` and `>` are escaped, to embed it in HTML."""
    for mark in "&<>":
        json_text = json_text.replace(mark, f"\\u{ord(mark):04x}")
    return json_text


def _allowed(text: str) -> str:
    """Return the source in a content security policy that allows a script or style: its hash."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"
