"""Commands of a `CMakeLists.txt`, as far as they say which sources a program has."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

#: Comments and strings, brackets and words; one pattern that any text fits.
_TOKEN = re.compile(
    r"#\[(?P<eq>=*)\[.*?(?:\](?P=eq)\]|\Z)|#[^\n]*|\[(?P<raw>=*)\[.*?(?:\](?P=raw)\]|\Z)"
    r'|"(?:\\.|[^"\\])*"?|[()]|[^\s()#"]+',
    re.DOTALL,
)
_VARIABLE = re.compile(r"\$\{([\w-]+)\}")
_EXECUTABLES = frozenset({"add_executable", "ament_auto_add_executable", "cuda_add_executable"})
_LIBRARIES = frozenset({"add_library", "ament_auto_add_library", "cuda_add_library"})
_MOST_WORDS = 10_000


class Installed(NamedTuple):
    """Files or a folder of a package that are installed below a folder of its shared files.

    `source` may be a pattern; a folder is installed by its own name, or with a slash at its end by
    its content.
    """

    source: str
    target: str
    is_folder: bool = False


@dataclass(slots=True)
class Targets:
    """Sources of targets, what they link, and which of them are programs and components.

    `programs` are files that are installed as they are, `started` the components that programs
    start; `installed` are the shared files.
    """

    sources: dict[str, list[str]] = field(default_factory=dict)
    links: dict[str, list[str]] = field(default_factory=dict)
    executables: dict[str, str] = field(default_factory=dict)
    plugins: dict[str, str] = field(default_factory=dict)
    started: dict[str, str] = field(default_factory=dict)
    programs: list[str] = field(default_factory=list)
    installed: list[Installed] = field(default_factory=list)

    def of(self, target: str) -> list[str]:
        """Return the sources of a target and of those of the file that it links."""
        found: list[str] = []
        waiting, seen = [target], set[str]()
        while waiting:
            each = waiting.pop()
            if each not in seen:
                seen.add(each)
                found += self.sources.get(each, ())
                waiting += self.links.get(each, ())
        return found


def read_cmake(text: str) -> Targets:  # noqa: C901 -- one case for each command
    """Return the targets of a `CMakeLists.txt`; conditions are taken whatever they say."""
    targets = Targets()
    values: dict[str, list[str]] = {}
    automatic: list[str] = []
    for name, words in _commands(text):
        given = _expanded(words, values)
        if not given:
            continue
        first, *others = given
        match name:
            case "set":
                values[first] = others[:_MOST_WORDS]
            case "project":
                values["PROJECT_NAME"] = [first]
                values["CATKIN_PACKAGE_SHARE_DESTINATION"] = [f"share/{first}"]
            case _ if name in _EXECUTABLES:
                targets.sources[first] = others
                targets.executables[first] = first
                if name.startswith("ament_auto"):
                    targets.links.setdefault(first, []).extend(automatic)
            case _ if name in _LIBRARIES:
                targets.sources[first] = others
                automatic += [first] * name.startswith("ament_auto")
            case "target_sources":
                targets.sources.setdefault(first, []).extend(others)
            case "target_link_libraries":
                targets.links.setdefault(first, []).extend(others)
            case "rclcpp_components_register_node":
                named = dict(pairwise(others))
                if "PLUGIN" in named:
                    targets.plugins[named["PLUGIN"]] = first
                if "EXECUTABLE" in named:
                    targets.executables[named["EXECUTABLE"]] = first
                    targets.started[named["EXECUTABLE"]] = named.get("PLUGIN", "")
            case "rclcpp_components_register_nodes":
                targets.plugins |= dict.fromkeys(others, first)
            case "install" | "catkin_install_python" if first == "PROGRAMS":
                programs = (
                    others[: others.index("DESTINATION")] if "DESTINATION" in others else others
                )
                targets.programs += programs
            case "install" if first in ("DIRECTORY", "FILES"):
                targets.installed += _installed(first == "DIRECTORY", others, values)
            case "set_target_properties":
                for key, value in pairwise(others):
                    if key == "OUTPUT_NAME":
                        targets.executables[value] = first
    return targets


def _installed(
    is_folder: bool, words: Sequence[str], values: Mapping[str, Sequence[str]]
) -> Iterator[Installed]:
    """Yield what a command installs to the shared folder of the package."""
    if "DESTINATION" not in words[:-1]:
        return
    at = words.index("DESTINATION")
    share = f"share/{' '.join(values.get('PROJECT_NAME', ()))}"
    target = words[at + 1].rstrip("/")
    if target == share or target.startswith(f"{share}/"):
        for word in words[:at]:
            source = word.removeprefix("${CMAKE_CURRENT_SOURCE_DIR}/")
            yield Installed(source, target.removeprefix(share).lstrip("/"), is_folder)


def _commands(text: str) -> Iterator[tuple[str, list[str]]]:
    """Yield each command with its words."""
    before, words, depth = "", list[str](), 0
    for match in _TOKEN.finditer(text):
        token = match[0]
        if token.startswith("#"):
            continue
        if token == "(":
            depth += 1
            if depth == 1:
                words = []
        elif token == ")":
            depth = max(0, depth - 1)
            if not depth and before:
                yield before.lower(), words
                before = ""
        elif depth:
            words.append(token[1:-1] if token.startswith('"') and len(token) > 1 else token)
        else:
            before = token


def _expanded(words: Sequence[str], values: dict[str, list[str]]) -> list[str]:
    """Return words with the variables in them replaced, a whole one by all its words."""
    found: list[str] = []
    for word in words:
        whole = _VARIABLE.fullmatch(word)
        if whole:
            found += values.get(whole[1], ())
        else:
            found.append(_VARIABLE.sub(lambda m: " ".join(values.get(m[1], (m[0],)))[:4096], word))
        if len(found) > _MOST_WORDS:
            break
    return found
