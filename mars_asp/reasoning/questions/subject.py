"""The things that a question names, and the errors of names without a thing."""

import re
from collections.abc import Iterable, Sequence, Set

from mars_asp.asp.rules.rulebook import Rulebook
from mars_asp.asp.signature import SPACE
from mars_asp.diagnostic import Diagnostic, MarsError, whole_file
from mars_asp.model.declarations import node_names
from mars_asp.reasoning.findings import consequence_kinds
from mars_asp.reasoning.project import Project
from mars_asp.spelling import nearest, suggestion

#: At most this many names are listed if none is similar.
_MOST_NAMES = 5
_PREDICATE = re.compile(r"(-?)([a-z_]\w*'*)(?=\()")
_STRING_OR_VARIABLE = re.compile(r'"(?:[^"\\]|\\.)*"|\b[A-Z_]\w*')


class NothingToExplainError(MarsError):
    """A correctly named subject without anything to explain: an answer rather than a mistake."""

    @property
    def sentence(self) -> str:
        """The answer in one line."""
        found = self.diagnostics[0]
        return f"{found.message}; {found.help}" if found.help else found.message


def quoted(subject: str, names: Set[str]) -> str:
    """Return a subject in which names of modules that look like variables are quoted."""

    def quote(word: re.Match[str]) -> str:
        return f'"{word[0]}"' if word[0] in names else word[0]

    return _STRING_OR_VARIABLE.sub(quote, subject)


def spaced_subjects(subject: str, rulebook: Rulebook) -> list[str]:
    """Return the readings of an atom: of the built-in predicate, and of each pack's.

    A subject that is not an atom is returned unchanged.
    """
    match = _PREDICATE.match(subject)
    if match is None or not rulebook.packs or SPACE in subject:
        return [subject]
    sign, name = match.groups()
    heads = {head.name for rule in rulebook.rules for head in rule.heads}
    spaced = sorted(each for each in heads if each.partition(SPACE)[0] == name and each != name)
    names = [*([name] if name in heads or not spaced else []), *spaced]
    return [f"{sign}{each}{subject[match.end() :]}" for each in names]


def absent_subject(
    subject: str, project: Project, rulebook: Rulebook, known: Iterable[str]
) -> MarsError:
    """Return the error that a subject names no existing thing, with a suggestion.

    `known` are the names that it may be meant for.
    """
    names = {name.text for name in project.configuration.modules}
    kind, _, rest = subject.partition("(")
    about = rest.removesuffix(")")
    is_kind = kind in consequence_kinds(rulebook)
    if project.configuration.node_kind(subject) is not None:
        message = f"the minimal specification has no node `{subject}`"
        return wrong_subject(project, message, f"`--why-not {subject}` shows what one would take")
    if not is_kind and kind not in node_names(project.configuration.kinds).values():
        message = f"this configuration has no module, node, consequence or true atom `{subject}`"
        help_text = suggestion(subject, known, "`--why-not ATOM` shows what an atom lacks")
        return wrong_subject(project, message, help_text)
    if about and about not in names:
        near = nearest(about, names)
        help_text = f"did you mean `{kind}({near})`?" if near else f"write `{kind}(NAME)`"
        return wrong_subject(project, f"unknown module `{about}`", help_text)
    question = f"`--why-not '{kind}({about or 'NAME'})'`"
    if is_kind:
        message = f"there is no `{subject}` in this configuration"
        return _nothing_to_explain(project, message, f"{question} shows why")
    message = f"`{subject}` is not the name of a node"
    return wrong_subject(project, message, f"{question} shows why there is one or none")


def no_node(subject: str, nodes: Sequence[str], project: Project) -> MarsError:
    """Return the error that a name is not a node of the specification."""
    more = f" and {len(nodes) - _MOST_NAMES} more" if len(nodes) > _MOST_NAMES else ""
    known = f"the nodes are {', '.join(nodes[:_MOST_NAMES])}{more}" if nodes else "there are none"
    if not nodes and project.configuration.kind == "specification":
        known = "nothing is added to a file that is a specification already: ask of a configuration"
        if project.configuration.origin is not None:
            known += f", as `mars-asp import {project.configuration.origin} --contract` prints it"
    message = f"`{subject}` is not a node of the specification"
    if subject in {name.text for name in project.configuration.modules}:
        message = f"`{subject}` is a module of the configuration, not a node that synthesis adds"
    return wrong_subject(project, message, suggestion(subject, nodes, known))


def unconcerned(subject: str, project: Project) -> MarsError:
    """Return the answer that a module takes part in no consequence, as an error."""
    help_text = "it takes part in no consequence"
    if project.configuration.kind == "specification":
        help_text += "; a specification resolves them, so ask about the configuration"
    return _nothing_to_explain(project, f"nothing concerns `{subject}`", help_text)


def unapplied(converter: str, project: Project) -> MarsError:
    """Return the answer that no DataTransformer applies a declared converter, as an error."""
    message = f"no DataTransformer of the minimal specification applies `{converter}`"
    help_text = "`--alternatives` shows other specifications, which may apply it"
    return _nothing_to_explain(project, message, help_text)


def _nothing_to_explain(project: Project, message: str, help_text: str) -> MarsError:
    return NothingToExplainError(wrong_subject(project, message, help_text).diagnostics)


def wrong_subject(project: Project, message: str, help_text: str) -> MarsError:
    """Return the error that a question has no valid subject."""
    return wrong_question(project.configuration.path, message, help_text)


def wrong_question(path: str, message: str, help_text: str) -> MarsError:
    """Return an error of a question about a file, without an excerpt of the file."""
    place = whole_file(path)
    return MarsError((Diagnostic("subject", "error", message, place, help=help_text, excerpt=""),))
