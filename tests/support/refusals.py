"""The diagnostics of refused inputs."""

from collections.abc import Callable
from typing import ParamSpec

import pytest

from mars_asp.diagnostic import Diagnostic, MarsError

P = ParamSpec("P")


def refusals(
    call: Callable[P, object], *words: P.args, **options: P.kwargs
) -> tuple[Diagnostic, ...]:
    """Return the diagnostics of the `MarsError` that a call raises."""
    with pytest.raises(MarsError) as caught:
        call(*words, **options)
    return caught.value.diagnostics


def refusal(call: Callable[P, object], *words: P.args, **options: P.kwargs) -> Diagnostic:
    """Return the only diagnostic of the `MarsError` that a call raises."""
    (diagnostic,) = refusals(call, *words, **options)
    return diagnostic
