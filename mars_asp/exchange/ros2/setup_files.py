"""Packages in Python: console scripts and installed files of a `setup.py` or `setup.cfg`."""

import ast
import configparser
import re
from collections.abc import Iterator, Mapping

from mars_asp.exchange.ros2.cmake import Installed

_MOST_SOURCES = 200


def has_unknown_scripts(text: str) -> bool:
    """Whether a `setup.py` has console scripts that are not written as a list."""
    tree, names = _parsed(text)
    return any(
        isinstance(key, ast.Constant)
        and key.value == "console_scripts"
        and not _is_list(listed, names, text)
        for node in ast.walk(tree)
        if isinstance(node, ast.Dict)
        for key, listed in zip(node.keys, node.values, strict=True)
    )


def _is_list(listed: ast.expr, names: Mapping[str, ast.expr], text: str) -> bool:
    """Whether scripts are a list, by itself or in a variable that nothing changes."""
    if isinstance(listed, ast.Name):
        is_changed = re.search(rf"\b{listed.id}\s*(?:\.\w|\+=|\[)", text) is not None
        return not is_changed and isinstance(names.get(listed.id), ast.List | ast.Tuple)
    return isinstance(listed, ast.List | ast.Tuple | ast.Constant)


def scripts_of_setup(text: str) -> Iterator[tuple[str, str]]:
    """Yield the console scripts of a `setup.py`, which is not run."""
    tree, names = _parsed(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.keyword) and node.arg == "entry_points":
            held = names.get(node.value.id) if isinstance(node.value, ast.Name) else node.value
            if isinstance(held, ast.Dict):
                for key, listed in zip(held.keys, held.values, strict=True):
                    if isinstance(key, ast.Constant) and key.value == "console_scripts":
                        yield from _scripts(listed, names)


def files_of_setup(text: str, package: str) -> Iterator[Installed]:
    """Yield the files that a `setup.py` installs to the shared folder of its package."""
    tree, names = _parsed(text)
    share = f"share/{package}"
    for node in ast.walk(tree):
        if not isinstance(node, ast.Tuple) or len(node.elts) != 2:
            continue
        target, listed = node.elts
        folder = (_text_of(target, names) or "").rstrip("/")
        if folder == share or folder.startswith(f"{share}/"):
            for source in _data_sources(listed, names):
                yield Installed(source, folder.removeprefix(share).lstrip("/"))


def lists_all_files(text: str) -> bool:
    """Whether a `setup.py` is Python that lists the files that it installs one by one.

    Then it installs no others than `files_of_setup` yields.
    """
    tree, names = _parsed(text)
    listed = [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.keyword) and node.arg == "data_files"
    ]
    is_called = any(
        isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "setup"
        for node in ast.walk(tree)
    )
    return is_called and all(
        isinstance(each, ast.List)
        and all(
            isinstance(entry, ast.Tuple)
            and len(entry.elts) == 2
            and _text_of(entry.elts[0], names) is not None
            and _lists_paths(entry.elts[1], names)
            for entry in each.elts
        )
        for each in listed
    )


def _lists_paths(listed: ast.expr, names: Mapping[str, ast.expr]) -> bool:
    """Whether the files of an entry of `data_files` are paths, and patterns for one folder."""
    match listed:
        case ast.List(elts=inner):
            return all(_lists_paths(each, names) for each in inner)
        case ast.BinOp(left=left, op=ast.Add(), right=right) if _text_of(listed, names) is None:
            return _lists_paths(left, names) and _lists_paths(right, names)
        case ast.Call(
            func=ast.Name(id="glob") | ast.Attribute(value=ast.Name(id="glob"), attr="glob"),
            args=[first],
            keywords=[],
        ):
            folder = (_text_of(first, names) or "*").rpartition("/")[0]
            return not set(folder) & set("*?[")
        case other:
            return _text_of(other, names) is not None


def scripts_of_configuration(text: str) -> Iterator[tuple[str, str]]:
    """Yield the console scripts of a `setup.cfg`."""
    parser = configparser.ConfigParser(interpolation=None)
    try:
        parser.read_string(text)
    except configparser.Error:
        return
    listed = parser.get("options.entry_points", "console_scripts", fallback="")
    for line in listed.splitlines():
        name, sign, entry = line.partition("=")
        if sign:
            yield name.strip(), entry.strip()


def _parsed(text: str) -> tuple[ast.AST, dict[str, ast.expr]]:
    """Return the tree of a `setup.py`, empty if it is not Python, and its variables."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        tree = ast.Module([], [])
    return tree, {
        node.targets[0].id: node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }


def _data_sources(listed: ast.expr, names: Mapping[str, ast.expr]) -> Iterator[str]:
    """Yield the files of an entry of `data_files`, by their paths or patterns."""
    waiting = [listed]
    for _ in range(_MOST_SOURCES):
        if not waiting:
            return
        match waiting.pop():
            case ast.List(elts=inner) | ast.Tuple(elts=inner):
                waiting += inner
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                waiting += [left, right]
            case ast.Call(func=ast.Name(id="glob") | ast.Attribute(attr="glob"), args=[first, *_]):
                waiting.append(first)
            case other:
                text = _text_of(other, names)
                if text:
                    yield text


def _scripts(listed: ast.expr, names: Mapping[str, ast.expr]) -> Iterator[tuple[str, str]]:
    for each in listed.elts if isinstance(listed, ast.List | ast.Tuple) else ():
        text = _text_of(each, names)
        name, sign, entry = (text or "").partition("=")
        if sign:
            yield name.strip(), entry.strip()


def _text_of(node: ast.expr, names: Mapping[str, ast.expr]) -> str | None:
    """Return a text that is written out, with names that stand for such."""
    between = ""
    match node:
        case ast.Constant(value=str() as value):
            return value
        case ast.Name(id=name) if isinstance(names.get(name), ast.Constant):
            return _text_of(names[name], {})
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            parts = [_text_of(left, names), _text_of(right, names)]
        case ast.JoinedStr(values=values):
            parts = [
                _text_of(v.value if isinstance(v, ast.FormattedValue) else v, names) for v in values
            ]
        case ast.Call(func=ast.Name(id="join") | ast.Attribute(attr="join"), args=given):
            parts, between = [_text_of(each, names) for each in given], "/"
        case _:
            return None
    return None if None in parts else between.join(filter(None, parts))
