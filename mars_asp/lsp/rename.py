"""Renaming of a module in all files of its robots: configurations, includes and sources."""

from mars_asp.lsp.places import Position, Range, TextEdit
from mars_asp.lsp.references import same_module
from mars_asp.lsp.robot import DocumentContext, prefixed_name
from mars_asp.model.names import read_name, written


class RefusedError(Exception):
    """A module cannot get the requested name; the message gives the reason."""


def renamed_range(scene: DocumentContext, position: Position) -> Range | None:
    """Return the range of the module name at a position, or None if there is none."""
    mention = scene.here.at(position)
    if mention is None or not mention.range.holds(position):
        return None
    return mention.range


def rename(scene: DocumentContext, position: Position, name: str) -> tuple[TextEdit, ...]:
    """Return the edits that rename the module at a position.

    A module of an included file has the name of the include as a prefix in other files.

    Raises:
        RefusedError: no module is at the position, or the name is taken or invalid.
    """
    mention = scene.here.at(position)
    if mention is None or not mention.range.holds(position):
        raise RefusedError("there is no module here")
    new = read_name(name) or name
    if not new.strip() or not new.isprintable():
        raise RefusedError("a name is one line of letters, digits and signs")
    same = same_module(scene, mention)
    own = min((each.name for _, each in same), key=len)
    before = mention.name.removesuffix(own)
    if not new.startswith(before):
        result = f"`{mention.name}` is included as `{before.rstrip('/')}`: begin with `{before}`"
        raise RefusedError(f"{result}, or rename the include")
    new = new.removeprefix(before)
    if new == own:
        return ()
    places = {place for place, _ in same}
    for robot in scene.robots:
        for file in scene.files(robot):
            for each in file.mentions:
                wanted = {each.name.removesuffix(own) + new for _, each in same}
                if each.name in wanted and (file.path, each.range) not in places:
                    result = prefixed_name(file.prefix, each.name)
                    raise RefusedError(f"`{result}` is a module already")
    return tuple(
        TextEdit(place, written(each.name.removesuffix(own) + new)) for place, each in same
    )
