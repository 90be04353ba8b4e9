"""The nodes that a launch file and its includes start, with names, namespaces and remappings."""

import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain, pairwise
from pathlib import Path
from typing import Literal, NamedTuple

from mars_asp.diagnostic import MarsError, Span
from mars_asp.exchange.ros2.actions import (
    Action,
    Declare,
    IncludeAction,
    LaunchArgument,
    LaunchDirectory,
    LaunchGroup,
    NodeParameter,
    PackageShare,
    PushNamespace,
    Readings,
    Reads,
    Remap,
    SetParameters,
    Start,
    Tests,
    Text,
    Undeclared,
    plain,
    text_of,
)
from mars_asp.exchange.ros2.descriptions import DESCRIPTIONS, files_named
from mars_asp.exchange.ros2.launch_markup import read_markup
from mars_asp.exchange.ros2.launch_python import NEWER, read_python
from mars_asp.exchange.ros2.names import Renaming, joined
from mars_asp.exchange.ros2.parameters import GivenParameter
from mars_asp.exchange.ros2.workspace import Workspace
from mars_asp.exchange.unread import ABSENT, ABSENT_PARAMETERS, CIRCLES, IMPORTED, Unread
from mars_asp.exchange.yaml_document import Items, Scalar
from mars_asp.model.graph import OPEN_CONDITION, AbsentFile, StartCondition

#: What launch files are called that are included and not found.
NOT_HERE = "included launch files that are not in the workspace"
#: Launch files that a newer Python may read.
IN_NEWER = "launch files in a newer Python than this one"
_NO_PARAMETERS = "parameter files that are not in the workspace"
#: Packages whose programs write the files that their arguments name, and options for outputs.
_RECORDERS = frozenset({"rosbag", "rosbag2", "map_server", "nav2_map_server"})
_OUTPUTS = frozenset({"-o", "-O", "--output", "--output-name", "--output-prefix"})
#: Code that checks whether a file exists.
_CHECKS_FILES = re.compile(r"\b(?:exists|isfile|is_file)\(")
#: A launch argument whose name is put together.
_COMPOSED_ARGUMENT = re.compile(r"\b(?:LaunchConfiguration\(|launch_configurations\[)\s*[fF][\"']")
#: Packages whose launch files read parameter files as YAML and write them anew.
_REWRITING = frozenset({"nav2_bringup"})
_DEEPEST_INCLUDE = 32
#: So many descriptions of a robot may include each other.
_MOST_DESCRIPTIONS = 300
#: Real robots have a hundred includes that differ in their arguments.
_MOST_INCLUDES = 300
_MOST_NODES = 20_000
_DEEPEST_ARGUMENT = 16
_PARAMETER_FILES = frozenset({".yaml", ".yml"})
_MARKUP = frozenset({".xml", ".yaml", ".yml", ".launch", ".test"})
_PYTHON = re.compile(r"^def generate_launch_description\b", re.MULTILINE)
#: A word of a command line; blanks in quotes and in substitutions (`$(...)`) belong to it.
_WORD = re.compile(r"""(?:\$\([^)]*\)|'[^']*'|"[^"]*"|\S)+""")
#: In place of a part of a command that is not known; no path has it.
_UNKNOWN_WORD = "\0"
#: Sorts of unread things that may read any launch argument.
_MAY_READ_ARGUMENTS = frozenset(
    {
        ABSENT,
        NOT_HERE,
        "included launch files with errors",
        IN_NEWER,
        "functions that only a run calls",
        IMPORTED,
        "branches of conditions",
        f"includes beyond the first {_MOST_INCLUDES} of a launch file",
    }
)
#: Values that conditions take for truths.
_TRUTHS = {"1": "true", "True": "true", "0": "false", "False": "false"}
_ANONYMOUS = re.compile(r"\$\(anon ([^)]*)\)")


