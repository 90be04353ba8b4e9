"""What an editor has open, and what is known of it: texts, robots, findings, rules."""

from collections.abc import Iterator, Mapping

from mars_asp.lsp.actions import Action
from mars_asp.lsp.occurrences import is_configuration, outline
from mars_asp.lsp.places import Place, changed_lines
from mars_asp.lsp.questions import Survey
from mars_asp.lsp.robot import DocumentContext, EditorFinding, EditorRobot
from mars_asp.lsp.rule_text import RuleText, is_rules, rule_text
from mars_asp.lsp.rules import Rules
from mars_asp.reading import read_file

_ENCODINGS = ("utf-8-sig", "latin-1")


class EditorWorkspace:
    """The open texts by their paths and, by the file that it was asked about, what was found."""

    def __init__(self) -> None:
        self.texts: dict[str, str] = {}
        self.robots: dict[str, EditorRobot] = {}
        self.found: dict[str, tuple[EditorFinding, ...]] = {}
        self.rules: dict[str, Rules] = {}
        #: The findings of the last analysis that could read a robot, and the texts at that time.
        self.readable: dict[str, tuple[tuple[EditorFinding, ...], dict[str, str]]] = {}
        #: Repairs of robots, and traces of their findings, as long as nothing is changed.
        self.repairs: dict[str, tuple[Action, ...]] = {}
        self.traces: dict[str, dict[str, str]] = {}
        #: Configurations that sources belong to, as far as it was looked for.
        self.owners: dict[str, tuple[str, ...]] = {}

    def unsaved(self) -> Mapping[str, str]:
        """Return the open texts that are not what the disk has."""
        return {path: text for path, text in self.texts.items() if not _is_saved(path, text)}

    def scene(self, path: str) -> DocumentContext | None:
        """Return what a question about a `.mars` file or a source is about."""
        text = self.texts.get(path)
        if text is None or is_rules(path):
            return None
        return DocumentContext(
            outline(path, text), self.robots_of(path), self.texts, self.findings(path)
        )

    def rule_text(self, path: str) -> RuleText | None:
        """Return an open file of rules."""
        text = self.texts.get(path)
        return None if text is None or not is_rules(path) else rule_text(path, text)

    def robots_of(self, path: str) -> tuple[EditorRobot, ...]:
        """Return the robots that a file is part of, its own first."""
        found = [robot for robot in self.robots.values() if path in robot.paths]
        return tuple(sorted(found, key=lambda robot: robot.path != path))

    def findings(self, path: str) -> tuple[EditorFinding, ...]:
        """Return the findings in a file, of all robots."""
        every = (each for found in self.found.values() for each in found)
        return tuple(dict.fromkeys(each for each in every if each.place.path == path))

    def asked_for(self, path: str) -> tuple[str, ...]:
        """Return the files to be asked about when one changes: robots, else itself."""
        robots = [robot.path for robot in self.robots_of(path)]
        if is_configuration(path) or is_rules(path):
            return tuple(dict.fromkeys((path, *robots)))
        owners = [each for each in robots if each != path] or list(self.owners.get(path, ()))
        return tuple(owners) or (path,)

    def forget(self, path: str) -> frozenset[str]:
        """Forget what no longer holds when a file changes; return what it was asked about."""
        asked = frozenset({path, *(robot.path for robot in self.robots_of(path))})
        for each in asked:
            self.repairs.pop(each, None)
            self.traces.pop(each, None)
        return asked

    def take(
        self, asked: str, found: tuple[EditorFinding, ...], robot: EditorRobot | None
    ) -> set[str]:
        """Keep what was found when a file was asked about; return the files to be told of it.

        They are those with findings, now or before, and those of the robot that are open.
        """
        if robot is not None:
            self.readable[asked] = found, dict(self.texts)
        elif found and all(map(_is_of_syntax, found)):
            found += tuple(self._kept_findings(asked))
        changed = {each.place.path for each in (*self.found.get(asked, ()), *found)}
        self.found[asked] = found
        if robot is not None:
            before = self.robots.get(asked)
            if before is not None:
                robot = robot._replace(consequences=before.consequences, nodes=before.nodes)
            self.robots[asked] = robot
            for path in robot.paths - {asked}:
                # What was found in a source alone, the robot has, too.
                if not is_configuration(path) and path in self.found:
                    changed |= self.drop(path)
        for path, owners in self.owners.items():
            # A source may be in no file of a robot that cannot be read.
            changed |= {path} if asked in owners else set()
        known = self.robots.get(asked)
        if known is not None:
            changed |= known.paths & self.texts.keys()
        return changed | {asked}

    def _kept_findings(self, asked: str) -> Iterator[EditorFinding]:
        """Yield the findings of the last readable texts at lines that are the same now."""
        findings, texts = self.readable.get(asked, ((), {}))
        for each in findings:
            place = self._place_now(each.place, texts)
            if place is not None and not _is_of_syntax(each):
                related = ((self._place_now(other, texts), label) for other, label in each.related)
                known = tuple((other, label) for other, label in related if other is not None)
                # Traces and repairs need a text that can be read.
                yield each._replace(place=place, related=known, title=None)

    def _place_now(self, place: Place, texts: Mapping[str, str]) -> Place | None:
        """Return a place of older texts in the open ones, or None if its lines changed."""
        before, now = texts.get(place.path), self.texts.get(place.path)
        if before == now:
            return place
        if before is None or now is None:
            return None
        found = changed_lines(before, now).moved(place.range)
        return None if found is None else Place(place.path, found)

    def learn(self, asked: str, survey: Survey) -> None:
        """Keep which consequences and nodes there are for the modules of a robot."""
        robot = self.robots.get(asked)
        if robot is not None:
            result = robot._replace(consequences=survey.consequences, nodes=survey.nodes)
            self.robots[asked] = result

    def drop(self, asked: str) -> set[str]:
        """Forget what was found when a file was asked about; return the files with findings."""
        self.robots.pop(asked, None)
        self.rules.pop(asked, None)
        self.readable.pop(asked, None)
        return {each.place.path for each in self.found.pop(asked, ())}

    def idle(self) -> Iterator[str]:
        """Yield the files that were asked about and of which nothing is open any more."""
        for asked in tuple(self.found):
            robot = self.robots.get(asked)
            paths = {asked} if robot is None else {asked, *robot.paths}
            paths |= {path for path, owners in self.owners.items() if asked in owners}
            if paths.isdisjoint(self.texts):
                yield asked


def _is_of_syntax(finding: EditorFinding) -> bool:
    """Return whether a finding is a mistake in a line or a module block of a `.mars` text."""
    is_mistake = finding.code == "syntax" or finding.code.startswith("MARS1")
    return is_mistake and is_configuration(finding.place.path)


def _is_saved(path: str, text: str) -> bool:
    """Whether the disk has a text, in whichever encoding."""
    # No encoding takes more for a character, and a mark before them all.
    most = 4 * len(text) + 4
    try:
        raw = read_file(path, most, path)
    except (OSError, ValueError):
        return False
    if len(raw) > most:
        return False
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        return raw.decode("utf-16", "replace") == text
    if raw.decode("utf-8", "replace") == text:
        return True
    for encoding in _ENCODINGS:
        try:
            if raw.decode(encoding) == text:
                return True
        except UnicodeDecodeError:
            continue
    return False
