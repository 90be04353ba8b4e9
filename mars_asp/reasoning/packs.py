"""Rule packs in folders: their manifests, and the stages of their files.

A pack is a folder. With a manifest, `pack.toml`, it has a name, and its rules lie in folders named
after stages; without one, its `.lp` files find consequences.

    name = "emergency-stop"
    version = "1.0"
    needs = ["mars-asp >= 0.1", "redundancy >= 1.2"]

    [[node]]
    kind = "watchdog"
    name = "Watchdog"
    carries = "control"
    inputs = "one"
    outputs = "one"
"""

import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from mars_asp import __version__
from mars_asp.diagnostic import Diagnostic, MarsError, Span, whole_file
from mars_asp.language.parse import decode, read_bytes
from mars_asp.language.toml_text import Places, read_tables
from mars_asp.model.declarations import NODE_NAMES, PackKind
from mars_asp.spelling import nearest, suggestion

if TYPE_CHECKING:
    from importlib.metadata import EntryPoints

MANIFEST = "pack.toml"
#: The folders of a pack with a manifest, with the stage of the files in each.
FOLDERS: Mapping[str, str] = {
    "consequences": "base",
    "resolve": "resolve",
    "specify": "specify",
    "verify": "verify",
    "run": "run",
    "repair": "repair",
}
#: Folders of a pack whose files are not its rules.
_OTHERS = ("cases", "docs", "examples", "tests")
#: The entry points by which distributions offer packs: a name, and the package that is its folder.
GROUP = "mars_asp.packs"
_CODE = "pack"
_KEYS = ("name", "version", "summary", "needs", "node")
_NAME = r"[a-z][a-z0-9]*([-_][a-z0-9]+)*"
_VERSION = r"[0-9]{1,9}(\.[0-9]{1,9})*"
_NEED = r"([a-z][a-z0-9_-]*?)\s*(?:(>=|==|<)\s*([0-9]{1,9}(?:\.[0-9]{1,9})*))?"
_KIND = r"[a-z][a-z0-9_]*"
_NODE_NAME = r"[A-Z][A-Za-z]*"
_COLOUR = r"#[0-9a-fA-F]{6}"
#: The keys of a kind of node, with their values; an empty tuple allows any text.
_NODE_KEYS: Mapping[str, tuple[str, ...]] = {
    "kind": (),
    "name": (),
    "carries": ("control", "data"),
    "inputs": ("one", "several"),
    "outputs": ("none", "one", "several"),
    "colour": (),
    "behaviour": ("needed", "none"),
}
_OURS = "mars-asp"
_MOST_BYTES = 64 * 1024
#: Limit of the number of requirements and of kinds of nodes in a manifest.
_MOST_LISTED = 200


class Requirement(NamedTuple):
    """A requirement of a pack: a pack or `mars-asp`, and the versions that suffice, if limited."""

    name: str
    comparison: str
    version: str
    span: Span


class Manifest(NamedTuple):
    """The content of `pack.toml`; `kinds` are the kinds of nodes that the pack provides."""

    name: str
    version: str
    needs: tuple[Requirement, ...]
    kinds: tuple[PackKind, ...]
    span: Span
    summary: str = ""


class PackFile(NamedTuple):
    """A file of a pack, and its stage."""

    path: Path
    stage: str


class Pack(NamedTuple):
    """A name space of rules: a folder with a manifest, one without, or files of one folder."""

    name: str
    folder: Path
    files: tuple[PackFile, ...]
    manifest: Manifest | None = None


def find_packs(given: Iterable[Path], problems: list[Diagnostic]) -> tuple[Pack, ...]:
    """Return the packs of some files and folders; note the errors in them.

    A file that is given several times is in its pack once.
    """
    seen: set[Path] = set()
    packs: list[Pack] = []
    loose: dict[Path, list[PackFile]] = {}
    for path in given:
        if path.is_dir() and is_pack(path):
            if (key := path.resolve()) not in seen:
                seen.add(key)
                packs += _with_manifest(path, problems)
        elif path.is_dir():
            files = tuple(PackFile(each, "base") for each in sorted(path.glob("*.lp")))
            files = tuple(each for each in files if _is_new(each.path, seen))
            if files:
                packs.append(Pack(path.resolve().name, path, files))
            problems += _empty(path)
        elif path.name == MANIFEST and path.is_file():
            message, advice = f"`{path}` is a manifest", f"give its folder, `{path.parent}`"
            problems.append(Diagnostic(_CODE, "error", message, whole_file(str(path)), help=advice))
        elif path.is_file():
            if _is_new(path, seen):
                loose.setdefault(path.parent, []).append(PackFile(path, "base"))
        else:
            problems.append(_missing_path(path))
    for folder, files_there in loose.items():
        packs.append(Pack(folder.resolve().name, folder, tuple(files_there)))
    problems += _wrong_together(packs)
    return tuple(packs)


