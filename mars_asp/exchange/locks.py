"""The locks of muxes: their names, and their lines in a configuration."""

from collections.abc import Container
from itertools import chain, count

from mars_asp.diagnostic import Span
from mars_asp.model.declarations import FOREVER, Lock
from mars_asp.model.graph import Mux, MuxInput


def lock_names(mux: Mux, before: str, taken: Container[str]) -> dict[MuxInput, str]:
    """Return the names of the locks of a mux, with the prefix `before`.

    A lock whose own name is `taken` has that of its topic as written, or without its leading `/`
    after a prefix; a number follows if that is taken too.
    """
    found: dict[MuxInput, str] = {}
    for lock in mux.locks:
        topic = before + lock.topic.lstrip("/") if before else lock.topic
        choices = chain((before + lock.name, topic), (f"{topic}_{k}" for k in count(2)))
        used = found.values()
        found[lock] = next(each for each in choices if each not in taken and each not in used)
    return found


def lock_line(
    controlled: str, source: str, lock: MuxInput, span: Span | None = None, port: str | None = None
) -> Lock:
    """Return the lock of a mux as a lock of the module that it controls.

    Without a timeout, silence does not lock.
    """
    hold = None if lock.hold_ms == FOREVER else lock.hold_ms
    return Lock(controlled, source, span or lock.span, lock.priority, hold, port)
