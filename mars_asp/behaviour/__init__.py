"""Behaviours of modules in runs, as Python functions or classes; see `docs/how-to/behaviours.md`.

>>> from mars_asp.behaviour import Command, Context
>>> def cruise(ranges: list[float], ctx: Context) -> Command:
...     return Command("Trans_Z", 200 if ctx.now < 10 else 100)
"""

from mars_asp.behaviour.command import Command
from mars_asp.behaviour.context import Context

__all__ = ["Command", "Context"]
