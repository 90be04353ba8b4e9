"""Answer editors: the language server for `.mars` files, annotated sources and rules, over stdio.

It needs the extra `lsp`.
"""

import argparse
import gc
from contextlib import suppress
from functools import partial
from importlib.util import find_spec

from mars_asp.cli.arguments import add_flags, misuse
from mars_asp.cli.suggested_commands import way_to_install

#: The server runs as long as the editor; each analysis is a process with its own limits.
IS_CONTAINED = False
#: Seconds that an answer may take by default.
_SECONDS = 60.0
#: So many questions are answered at a time.
_AT_A_TIME = 2


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    # Clients in editors add this option, as some servers have several transports.
    add_flags(parser, "--stdio")


def run(arguments: argparse.Namespace) -> int:
    """Serve until the editor is gone; return 2 if the extra is missing."""
    if find_spec("pygls") is None:
        return misuse("lsp", f"the language server needs the extra `lsp`: {way_to_install('lsp')}")
    from mars_asp.asp.contained import Server, limit_memory
    from mars_asp.cli.limits import memory_limit
    from mars_asp.lsp.server import serve
    from mars_asp.lsp.workers import Workers

    # A process of hours needs garbage collection, but rarely, as answers wait for it.
    gc.freeze()
    gc.set_threshold(500_000, 20, 20)
    gc.enable()
    seconds = arguments.time_limit or _SECONDS
    with suppress(OSError, ValueError):
        limit_memory(memory_limit(arguments))
    start = partial(Server, "mars_asp.cli.lsp_answers", "main", arguments)
    serve(Workers(start, seconds, _AT_A_TIME))
    return 0
