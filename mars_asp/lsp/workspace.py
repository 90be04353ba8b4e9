"""The open texts of an editor, and their robots, findings and rules."""

from collections.abc import Iterator, Mapping

from mars_asp.lsp.occurrences import is_configuration, outline
from mars_asp.lsp.places import Place, changed_lines
from mars_asp.lsp.questions import Survey
from mars_asp.lsp.robot import DocumentContext, EditorFinding, EditorRobot
from mars_asp.lsp.rule_text import RuleText, is_rules, rule_text
from mars_asp.lsp.rules import Rules
from mars_asp.reading import decoded, read_file


class EditorWorkspace:
    """The open texts by their paths, and the findings by the file that a worker analysed."""

    def __init__(self) -> None:
        self.texts: dict[str, str] = {}
        self.robots: dict[str, EditorRobot] = {}
        self.found: dict[str, tuple[EditorFinding, ...]] = {}
        self.rules: dict[str, Rules] = {}
        #: The findings of the last analysis that could read a robot, and the texts at that time.
        self.readable: dict[str, tuple[tuple[EditorFinding, ...], dict[str, str]]] = {}
        #: The configurations of each source that was searched for.
        self.owners: dict[str, tuple[str, ...]] = {}

    def overlay(self) -> Mapping[str, str]:
        """Return the open texts that differ from the files on the disk."""
        return {path: text for path, text in self.texts.items() if not _is_saved(path, text)}

    def context(self, path: str) -> DocumentContext | None:
        """Return the context of a `.mars` file or a source, or None if it is not open."""
        text = self.texts.get(path)
        if text is None or is_rules(path):
            return None
        return DocumentContext(
            outline(path, text), self.robots_of(path), self.texts, self.findings(path)
        )

    def rule_text(self, path: str) -> RuleText | None:
        """Return an open file of rules, or None if it is another file or not open."""
        text = self.texts.get(path)
        return None if text is None or not is_rules(path) else rule_text(path, text)

    def robots_of(self, path: str) -> tuple[EditorRobot, ...]:
        """Return the robots that include a file; the robot of this configuration is first."""
        found = [robot for robot in self.robots.values() if path in robot.paths]
        return tuple(sorted(found, key=lambda robot: robot.path != path))

    def findings(self, path: str) -> tuple[EditorFinding, ...]:
        """Return the findings in a file, of all robots."""
        every = (each for found in self.found.values() for each in found)
        return tuple(dict.fromkeys(each for each in every if each.place.path == path))

    def queried_files(self, path: str) -> tuple[str, ...]:
        """Return the files to analyse again after a file changes."""
        robots = [robot.path for robot in self.robots_of(path)]
        if is_configuration(path) or is_rules(path):
            return tuple(dict.fromkeys((path, *robots)))
        owners = [each for each in robots if each != path] or list(self.owners.get(path, ()))
        return tuple(owners) or (path,)

    def store(
        self, queried: str, found: tuple[EditorFinding, ...], robot: EditorRobot | None
    ) -> set[str]:
        """Store the findings and the robot of an analysed file; return the files to publish.

        These are the files with findings, now or before, and the open files of the robot.
        """
        if robot is not None:
            self.readable[queried] = found, dict(self.texts)
        elif found and all(map(_is_of_syntax, found)):
            found += tuple(self._kept_findings(queried))
        changed = {each.place.path for each in (*self.found.get(queried, ()), *found)}
        self.found[queried] = found
        if robot is not None:
            before = self.robots.get(queried)
            if before is not None:
                robot = robot._replace(consequences=before.consequences, nodes=before.nodes)
            self.robots[queried] = robot
            for path in robot.paths - {queried}:
                # The robot has the findings of the source alone as well.
                if not is_configuration(path) and path in self.found:
                    changed |= self.evict(path)
        for path, owners in self.owners.items():
            # A source may be in no file of a robot that cannot be read.
            changed |= {path} if queried in owners else set()
        known = self.robots.get(queried)
        if known is not None:
            changed |= known.paths & self.texts.keys()
        return changed | {queried}

    def _kept_findings(self, queried: str) -> Iterator[EditorFinding]:
        """Yield the last findings of the file `queried` while readable, in unchanged lines."""
        findings, texts = self.readable.get(queried, ((), {}))
        for each in findings:
            place = self._place_now(each.place, texts)
            if place is not None and not _is_of_syntax(each):
                related = ((self._place_now(other, texts), label) for other, label in each.related)
                known = tuple((other, label) for other, label in related if other is not None)
                # Traces and repairs need a text that can be read.
                yield each._replace(place=place, related=known, title=None)

    def _place_now(self, place: Place, texts: Mapping[str, str]) -> Place | None:
        """Return a location of older texts in the open texts, or None if its lines changed."""
        before, now = texts.get(place.path), self.texts.get(place.path)
        if before == now:
            return place
        if before is None or now is None:
            return None
        found = changed_lines(before, now).moved(place.range)
        return None if found is None else Place(place.path, found)

    def update(self, queried: str, survey: Survey) -> None:
        """Update a robot with the consequences and nodes of its modules."""
        robot = self.robots.get(queried)
        if robot is not None:
            result = robot._replace(consequences=survey.consequences, nodes=survey.nodes)
            self.robots[queried] = result

    def evict(self, queried: str) -> set[str]:
        """Delete the results of an analysed file; return the files that had findings."""
        self.robots.pop(queried, None)
        self.rules.pop(queried, None)
        self.readable.pop(queried, None)
        return {each.place.path for each in self.found.pop(queried, ())}

    def idle(self) -> Iterator[str]:
        """Yield the analysed files of which no file is open any more."""
        for queried in tuple(self.found):
            robot = self.robots.get(queried)
            paths = {queried} if robot is None else {queried, *robot.paths}
            paths |= {path for path, owners in self.owners.items() if queried in owners}
            if paths.isdisjoint(self.texts):
                yield queried


def _is_of_syntax(finding: EditorFinding) -> bool:
    """Whether a finding is about the syntax of a line or block of a `.mars` file."""
    is_mistake = finding.code == "syntax" or finding.code.startswith("MARS1")
    return is_mistake and is_configuration(finding.place.path)


def _is_saved(path: str, text: str) -> bool:
    """Whether the file on the disk has this text, in any known encoding."""
    # No encoding has more bytes for a character or for the byte order mark.
    most = 4 * len(text) + 4
    try:
        raw = read_file(path, most, path)
    except (OSError, ValueError):
        return False
    if len(raw) > most:
        return False
    return text in (decoded(raw), raw.decode("utf-8", "replace"), raw.decode("latin-1"))
