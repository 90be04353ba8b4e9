"""Turn a function or a class of a user into the callable of a run, or refuse it with a reason."""

import inspect
import re
from collections.abc import Callable, Sequence
from functools import partial
from inspect import Parameter, Signature
from typing import Any, NamedTuple, get_args

from mars_asp.behaviour.context import Context
from mars_asp.spelling import nearest

_POSITIONAL = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)
_VARIABLE = (Parameter.VAR_POSITIONAL, Parameter.VAR_KEYWORD)
_CONTEXT = re.compile(rf"\b{Context.__name__}\b")
_TABLE = "`[bindings.NAME.parameters]`"


class UnfitError(Exception):
    """An object cannot be a behaviour; the error has a message and a help text."""

    def __init__(self, message: str, help_text: str) -> None:
        super().__init__(message)
        self.help = help_text

    def __str__(self) -> str:
        return f"{self.args[0]}: {self.help}"


class Made(NamedTuple):
    """An object of a user's class; `knows` is whether its constructor got context or parameters."""

    instance: Any
    knows: bool


class EntryPoint(NamedTuple):
    """An input of a module: its source, and its name and position if known."""

    source: str
    name: str | None = None
    place: int | None = None


def made(kind: type, context: Context) -> Made:
    """Return an object of a class for one module.

    Its constructor gets the context, if it has a parameter for that, and the parameters of the
    scenario by their names.

    Raises:
        UnfitError: the constructor lacks a parameter of the scenario, or needs a further one.
        Exception: whatever the constructor raises.
    """
    signature = _signature(kind)
    if signature is None:
        return Made(kind(), knows=False)
    shown, left = f"{kind.__name__}{_parameter_list(signature)}", dict(context.parameters)
    given, first, named = _context_of(signature), [], {}
    for name, parameter in signature.parameters.items():
        if parameter.kind in _VARIABLE or (name not in left and parameter is not given):
            if parameter.kind not in _VARIABLE and parameter.default is Parameter.empty:
                near = nearest(name, left)
                hint = f"set it in {_TABLE}, or give it a default"
                help_text = f"{_TABLE} has `{near}`: change one of them" if near else hint
                raise UnfitError(f"`{shown}` needs the parameter `{name}`", help_text)
            continue
        value = context if parameter is given else left.pop(name)
        if parameter.kind is Parameter.POSITIONAL_ONLY:
            first.append(value)
        else:
            named[name] = value
    if any(p.kind is Parameter.VAR_KEYWORD for p in signature.parameters.values()):
        named, left = {**left, **named}, {}
    if left and given is None:
        wrong = next(iter(left))
        known = [name for name, parameter in signature.parameters.items()]
        near = nearest(wrong, known)
        hint = f"did you mean `{near}`?" if near else f"take it from {_TABLE}"
        raise UnfitError(f"`{shown}` takes no parameter `{wrong}`", hint)
    return Made(kind(*first, **named), knows=bool(first or named))


def method_of(instance: object, name: str | None) -> Callable[..., Any]:
    """Return a method of an object, or without a name the object itself, which has to be callable.

    Raises:
        UnfitError: the object has no such method, or is not callable.
    """
    kind = type(instance).__name__
    methods = [each for each in dir(instance) if not each.startswith("_")]
    methods = [each for each in methods if callable(getattr(instance, each, None))]
    found: Any = instance if name is None else getattr(instance, name, None)
    if callable(found):
        return found  # type: ignore[no-any-return]
    near = nearest(name, methods) if name else None
    some = f"name one, as in `FILE.py:{kind}.{methods[0] if methods else 'step'}`"
    if not methods and callable(instance):
        some = f"leave out `.{name}`: an object of the class is called"
    help_text = f"did you mean `{near}`?" if near else some
    what = f"method `{name}`" if name else "`__call__`"
    raise UnfitError(f"the class `{kind}` has no {what}", help_text)


