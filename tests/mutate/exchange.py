"""Changed modules in the place of modules that others have imported already.

Other modules hold functions of a module; these stay the same objects and get other code.
"""

import gc
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from types import CodeType, FunctionType, ModuleType
from typing import Any, TypeAlias

from tests.support.documents import ROOT

#: The functions that have code of a name and a first line.
_Functions: TypeAlias = Mapping[tuple[str, int], list[FunctionType]]


@dataclass(frozen=True, slots=True)
class Exchange:
    """A module whose code can be exchanged, and the caches of results of its former code."""

    module: ModuleType
    functions: _Functions
    remembering: tuple[Callable[[], None], ...]

    def put(self, code: CodeType, alone: CodeType | None = None) -> None:
        """Exchange the code of all functions, and run one statement of the module alone.

        Raises:
            Exception: whatever the statement raises.
        """
        for new in _below(code):
            for function in self.functions.get((new.co_qualname, new.co_firstlineno), ()):
                # What takes other variables from around itself is left as it was.
                with suppress(ValueError):
                    function.__code__ = new
        for forget in self.remembering:
            forget()
        if alone is not None:
            before = dict(vars(self.module))
            exec(alone, vars(self.module))
            _tell(before, vars(self.module))


def exchanges(paths: Iterable[str]) -> dict[str, Exchange]:
    """Return an `Exchange` for each module, by its path in the repository."""
    modules = {path: import_module(path.removesuffix(".py").replace("/", ".")) for path in paths}
    # What the suite has frozen is in no list of objects.
    gc.unfreeze()
    everything = gc.get_objects()
    remembering = tuple(
        held.cache_clear
        for held in everything
        if type(held).__name__ == "_lru_cache_wrapper" and _is_ours(held.__module__)
    )
    found: dict[str, Exchange] = {}
    for path, module in modules.items():
        functions: dict[tuple[str, int], list[FunctionType]] = {}
        for held in everything:
            if isinstance(held, FunctionType) and held.__globals__ is vars(module):
                code = held.__code__
                functions.setdefault((code.co_qualname, code.co_firstlineno), []).append(held)
        found[path] = Exchange(module, functions, remembering)
    return found


def _is_ours(name: str | None) -> bool:
    return (name or "").partition(".")[0] in ("mars_asp", ROOT.joinpath("tests").name)


def _below(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _below(constant)


def _tell(before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Replace changed objects in all modules that have imported them."""
    for name, new in after.items():
        old = before.get(name)
        if old is None or new is old:
            continue
        for held in list(sys.modules.values()):
            if _is_ours(getattr(held, "__name__", None)) and vars(held).get(name) is old:
                vars(held)[name] = new
