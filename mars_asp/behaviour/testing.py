"""Step a behaviour by hand, without a robot or a scenario: for tests and for trying things out.

>>> from mars_asp.behaviour import Command, Context
>>> from mars_asp.behaviour.testing import Stepper
>>> def cruise(ranges: list[float], ctx: Context) -> Command:
...     return Command("Trans_Z", 200 if ctx.now < 10 else 100)
>>> Stepper(cruise).step([900.0], at=12.0)
Command(function='Trans_Z', rate=100.0)
"""

from collections.abc import Callable, Mapping
from typing import Any

from mars_asp.behaviour.calls import made, method_of, prepared
from mars_asp.behaviour.command import Command, command_of
from mars_asp.behaviour.context import Context
from mars_asp.behaviour.values import copied


class Stepper:
    """One module that runs a behaviour and is stepped by hand.

    `behaviour` is a function, a class or an object; of a class it makes one object, with
    `parameters`, and calls `method`, or the object itself without one. `module` and `seed` decide
    the random numbers of `ctx.random`, as in a run.

    Raises:
        UnfitError: it cannot be a behaviour, or its constructor does not take the parameters.
    """

    def __init__(
        self,
        behaviour: Callable[..., Any],
        *,
        parameters: Mapping[str, Any] | None = None,
        seed: int = 0,
        module: str = "",
        method: str | None = None,
    ) -> None:
        self.context = Context(module, seed, copied(dict(parameters or {})))
        self.now = 0.0
        target: Any = behaviour
        knows = False
        if isinstance(target, type):
            target, knows = made(target, self.context)
        target = method_of(target, method)
        self._call = prepared(target, self.context, lambda: self.now, knows=knows)

    def step(self, *inputs: Any, at: float | None = None) -> Any:
        """Return the result for inputs at the time `at` in s, by default that of the last step.

        Inputs and result are copies, as messages are in a run.

        Raises:
            ValueError: the time is before that of the last step.
            Exception: whatever the behaviour raises.
        """
        at = self.now if at is None else at
        if at < self.now:
            raise ValueError(f"the step at {at:g} s comes after one at {self.now:g} s")
        self.now = at
        return copied(self._call(*map(copied, inputs)))

    def command(self, *inputs: Any, at: float | None = None) -> Command | None:
        """Return the command of a controller, checked as in a run, or None; see `step`.

        Raises:
            ValueError, TypeError: the result is not a command.
        """
        result = self.step(*inputs, at=at)
        return None if result is None else command_of(result)
