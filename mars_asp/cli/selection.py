"""The selection of reported findings by options, settings, comments and baselines.

A selection does not affect the rules: a finding that is not reported is still derived, and the
specification stays the same. Options replace the settings of the same name.
"""

import argparse
import os
import shlex
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.cli.deliver import write_file
from mars_asp.cli.ignores import Ignore, ignores_in, ignores_of
from mars_asp.cli.input_codes import ignorable_codes, is_input_error
from mars_asp.cli.inputs import STANDARD_INPUT, check_inputs, workspace_of
from mars_asp.cli.settings import settings_of
from mars_asp.diagnostic import (
    Diagnostic,
    MarsError,
    Severity,
    Span,
    refusal,
    whole_file,
)
from mars_asp.output import counted, visible
from mars_asp.reading import SHOWN_INPUT
from mars_asp.reasoning.analysis import Analysis, Consequence, read_consequences
from mars_asp.reasoning.findings import consequence_kinds, kinds_of
from mars_asp.reasoning.project import Project
from mars_asp.reasoning.rules import load_rulebook
from mars_asp.spelling import nearest

if TYPE_CHECKING:
    from mars_asp.cli.baseline import Baseline, BaselineEntry


class Hidden(NamedTuple):
    """A finding that is not reported, the filter that hides it, and the reason in a comment.

    `is_known` is whether a baseline lists it.
    """

    consequence: Consequence
    by: Literal["comment", "baseline"]
    reason: str
    is_known: bool


class Selected(NamedTuple):
    """The reported and the hidden findings of a file, and remarks on the selection.

    `is_compared` is whether a baseline was used.
    """

    shown: tuple[Consequence, ...]
    hidden: tuple[Hidden, ...] = ()
    remarks: tuple[Diagnostic, ...] = ()
    is_compared: bool = False

    @property
    def has_errors(self) -> bool:
        """Whether a consequence that is shown is an error."""
        return any(consequence.severity == "error" for consequence in self.shown)


class _Choice(NamedTuple):
    """The reported findings in a folder: names to select, names to ignore, a baseline.

    A name is the kind of a finding, or the id of its rule.
    """

    select: frozenset[str] | None
    ignore: frozenset[str]
    baseline: "Baseline | None"

    def has(self, names: tuple[str, ...]) -> bool:
        """Whether findings that have these names are reported."""
        is_selected = self.select is None or not self.select.isdisjoint(names)
        return is_selected and self.ignore.isdisjoint(names)


def hidden_text(hidden: Mapping[str, int]) -> str:
    """Return the sentence with the numbers of hidden findings, by filter."""
    parts = []
    if number := hidden.get("comment", 0):
        parts.append(f"{number} hidden by {'a comment' if number == 1 else 'comments'}")
    if number := hidden.get("baseline", 0):
        parts.append(f"{number} in the baseline")
    return f"not reported: {', '.join(parts)}"


def add_selection(parser: argparse.ArgumentParser, writes: bool = True) -> None:
    """Add the options that select the reported findings; with `writes`, also `--write-baseline`."""
    for option in ("--select", "--ignore"):
        parser.add_argument(option, metavar="NAME,...", type=_kinds, action="extend")
    parser.add_argument("--baseline", metavar="BASELINE")
    if writes:
        parser.add_argument("--write-baseline", metavar="BASELINE")
    else:
        parser.set_defaults(write_baseline=None)


def _selected_notes(numbers: Mapping[str, int], path: str) -> Iterator[Diagnostic]:
    """Yield a note for each selected kind with findings that are only notes."""
    way = visible(shlex.join(["mars-asp", "analyse", "-" if path == SHOWN_INPUT else path]))
    for kind, number in numbers.items():
        message = (
            f"{counted(number, 'finding')} of `{kind}` not reported, as `check` leaves out notes"
        )
        yield Diagnostic("kind", "note", message, whole_file(path), help=f"`{way}` lists them")


