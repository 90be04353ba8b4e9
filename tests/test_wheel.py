"""The wheel brings its rules along and works where there is no checkout."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

from tests.support.documents import ROOT


def test_the_wheel_works_outside_the_checkout(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    site = tmp_path / "site"
    zipfile.ZipFile(wheel).extractall(site)
    shutil.copy(ROOT / "examples" / "level0" / "config.mars", tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", "mars_asp", "synthesise", "config.mars"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(site), "PYTHONSAFEPATH": "1"},
        check=True,
        capture_output=True,
        text=True,
    )
    assert done.stdout == (ROOT / "tests" / "specifications" / "level0.mars").read_text()
    for carried in ("rules/vocabulary.lp", "py.typed", "execution/recording/replay.html"):
        assert (site / "mars_asp" / carried).is_file()