@dataclass(frozen=True, slots=True)
class Started:
    """A node that is started.

    `name` is empty if the program chooses it; `namespace` begins with a slash; `files` are those of
    its parameters, in the workspace; `conditions` decide if it starts; `arguments` are the words
    after its program, the unknown ones empty. `has_further_files` is whether it has files of
    parameters that are not known, `is_rewritten` whether a launch file reads its files as YAML,
    `is_name_open` whether only a run knows its name or namespace.
    """

    package: str
    executable: str
    plugin: bool
    name: str
    namespace: str
    remaps: tuple[Renaming, ...]
    spans: Mapping[Renaming, Span]
    files: tuple[Path, ...]
    parameters: Mapping[str, GivenParameter]
    span: Span
    conditions: tuple[StartCondition, ...] = ()
    arguments: tuple[str, ...] = ()
    has_further_files: bool = False
    is_rewritten: bool = False
    is_name_open: bool = False


class _Entered(NamedTuple):
    """The results of an included file: started nodes, skipped contents, read and absent files."""

    started: list[Started]
    unread: list[Unread]
    reached: set[Path]
    missing: dict[AbsentFile, None]


@dataclass(slots=True)
class _Scope:
    """The settings that apply to the actions of a group."""

    #: The launch file of the actions, after the files that include it.
    launched: tuple[Path, ...]
    namespace: str = "/"
    #: Whether only a run knows a part of the namespace.
    is_namespace_open: bool = False
    remaps: list[tuple[Renaming, Span]] = field(default_factory=list)
    arguments: dict[str, str | None] = field(default_factory=dict)
    files: tuple[Path, ...] = ()
    parameters: dict[str, GivenParameter] = field(default_factory=dict)
    conditions: tuple[StartCondition, ...] = ()
    #: Arguments that an including file has set, and the variables of those that it forwards.
    fixed: frozenset[str] = frozenset()
    passed: Mapping[str, str] = field(default_factory=dict)
    #: Whether nothing comes from outside but what is passed, as in ROS 1.
    closed: bool = False

    def inner(self) -> "_Scope":
        """Return a copy of the settings for an inner group."""
        return replace(
            self,
            remaps=list(self.remaps),
            arguments=dict(self.arguments),
            parameters=dict(self.parameters),
        )

    def state(self) -> tuple[Hashable, ...]:
        """Return the settings on which the effect of actions depends, to compare scopes."""
        return (
            self.launched,
            self.namespace,
            self.is_namespace_open,
            tuple(self.remaps),
            tuple(self.arguments.items()),
            self.files,
            tuple(self.parameters.items()),
            self.fixed,
            tuple(self.passed.items()),
            self.closed,
        )

    @property
    def file(self) -> Path:
        """The launch file of the actions."""
        return self.launched[-1]

    def variable(self, name: str) -> str | None:
        """Return the user's variable that sets an argument; None if a launch file sets it."""
        if name in self.passed:
            return self.passed[name]
        # The environment is the same in every file.
        if name.startswith("env "):
            return name
        return None if self.closed or name in self.fixed else name


