"""The rules of MARS: where they are, their stages, and what packs of others may do beside them."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from mars_asp.asp.cache import keep, recall, version_of
from mars_asp.asp.rules import checks
from mars_asp.asp.rules.checks import Seal
from mars_asp.asp.rules.metadata import file_name, repeated_ids
from mars_asp.asp.rules.read import RuleFile, pack_files, read_file, told_apart, wrong_packs
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import Signature, constant_names, declared
from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.reasoning import findings
from mars_asp.reasoning.facts import compile as facts
from mars_asp.reasoning.facts.compile import CONSTANTS
from mars_asp.reasoning.findings import CONTRACT, EXPANSIONS

#: What the rules of the base, in `rules/*.lp`, are for.
BASE = "what follows from a configuration: its consequences, each with its reason"
#: The stages behind the base by the names of their folders, and what each is for.
STAGES: Mapping[str, str] = {
    "resolve": "which nodes and lines the cheapest specification has, and what each is there for",
    "verify": "whether a specification realises its configuration, clause by clause",
    "cost": "what a specification costs as it is written",
    "run": "what must hold while a specification runs, and what a scenario asks for",
    "can": "what a robot is able to do at one time",
    "repair": "which edits of a configuration remove what is wrong with it",
}


def rules_directory() -> Path:
    """Return where the built-in rules are: beside the source tree, else in the package."""
    here = Path(__file__).resolve().parents[1]
    beside = here.parent / "rules"
    return beside if (beside / "vocabulary.lp").is_file() else here / "rules"


def load_rulebook(
    extra: Sequence[Path] = (), stages: Collection[str] = ("resolve",), strict: bool = False
) -> Rulebook:
    """Read the built-in rules of the base and of `stages`, and rule packs from elsewhere.

    The holes of the built-in messages are checked only when `strict`: the tests have done so.

    Raises:
        MarsError: files that cannot be read, that the gate refuses, or whose metadata is wrong, and
            packs that derive or mean what is not theirs.
    """
    problems: list[Diagnostic] = []
    own = _built_in(stages, strict, problems)
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
    if problems:
        raise MarsError(problems)
    if not packs:
        return own
    rules = tuple(rule for pack in packs for rule in pack.rules)
    return Rulebook(
        (*own.rules, *rules),
        (*own.texts, *((pack.stage, pack.text) for pack in packs)),
        len(packs),
        len(rules),
        (*own.paths, *(pack.shown for pack in packs)),
    )


def _built_in(stages: Collection[str], strict: bool, problems: list[Diagnostic]) -> Rulebook:
    """Return the built-in rules, as they were kept while no file has changed."""
    found = _files(stages)
    name = "-".join(("rules", *stages))
    version = _version(found)
    kept: Rulebook | None = None if strict else recall(name, version)
    if kept is not None:
        return kept
    files = []
    for path, shown, stage in found:
        file = read_file(path, shown, stage, problems, strict, EXPANSIONS)
        if file is not None:
            files.append(file)
    rules = tuple(rule for file in files for rule in file.rules)
    texts = tuple((file.stage, file.text) for file in files)
    made = Rulebook(rules, texts, paths=tuple(file.shown for file in files))
    if not problems:
        keep(name, version, made)
    return made


def seal() -> Seal:
    """Return what the built-in rules of all stages have for themselves, kept between commands."""
    found = _files(
        [folder.name for folder in sorted(rules_directory().iterdir()) if folder.is_dir()]
    )
    version = _version(found)
    kept: Seal | None = recall("seal", version)
    if kept is not None:
        return kept
    problems: list[Diagnostic] = []
    derived: dict[Signature, str] = {}
    given: dict[Signature, str] = {}
    ids: dict[str, Span] = {}
    constants = set(CONSTANTS)
    for path, shown, stage in found:
        file = read_file(path, shown, stage, problems, False, EXPANSIONS)
        if file is not None:
            for rule in file.rules:
                derived.update((head, stage) for head in rule.heads if head not in derived)
                ids[rule.id] = rule.span
            given.update((each, stage) for each in declared(file.text) if each not in given)
            constants |= constant_names(file.text)
    made = Seal(derived, given, frozenset(constants), ids)
    if not problems:
        keep("seal", version, made)
    return made


def _files(stages: Iterable[str]) -> list[tuple[Path, str, str]]:
    """Return the built-in files of the base and of stages: path, how it is shown, and stage."""
    root = rules_directory()
    folders = [(root, "base"), *((root / name, name) for name in stages)]
    found = [(path, stage) for folder, stage in folders for path in sorted(folder.glob("*.lp"))]
    return [(path, f"rules/{path.relative_to(root).as_posix()}", stage) for path, stage in found]


def _version(files: Iterable[tuple[Path, str, str]]) -> str:
    hosts = (Path(module.__file__ or "") for module in (facts, findings))
    makers = (*Path(checks.__file__).parent.glob("*.py"), Path(__file__), *hosts)
    return version_of((*sorted(makers), *(path for path, _, _ in files)))
