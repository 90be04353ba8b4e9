"""Finds case files, and runs their cases with the rules."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import chain
from pathlib import Path

import clingo

from mars_asp.asp.cases.expectations import ANY, CODE, Block, ExpectedAtom, blocks_of
from mars_asp.asp.cases.outcomes import Check, FoundAnswer, Outcome, judged, rewritten
from mars_asp.asp.fragments import Fragment, able_to_fire, joined, refusals
from mars_asp.asp.messages import heard, predicate_of, saying
from mars_asp.asp.rules.arithmetic import telling, wrapped
from mars_asp.asp.rules.read import read_case
from mars_asp.asp.rules.rule import Rule
from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.rules.statements import Piece
from mars_asp.asp.rules.statements import shown as shows
from mars_asp.asp.signature import SPACE, Signature, plain, signature_of
from mars_asp.asp.solve.term_ids import as_term
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.spelling import suggestion

#: The stage name for messages of cases.
_STAGE = "case"
#: The beginning of an expectation, as in `expectations.py`.
_EXPECTED = re.compile(r"(?m)^[ \t]*%(?:[=>~]|(?:only|has|not|case):)")
#: A name in rules, as a group; a string matches as well, whose words are not names.
_WORD = re.compile(r'"(?:[^"\\]|\\.)*"|([a-z][\w\']*)')
_MOST_ANSWERS = 100
_MOST_MESSAGES = 10_000


def find_cases(paths: Iterable[Path], packs: Iterable[Path] = ()) -> tuple[Path, ...]:
    """Return the case files at some paths, those of folders sorted by name.

    In a folder, these are the files that have an expectation and do not belong to the rule packs.
    """
    rules = {path.resolve() for path in packs}
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            held = sorted(path.rglob("*.lp"))
            held = [p for p in held if not {p.resolve(), p.resolve().parent} & rules]
            found += filter(_states_expectation, held)
        else:
            found.append(path)
    return tuple(found)


def _states_expectation(path: Path) -> bool:
    try:
        return _EXPECTED.search(path.read_text(encoding="utf-8")) is not None
    except (OSError, UnicodeDecodeError):
        # The error is reported when the file is run.
        return True


def stages_of(path: Path, stages: Collection[str]) -> tuple[str, ...]:
    """Return the stages that the folders of a case are named after.

    For a case below the current folder, only folders below the current one count.
    """
    full, here = path.absolute(), Path.cwd()
    parts = full.relative_to(here).parts if full.is_relative_to(here) else full.parts
    return tuple(stage for stage in stages if stage in parts)


def case_texts(path: Path) -> tuple[str, ...]:
    """Return the text of each case of a file; lines keep their numbers.

    Raises:
        MarsError: clingo must not read it, or an expectation cannot be read.
    """
    return tuple(block.text for block in _blocks(path)[0])


def _blocks(path: Path) -> tuple[tuple[Block, ...], tuple[Piece, ...], str]:
    """Return the cases of a file, its statements, and its text.

    Raises:
        MarsError: clingo must not read it, or an expectation cannot be read.
    """
    text, written = read_case(path)
    problems: list[Diagnostic] = []
    blocks = blocks_of(text, str(path), problems)
    if problems:
        raise MarsError(problems)
    return blocks, written, text


def run_case(
    path: Path, rulebook: Rulebook, stages: Collection[str], finding: Signature
) -> Outcome:
    """Run the cases of a file with the rules of the base and of `stages`.

    `finding` is the predicate that `%=` compares if a case shows none.

    Raises:
        MarsError: clingo must not read a case, or an expectation cannot be read.
    """
    blocks, written, text = _blocks(path)
    problems = tuple(_unknown(blocks, written, rulebook, finding))
    if problems:
        raise MarsError(problems)
    answers = {
        block: _answers(block, _of_block(written, block, blocks), rulebook, stages, finding)
        for block in blocks
    }
    checks = (Check(each.title, each.span, judged(each, answers[each])) for each in blocks)
    updated = rewritten(text, blocks, answers, _own_sorts(rulebook, finding))
    return Outcome(path, tuple(checks), updated if updated != text else None)


def _unknown(
    blocks: Iterable[Block], written: Iterable[Piece], rulebook: Rulebook, finding: Signature
) -> Iterator[Diagnostic]:
    """Yield an error for each expected predicate or kind of finding that no rule can derive.

    Those of `%has:`, `%not:` and `%only:` count: a case that excludes such an atom cannot fail.
    """
    known = {Signature(plain(each.name), each.arity) for each in rulebook.declarations}
    known |= {Signature(plain(h.name), h.arity) for rule in rulebook.rules for h in rule.heads}
    rules = (piece.text for piece in written if piece.sort != "comment")
    here = {word for text in rules for word in _WORD.findall(text)}
    # What is not documented is internal, and as a suggestion would only mislead.
    own = rulebook.rules[len(rulebook.rules) - rulebook.pack_rules :]
    named = {*rulebook.declarations, *(head for rule in own for head in rule.heads)}
    names = here | {plain(each.name) for each in named}
    makers = [rule for rule in rulebook.rules if finding in rule.heads]
    is_open = finding.name in here or any(finding not in rule.firsts for rule in makers)
    kinds = {kind for rule in makers for kind in rule.firsts.get(finding, ())}
    for atom in chain.from_iterable(e.atoms for b in blocks for e in b.of("has", "not", "only")):
        signature = signature_of(atom.pattern).unsigned
        first = next(iter(atom.pattern.arguments), ANY)
        if signature.name not in here and signature not in known:
            others = sorted(str(each) for each in known if each.name == signature.name)
            advice = (
                f"there is `{others[0]}`" if others else suggestion(signature.name, names, None)
            )
            yield _cannot_hold(f"no rule derives `{signature}`", atom, advice)
        elif signature == finding and not is_open and first != ANY and str(first) not in kinds:
            advice = suggestion(str(first), kinds, None)
            yield _cannot_hold(f"no rule finds the kind `{first}`", atom, advice)


def _cannot_hold(message: str, atom: ExpectedAtom, advice: str | None) -> Diagnostic:
    return Diagnostic(CODE, "error", message, atom.span, help=advice)


def _own_sorts(rulebook: Rulebook, finding: Signature) -> Sequence[str] | None:
    """Return patterns of the atoms that packs derive: their predicates and kinds of findings.

    They are None without packs, or if a pack derives a finding whose kind is a variable.
    """
    own = rulebook.rules[len(rulebook.rules) - rulebook.pack_rules :]
    if not rulebook.packs or any(finding in r.heads and finding not in r.firsts for r in own):
        return None
    kinds = {kind for rule in own for kind in rule.firsts.get(finding, ())}
    found = [
        f"{finding.name}({','.join([kind, *'_' * (finding.arity - 1)])})" for kind in sorted(kinds)
    ]
    others = sorted({head for rule in own for head in rule.heads} - {finding})
    found += [
        f"{plain(s.name)}({','.join('_' * s.arity)})" if s.arity else plain(s.name) for s in others
    ]
    return found


def _of_block(
    written: Iterable[Piece], block: Block, blocks: Sequence[Block]
) -> tuple[Signature, ...]:
    """Return the predicates in the `#show` lines of a block."""
    if len(blocks) > 1:
        lines = block.text.split("\n")
        written = (piece for piece in written if lines[piece.begin[0] - 1])
    return tuple(each for piece in written if piece.sort == "shown" for each in shows(piece.text))


def _answers(
    block: Block,
    wanted: Sequence[Signature],
    rulebook: Rulebook,
    stages: Collection[str],
    finding: Signature,
) -> tuple[FoundAnswer, ...]:
    """Return the answer sets of a case, only optimal ones if something is minimised.

    `wanted` are the predicates that `%=` compares.

    Raises:
        MarsError: clingo refuses the program, or an operation has no value.
    """
    wanted, stages = wanted or (finding,), ("base", *stages)
    messages, exact = block.of(">"), bool(block.of("="))
    speakers = [r for r in rulebook.rules if messages and r.because and r.stage in stages]
    if exact:
        speakers = [rule for rule in speakers if rule.heads.intersection(wanted)]
    program = [Fragment(rulebook.as_named(block.text), block.span.path)]
    program += [fragment for stage in stages for fragment in rulebook.fragments(stage)]
    program += saying(_STAGE, speakers)
    checked = rulebook.arithmetic
    program += [Fragment(telling(at, each), "rules", each.span) for at, each in enumerate(checked)]
    control = _grounded(able_to_fire(program))
    overflowing = tuple(wrapped(control, checked))
    if overflowing:
        raise MarsError(overflowing)
    with_atoms = bool(block.of("has", "not", "only"))
    return _solved(control, wanted, speakers, bool(block.of("~")), with_atoms)


def _grounded(program: Sequence[Fragment]) -> clingo.Control:
    """Return a control with a grounded program.

    Raises:
        MarsError: clingo refuses it, or an operation has no value.
    """
    entries: list[tuple[clingo.MessageCode, str]] = []
    options = ["--opt-mode=optN", f"--models={_MOST_ANSWERS}", "--warn=no-atom-undefined"]
    control = clingo.Control(
        options, lambda code, note: entries.append((code, note)), _MOST_MESSAGES
    )
    reason = ""
    try:
        control.add("base", [], joined(program))
        control.ground()
    except RuntimeError as error:
        reason = str(error)
    undefined = clingo.MessageCode.OperationUndefined
    wrong = [note for code, note in entries if reason or code == undefined]
    if reason or wrong:
        place = whole_file(program[0].path)
        whole = Diagnostic("rules-refused", "error", f"clingo refuses this: {reason}", place)
        raise MarsError(tuple(refusals(wrong, program)) or (whole,))
    return control


def _solved(
    control: clingo.Control,
    wanted: Sequence[Signature],
    speakers: Sequence[Rule],
    with_costs: bool,
    with_atoms: bool,
) -> tuple[FoundAnswer, ...]:
    found: dict[tuple[str, ...], FoundAnswer] = {}

    def keep(model: clingo.Model) -> None:
        if model.cost and not model.optimality_proven:
            return
        atoms = model.symbols(atoms=True)
        compared = {plain(str(a)) for a in atoms if _signature(a) in wanted}
        rendered = (heard(as_term(a), speakers) for a in atoms if a.name == predicate_of(_STAGE))
        entries = {f"%> {each.rule.id}: {each.message}" for each in rendered}
        levels = zip(model.cost, model.priority, strict=True)
        cost = " ".join(["%~", *(f"{cost}@{level}" for cost, level in levels if cost)])
        compared |= entries | ({cost} if with_costs else set())
        key = tuple(sorted(compared))
        kept = tuple(a for a in atoms if with_atoms and not a.name.startswith("_"))
        # With atoms requested, answer sets that agree in the compared ones can differ in others.
        found[(*key, *sorted(map(str, kept)))] = FoundAnswer(key, kept, frozenset(entries), cost)

    control.solve(on_model=keep)
    return tuple(found[key] for key in sorted(found))


def _signature(symbol: clingo.Symbol) -> Signature:
    """Return the predicate of an atom as its pack names it."""
    signature = signature_of(symbol)
    return signature._replace(name=plain(signature.name)) if SPACE in signature.name else signature