class Launch:
    """The nodes of a launch tree: a launch file of a workspace, and all files that it includes."""

    def __init__(self, workspace: Workspace, before: "Launch | None" = None) -> None:
        """Begin with nothing started; files that the launch `before` read are not read again."""
        self.workspace = workspace
        self.path: Path | None = None
        self.started: list[Started] = []
        self.unread: list[Unread] = []
        self.reached: set[Path] = set()
        self.missing: dict[AbsentFile, None] = {}
        #: Parameter files that are passed to launch files which are not here.
        self.passed: dict[Path, None] = {}
        #: The first default of each launch argument that users may set.
        self.defaults: dict[str, str] = {}
        self._described: set[Path] = set()
        self._actions: dict[Path, tuple[Action, ...]] = {} if before is None else before._actions
        self._entered: dict[Hashable, _Entered] = {}

    def launch(self, file: Path) -> None:
        """Add the nodes that a launch file and its includes start.

        Raises:
            MarsError: the file itself has an error.
        """
        self._walk(self._read_actions(file), _Scope((file,)))

    def _read_actions(self, file: Path) -> tuple[Action, ...]:
        self.reached.add(file)
        if file not in self._actions:
            text = self.workspace.text(file)
            shown = self.workspace.shown(file)
            is_python = file.suffix == ".py" or (
                file.suffix not in _MARKUP and _PYTHON.search(text) is not None
            )
            self._actions[file] = (read_python if is_python else read_markup)(text, shown)
        return self._actions[file]

    def _walk(self, actions: Sequence[Action], scope: _Scope) -> None:  # noqa: C901 -- one case for each action
        for action in actions:
            if len(self.started) >= _MOST_NODES:
                return
            match action:
                case Start():
                    self._add_started(action, scope)
                case LaunchGroup(inner, scoped, tests):
                    within = scope.inner() if scoped else scope
                    before = within.conditions
                    conditions = self._conditions(tests, scope)
                    if conditions is not None:
                        within.conditions = (*before, *conditions)
                        self._walk(inner, within)
                        within.conditions = before
                case PushNamespace(namespace, span):
                    pushed = self._known_text(namespace, scope)
                    if pushed is None:
                        scope.is_namespace_open = True
                        self.unread.append(
                            Unread(
                                "namespaces made at run time",
                                self._partial_text(namespace, scope),
                                span,
                            )
                        )
                    else:
                        scope.namespace = joined(scope.namespace, pushed)
                case Remap():
                    scope.remaps += self._remaps((action,), scope)
                case Declare():
                    self._declare(action, scope)
                case SetParameters(paths, parameters):
                    scope.files += tuple(self._parameter_files(paths, scope, None))
                    given = self._parameters(parameters, scope, is_for_all=True)
                    scope.parameters.update(given)
                case IncludeAction():
                    self._include(action, scope)
                case Reads(words, span):
                    self._note_read(words, span, scope)
                case Readings(readings):
                    self._either(readings, scope)
                case Unread():
                    self.unread.append(action)
                case Undeclared(name, span):
                    self._note_undeclared(name, span, scope)

    def _declare(self, action: Declare, scope: _Scope) -> None:
        """Store a launch argument's value; note a default that names a file that does not exist."""
        if not self._is_usual(action.tests, scope):
            return
        name = action.name
        value = None if action.value is None else self._known_text(action.value, scope)
        # An including file may have set it to a value that only a run knows.
        is_open = scope.arguments.get(name) is None and name not in scope.fixed
        if is_open:
            self._note_missing(value, action.span, scope)
        variable = None if action.forced else scope.variable(name)
        if action.forced or is_open:
            scope.arguments[name] = value
            if value is not None and variable is not None:
                self.defaults.setdefault(variable, value)
        if action.forced:
            scope.fixed |= {name}

    def _either(self, readings: Sequence[tuple[Sequence[Action], Tests]], scope: _Scope) -> None:
        """Collect the nodes of all readings; a node in only some gets their branches."""
        lacking: list[dict[AbsentFile, None]] = []
        noted = len(self.unread)
        found: list[tuple[Started, set[int]]] = []
        at: dict[Span, list[tuple[Started, set[int]]]] = {}
        branches: dict[int, dict[tuple[Text, Text], StartCondition]] = {}
        for number, (actions, tests) in enumerate(readings):
            conditions = self._branches(tests, scope)
            if conditions is None:
                continue
            branches[number] = conditions
            read = self._apart(partial(self._walk, actions, scope.inner()))
            self.unread += read.unread
            self.reached |= read.reached
            if all(not test.branch for test in tests):
                self.missing |= read.missing
            lacking.append(read.missing)
            for each in read.started:
                same = at.setdefault(each.span, [])
                by = next((by for one, by in same if one == each), None)
                if by is None:
                    same.append((each, {number}))
                    found.append(same[-1])
                else:
                    by.add(number)
        # A branch of code that may never be taken names its files in vain, if no other does.
        self.missing |= {
            each: None for each in chain(*lacking) if all(each in by for by in lacking)
        }
        self.unread[noted:] = dict.fromkeys(self.unread[noted:])
        decided: list[tuple[Started, list[StartCondition]]] = []
        for each, by in found:
            others = [branches[number] for number in branches if number not in by]
            first, *further = (branches[number] for number in sorted(by))
            # Those alone decide that all have in common which start it, and some other has not.
            common = [
                one
                for key, one in first.items()
                if all(same.get(key) == one for same in further)
                and any(other.get(key) != one for other in others)
            ]
            decided.append((each, common))
        unmet = {one.variable for _, every in decided for one in every if not one.wanted}
        implied = {test.text for _, tests in readings for test in tests if test.implied}
        for each, every in decided:
            needed = (
                one
                for one in every
                # What other tests imply tells apart only the nodes of the other branch.
                if one.variable in unmet or (one.variable,) not in implied
            )
            self.started.append(replace(each, conditions=(*each.conditions, *needed)))

    def _branches(
        self, tests: Tests, scope: _Scope
    ) -> dict[tuple[Text, Text], StartCondition] | None:
        """Return the undecided tests of a reading by text and value, or None if one fails."""
        found: dict[tuple[Text, Text], StartCondition] = {}
        for test in tests:
            key = test.text, test.value or ()
            if test.branch:
                shown = text_shown(test.text), text_shown(test.value or ())
                # Two of one file may be alternatives.
                found[key] = StartCondition(*shown, test.wanted, test.span, (test.span.path,))
                continue
            conditions = self._conditions((test,), scope)
            if conditions is None:
                return None
            found.update((key, one) for one in conditions)
        return found

    def _include(self, action: IncludeAction, scope: _Scope) -> None:
        written = self._partial_text(action.path, scope)
        path = self._known_text(action.path, scope)
        found = None if path is None else self.workspace.find(path, scope.file.parent)
        known = self.workspace.catalogued(path) if found is None and path is not None else None
        if known is not None and known not in scope.launched:
            self._include_known(known, action, scope)
            return
        is_missing = self._note_missing(path, action.span, scope)
        if found is None:
            self.unread.append(Unread(ABSENT if is_missing else NOT_HERE, written, action.span))
            for value in self._parameters(action.arguments, scope).values():
                named = value.text if value.is_known else ""
                self._note_missing(named, action.span, scope)
                given = self.workspace.find(named, scope.file.parent)
                if given is not None and given.suffix in _PARAMETER_FILES:
                    self.passed[given] = None
            return
        if found == scope.file and not (action.tests or scope.conditions):
            name = f"{self.workspace.shown(found)}: the file always includes itself"
            self.unread.append(Unread(CIRCLES, name, action.span))
            return
        if found in scope.launched or len(scope.launched) > _DEEPEST_INCLUDE:
            self.unread.append(Unread("includes in a circle", written, action.span))
            return
        try:
            actions = self._read_actions(found)
        except MarsError as error:
            first = error.diagnostics[0]
            sort = IN_NEWER if first.code == NEWER else "included launch files with errors"
            name = f"{self.workspace.shown(found)}: {first.message}"
            self.unread.append(Unread(sort, name, first.span))
            return
        self._enter(actions, action, scope, found)

    def _include_known(self, file: Path, action: IncludeAction, scope: _Scope) -> None:
        """Collect the nodes of a catalogued launch file, located at the include."""
        span, actions = action.span, self._read_actions(file)
        found = self._apart(partial(self._enter, actions, action, scope, file))
        self.reached |= found.reached
        self.missing |= dict.fromkeys(
            replace(each, span=span) for each in found.missing if "argument" not in each.sort
        )
        rewrites = file.parent.parent.name in _REWRITING
        self.started += (_at_include(each, span, rewrites) for each in found.started)
        # Its own default files are not here, and name no topics.
        kept = (each for each in found.unread if each.sort != _NO_PARAMETERS)
        self.unread += (each._replace(span=span) for each in kept)

    def _apart(self, collect: Callable[[], None]) -> _Entered:
        """Run `collect`, and return its results without adding them to this launch."""
        before = self.started, self.unread, self.reached, self.missing
        self.started, self.unread, self.reached, self.missing = [], [], set(), {}
        collect()
        found = _Entered(self.started, self.unread, self.reached, self.missing)
        self.started, self.unread, self.reached, self.missing = before
        return found

    def _enter(
        self, actions: Sequence[Action], action: IncludeAction, scope: _Scope, file: Path
    ) -> None:
        """Process the actions of the file that `action` includes in `scope`."""
        conditions = self._conditions(action.tests, scope)
        if conditions is None:
            return
        within = scope.inner()
        within.launched, within.conditions = (*scope.launched, file), ()
        if not action.inherits:
            within.arguments.clear()
            within.fixed, within.passed, within.closed = frozenset(), {}, True
        given = [each for each in action.arguments if self._is_usual(each.tests, scope)]
        for each in given:
            self._pass(each, scope, within)
        passed = self._parameters(given, scope)
        for value in passed.values():
            self._note_missing(value.text, action.span, scope)
        within.arguments |= {name: each.text for name, each in passed.items() if each.is_known}
        found = self._entered_with(actions, within, action.span)
        if not action.inherits:
            self._note_arguments(given, file, (file,))
        elif all(each.sort not in _MAY_READ_ARGUMENTS for each in found.unread):
            self._note_arguments(given, file, found.reached)
        conditions = (*scope.conditions, *conditions)
        self.started += (
            replace(each, conditions=(*conditions, *each.conditions))
            for each in found.started[: _MOST_NODES - len(self.started)]
        )
        self.unread += found.unread
        self.reached |= found.reached
        self.missing |= found.missing

    def _entered_with(self, actions: Sequence[Action], within: _Scope, span: Span) -> _Entered:
        """Return the results of an included file within a scope; memoized.

        Many branches of code may include one file with the same arguments.
        """
        key = within.state()
        if key not in self._entered:
            if len(self._entered) >= _MOST_INCLUDES:
                sort = f"includes beyond the first {_MOST_INCLUDES} of a launch file"
                return _Entered([], [Unread(sort, within.file.name, span)], set(), {})
            self._entered[key] = self._apart(partial(self._walk, actions, within))
            self._entered[key].reached.add(within.file)
        return self._entered[key]

    def _note_arguments(
        self, given: Iterable[NodeParameter], file: Path, read: Iterable[Path]
    ) -> None:
        """Note the arguments passed to a file whose names neither it nor its includes contain.

        `given` are the arguments, `read` the files.
        """
        if any(_COMPOSED_ARGUMENT.search(self.workspace.text(each)) for each in read):
            return
        words = [self.workspace.words_in(each) for each in read]
        for each in given:
            name = plain(each.name) or ""
            if name.isidentifier() and all(name not in found for found in words):
                shown = self.workspace.shown(file)
                sort: Literal["argument", "refused argument"] = "argument"
                package = self.workspace.package_of(file)
                if package is not None and package.is_of_ros1 and not package.is_of_ros2:
                    sort = "refused argument"
                self.missing[AbsentFile(name, shown, each.keys[0][1], sort)] = None

    def _note_undeclared(self, name: str, span: Span, scope: _Scope) -> None:
        """Note an argument that a file of ROS 1 reads without declaring it.

        It is not noted if an include forwards all arguments of the including file.
        """
        package = self.workspace.package_of(scope.file)
        is_of_ros2 = package is not None and package.is_of_ros2
        is_handed_on = len(scope.launched) > 1 and not scope.closed
        if not (is_of_ros2 or is_handed_on):
            shown = self.workspace.shown(scope.file)
            self.missing[AbsentFile(name, shown, span, "undeclared argument")] = None

    def _note_missing(self, path: str | None, span: Span, scope: _Scope) -> bool:
        """Return whether a package here lacks the file at a path, and note it if so.

        A launch file that checks whether files exist works without them.
        """
        # Most texts of launch files name no file, which has an ending.
        if path is None or "." not in path:
            return False
        folder = scope.file.parent
        is_here = self.workspace.find(path, folder) is not None
        lacks = self.workspace.not_installed if is_here else self.workspace.lacking
        lacking = lacks(path, folder)
        if lacking is None or _CHECKS_FILES.search(self.workspace.text(scope.file)):
            return False
        package, name = lacking
        sort: Literal["file", "not installed"] = "not installed" if is_here else "file"
        self.missing[AbsentFile(name, package, span, sort)] = None
        return not is_here

    def _note_read(self, words: Text, span: Span, scope: _Scope) -> None:
        """Note the files among `words` that launching reads and a package lacks."""
        spelt = "".join(self._known_text((part,), scope) or _UNKNOWN_WORD for part in words)
        for word in _WORD.findall(spelt):
            path = word.strip("'\"")
            if _UNKNOWN_WORD not in path:
                self._note_missing(path, span, scope)
                self._describe(self.workspace.find(path, scope.file.parent), scope)

    def _describe(self, file: Path | None, scope: _Scope) -> None:
        """Note the meshes that a robot description names but packages lack; follow its includes."""
        if file is None or file.suffix not in DESCRIPTIONS or file in self._described:
            return
        self._described.add(file)
        try:
            text = self.workspace.text(file)
        except MarsError:
            return
        for path, span, is_included in files_named(text, self.workspace.shown(file)):
            self._note_missing(path, span, scope)
            if is_included and len(self._described) < _MOST_DESCRIPTIONS:
                self._describe(self.workspace.find(path, file.parent), scope)

    def _pass(self, argument: NodeParameter, scope: _Scope, within: _Scope) -> None:
        """Set an argument of an included file: to a value, or to an argument of the includer."""
        name = plain(argument.name)
        if name is None:
            return
        variable = self._variable_of(argument.value, scope)
        within.fixed -= {name}
        within.passed = {key: of for key, of in within.passed.items() if key != name}
        if variable is None:
            within.fixed |= {name}
        else:
            within.passed = {**within.passed, name: variable}

    def _variable_of(self, text: Text, scope: _Scope) -> str | None:
        """Return the variable if a text is only a reference to one, else None; keep its default."""
        if len(text) != 1 or not isinstance(text[0], LaunchArgument):
            return None
        name, written = text[0].name, text[0].default
        variable = scope.variable(name)
        if variable is not None and written is not None and scope.arguments.get(name) is None:
            default = self._known_text(written, scope)
            if default is not None:
                self.defaults.setdefault(variable, default)
        return variable

    def _conditions(self, tests: Tests, scope: _Scope) -> tuple[StartCondition, ...] | None:
        """Return the undecided tests as conditions, or None if a test fails in any case."""
        found: list[StartCondition] = []
        for test in tests:
            value = "true" if test.value is None else self._known_text(test.value, scope)
            variable = self._variable_of(test.text, scope)
            if variable is not None and value is not None:
                found.append(StartCondition(variable, value, test.wanted, test.span))
                continue
            given = None if variable is not None else self._known_text(test.text, scope)
            if given is None or value is None:
                arguments = (
                    scope.variable(part.name) or part.name
                    for part in test.text
                    if isinstance(part, LaunchArgument)
                )
                at = f"{test.span.path}:{test.span.line}:{test.span.column}"
                # Two that were not read may be alternatives, above all where they are of one file.
                reads = (test.span.path, *arguments)
                found.append(
                    StartCondition(f"{OPEN_CONDITION}{at}", "true", test.wanted, test.span, reads)
                )
            elif test.wanted != (
                given == value if test.value is not None else given.lower() in ("true", "1")
            ):
                return None
        return tuple(found)

    def _is_usual(self, tests: Tests, scope: _Scope) -> bool:
        """Whether tests hold with the default launch arguments, as far as these decide."""
        conditions = self._conditions(tests, scope)
        if conditions is None:
            return False
        for each in conditions:
            default = self.defaults.get(each.variable)
            is_so = default == each.value or _TRUTHS.get(default or "", "") == each.value
            if default is not None and is_so != each.wanted:
                return False
        return True

    def _add_started(self, action: Start, scope: _Scope) -> None:
        conditions = self._conditions(action.tests, scope)
        if conditions is None:
            return
        package = self._known_text(action.package, scope)
        executable = self._known_text(action.executable, scope)
        name = "" if action.name is None else self._known_text(action.name, scope)
        namespace = "" if action.namespace is None else self._known_text(action.namespace, scope)
        if package is None or executable is None:
            called = name or executable or package or "?"
            sort = "nodes whose program is known at run time alone"
            self.unread.append(Unread(sort, called, action.span))
            if not name:
                return
        if namespace is None or name is None:
            called = name or executable or "?"
            self.unread.append(Unread("names made at run time", called, action.span))
        for _, span in action.unread:
            called = name or executable or "?"
            self.unread.append(Unread("remappings made at run time", called, span))
        words = self._argument_words(action, scope)
        for before, word in pairwise(("", *words)):
            is_read = package not in _RECORDERS and before not in _OUTPUTS
            if is_read:
                self._note_missing(word, action.span, scope)
        # The name in the arguments of a program wins over that of the launch file.
        entries = {
            s: target for s, _, target in (w.partition(":=") for w in words) if s[:2] == "__"
        }
        name = entries.get("__node") or entries.get("__name") or name
        at = joined(scope.namespace, namespace or "")
        remaps = [
            *scope.remaps,
            *self._remaps(action.remaps, scope),
            *self._argued(action, words),
        ]
        given = dict(scope.parameters)
        given |= self._parameters(action.parameters, scope)
        given |= dict(_set(words, action.span))
        named = [text_of(path) for before, path in pairwise(words) if before == "--params-file"]
        paths = (*action.files, *named)
        self.started.append(
            Started(
                package or "",
                executable or "",
                action.plugin,
                _ANONYMOUS.sub(r"\1", name or ""),
                joined("/", entries.get("__ns") or at),
                tuple(rule for rule, _ in remaps),
                dict(reversed(remaps)),
                (*scope.files, *self._parameter_files(paths, scope, action.span)),
                given,
                action.span,
                (*scope.conditions, *conditions),
                tuple(words),
                any(self._is_unknown(path, scope) for path in paths),
                action.is_rewritten,
                # An unknown word, which is empty, may rename the node.
                scope.is_namespace_open
                or None in (name, namespace)
                or "" in words
                or _ANONYMOUS.search(name or "") is not None,
            )
        )

    def _argument_words(self, action: Start, scope: _Scope) -> list[str]:
        """Return the words of a program's arguments; unknown words are empty."""
        texts = [self._known_text(each, scope) or "" for each in action.arguments]
        return [word.strip("'\"") for text in texts for word in _WORD.findall(text) or [""]]

    def _argued(self, action: Start, words: Sequence[str]) -> Iterator[tuple[Renaming, Span]]:
        """Yield the remappings among a program's arguments, such as `-r a:=b` or `a:=b`."""
        ours = "--ros-args" in words
        for before, word in zip(["", *words], words, strict=False):
            source, sign, target = word.partition(":=")
            is_remapping = before in ("-r", "--remap") if ours else not source.startswith("_")
            if sign and is_remapping and source and target and not source.startswith("__"):
                yield (source, target), action.span

    def _remaps(self, remaps: Sequence[Remap], scope: _Scope) -> Iterator[tuple[Renaming, Span]]:
        for remap in remaps:
            source = self._known_text(remap.source, scope)
            target = self._known_text(remap.target, scope)
            if source and target:
                yield (source, target), remap.span
            else:
                called = self._partial_text(remap.source, scope)
                self.unread.append(Unread("remappings made at run time", called, remap.span))

    def _parameters(
        self, given: Sequence[NodeParameter], scope: _Scope, *, is_for_all: bool = False
    ) -> dict[str, GivenParameter]:
        found: dict[str, GivenParameter] = {}
        for each in given:
            steps = [self._known_text(step, scope) for step, _ in each.keys]
            names = [step for step in steps if step is not None]
            texts = [self._known_text(text, scope) for text in each.items or (each.value,)]
            known = [Scalar(text, False, each.span) for text in texts if text is not None]
            if len(names) < len(steps):
                continue
            keys = tuple(
                # Quoted, as a place is of the whole key.
                Scalar(name, True, span)
                for name, (_, span) in zip(names, each.keys, strict=True)
            )
            is_known = each.written is not None or len(known) == len(texts)
            value = known[0] if known and each.items is None else Items(tuple(known), each.span)
            found[".".join(names)] = GivenParameter(
                keys, each.written or value, is_known, is_for_all
            )
        return found

    def _parameter_files(
        self, paths: Sequence[Text], scope: _Scope, span: Span | None
    ) -> Iterator[Path]:
        for each in paths:
            path = self._known_text(each, scope)
            found = None if path is None else self.workspace.find(path, scope.file.parent)
            if found is not None:
                if span is not None:
                    self._note_missing(path, span, scope)
                yield found
            elif span is not None:
                called = self._partial_text(each, scope)
                is_missing = self._note_missing(path, span, scope)
                sort = ABSENT_PARAMETERS if is_missing else _NO_PARAMETERS
                self.unread.append(Unread(sort, called, span))

    def _is_unknown(self, path: Text, scope: _Scope) -> bool:
        """Whether a parameter file is unknown, or is missing in a package here.

        A file of another package is assumed to give the defaults of its programs.
        """
        name, folder = self._known_text(path, scope), scope.file.parent
        if name is None or self.workspace.find(name, folder) is not None:
            return name is None
        return self.workspace.lacking(name, folder) is not None

    def _known_text(self, text: Text, scope: _Scope, depth: int = 0) -> str | None:
        """Return a text with all parts replaced by their values, or None if one is unknown."""
        if depth > _DEEPEST_ARGUMENT:
            return None
        found: list[str] = []
        for part in text:
            match part:
                case str():
                    spelt: str | None = part
                case LaunchArgument(name, default):
                    spelt = scope.arguments.get(name)
                    if spelt is None and default is not None:
                        spelt = self._known_text(default, scope, depth + 1)
                case PackageShare(package):
                    named = self._known_text(package, scope, depth + 1)
                    spelt = None if named is None else f"$(find-pkg-share {named})"
                case LaunchDirectory():
                    spelt = str(scope.file.parent)
                case _:
                    spelt = None
            if spelt is None:
                return None
            found.append(spelt)
        return "".join(found)

    def _partial_text(self, text: Text, scope: _Scope) -> str:
        """Return a text for messages, in which unknown parts are `...`."""
        shown: list[str] = []
        for part in text:
            match part:
                case str():
                    shown.append(part)
                case LaunchArgument(name, _):
                    shown.append(scope.arguments.get(name) or f"$(var {name})")
                case PackageShare(package):
                    shown.append(f"$(find-pkg-share {self._partial_text(package, scope)})")
                case LaunchDirectory():
                    pass
                case _:
                    shown.append("...")
        whole = "".join(shown)
        # Without the folder of the launch file, what is left begins with the separator after it.
        whole = whole.lstrip("/") if text and isinstance(text[0], LaunchDirectory) else whole
        return whole or "..."


