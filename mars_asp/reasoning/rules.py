"""The built-in rules: their location, their stages, and the limits for foreign rule packs."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from mars_asp.asp.cache import digest, memoized
from mars_asp.asp.rules import checks
from mars_asp.asp.rules.checks import Seal
from mars_asp.asp.rules.declarations import Documented
from mars_asp.asp.rules.metadata import file_name, repeated_ids
from mars_asp.asp.rules.namespaces import apart
from mars_asp.asp.rules.read import NameSpace, read_file, with_unique_ids, wrong_packs
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import constant_names, defined
from mars_asp.asp.signature import Signature
from mars_asp.asp.solve.atoms import Atom
from mars_asp.diagnostic import Diagnostic, MarsError, Span
from mars_asp.model.declarations import NODE_NAMES, PackKind
from mars_asp.reasoning import findings
from mars_asp.reasoning.attributes import AttributeKind, attribute_kinds, wrong_kinds
from mars_asp.reasoning.facts.compile import CONSTANTS
from mars_asp.reasoning.findings import CONTRACT, EXPANSIONS
from mars_asp.reasoning.packs import Pack, find_packs, kinds_of

#: What the rules of the base, in `rules/*.lp`, are for.
BASE = "what follows from a configuration: its consequences, each with its reason"
#: The stages after the base by the names of their folders, with the purpose of each.
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
    "launch": "which faults launch trees have",
}
#: For a stage, the next one, which reads its decisions and is always loaded with it.
FOLLOWING: Mapping[str, str] = {"resolve": "specify"}

#: For each stage in which packs have rules, the stages whose predicates these can read.
SEES: Mapping[str, frozenset[str]] = {
    "base": frozenset({"base"}),
    "resolve": frozenset({"base", "resolve"}),
    "specify": frozenset({"base", "resolve", "specify"}),
    "verify": frozenset({"base", "verify"}),
    "run": frozenset({"run"}),
    "repair": frozenset({"base", "repair"}),
}
#: Facts of the configuration for rules about runs, besides attributes of modules.
GIVEN_TO_RUNS = (Signature("class", 2), Signature("guard", 1))
#: For the stage of a file, the stages in which packs can derive its extensible predicates.
EXTENDED_IN: Mapping[str, tuple[str, ...]] = {
    "base": ("base", "run"),
    "repair": ("base", "repair"),
    **{stage: (stage,) for stage in ("resolve", "specify", "verify", "run")},
}

#: The levels of the minimisation in `rules/resolve` and `rules/cost`, the highest first.
NODES, CONVERSION, RELATIONSHIPS = 30, 20, findings.LEAST_COST
#: The level of each cost, by the names that users know.
COSTS: Mapping[str, int] = {
    "nodes": NODES,
    "conversion": CONVERSION,
    "relationships": RELATIONSHIPS,
}


def by_name(cost: Mapping[int, int]) -> dict[str, int]:
    """Return the cost by level with the names of levels as keys."""
    return {name: cost.get(level, 0) for name, level in COSTS.items()}


class _RuleText(NamedTuple):
    """A built-in file: its path, its shown name, and its stage."""

    path: Path
    shown: str
    stage: str


class _Read(NamedTuple):
    """The content of a built-in file; empty if it cannot be read, with the `problems`."""

    text: str
    rules: tuple[Rule, ...]
    documented: Documented
    problems: tuple[Diagnostic, ...]


def rules_directory() -> Path:
    """Return the folder of the built-in rules: next to the source tree, else in the package."""
    here = Path(__file__).resolve().parents[1]
    beside = here.parent / "rules"
    return beside if (beside / "vocabulary.lp").is_file() else here / "rules"


def load_rulebook(
    extra: Sequence[Path] = (),
    stages: Collection[str] = ("resolve",),
    strict: bool = False,
    trusted: bool = False,
    noted: list[Diagnostic] | None = None,
) -> Rulebook:
    """Return the built-in rules of the base and of `stages`, and the rules of the packs `extra`.

    Stages that always follow these are read as well. `strict` also checks the variables in built-in
    messages. Packs that are `trusted` may rank their minimisation above nodes, conversions and
    lines. If `noted` is a list, errors are added to it, and the readable rules are returned.

    Raises:
        MarsError: files that cannot be read or break the limits for packs, wrong metadata, and
            packs that derive or redefine predicates of other name spaces.

    >>> load_rulebook().by_id["data/divergence"].because
    '`{S}` delivers data to {N} receivers{T}'
    """
    problems: list[Diagnostic] = []
    following = (FOLLOWING[stage] for stage in stages if stage in FOLLOWING)
    wanted = tuple(dict.fromkeys((*stages, *following)))
    own = _built_in(wanted, strict, problems)
    packs = find_packs(extra, problems)
    if problems:
        # Errors in packs as such make messages about their rules wrong.
        raise MarsError(problems)
    spaces = tuple(_name_space(pack, problems) for pack in packs)
    attributes: tuple[AttributeKind, ...] = ()
    if spaces:
        # Only rules about runs see the facts of a run.
        stages = {*SEES} - {"run"} | {file.stage for space in spaces for file in space.files}
        sealed = seal().for_stages(stages)
        attributes = attribute_kinds(spaces, sealed, problems)
        own_names = {each.declaration.signature: each.predicate for each in attributes}
        taken = (file_name(path, at) for path, (at, _) in zip(own.paths, own.texts, strict=True))
        spaces = tuple(with_unique_ids(spaces, taken))
        problems += wrong_kinds(attributes, spaces, sealed)
        contract = replace(CONTRACT, trusted=trusted)
        problems += wrong_packs(spaces, sealed.without(own_names), contract)
        spaces = tuple(apart(spaces, sealed, own_names))
    if strict:
        problems += repeated_ids(own.rules)
    if problems and noted is None:
        raise MarsError(problems)
    if noted is not None:
        noted += problems
    if not packs:
        return own
    every = (file for space in spaces for file in space.files)
    files = [file for file in every if file.stage in ("base", *wanted)]
    rules = tuple(rule for file in files for rule in file.rules)
    kinds = kinds_of(packs)
    declared = tuple(map(_kind_rule, kinds))
    return Rulebook(
        (*own.rules, *declared, *rules),
        (
            *own.texts,
            *((rule.stage, rule.text) for rule in declared),
            *((f.stage, f.text) for f in files),
        ),
        len(files),
        len(rules),
        (*own.paths, *(r.span.path for r in declared), *(file.shown for file in files)),
        (
            *own.documented,
            *(Documented(rule.stage, rule.span.path, ()) for rule in declared),
            *(file.documented for file in files),
        ),
        (*kinds, *attributes),
        ((next(iter(NODE_NAMES)), tuple(kind.kind for kind in kinds)),) if kinds else (),
    )


def brought_by(extra: Iterable[Path]) -> tuple[object, ...]:
    """Return the kinds of nodes and the attributes that rule packs declare.

    Raises:
        MarsError: files that cannot be read, and attributes that are declared in two ways.
    """
    problems: list[Diagnostic] = []
    packs = find_packs(extra, problems)
    spaces = tuple(_name_space(pack, problems) for pack in packs)
    brought = (*kinds_of(packs), *attribute_kinds(spaces, seal(), problems))
    if problems:
        raise MarsError(problems)
    return brought


def _name_space(pack: Pack, problems: list[Diagnostic]) -> NameSpace:
    """Return the rules in the readable files of a pack."""
    read = (
        read_file(file.path, str(file.path), file.stage, problems, True, EXPANSIONS)
        for file in pack.files
    )
    needs = None if pack.manifest is None else frozenset(n.name for n in pack.manifest.needs)
    return NameSpace(pack.name, tuple(filter(None, read)), needs)


def _kind_rule(kind: PackKind) -> Rule:
    """Return the fact that declares a kind of node, located in the manifest."""
    declared = kind.kind, kind.carries, kind.inputs, kind.outputs
    atom = Atom("node_kind", tuple(map(Atom, declared)))
    name = f"{kind.span.path}:{kind.span.line}"
    return Rule(name, None, None, kind.span, f"{atom}.", "base")


def _built_in(stages: Collection[str], strict: bool, problems: list[Diagnostic]) -> Rulebook:
    """Return the built-in rules, newly read and checked if `strict`; add errors to `problems`."""
    files = tuple(_built_in_files(stages))
    if strict:
        rulebook, found = _rulebook_of(files, [_read_rules(file, strict) for file in files])
    else:
        rulebook, found = _unchanged(files, tuple(_state(file.path) for file in files))
    problems += found
    return rulebook


@lru_cache(maxsize=32)
def _unchanged(
    files: tuple[_RuleText, ...], states: tuple[object, ...]
) -> tuple[Rulebook, Sequence[Diagnostic]]:
    """Return the rules of files in certain states, with their errors.

    Whatever a rulebook has computed is kept for the next command in this process.
    """
    return _rulebook_of(files, _made(files))


def _state(path: Path) -> tuple[int, ...]:
    try:
        status = path.stat()
    except OSError:  # the reader reports the error
        return ()
    return status.st_mtime_ns, status.st_size, status.st_ino


def _rulebook_of(
    files: Sequence[_RuleText], read: Sequence[_Read]
) -> tuple[Rulebook, Sequence[Diagnostic]]:
    """Return the rules of the files that could be read, and the errors of the others."""
    problems = [problem for each in read for problem in each.problems]
    whole = [(file, each) for file, each in zip(files, read, strict=True) if not each.problems]
    rulebook = Rulebook(
        tuple(rule for _, each in whole for rule in each.rules),
        tuple((file.stage, each.text) for file, each in whole),
        paths=tuple(file.shown for file, _ in whole),
        documented=tuple(each.documented for _, each in whole),
    )
    return rulebook, problems


def seal() -> Seal:
    """Return the predicates, constants and rule identifiers of the built-in rules of all stages."""
    folders = (folder for folder in sorted(rules_directory().iterdir()) if folder.is_dir())
    files = _built_in_files(folder.name for folder in folders)
    read = _made(files)
    texts = {digest(each.text.encode()): each.text for each in read}
    named = memoized("named", _makers(), texts, lambda key: _declared_names(texts[key]))
    derived: dict[Signature, set[str]] = {}
    given: dict[Signature, set[str]] = {}
    ids: dict[str, Span] = {}
    constants, public = set(CONSTANTS), set[Signature]()
    extensible: dict[Signature, set[str]] = {}
    for file, each in zip(files, read, strict=True):
        for rule in each.rules:
            for head in rule.heads:
                derived.setdefault(head, set()).add(file.stage)
            ids[rule.id] = rule.span
        own, names = named[digest(each.text.encode())]
        for signature in own:
            given.setdefault(signature, set()).add(file.stage)
        constants |= names
        for one in each.documented.declarations:
            if one.public:
                public.add(one.signature)
            if one.extensible:
                extensible.setdefault(one.signature, set()).update(EXTENDED_IN[file.stage])
    for signature in GIVEN_TO_RUNS:
        given[signature].add("run")
    return Seal(
        _frozen(derived),
        _frozen(given),
        frozenset(constants),
        ids,
        _frozen(extensible),
        SEES,
        frozenset(public),
    )


def _frozen(found: Mapping[Signature, set[str]]) -> dict[Signature, frozenset[str]]:
    return {signature: frozenset(stages) for signature, stages in found.items()}


def _made(files: Iterable[_RuleText]) -> list[_Read]:
    """Return the content of built-in files, from the table that the build made if it is current."""
    keys = {(file.shown, file.stage, _digest(file.path)): file for file in files}
    return list(
        memoized("rules", _makers(), keys, lambda key: _read_rules(keys[key], False)).values()
    )


def _digest(path: Path) -> bytes:
    try:
        return digest(path.read_bytes())
    except OSError:  # the reader reports the error
        return b""


def _read_rules(file: _RuleText, strict: bool) -> _Read:
    problems: list[Diagnostic] = []
    read = read_file(*file, problems, strict, EXPANSIONS)
    if read is None:
        return _Read("", (), Documented(file.stage, file.shown, ()), tuple(problems))
    return _Read(read.text, read.rules, read.documented, ())


def _declared_names(text: str) -> tuple[tuple[Signature, ...], frozenset[str]]:
    """Return the predicates that a text declares, and the names of its constants."""
    return tuple(sorted(defined(text))), frozenset(constant_names(text))


def is_rule_base(path: Path) -> bool:
    """Whether a path is the folder of the built-in rules, a copy of it, or in it."""
    root = rules_directory()
    if path.resolve().is_relative_to(root.resolve()):
        return True
    pairs = ((path / each.relative_to(root), each) for each in root.rglob("*.lp"))
    return all(one.is_file() and one.read_bytes() == own.read_bytes() for one, own in pairs)


def _built_in_files(stages: Iterable[str]) -> list[_RuleText]:
    """Return the built-in files of the base and of stages."""
    root = rules_directory()
    folders = [(root, "base"), *((root / name, name) for name in stages)]
    found = [(path, stage) for folder, stage in folders for path in sorted(folder.glob("*.lp"))]
    return [_RuleText(path, f"rules/{path.relative_to(root).as_posix()}", at) for path, at in found]


def _makers() -> list[Path]:
    own = (Path(__file__), Path(findings.__file__))
    return sorted((*own, *Path(checks.__file__).parent.glob("*.py")))