def pack_of(file: Path, folders: Collection[str] = ("", *FOLDERS)) -> Path | None:
    """Return the pack with a manifest whose folder of rules contains a file, or None.

    `folders` replaces the folders of rules; an empty name is the folder of the pack itself.
    """
    found = folders_around(file.parent)
    return next((outer for inner, outer in found if inner in folders and is_pack(outer)), None)


def is_pack(folder: Path) -> bool:
    """Whether a folder has a manifest."""
    return os.path.isfile(folder / MANIFEST)  # noqa: PTH113 -- false where a folder may not be entered


def packs_around(folder: Path) -> tuple[Path, ...]:
    """Return the nearest pack from a folder upwards, last, after the packs that it needs.

    Paths are relative to the current folder; there are none if the folder is in no pack. Files of
    other programs have the name of the manifest as well, so a pack has rules.
    """
    here = folder.resolve()
    found = (each for each in (here, *here.parents) if is_pack(each) and _has_rules(each))
    pack = next(found, None)
    return () if pack is None else with_companions(Path(os.path.relpath(pack)))


def _has_rules(pack: Path) -> bool:
    return any(True for name in ("", *FOLDERS) for _ in (pack / name).glob("*.lp"))


def with_companions(pack: Path) -> tuple[Path, ...]:
    """Return a pack, last, after the packs next to it that it needs, also indirectly."""
    found: dict[Path, None] = {}
    waiting = [pack]
    while waiting:
        each = waiting.pop()
        if each in found:
            continue
        found[each] = None
        for read in find_packs([each], []):
            needs = () if read.manifest is None else read.manifest.needs
            # The parent of `.` or `..` is not in its path.
            folder = each / ".." if each.name in ("", "..") else each.parent
            beside = (folder / need.name for need in needs)
            waiting += (other for other in beside if is_pack(other))
    return tuple(reversed(found))


