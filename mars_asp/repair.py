"""The smallest edits that remove a finding: proposed by `rules/repair`, each tried by solving.

>>> for repair in repairs(load_project("config.mars"), load_rulebook(stages=STAGES)):
...     print(repair.consequence.message, [mend.cost for mend in repair.mends])
"""

import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import clingo

from mars_asp.analysis import Analysis, Consequence, analyse, fill, shown
from mars_asp.atom import Fact
from mars_asp.diagnostic import MarsError
from mars_asp.edits import Line, UnknownEditError, apply_edits
from mars_asp.explain import wrong_subject
from mars_asp.facts import facts_text
from mars_asp.project import Project, project_facts
from mars_asp.resolve import Synthesis, synthesise
from mars_asp.rulebook import Rule, Rulebook, consequence_kinds
from mars_asp.solve import Grounding
from mars_asp.spelling import nearest

#: What the rulebook of a repair holds.
STAGES = ("resolve", "repair")
#: Mends are looked for until so many are found, or so many sets of edits were tried.
MOST_MENDS, MOST_TRIED, MOST_EDITS = 5, 60, 3
_EDIT = ("edit", 5)


@dataclass(frozen=True, slots=True)
class Edit:
    """One edit that a rule proposes; `weight` is how much it changes, from 1."""

    term: clingo.Symbol
    message: str
    weight: int
    rule: Rule


@dataclass(frozen=True, slots=True)
class Mend:
    """Edits that together remove a finding, and what the result was when it was solved.

    `warnings` are warnings that were not there before; `errors` counts the errors that are left;
    `synthesis` is the least specification, `None` while errors are left.
    """

    edits: tuple[Edit, ...]
    lines: tuple[Line, ...]
    warnings: tuple[Consequence, ...]
    errors: int
    synthesis: Synthesis | None

    @property
    def cost(self) -> tuple[int, int, int]:
        """Return by what mends are ranked: edits, their weight, new warnings."""
        return len(self.edits), sum(edit.weight for edit in self.edits), len(self.warnings)


@dataclass(frozen=True, slots=True)
class Repair:
    """A finding and the smallest mends of it, best first.

    `tried` of `candidates` sets of edits were solved; `complete` is whether no smaller or equally
    small set was left untried.
    """

    consequence: Consequence
    mends: tuple[Mend, ...]
    tried: int
    complete: bool


def repairs(
    project: Project, rulebook: Rulebook, subject: str | None = None, seconds: float | None = None
) -> tuple[Repair, ...]:
    """Look for mends of every error, or of every warning where there is no error.

    `subject` chooses findings by kind, subject or `kind(subject)` instead. `rulebook` holds the
    stages `STAGES`. After `seconds` what was found so far is returned.

    Raises:
        MarsError: numbers that do not fit, rules that clingo refuses; the subject is no module,
            and no kind of consequence.
    """
    deadline = None if seconds is None else time.monotonic() + seconds
    facts = project_facts(project)
    analysis = analyse(facts, rulebook, project.configuration.span)
    findings = _asked(analysis.consequences, subject)
    if not findings:
        _check_subject(subject, project, rulebook)
        return ()
    proposed = _proposals(facts, rulebook)
    search = _Search(project, rulebook, analysis, deadline)
    return tuple(
        search.repair(finding, proposed.get(_key_of(finding.atom), ())) for finding in findings
    )


def _asked(found: Sequence[Consequence], subject: str | None) -> list[Consequence]:
    if subject is not None:
        names = (subject,)
        return [
            c
            for c in found
            if c.severity != "note"
            and {c.kind, c.subject, f"{c.kind}({c.subject})", *c.participants} & set(names)
        ]
    errors = [c for c in found if c.severity == "error"]
    return errors or [c for c in found if c.severity == "warning"]


def _check_subject(subject: str | None, project: Project, rulebook: Rulebook) -> None:
    """Tell a subject that is sound from one that nothing could be found for."""
    names = {name.text for name in project.configuration.modules}
    kinds = consequence_kinds(rulebook)
    kind, bracket, about = (subject or "").partition("(")
    if subject is None or subject in names | kinds:
        return
    if bracket and kind in kinds and about.removesuffix(")") in names:
        return
    near = nearest(subject, names | kinds)
    raise wrong_subject(
        project,
        f"`{subject}` is no module and no kind of consequence",
        f"did you mean `{near}`?" if near else "write a module, a KIND or `KIND(NAME)`",
    )


