"""The rules of MARS: where they are, their stages, and what packs of others may do beside them."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import digest, made_of
from mars_asp.asp.rules import checks
from mars_asp.asp.rules.checks import Seal
from mars_asp.asp.rules.declarations import Documented
from mars_asp.asp.rules.metadata import file_name, repeated_ids
from mars_asp.asp.rules.read import RuleFile, pack_files, read_file, told_apart, wrong_packs
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import constant_names, defined
from mars_asp.asp.signature import Signature
from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.reasoning import findings
from mars_asp.reasoning.facts.compile import CONSTANTS
from mars_asp.reasoning.findings import CONTRACT, EXPANSIONS

#: What the rules of the base, in `rules/*.lp`, are for.
BASE = "what follows from a configuration: its consequences, each with its reason"
#: The stages behind the base by the names of their folders, and what each is for.
STAGES: Mapping[str, str] = {
    "resolve": "which nodes and lines the cheapest specification has",
    "specify": (
        "what a resolution means: its nodes, what each is there for, the lines between them, and "
        "what each states"
    ),
    "account": (
        "the sentences about each consequence and node, and the lines of files that they rest on"
    ),
    "verify": "whether a specification realises its configuration, clause by clause",
    "cost": "what a specification costs as it is written",
    "run": "what must hold while a specification runs, and what a scenario asks for",
    "can": "what a robot is able to do at one time",
    "repair": "which edits of a configuration remove what is wrong with it",
    "absence": "why there is no consequence or node of a kind, and what would give one",
}
#: Of a stage, the one that reads what it decides, and without which nobody asks for it.
FOLLOWING: Mapping[str, str] = {"resolve": "specify"}

#: The levels of the minimisation in `rules/resolve` and `rules/cost`, the highest first.
NODES, CONVERSION, RELATIONSHIPS = 30, 20, 10
#: What is counted on each level, by the names that users know.
COSTS: Mapping[str, int] = {
    "nodes": NODES,
    "conversion": CONVERSION,
    "relationships": RELATIONSHIPS,
}


def by_name(cost: Mapping[int, int]) -> dict[str, int]:
    """Return what something costs, level by level, by the names that users know."""
    return {name: cost.get(level, 0) for name, level in COSTS.items()}


class _File(NamedTuple):
    """A built-in file: where it is, how that is shown, and its stage."""

    path: Path
    shown: str
    stage: str


class _Read(NamedTuple):
    """What a built-in file holds; nothing where `problems` say that it cannot be read."""

    text: str
    rules: tuple[Rule, ...]
    documented: Documented
    problems: tuple[Diagnostic, ...]


def rules_directory() -> Path:
    """Return where the built-in rules are: beside the source tree, else in the package."""
    here = Path(__file__).resolve().parents[1]
    beside = here.parent / "rules"
    return beside if (beside / "vocabulary.lp").is_file() else here / "rules"


def load_rulebook(
    extra: Sequence[Path] = (),
    stages: Collection[str] = ("resolve",),
    strict: bool = False,
    noted: list[Diagnostic] | None = None,
) -> Rulebook:
    """Read the built-in rules of the base and of `stages`, and rule packs from elsewhere.

    The stage that follows one of them is read, too. The holes of the built-in messages are checked
    only when `strict`: the tests have done so. Where `noted` is given, it gets what is wrong, and
    what can be read is returned.

    Raises:
        MarsError: files that cannot be read, that the gate refuses, or whose metadata is wrong, and
            packs that derive or mean what is not theirs.
    """
    problems: list[Diagnostic] = []
    following = (FOLLOWING[stage] for stage in stages if stage in FOLLOWING)
    own = _built_in(tuple(dict.fromkeys((*stages, *following))), strict, problems)
    packs: list[RuleFile] = []
    for path in pack_files(extra, problems):
        found = read_file(path, str(path), "base", problems, True, EXPANSIONS)
        if found is not None:
            packs.append(found)
    if packs:
        taken = (file_name(path, at) for path, (at, _) in zip(own.paths, own.texts, strict=True))
        packs = list(told_apart(packs, taken))
        problems += wrong_packs(packs, seal(), CONTRACT)
    if strict:
        problems += repeated_ids(own.rules)
    if problems and noted is None:
        raise MarsError(problems)
    if noted is not None:
        noted += problems
    if not packs:
        return own
    rules = tuple(rule for pack in packs for rule in pack.rules)
    return Rulebook(
        (*own.rules, *rules),
        (*own.texts, *((pack.stage, pack.text) for pack in packs)),
        len(packs),
        len(rules),
        (*own.paths, *(pack.shown for pack in packs)),
        (*own.documented, *(pack.documented for pack in packs)),
    )


def _built_in(stages: Collection[str], strict: bool, problems: list[Diagnostic]) -> Rulebook:
    """Return the built-in rules; `problems` say what cannot be read of them."""
    files = _files(stages)
    read = [_read(file, strict) for file in files] if strict else _made(files)
    for each in read:
        problems += each.problems
    whole = [(file, each) for file, each in zip(files, read, strict=True) if not each.problems]
    return Rulebook(
        tuple(rule for _, each in whole for rule in each.rules),
        tuple((file.stage, each.text) for file, each in whole),
        paths=tuple(file.shown for file, _ in whole),
        documented=tuple(each.documented for _, each in whole),
    )


def seal() -> Seal:
    """Return what the built-in rules of all stages have for themselves."""
    folders = (folder for folder in sorted(rules_directory().iterdir()) if folder.is_dir())
    files = _files(folder.name for folder in folders)
    read = _made(files)
    named = made_of("named", _makers(), dict.fromkeys(each.text for each in read), _named)
    derived: dict[Signature, str] = {}
    given: dict[Signature, str] = {}
    ids: dict[str, Span] = {}
    constants, extensible = set(CONSTANTS), set[Signature]()
    for file, each in zip(files, read, strict=True):
        for rule in each.rules:
            derived.update((head, file.stage) for head in rule.heads if head not in derived)
            ids[rule.id] = rule.span
        own, names = named[each.text]
        given.update((signature, file.stage) for signature in own if signature not in given)
        constants |= names
        extensible |= {one.signature for one in each.documented.declarations if one.extensible}
    return Seal(derived, given, frozenset(constants), ids, frozenset(extensible))


def _made(files: Iterable[_File]) -> list[_Read]:
    """Return what built-in files hold, as the build has made it where they are the same."""
    keys = {(file.shown, file.stage, _digest(file.path)): file for file in files}
    return list(made_of("rules", _makers(), keys, lambda key: _read(keys[key], False)).values())


def _digest(path: Path) -> bytes:
    try:
        return digest(path.read_bytes())
    except OSError:  # the reader says why
        return b""


def _read(file: _File, strict: bool) -> _Read:
    problems: list[Diagnostic] = []
    read = read_file(*file, problems, strict, EXPANSIONS)
    if read is None:
        return _Read("", (), Documented(file.stage, file.shown, ()), tuple(problems))
    return _Read(read.text, read.rules, read.documented, ())


def _named(text: str) -> tuple[tuple[Signature, ...], frozenset[str]]:
    """Return the predicates that a text declares, and the names of its constants."""
    return tuple(sorted(defined(text))), frozenset(constant_names(text))


def _files(stages: Iterable[str]) -> list[_File]:
    """Return the built-in files of the base and of stages."""
    root = rules_directory()
    folders = [(root, "base"), *((root / name, name) for name in stages)]
    found = [(path, stage) for folder, stage in folders for path in sorted(folder.glob("*.lp"))]
    return [_File(path, f"rules/{path.relative_to(root).as_posix()}", at) for path, at in found]


def _makers() -> list[Path]:
    own = (Path(__file__), Path(findings.__file__))
    return sorted((*own, *Path(checks.__file__).parent.glob("*.py")))