def prepared(
    target: Callable[..., Any],
    context: Context,
    clock: Callable[[], float],
    inputs: Sequence[EntryPoint | str] | None = None,
    *,
    knows: bool = False,
) -> Callable[..., Any]:
    """Return a function that takes the inputs of one computation and returns its result.

    `inputs` has an entry point or a source for each input; None means unknown inputs. The values
    come in this order, and each goes to the parameter of the input's name, else to that at its
    position, else to the first free one. `knows` is whether the object of a method has the context
    or the parameters already. Before each call, the time of the context is set from `clock`, in
    seconds.

    Raises:
        UnfitError: `target` cannot be called with so many inputs, or does not return one result.
    """
    shown = getattr(target, "__qualname__", type(target).__name__)
    _refuse_stretched(target, shown)
    signature = _signature(target)
    given = None if signature is None else _context_of(signature)
    order = None
    if context.parameters and given is None and not knows:
        text = ", ".join(f"`{name}`" for name in context.parameters)
        help_text = "add a parameter `ctx`, and read `ctx.parameters`"
        raise UnfitError(f"`{shown}` takes no `ctx`, so it cannot read {text}", help_text)
    if signature is not None and inputs is not None:
        entries = [EntryPoint(each) if isinstance(each, str) else each for each in inputs]
        _refuse_inputs(signature, given, entries, shown)
        order = _parameter_order(signature, given, entries, shown)
    if given is not None and signature is not None:
        target = _handing(target, signature, given, context)
    if order is not None:
        target = order(target)
    if given is None and not knows:
        return target

    def call(*values: Any) -> Any:
        context.advance(clock())
        return target(*values)

    return call


def _parameter_order(
    signature: Signature, given: Parameter | None, inputs: Sequence[EntryPoint], shown: str
) -> Callable[[Callable[..., Any]], Callable[..., Any]] | None:
    """Return a decorator that passes each of `inputs` to its parameter; None if they fit.

    Raises:
        UnfitError: nothing feeds a parameter, or several inputs have names that are not parameters.
    """
    parameters = [each for each in _positional(signature) if each is not given]
    filled = _filled(parameters, inputs)
    last = max(filled, default=-1)
    for number, each in enumerate(parameters[: last + 1]):
        if number not in filled and each.default is Parameter.empty:
            message = f"nothing feeds the parameter `{each.name}` of `{shown}`"
            raise UnfitError(message, "add a line that feeds it, or give it a default")
    names = {each.name for each in parameters}
    strangers = [
        inputs[at].name
        for at in filled.values()
        if inputs[at].place is None and inputs[at].name not in {*names, None}
    ]
    if len(strangers) > 1:
        listed = ", ".join(f"`{name}`" for name in strangers)
        message = f"`{shown}{_parameter_list(signature)}` has no parameters {listed}"
        known = ", ".join(f"`{each.name}`" for each in parameters)
        raise UnfitError(message, f"name the inputs in the lines like the parameters: {known}")
    further = [at for at in range(len(inputs)) if at not in filled.values()]
    order = [filled.get(number) for number in range(last + 1)]
    if [*order, *further] == list(range(len(inputs))):
        return None
    defaults = [each.default for each in parameters]

    def reorder(target: Callable[..., Any]) -> Callable[..., Any]:
        def call(*values: Any) -> Any:
            first = [defaults[n] if at is None else values[at] for n, at in enumerate(order)]
            return target(*first, *(values[at] for at in further))

        return call

    return reorder


def _filled(parameters: Sequence[Parameter], inputs: Sequence[EntryPoint]) -> dict[int, int]:
    """Return the input of each parameter, both as indices: by name, by position, then in order."""
    number_of: dict[str | None, int] = {each.name: n for n, each in enumerate(parameters)}
    filled: dict[int, int] = {}

    def fill(at: int, number: int | None) -> None:
        if number is not None and number < len(parameters) and number not in filled:
            if at not in filled.values():
                filled[number] = at

    for at, each in enumerate(inputs):
        fill(at, number_of.get(each.name))
    for at, each in enumerate(inputs):
        fill(at, each.place)
    for at in range(len(inputs)):
        fill(at, next((n for n in range(len(parameters)) if n not in filled), None))
    return filled