def _kinds(text: str) -> list[str]:
    kinds = [kind.strip() for kind in text.split(",") if kind.strip()]
    if not kinds:
        raise argparse.ArgumentTypeError("expected kinds of findings, separated by commas")
    return kinds


class Selection:
    """The selection of a command for all its files; each entry of a baseline is used once."""

    def __init__(self, arguments: argparse.Namespace, *rulebooks: Rulebook) -> None:
        """Check the options, and read the baseline that an option names.

        `rulebooks` are all that judge robots of the command.

        Raises:
            MarsError: options name kinds that no rule finds, or a baseline is wrong.
        """
        self._arguments, self._rulebooks = arguments, rulebooks
        self._baselines: dict[str, Baseline] = {}
        self._read: set[str] = set()
        self._written: list[Consequence | Diagnostic] = []
        self._check(arguments.select, lambda _: whole_file("--select"))
        self._check(arguments.ignore, lambda _: whole_file("--ignore"))
        if arguments.write_baseline not in (None, STANDARD_INPUT):
            from mars_asp.cli.baseline import check_replaceable

            check_replaceable(arguments.write_baseline)
        # A baseline of the same name is the one to be renewed.
        if arguments.baseline not in (None, arguments.write_baseline):
            if arguments.write_baseline is not None:
                message = "--write-baseline lists all findings, also those of a baseline"
                raise refusal("usage", message, "--baseline", "leave out one of the two")
            check_inputs(*arguments.files, arguments.baseline)
            self._baseline(arguments.baseline)

    def of(
        self,
        project: Project,
        analysis: Analysis,
        notes: bool = True,
        with_participants: bool = False,
    ) -> Selected:
        """Return the reported and hidden findings of a file; notes are omitted unless `notes`.

        Without notes, participants are read if a baseline is written or the caller needs them.

        Raises:
            MarsError: the settings of its folder, or their baseline, are wrong.
        """
        choice, ignores = self._choice_and_ignores(project)
        is_all = notes or ignores or choice.select or choice.baseline
        if not is_all and self._arguments.format != "sarif":
            # Many robots have thousands of notes, and warnings are printed without participants.
            with_participants |= self._arguments.write_baseline is not None
            found = read_consequences(analysis, with_participants, False)
        else:
            found = analysis.consequences
        selected = self._selected(project, choice, ignores, found, notes)
        if self._arguments.write_baseline is None:
            return selected
        self._written += selected.shown
        return selected._replace(shown=())

    def unused(self) -> "Mapping[str, Counter[BaselineEntry]]":
        """Return the unused entries of each baseline that was read, by its path."""
        return {path: each.left.copy() for path, each in self._baselines.items()}

    def restore(self, unused: "Mapping[str, Counter[BaselineEntry]]") -> None:
        """Use entries again that were unused, and those of a baseline that was not read then."""
        for path, baseline in self._baselines.items():
            baseline.left = unused.get(path, baseline.entries).copy()

    def messages(
        self, project: Project, more: Iterable[Diagnostic] = ()
    ) -> tuple[tuple[Diagnostic, ...], Counter[str]]:
        """Return the reported messages on reading a project, and `more`, and the numbers of hidden.

        Errors are always reported, and warnings without a kind unless their code is ignored.

        Raises:
            MarsError: the settings of its folder, or their baseline, are wrong.
        """
        choice, ignores = self._choice_and_ignores(project)
        commented = {(span.path, span.line, name) for each in ignores for name, span in each.kinds}
        shown: list[Diagnostic] = []
        hidden: Counter[str] = Counter()
        for each in (*project.diagnostics, *more):
            if each.kind in ("broken_file", "missing_file") and project.trees:
                # The analysis of launch trees has the same finding.
                continue
            names = _selectors(each)
            if each.severity == "error":
                shown.append(each)
            elif not (choice.has(names) if each.kind else choice.ignore.isdisjoint(names)):
                continue
            elif any((each.span.path, each.span.line, name) in commented for name in names):
                hidden["comment"] += 1
            elif each.kind is None:
                shown.append(each)
            elif choice.baseline is not None and choice.baseline.takes(each):
                hidden["baseline"] += 1
            elif self._arguments.write_baseline is not None and each.severity == "warning":
                self._written.append(each)
            else:
                shown.append(each)
        return tuple(shown), hidden

    def among(self, project: Project, found: Sequence[Consequence]) -> Selected:
        """Return which of some findings are reported, without remarks on comments.

        Raises:
            MarsError: the settings of its folder, or their baseline, are wrong.
        """
        choice, ignores = self._choice_and_ignores(project)
        return self._selected(project, choice, ignores, found)._replace(remarks=())

    def has_errors(self, project: Project, analysis: Analysis) -> bool:
        """Whether an error in a file is reported.

        Raises:
            MarsError: the settings of its folder, or their baseline, are wrong.
        """
        if self.leaves_all(project):
            return analysis.has_errors
        return self.among(project, analysis.consequences).has_errors

    def leaves_all(self, project: Project) -> bool:
        """Whether all findings of a file are reported, as nothing selects or hides any.

        Raises:
            MarsError: the settings of its folder, or their baseline, are wrong.
        """
        choice, ignores = self._choice_and_ignores(project)
        return not ignores and choice == _Choice(None, frozenset(), None)

    def _choice_and_ignores(self, project: Project) -> tuple[_Choice, tuple[Ignore, ...]]:
        """Return the selection for the folder of a file, and the ignore comments of its robot.

        Raises:
            MarsError: the settings, or their baseline, are wrong.
        """
        path = Path(project.configuration.path)
        choice = self._choice(path if path.is_dir() else path.parent)
        files = _files_of_project(project)
        if self._is_whole(project):
            self._read |= files
        return choice, tuple(_ignores(project, files))

    def _selected(
        self,
        project: Project,
        choice: _Choice,
        ignores: Sequence[Ignore],
        found: Sequence[Consequence],
        notes: bool = True,
    ) -> Selected:
        entries = {
            (span.path, span.line, kind): ignore.reason
            for ignore in reversed(ignores)
            for kind, span in ignore.kinds
        }
        shown: list[Consequence] = []
        hidden: list[Hidden] = []
        unlisted: Counter[str] = Counter()
        for each in found:
            # A finding uses its baseline entry even if something else hides it.
            is_known = choice.baseline is not None and choice.baseline.takes(each)
            names = _selectors(each)
            if not choice.has(names):
                continue
            if each.severity == "note" and not notes:
                unlisted[each.kind] += choice.select is not None
                continue
            path, line = each.spans[0][:2]
            reasons = [entries[path, line, name] for name in names if (path, line, name) in entries]
            if reasons:
                hidden.append(Hidden(each, "comment", reasons[0], is_known))
            elif is_known:
                hidden.append(Hidden(each, "baseline", "", is_known))
            else:
                shown.append(each)
        is_judged = "unused-ignore" not in choice.ignore and (
            choice.select is None or "unused-ignore" in choice.select
        )
        remarks = (
            *self._remarks(ignores if is_judged else (), found, project),
            *_selected_notes(+unlisted, project.configuration.path),
        )
        return Selected(tuple(shown), tuple(hidden), remarks, choice.baseline is not None)

    def end(self, is_whole: bool = True) -> Iterator[Diagnostic]:
        """Write the baseline if requested and all files were read (`is_whole`); yield remarks."""
        for baseline in self._baselines.values():
            if "baseline" not in (self._arguments.ignore or ()):
                yield from baseline.unmatched(self._read)
        path = self._arguments.write_baseline
        if path is None:
            return
        if not is_whole:
            message = "no baseline was written, as not every file could be read"
            yield Diagnostic("baseline", "error", message, whole_file(path))
            return
        from mars_asp.cli.baseline import baseline_text, entries_of_others, known_of

        found = Counter(known_of(each, path) for each in self._written)
        entries = found | entries_of_others(path, self._read)
        text = baseline_text(entries.elements())
        if path == STANDARD_INPUT:
            print(text, end="")
            return
        write_file(path, text)
        words = f"the baseline lists {counted(entries.total(), 'finding')}"
        if kept := entries.total() - found.total():
            words += f", {kept} of them as before, of what was not read"
        yield Diagnostic("baseline", "note", words, whole_file(path))

    # ---- What is chosen --------------------------------------------------------------------------

    def _choice(self, folder: Path) -> _Choice:
        """Return names to select and ignore and a baseline: of options, else a folder's settings.

        Raises:
            MarsError: the settings or the baseline are wrong.
        """
        settings = settings_of(self._arguments, folder)
        for key, kinds in (("select", settings.select), ("ignore", settings.ignore)):
            self._check(kinds, partial(settings.place, key))
        select = self._arguments.select or settings.select
        ignore = self._arguments.ignore or settings.ignore or ()
        path = self._arguments.baseline or settings.baseline
        # A new baseline also lists the findings of that in the settings.
        compared = path is not None and self._arguments.write_baseline is None
        if compared and path is not None and not self._arguments.baseline:
            settings.check_named(path, "baseline")
        return _Choice(
            None if select is None else frozenset(select),
            frozenset(ignore),
            self._baseline(path) if path is not None and compared else None,
        )

    def _baseline(self, path: str) -> "Baseline":
        """Return a baseline; each is read once.

        Raises:
            MarsError: the baseline cannot be read.
        """
        from mars_asp.cli.baseline import read_baseline

        if path not in self._baselines:
            self._baselines[path] = read_baseline(path)
        return self._baselines[path]

    # ---- Names -----------------------------------------------------------------------------------

    @cached_property
    def _known_names(self) -> frozenset[str]:
        return ignorable_codes().union(*map(_names_in, self._rulebooks))

    @cached_property
    def _launch_names(self) -> frozenset[str]:
        return _names_in(load_rulebook(stages=("launch",)))

    @cached_property
    def _is_open(self) -> bool:
        """Whether a rule computes the kinds of its findings, so that any name may be a kind."""
        return any(kinds_of(rule) is None for book in self._rulebooks for rule in book.rules)

    def _check(self, kinds: Sequence[str] | None, place: Callable[[int], Span]) -> None:
        """Check that names are kinds or rules; `place` locates one by its index.

        Raises:
            MarsError: some names are neither; has an error for each.
        """
        unknown = {
            name: number for number, name in enumerate(kinds or ()) if self._is_unknown(name)
        }
        if unknown:
            raise MarsError(self._refusal(name, place(number)) for name, number in unknown.items())

    def _is_unknown(self, name: str) -> bool:
        if name in self._known_names:
            return False
        return is_input_error(name) or not (self._is_open or name in self._launch_names)

    def _refusal(
        self, name: str, span: Span, code: str = "kind", severity: Severity = "error"
    ) -> Diagnostic:
        """Return the diagnostic for a name that is not a finding, with the nearest known name."""
        if is_input_error(name):
            message = f"`{name}` is an error of the input, which cannot be ignored or selected"
            return Diagnostic(code, severity, message, span, help="it is always reported: fix it")
        names = self._known_names | self._launch_names
        ends = sorted(each for each in names if each.rpartition("/")[2] == name)
        # A kind is written with `_`, the rule of that name may be one of several.
        kind = name.replace("-", "_")
        near = kind if kind in names else ends[0] if ends else nearest(name, names)
        advice = "`mars-asp rules list` names them all, and --rules adds more"
        # One of several would be a guess, and select nothing that is meant.
        parts = sorted(each for each in names if name in each and "/" not in each)
        if name == "ALL":
            advice = "leave out --select, and all are reported"
        elif len(parts) > 1 and near != kind:
            advice = f"did you mean {' or '.join(f'`{each}`' for each in parts)}?"
        elif near is not None:
            advice = f"did you mean `{near}`?"
        return Diagnostic(code, severity, f"no rule finds `{name}`", span, help=advice)

    # ---- Comments --------------------------------------------------------------------------------

    def _remarks(
        self,
        ignores: Sequence[Ignore],
        found: Sequence[Consequence],
        project: Project,
    ) -> Iterator[Diagnostic]:
        """Yield remarks on comments that hide nothing or name an unknown kind."""
        if not ignores:
            return
        matched = {(*one.spans[0][:2], name) for one in found for name in _selectors(one)}
        for each in project.diagnostics:
            matched.update((*each.span[:2], name) for name in _selectors(each))
        is_whole = self._is_whole(project)
        for ignore in ignores:
            if not ignore.kinds:
                message = "this comment names no kind of finding, so it hides nothing"
                advice = "write the kinds in brackets, and then why: mars: ignore[KIND] reason"
                yield _remark(message, ignore.span, advice)
            for kind, span in dict(ignore.kinds).items():
                if (span.path, span.line, kind) in matched:
                    continue
                if self._is_unknown(kind):
                    yield self._refusal(kind, span, "unused-ignore", "warning")
                elif is_whole:
                    message = f"this comment hides nothing: no `{kind}` is reported at its line"
                    yield _remark(message, span, _elsewhere(kind, span, found))

    def _is_whole(self, project: Project) -> bool:
        """Whether a project has all that comments and entries of a baseline may be about.

        A project of ROS is whole as a workspace, or as a package in none, without a chosen launch
        file and a file with errors; a mux file in a workspace is a part of it.
        """
        path = project.configuration.path
        if not project.trees:
            return project.format is None or workspace_of(path) is None
        if not os.path.isdir(path) or getattr(self._arguments, "launch", None):  # noqa: PTH112
            return False
        if any(tree.broken for tree in project.trees):
            return False
        around = workspace_of(os.path.join(path, "_"))  # noqa: PTH118 -- may be `.`
        return around is None or os.path.realpath(around) == os.path.realpath(path)