def _proposals(
    facts: Iterable[Fact], rulebook: Rulebook
) -> dict[tuple[clingo.Symbol, ...], list[Edit]]:
    """Return the edits that the rules propose for each finding, least first."""
    speakers = [rule for rule in rulebook.rules if _EDIT in rule.heads]
    said = "\n".join(_saying(number, rule) for number, rule in enumerate(speakers))
    text = "\n".join((rulebook.text("base"), rulebook.text("repair"), said))
    grounding = Grounding(text, facts_text(facts))
    found: dict[tuple[clingo.Symbol, ...], dict[clingo.Symbol, Edit]] = {}
    for symbol in sorted(grounding.symbols("_proposed", 3)):
        number, head, values = symbol.arguments
        rule = speakers[number.number]
        *key, term, weight = head.arguments
        named = dict(zip(rule.holes, values.arguments, strict=True))
        message = fill(rule.because, named, shown) or str(term)
        edit = Edit(term, message, weight.number, rule)
        found.setdefault(tuple(key), {}).setdefault(term, edit)
    return {
        key: sorted(edits.values(), key=lambda edit: (edit.weight, edit.rule.span, edit.term))
        for key, edits in found.items()
    }


def _saying(number: int, rule: Rule) -> str:
    body = "; ".join(str(literal) for literal in rule.ast.body)
    return f"_proposed({number},{rule.ast.head},v({','.join(rule.holes)})) :- {body}."


def _key_of(atom: clingo.Symbol) -> tuple[clingo.Symbol, ...]:
    kind, _, subject, case = atom.arguments
    return kind, subject, case


class _Search:
    """Tries sets of edits on one project."""

    def __init__(
        self, project: Project, rulebook: Rulebook, analysis: Analysis, deadline: float | None
    ) -> None:
        self._project = project
        self._rulebook = rulebook
        self._deadline = deadline
        self._before = Counter(map(_name, analysis.consequences))

    def repair(self, finding: Consequence, edits: Sequence[Edit]) -> Repair:
        """Look for mends of one finding, by size and then by weight."""
        mends: list[Mend] = []
        tried = 0
        for size in range(1, MOST_EDITS + 1):
            for chosen in _by_weight(edits, size):
                late = self._deadline is not None and time.monotonic() > self._deadline
                if len(mends) == MOST_MENDS or tried == MOST_TRIED or late:
                    return Repair(finding, _ranked(mends), tried, complete=False)
                tried += 1
                mend = self._try(finding, chosen)
                if mend is not None:
                    mends.append(mend)
            if mends:
                break
        return Repair(finding, _ranked(mends), tried, complete=True)

    def _try(self, finding: Consequence, edits: tuple[Edit, ...]) -> Mend | None:
        """Solve the edited project; return nothing where the finding stays or an error comes."""
        try:
            project, lines = apply_edits(self._project, [edit.term for edit in edits])
            facts = project_facts(project)
            analysis = analyse(facts, self._rulebook, project.configuration.span)
        except (MarsError, UnknownEditError):
            return None
        after = Counter(map(_name, analysis.consequences))
        if after[_name(finding)] >= self._before[_name(finding)]:
            return None
        new = [c for c in analysis.consequences if after[_name(c)] > self._before[_name(c)]]
        if any(c.severity == "error" for c in new):
            return None
        errors = sum(c.severity == "error" for c in analysis.consequences)
        synthesis = None if errors else self._synthesise(project, analysis)
        if not errors and synthesis is None:
            return None
        warnings = tuple(c for c in new if c.severity == "warning")
        return Mend(edits, lines, warnings, errors, synthesis)

    def _synthesise(self, project: Project, analysis: Analysis) -> Synthesis | None:
        left = None if self._deadline is None else max(0.1, self._deadline - time.monotonic())
        try:
            return synthesise(
                project.configuration, project.modules, analysis, self._rulebook, left
            )
        except (MarsError, TimeoutError):
            return None


def _by_weight(edits: Sequence[Edit], size: int) -> Iterator[tuple[Edit, ...]]:
    """Yield the sets of a size, those of least weight first."""
    chosen = combinations(edits, size)
    if size == 1:
        yield from chosen
    else:
        # Of more than a screenful of edits sets would be too many to try anyway.
        yield from sorted(
            combinations(edits[:20], size), key=lambda group: sum(edit.weight for edit in group)
        )


def _ranked(mends: Iterable[Mend]) -> tuple[Mend, ...]:
    return tuple(sorted(mends, key=lambda mend: mend.cost))


def _name(consequence: Consequence) -> tuple[str, str]:
    return consequence.kind, consequence.subject
