"""Short names of the types of pytest's fixtures."""

from typing import TypeAlias

import pytest

Captured: TypeAlias = pytest.CaptureFixture[str]
Patch: TypeAlias = pytest.MonkeyPatch