def _at_include(started: Started, span: Span, is_rewritten: bool) -> Started:
    """Return a node of a catalogued launch file, located at the include (`span`)."""
    shown = started.span.path
    return replace(
        started,
        span=span,
        is_rewritten=is_rewritten,
        spans={rule: span if at.path == shown else at for rule, at in started.spans.items()},
        conditions=tuple(
            replace(each, span=span) if each.span.path == shown else each
            for each in started.conditions
        ),
    )


def text_shown(text: Text) -> str:
    """Return a text for messages, in which arguments are shown by name."""
    return "".join(
        part if isinstance(part, str) else part.name if isinstance(part, LaunchArgument) else "..."
        for part in text
    )


def _set(words: Sequence[str], span: Span) -> Iterator[tuple[str, GivenParameter]]:
    """Yield the parameters among a program's arguments, such as `-p a:=1` or `_a:=1`."""
    ours = "--ros-args" in words
    for before, word in pairwise(["", *words]):
        name, sign, value = word.partition(":=")
        if ours:
            is_parameter = before in ("-p", "--param")
        else:
            is_parameter, name = re.match("_[^_]", name) is not None, name[1:]
        if sign and is_parameter and name:
            own = name.rpartition(":")[2]
            keys = tuple(Scalar(step, True, span) for step in own.split("."))
            yield own, GivenParameter(keys, Scalar(value, False, span))