def _selectors(finding: Consequence | Diagnostic) -> tuple[str, ...]:
    """Return the names by which a finding or message can be selected: kind, rule id, code."""
    if isinstance(finding, Consequence):
        return finding.kind, finding.rule.id
    return (finding.kind, finding.code) if finding.kind else (finding.code,)


def _names_in(rulebook: Rulebook) -> frozenset[str]:
    """Return the kinds of consequence that rules find, and the ids of these rules."""
    ids = (rule.id for rule in rulebook.rules if kinds_of(rule) != frozenset())
    return consequence_kinds(rulebook).union(ids)


def _elsewhere(kind: str, span: Span, found: Iterable[Consequence]) -> str:
    """Return the advice to move or delete a comment at `span` that hides no `kind`."""
    for each in found:
        first = each.spans[0]
        if kind in _selectors(each) and any(
            (at.path, at.line) == (span.path, span.line) for at in each.spans[1:]
        ):
            return f"move it to the end of line {first.line} of {first.path}, its first place"
    return "delete it, or move it to the end of the line that the finding is reported at"


def _remark(message: str, span: Span, advice: str) -> Diagnostic:
    return Diagnostic("unused-ignore", "warning", message, span, help=advice)


def _files_of_project(project: Project) -> set[str]:
    """Return the files with a declaration or relationship of a project."""
    configuration = project.configuration
    placed = (
        *configuration.modules,
        *configuration.relationships,
        *configuration.declared,
        *project.modules.values(),
    )
    files = {configuration.path, *(each.span.path for each in placed)}
    return files.union(*(tree.files for tree in project.trees))


def _ignores(project: Project, files: Iterable[str]) -> Iterator[Ignore]:
    """Yield the comments of a project's files that hide findings."""
    own = project.configuration.path
    yield from ignores_in(own, project.text, None if project.format else "mars")
    for path in sorted(set(files) - {own}):
        yield from ignores_of(path)
