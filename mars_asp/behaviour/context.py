"""The context of a behaviour beside its inputs: time, random numbers, scenario parameters."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from random import Random
from typing import Any

from mars_asp.spelling import nearest


class Parameters(dict[str, Any]):
    """The parameters of one module; looking up a missing one is an error with a hint.

    Raises:
        KeyError: the scenario does not set the parameter.
    """

    def __missing__(self, name: str) -> Any:
        near = nearest(name, self) if isinstance(name, str) else None
        hint = f"did you mean `{near}`?" if near else "give it in `[bindings.NAME.parameters]`"
        raise KeyError(f"no parameter `{name}`: {hint}")


@dataclass(slots=True)
class Context:
    """The data of one module beside its inputs; one object for the whole run, kept current.

    `now` is the time in s since the run began, `dt` how many s ago the module computed before (0 at
    the first time). `random` is drawn from `seed` and the name of the module, so that no other
    module disturbs it. `parameters` are those of `[bindings.NAME.parameters]`.
    """

    module: str = ""
    seed: int = 0
    parameters: Mapping[str, Any] = field(default_factory=Parameters)
    now: float = 0.0
    dt: float = 0.0
    random: Random = field(init=False)
    _before: float | None = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        self.parameters = Parameters(self.parameters)
        self.random = Random(f"{self.seed}/{self.module}")

    def advance(self, now: float) -> None:
        """Set the time of the next computation, in seconds."""
        # Instants are whole nanoseconds, so their differences are rounded to these.
        self.dt = 0.0 if self._before is None else round(now - self._before, 9)
        self.now = self._before = now
