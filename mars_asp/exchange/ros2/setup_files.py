"""Packages in Python: console scripts and installed files of a `setup.py` or `setup.cfg`."""

import ast
import configparser
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress

from mars_asp.exchange.ros2.cmake import Installed
from mars_asp.exchange.ros2.python_files import (
    PythonFiles,
    SourceFile,
    parse_source,
)
from mars_asp.exchange.ros2.python_texts import PythonTexts

_MOST_SOURCES = 200


def has_unknown_scripts(text: str) -> bool:
    """Whether a `setup.py` computes its console scripts instead of listing them."""
    texts = _texts_of(text)
    return not all(_is_list(listed, texts, text) for listed in _console_scripts(texts))


def _console_scripts(texts: PythonTexts) -> Iterator[ast.expr]:
    """Yield the values of the key `console_scripts`."""
    for node in ast.walk(texts.node):
        if isinstance(node, ast.Dict):
            for key, listed in zip(node.keys, node.values, strict=True):
                if isinstance(key, ast.Constant) and key.value == "console_scripts":
                    yield listed


def _is_list(listed: ast.expr, texts: PythonTexts, text: str) -> bool:
    """Whether an expression is a list, or a variable whose list the file never changes."""
    if isinstance(listed, ast.Name):
        is_changed = re.search(rf"\b{listed.id}\s*(?:\.\w|\+=|\[)", text) is not None
        return not is_changed and isinstance(
            texts.file.constants.get(listed.id), ast.List | ast.Tuple
        )
    return isinstance(listed, ast.List | ast.Tuple | ast.Constant)


def scripts_of_setup(text: str) -> Iterator[tuple[str, str]]:
    """Yield the console scripts of a `setup.py`, which is not run."""
    texts = _texts_of(text)
    for listed in _console_scripts(texts):
        items = listed.elts if isinstance(listed, ast.List | ast.Tuple) else ()
        yield from _entries_of(_text_of(each, texts) or "" for each in items)


def files_of_setup(text: str, package: str) -> Iterator[Installed]:
    """Yield the files that a `setup.py` installs to the shared folder of its package."""
    texts = _texts_of(text)
    share = f"share/{package}"
    for node in ast.walk(texts.node):
        if not isinstance(node, ast.Tuple) or len(node.elts) != 2:
            continue
        target, listed = node.elts
        folder = (_text_of(target, texts) or "").rstrip("/")
        if folder == share or folder.startswith(f"{share}/"):
            for source in filter(None, _data_sources(listed, texts)):
                yield Installed(source, folder.removeprefix(share).lstrip("/"))


def lists_all_files(text: str) -> bool:
    """Whether a `setup.py` lists all files that it installs, as `files_of_setup` yields.

    Then it installs no others than `files_of_setup` yields.
    """
    texts = _texts_of(text)
    listed = [
        node.value
        for node in ast.walk(texts.node)
        if isinstance(node, ast.keyword) and node.arg == "data_files"
    ]
    is_called = any(
        isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "setup"
        for node in ast.walk(texts.node)
    )
    return is_called and all(
        isinstance(each, ast.List)
        and all(
            isinstance(entry, ast.Tuple)
            and len(entry.elts) == 2
            and _text_of(entry.elts[0], texts) is not None
            and None not in _data_sources(entry.elts[1], texts)
            for entry in each.elts
        )
        for each in listed
    )


def scripts_of_configuration(text: str) -> Iterator[tuple[str, str]]:
    """Yield the console scripts of a `setup.cfg`."""
    parser = configparser.ConfigParser(interpolation=None)
    try:
        parser.read_string(text)
    except configparser.Error:
        return
    listed = parser.get("options.entry_points", "console_scripts", fallback="")
    yield from _entries_of(listed.splitlines())


def _entries_of(lines: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the name of each script with its module and function."""
    for line in lines:
        name, sign, entry = line.partition("=")
        if sign:
            yield name.strip(), entry.strip()


def _texts_of(text: str) -> PythonTexts:
    """Return an evaluator of a `setup.py`, which has no code if it is not Python."""
    file = None
    with suppress(SyntaxError):
        file = parse_source(text, "setup.py", "setup")
    file = file or SourceFile("setup.py", [], ast.Module([], []))
    return PythonTexts(PythonFiles(lambda _: None), file, file.tree)


def _data_sources(listed: ast.expr, texts: PythonTexts) -> Iterator[str | None]:
    """Yield the paths or patterns in an entry of `data_files`; None for unknown ones."""
    waiting = [listed]
    for _ in range(_MOST_SOURCES):
        if not waiting:
            return
        node = waiting.pop()
        text = _text_of(node, texts)
        match node:
            case ast.List(elts=inner) | ast.Tuple(elts=inner):
                waiting += inner
            case ast.BinOp(left=left, op=ast.Add(), right=right) if text is None:
                waiting += [left, right]
            case ast.Call(func=ast.Name(id="glob") | ast.Attribute(attr="glob"), args=[first, *_]):
                pattern = _text_of(first, texts)
                is_recursive = any(each.arg == "recursive" for each in node.keywords)
                yield pattern if is_recursive or pattern is None else pattern.replace("**", "*")
                is_plain = len(node.args) == 1 and not node.keywords
                if not is_plain or set((pattern or "").rpartition("/")[0]) & set("*?["):
                    yield None
            case _:
                yield text
    yield None


def _text_of(node: ast.expr, texts: PythonTexts) -> str | None:
    """Return the text that an expression is, or None if only a run knows it."""
    texts.steps = 0
    return texts.text(node)
