"""What `import mars_asp` offers."""

import subprocess
import sys
from importlib.resources import files

import pytest

import mars_asp


def test_everything_public_can_be_had() -> None:
    for name in mars_asp.__all__:
        assert getattr(mars_asp, name).__doc__, name
    with pytest.raises(AttributeError, match="nothing_here"):
        mars_asp.nothing_here  # noqa: B018
    assert files("mars_asp").joinpath("py.typed").is_file()


def test_nothing_is_loaded_before_it_is_asked_for() -> None:
    code = "import sys, mars_asp; print([m for m in sys.modules if m.startswith('mars_asp.')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
