"""Pages in headless Chromium, where there is one."""

import json
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
in_a_browser = pytest.mark.skipif(
    CHROMIUM is None, reason="no Chromium: a browser is no Python package that we could ask for"
)


def rendered(path: Path, text: str) -> str:
    """Return a page's elements after its scripts have run for two seconds of its time."""
    path.write_text(text, encoding="utf-8")
    words = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=2000"]
    done = subprocess.run(
        [str(CHROMIUM), *words, f"--user-data-dir={path.parent}", "--dump-dom", path.as_uri()],
        capture_output=True,
        check=True,
        timeout=180,
    )
    return done.stdout.decode()


def probed(path: Path, page: str, probe: str) -> dict[str, Any]:
    """Run a script in a page, without the page's policy; return what it puts into `found`."""
    script = f"""<script>
      const found = {{}};
      {probe}
      setTimeout(() => {{ document.documentElement.dataset.found = JSON.stringify(found); }}, 1500);
    </script></body>"""
    text = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page)
    shown = rendered(path, text.replace("</body>", script))
    told = re.search(r'data-found="([^"]*)"', shown)
    assert told, shown
    result: dict[str, Any] = json.loads(unescape(told[1]))
    return result
