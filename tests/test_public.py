"""The public names of `mars_asp`."""

import keyword
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest

import mars_asp
from tests.support.documents import ROOT

#: Packages that only `run` or one kind of picture needs.
OF_OTHERS = ("jsonschema_rs", "mcap", "resvg_py", "tree_sitter", "tree_sitter_toml")


def test_everything_public_can_be_had() -> None:
    for name in mars_asp.__all__:
        assert getattr(mars_asp, name).__doc__, name
    with pytest.raises(AttributeError, match="nothing_here"):
        mars_asp.nothing_here  # noqa: B018
    assert files("mars_asp").joinpath("py.typed").is_file()


def test_modules_have_names_that_can_be_imported() -> None:
    names = [path.stem for path in Path(mars_asp.__file__).parent.rglob("*.py")]
    assert [name for name in names if not name.isidentifier() or keyword.iskeyword(name)] == []


def test_nothing_is_loaded_before_its_first_use() -> None:
    code = "import sys, mars_asp; print([m for m in sys.modules if m.startswith('mars_asp.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


@pytest.mark.parametrize("verb", ["check", "analyse", "synthesise", "explain", "draw"])
def test_verbs_import_nothing_that_only_others_need(verb: str, tmp_path: Path) -> None:
    target = ["-o", str(tmp_path / "a.svg")] if verb == "draw" else []
    words = [verb, "examples/level0/config.mars", *target]
    code = (
        f"import sys; from mars_asp.cli import run_here; run_here({words}); "
        f"print([name for name in {OF_OTHERS} if name in sys.modules], file=sys.stderr)"
    )
    called = [sys.executable, "-c", code]
    done = subprocess.run(called, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stderr.endswith("[]\n")