def _handing(
    target: Callable[..., Any], signature: Signature, given: Parameter, context: Context
) -> Callable[..., Any]:
    """Return a function of inputs that calls `target` with them and the context."""
    named = partial(target, **{given.name: context})
    if given.kind is Parameter.KEYWORD_ONLY:
        return named
    index = _positional(signature).index(given)

    def call(*values: Any) -> Any:
        if len(values) < index:  # parameters with defaults come before it
            return named(*values)
        return target(*values[:index], context, *values[index:])

    return call


def _signature(target: Callable[..., Any]) -> Signature | None:
    """Return the signature of a callable, or None if Python cannot determine it."""
    try:
        return inspect.signature(target, eval_str=True)
    except Exception:  # an annotation that Python cannot read may raise anything
        pass
    try:
        return inspect.signature(target)
    except (TypeError, ValueError):
        return None


def _context_of(signature: Signature) -> Parameter | None:
    """Return the parameter for the context: called `ctx`, or annotated `Context`; else None."""
    for parameter in signature.parameters.values():
        written = parameter.annotation
        if isinstance(written, str):
            annotated = bool(_CONTEXT.search(written))
        else:
            annotated = Context in (written, *get_args(written))
        if parameter.kind not in _VARIABLE and (parameter.name == "ctx" or annotated):
            return parameter
    return None


def _positional(signature: Signature) -> list[Parameter]:
    return [each for each in signature.parameters.values() if each.kind in _POSITIONAL]


def _refuse_stretched(target: Callable[..., Any], shown: str) -> None:
    """Raise UnfitError for generators and asynchronous functions."""
    own = target if inspect.isroutine(target) else getattr(target, "__call__", target)  # noqa: B004
    for each in (target, own):
        if inspect.isgeneratorfunction(each) or inspect.isasyncgenfunction(each):
            help_text = "return one result for each call; a class keeps state between calls"
            raise UnfitError(f"`{shown}` is a generator (it has `yield`)", help_text)
        if inspect.iscoroutinefunction(each):
            help_text = "write `def`: it is called when its inputs are there, and returns at once"
            raise UnfitError(f"`{shown}` is asynchronous (`async def`)", help_text)


def _refuse_inputs(
    signature: Signature, given: Parameter | None, inputs: Sequence[EntryPoint], shown: str
) -> None:
    """Raise UnfitError if a function cannot be called with so many inputs."""
    taken = [each for each in _positional(signature) if each is not given]
    least = sum(each.default is Parameter.empty for each in taken)
    kinds = {each.kind for each in signature.parameters.values()}
    most = float("inf") if Parameter.VAR_POSITIONAL in kinds else len(taken)
    for each in signature.parameters.values():
        needed = each.kind is Parameter.KEYWORD_ONLY and each.default is Parameter.empty
        if needed and each is not given:
            help_text = "only `ctx` is given by name: put it before the `*`, or give it a default"
            raise UnfitError(f"`{shown}` takes `{each.name}` by name", help_text)
    if least <= len(inputs) <= most:
        return
    bound, number = ("", most) if least == most else ("at most ", most)
    if len(inputs) < least:
        bound, number = ("", least) if least == most else ("at least ", least)
    wants = f"{bound}{number} input{'s' * (number != 1)}" if number else "no inputs"
    sources = ", ".join(each.source for each in inputs)
    come = f"{len(inputs)} ({sources})" if inputs else "none"
    message = f"`{shown}{_parameter_list(signature)}` takes {wants}, and the module gets {come}"
    raise UnfitError(message, "give it one parameter for each input, in the order of the lines")


def _parameter_list(signature: Signature) -> str:
    """Return the parameters of a function as text, without types."""
    bare = [each.replace(annotation=Parameter.empty) for each in signature.parameters.values()]
    return str(Signature(bare))
