"""A package of ROS that a test writes."""

from collections.abc import Mapping
from pathlib import Path


def write_package(written: Mapping[str, str], folder: Path) -> None:
    """Write the files of a package `mine`, with its manifest, into a folder."""
    for name, text in {"package.xml": "<package><name>mine</name></package>", **written}.items():
        (folder / name).parent.mkdir(exist_ok=True, parents=True)
        (folder / name).write_text(text, encoding="utf-8")
