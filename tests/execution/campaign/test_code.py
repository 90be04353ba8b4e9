"""The Python files that runs import, found without running any."""

from pathlib import Path

from mars_asp.execution.campaign.code import hash_of, imported_code

FILES = {
    "b.py": "import os, helper, pkg.a, lib.x as y\nfrom pkg.sub import deep\nraise SystemExit",
    "helper.py": "from lib import z\ndef late():\n    import computed",
    "computed.py": "import b",
    "unused.py": "",
    "os.py": "",
    "lib/x.py": "this is not Python",
    "lib/z.py": "",
    "lib/unused.py": "",
    "pkg/__init__.py": "",
    "pkg/a.py": "from .sub.deep import value\nfrom . import b2, value\nfrom .. import nothing",
    "pkg/b2.py": "import pkg.b3",
    "pkg/b3.py": "",
    "pkg/unused.py": "",
    "pkg/sub/__init__.py": "",
    "pkg/sub/deep.py": "from ..b2 import *",
}
UNUSED = {"unused.py", "lib/unused.py", "pkg/unused.py"}


def test_modules_imported_from_beside_a_file_are_found(tmp_path: Path) -> None:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = imported_code([tmp_path / "b.py"])
    names = {Path(path).relative_to(tmp_path).as_posix() for path in found}
    assert names == FILES.keys() - UNUSED
    assert found[str(tmp_path / "lib/x.py")] == b"this is not Python"


def test_a_hash_is_of_names_and_contents_wherever_they_are() -> None:
    first = hash_of("text", {"/a/b.py": b"1", "/a/c.py": b"2"})
    assert hash_of("text", {"/elsewhere/c.py": b"2", "/elsewhere/b.py": b"1"}) == first
    others = [
        hash_of("text", {"/a/b.py": b"2", "/a/c.py": b"1"}),
        hash_of("text", {"/a/b.py": b"1"}),
        hash_of("text", {"/a/b.py": b"1", "/a/d.py": b"2"}),
        hash_of("other", {"/a/b.py": b"1", "/a/c.py": b"2"}),
    ]
    assert len({first, *others}) == 5