def folders_around(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield a folder and its parents, each with the name of its child on the path ("" first)."""
    name = ""
    for outer in (folder, *folder.parents):
        yield name, outer
        name = outer.name
    if not folder.is_absolute():
        here = Path.cwd()
        # A path may begin within a pack.
        name = name or here.name
        for outer in (here, *here.parents) if folder.parts[:1] != ("..",) else ():
            yield name, outer
            name = outer.name


def installed_pack(name: str) -> Path | None:
    """Return the folder of the pack that an installed distribution offers under a name, or None."""
    return next((folder for _, folder in _installed(_entry_points(name))), None)


def installed_packs() -> dict[str, Path]:
    """Return the folders of the packs that installed distributions offer, by their names."""
    packs: dict[str, Path] = {}
    for name, folder in _installed(_entry_points()):
        packs.setdefault(name, folder)
    return dict(sorted(packs.items()))


def _entry_points(name: str | None = None) -> "EntryPoints":
    from importlib.metadata import entry_points  # noqa: PLC0415 -- few commands need it

    return entry_points(group=GROUP) if name is None else entry_points(group=GROUP, name=name)


def _installed(offers: "EntryPoints") -> Iterator[tuple[str, Path]]:
    """Yield the name and the folder of each pack in entry points, without importing its code."""
    for offer in offers:
        first, *inner = offer.value.split(".")
        try:
            # Finding an inner package in this way would import the outer one.
            spec = find_spec(first)
        except (ImportError, ValueError):
            continue
        outer = () if spec is None else spec.submodule_search_locations or ()
        folders = (Path(each, *inner) for each in outer)
        yield from ((offer.name, folder) for folder in folders if folder.is_dir())


def kinds_of(packs: Iterable[Pack]) -> tuple[PackKind, ...]:
    """Return the kinds of nodes that packs provide."""
    manifests = (pack.manifest for pack in packs if pack.manifest is not None)
    return tuple(kind for manifest in manifests for kind in manifest.kinds)


def _is_new(path: Path, seen: set[Path]) -> bool:
    key = path.resolve()
    if key in seen:
        return False
    seen.add(key)
    return True


def _missing_path(path: Path) -> Diagnostic:
    message, span, advice = "no such file or folder", whole_file(str(path)), known_packs(path.name)
    return Diagnostic("rules-missing", "error", message, span, help=advice, excerpt="")


def known_packs(name: str) -> str | None:
    """Return the help that names the installed packs, or that one like a name; None without any."""
    known = installed_packs()
    near = nearest(name, known)
    if near:
        return f"did you mean the installed pack `{near}`?"
    return f"installed packs are {', '.join(f'`{each}`' for each in known)}" if known else None


def _empty(folder: Path) -> Iterator[Diagnostic]:
    """Yield an error if a folder without a manifest contains no rules."""
    if any(folder.glob("*.lp")):
        return
    inside = sorted(each.parent for each in folder.glob(f"*/{MANIFEST}"))
    named = [each for each in FOLDERS if any((folder / each).glob("*.lp"))]
    if inside:
        advice = f"give each pack in it: {', '.join(f'`{each}`' for each in inside)}"
    elif named:
        advice = f"folders such as `{named[0]}` need a manifest beside them, `{MANIFEST}`"
    else:
        advice = f"a pack is a folder of `.lp` files, or has a manifest, `{MANIFEST}`"
    place = whole_file(str(folder))
    yield Diagnostic("rules-missing", "error", f"`{folder}` holds no rules", place, help=advice)


def _with_manifest(folder: Path, problems: list[Diagnostic]) -> Iterator[Pack]:
    before = len(problems)
    manifest = _manifest(folder / MANIFEST, problems)
    files = [PackFile(path, "base") for path in sorted(folder.glob("*.lp"))]
    for name, stage in FOLDERS.items():
        files += (PackFile(path, stage) for path in sorted((folder / name).glob("*.lp")))
    problems += _stray(folder)
    if manifest is not None and len(problems) == before:
        yield Pack(manifest.name, folder, tuple(files), manifest)


def _stray(folder: Path) -> Iterator[Diagnostic]:
    """Yield an error for each folder with rules that is not named after a stage."""
    for each in sorted(folder.iterdir()):
        if each.is_dir() and each.name not in (*FOLDERS, *_OTHERS) and any(each.glob("*.lp")):
            known = suggestion(each.name, FOLDERS, f"one of {', '.join(FOLDERS)}")
            message = f"the rules in `{each.name}` belong to no stage"
            yield Diagnostic(_CODE, "error", message, whole_file(str(each)), help=known)


def _manifest(path: Path, problems: list[Diagnostic]) -> Manifest | None:
    shown = str(path)
    try:
        text = decode(read_bytes(path, _MOST_BYTES), shown, _MOST_BYTES).replace("\r\n", "\n")
        tables = read_tables(text, shown, _CODE)
    except MarsError as error:
        problems += error.diagnostics
        return None
    reader = _ManifestReader(text, shown)
    manifest = reader.manifest(tables)
    problems += reader.problems
    return None if reader.problems else manifest


class _ManifestReader:
    """Reads one manifest, and notes the errors in it."""

    def __init__(self, text: str, shown: str) -> None:
        self._places = Places(text, shown)
        self.problems: list[Diagnostic] = []

    def manifest(self, tables: Mapping[str, Any]) -> Manifest:
        """Return the manifest in the tables; only valid without problems."""
        self._add_unknown_keys(tables, _KEYS, "a manifest")
        name = self._read_text(tables, "name", _NAME, "small letters, digits and `-`", ())
        if name == _OURS:
            self._add_error(f"`{_OURS}` is the name of this program", "choose another name", "name")
        version = self._read_text(tables, "version", _VERSION, "numbers with dots, as 1.0", ())
        summary = tables.get("summary", "")
        if not isinstance(summary, str):
            self._add_error("`summary` must be a text", None, "summary")
        needs = tuple(filter(None, self._needs(tables.get("needs", []))))
        nodes = tables.get("node", [])
        if not isinstance(nodes, list) or not all(isinstance(each, dict) for each in nodes):
            self._add_error("`node` must be tables", "write `[[node]]`", "node")
            nodes = []
        if len(nodes) > _MOST_LISTED:
            self._add_error(f"there are more than {_MOST_LISTED} kinds of nodes", None, "node")
            nodes = []
        kinds = tuple(self._kind(each, number, name) for number, each in enumerate(nodes))
        place = self._places.of("name")
        return Manifest(name, version, needs, kinds, place, str(summary))

    def _kind(self, table: Mapping[str, Any], number: int, pack: str) -> PackKind:
        at = ("node", number)
        self._add_unknown_keys(table, tuple(_NODE_KEYS), "a kind of node", at)
        kind = self._read_text(table, "kind", _KIND, "small letters, digits and `_`", at)
        name = self._read_text(table, "name", _NODE_NAME, "letters, the first of them large", at)
        if kind in NODE_NAMES or name in NODE_NAMES.values():
            message = f"`{kind if kind in NODE_NAMES else name}` is a kind of node already"
            self._add_error(message, "choose another name", *at, "kind")
        entries = {key: table.get(key) for key, choices in _NODE_KEYS.items() if choices}
        for key, value in entries.items():
            choices = _NODE_KEYS[key]
            is_needed = key in ("carries", "inputs", "outputs")
            if (value is not None or is_needed) and value not in choices:
                written = "is missing" if value is None else f"is {value!r}"
                self._add_error(f"`{key}` {written}", f"one of {', '.join(choices)}", *at, key)
        colour = table.get("colour")
        if colour is not None and not (isinstance(colour, str) and re.fullmatch(_COLOUR, colour)):
            self._add_error(f"`colour` is {colour!r}", "write it as `#1f77b4`", *at, "colour")
        return PackKind(
            kind,
            name,
            str(entries["carries"]),
            str(entries["inputs"]),
            str(entries["outputs"]),
            None if colour is None else str(colour),
            entries["behaviour"] != "none",
            self._places.of(*at),
            pack,
        )

    def _needs(self, needs: object) -> Iterator[Requirement | None]:
        if isinstance(needs, list) and len(needs) > _MOST_LISTED:
            self._add_error(f"`needs` lists more than {_MOST_LISTED} packs", None, "needs")
            return
        if not isinstance(needs, list):
            self._add_error(
                "`needs` must be a list", 'write `needs = ["mars-asp >= 0.1"]`', "needs"
            )
            return
        for number, each in enumerate(needs):
            match = re.fullmatch(_NEED, each.strip()) if isinstance(each, str) else None
            if match is None:
                advice = 'write a name, or a name and a version: "redundancy >= 1.0"'
                self._add_error(f"{each!r} is not what a pack needs", advice, "needs", number)
            else:
                place = self._places.of("needs", number)
                yield Requirement(match[1], match[2] or "", match[3] or "", place)

    def _read_text(
        self,
        table: Mapping[str, Any],
        key: str,
        form: str,
        made_of: str,
        at: tuple[str | int, ...],
    ) -> str:
        value = table.get(key)
        if value is None:
            self._add_error(f"`{key}` is missing", f'write `{key} = "..."`', *at)
        elif not isinstance(value, str) or not re.fullmatch(form, value):
            self._add_error(f"`{key}` is {value!r}", f"write it in {made_of}", *at, key)
        return str(value)

    def _add_unknown_keys(
        self,
        table: Mapping[str, Any],
        keys: Sequence[str],
        what: str,
        at: tuple[str | int, ...] = (),
    ) -> None:
        for key in table:
            if key not in keys:
                known = suggestion(key, keys, f"one of {', '.join(keys)}")
                self._add_error(f"`{key}` is not a key of {what}", known, *at, key)

    def _add_error(self, message: str, advice: str | None, *key: str | int) -> None:
        place = self._places.of(*key)
        self.problems.append(Diagnostic(_CODE, "error", message, place, help=advice))


def _wrong_together(packs: Sequence[Pack]) -> Iterator[Diagnostic]:
    """Yield errors for duplicate packs or kinds, and for unmet requirements."""
    named = {each.manifest.name: each.manifest for each in packs if each.manifest is not None}
    first: dict[str, Span] = {}
    for manifest in (pack.manifest for pack in packs if pack.manifest is not None):
        names = [(f"pack `{manifest.name}`", manifest.span)]
        names += [(f"kind of node `{kind.kind}`", kind.span) for kind in manifest.kinds]
        names += [(f"name of a node `{kind.name}`", kind.span) for kind in manifest.kinds]
        for what, place in names:
            earlier = first.setdefault(what, place)
            if earlier != place:
                message = f"the {what} is there twice"
                yield Diagnostic(_CODE, "error", message, place, ((earlier, "first here"),))
        for need in manifest.needs:
            there = __version__ if need.name == _OURS else None
            if need.name in named:
                there = named[need.name].version
            if there is None:
                message = f"pack `{manifest.name}` needs `{need.name}`, which is not given"
                found = f"`test`, `rules lint` and `rules doc` find `../{need.name}` themselves"
                advice = f"also give its folder with `--rules`; {found}"
                yield Diagnostic(_CODE, "error", message, need.span, help=advice)
            elif not _suffices(there, need):
                needed = f"{need.comparison} {need.version}"
                message = f"pack `{manifest.name}` needs `{need.name}` {needed}, this is {there}"
                yield Diagnostic(_CODE, "error", message, need.span)


def _suffices(version: str, need: Requirement) -> bool:
    if not need.comparison:
        return True
    there, needed = (_version_parts(each) for each in (version, need.version))
    return {">=": there >= needed, "==": there == needed, "<": there < needed}[need.comparison]


def _version_parts(version: str) -> tuple[int, ...]:
    parts = [int(each) for each in re.findall(r"[0-9]+", version)]
    while parts and not parts[-1]:
        parts.pop()
    return tuple(parts)
