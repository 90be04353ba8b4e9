"""The arguments of behaviours in functions and classes, and refusals of others."""

from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from mars_asp.behaviour import Context
from mars_asp.behaviour.calls import UnfitError, made, method_of, prepared


def context(**parameters: Any) -> Context:
    return Context("M", 7, parameters)


def defined(text: str) -> Any:
    """Return the object `f` that a text defines."""
    names: dict[str, Any] = {"Context": Context}
    exec(text, names)
    return names["f"]


@pytest.mark.parametrize(
    ("text", "inputs"),
    [
        ("def f(x, y): return x, y, None", 2),
        ("def f(ctx, x, y): return x, y, ctx", 2),
        ("def f(x, ctx, y): return x, y, ctx", 2),
        ("def f(x, y, ctx): return x, y, ctx", 2),
        ("def f(ctx, /, x, y): return x, y, ctx", 2),
        ("def f(x, y, /, *, ctx): return x, y, ctx", 2),
        ("def f(x, y=2, ctx=None): return x, y, ctx", 1),
        ("def f(x, y=2, z=3, *, ctx): return x, y, ctx", 1),
        ("def f(x, y, my: Context): return x, y, my", 2),
        ("def f(x, y, my: Context | None = None): return x, y, my", 2),
        ("def f(x, y, my: 'Context'): return x, y, my", 2),
        ("def f(x, y, my: 'behaviour.Context | Missing'): return x, y, my", 2),
        ("def f(ctx, *inputs): return *inputs, ctx", 2),
        ("def f(*inputs, ctx): return *inputs, ctx", 2),
        ("def f(x, y, *ctx): return x, y, None", 2),
    ],
)
def test_the_context_is_passed_to_every_parameter_for_it(text: str, inputs: int) -> None:
    own = context()
    call = prepared(defined(text), own, lambda: 4.0, ["A", "B"][:inputs])
    x, y, given = call(*[1, 2][:inputs])
    assert (x, y) == (1, 2)
    assert given is (own if "ctx" in text.replace("*ctx", "") or "Context" in text else None)
    assert own.now == (4.0 if given is own else 0.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("def f(): ...", "`f()` takes no inputs, and the module gets 1 (Eye): give it one"),
        ("def f(x, y): ...", "`f(x, y)` takes 2 inputs, and the module gets 1 (Eye)"),
        ("def f(x, y, *rest): ...", "`f(x, y, *rest)` takes at least 2 inputs, and the module"),
        ("def f(x, *, gain): ...", "`f` takes `gain` by name: only `ctx` is given by name"),
        ("async def f(x): ...", "`f` is asynchronous (`async def`)"),
        ("def f(x): yield x", "`f` is a generator (it has `yield`)"),
        ("async def f(x): yield x", "`f` is a generator (it has `yield`)"),
        ("class K:\n  def __call__(self, x): yield x\nf = K()", "`K` is a generator"),
        ("class K:\n  async def step(self, x): ...\nf = K().step", "`K.step` is asynchronous"),
        ("class K:\n  def step(self): ...\nf = K().step", "`K.step()` takes no inputs"),
    ],
)
def test_an_object_that_cannot_be_called_is_refused_with_help(text: str, message: str) -> None:
    with pytest.raises(UnfitError) as raised:
        prepared(defined(text), context(), lambda: 0.0, ["Eye"])
    assert str(raised.value).startswith(message)


def test_too_many_inputs() -> None:
    with pytest.raises(UnfitError, match=r"takes at most 1 input, and the module gets 2 \(A, B\)"):
        prepared(defined("def f(x=1): ..."), context(), lambda: 0.0, ["A", "B"])


def test_a_callable_without_known_parameters_is_called_unchanged() -> None:
    assert prepared(max, context(), lambda: 0.0, ["A", "B"])(3, 4) == 4
    assert prepared(partial(pow, 2), context(), lambda: 0.0, ["A"])(3) == 8


def test_parameters_that_nothing_can_read_are_refused() -> None:
    with pytest.raises(UnfitError, match="`f` takes no `ctx`, so it cannot read `near`"):
        prepared(defined("def f(x): ..."), context(near=3), lambda: 0.0, ["A"])
    with pytest.raises(KeyError, match="no parameter `neer`: did you mean `near`"):
        context(near=3).parameters["neer"]
    with pytest.raises(KeyError, match="no parameter `far`: give it in"):
        context(near=3).parameters["far"]


class Keeping:
    def __init__(self, near: float, ctx: Context, far: float = 9.0) -> None:
        self.near, self.ctx, self.far = near, ctx, far

    def __call__(self) -> tuple[float, float, float]:
        return self.near, self.far, self.ctx.now


def test_a_constructor_is_given_parameters_by_name_and_a_context_that_is_kept_current() -> None:
    own = context(near=3.0)
    instance, knows = made(Keeping, own)
    times = iter([1.5, 1.6])
    call = prepared(instance, own, lambda: next(times), [], knows=knows)
    assert (call(), own.dt) == ((3.0, 9.0, 1.5), 0.0)
    assert (call(), own.dt) == ((3.0, 9.0, 1.6), 0.1)


@pytest.mark.parametrize(
    ("kind", "parameters", "message"),
    [
        ("class f:\n  def __init__(self, near): ...", {}, "`f(near)` needs the parameter `near`"),
        (
            "class f:\n  def __init__(self, near): ...",
            {"neer": 1},
            "`f(near)` needs the parameter `near`: `[bindings.NAME.parameters]` has `neer`",
        ),
        (
            "class f:\n  def __init__(self, near=1): ...",
            {"neer": 1},
            "`f(near=1)` takes no parameter `neer`: did you mean `near`?",
        ),
        ("class f: ...", {"near": 1}, "`f()` takes no parameter `near`: take it from"),
    ],
)
def test_parameters_that_a_constructor_lacks_or_does_not_know(
    kind: str, parameters: dict[str, Any], message: str
) -> None:
    with pytest.raises(UnfitError) as raised:
        made(defined(kind), context(**parameters))
    assert str(raised.value).startswith(message)


def test_a_constructor_may_take_all_parameters() -> None:
    text = "class f:\n  def __init__(self, a, /, b, **rest): self.all = a, b, rest"
    assert made(defined(text), context(a=1, b=2, c=3)).instance.all == (1, 2, {"c": 3})


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (None, "has no `__call__`: name one, as in `FILE.py:Thing.step`"),
        ("stp", "did you mean `step`?"),
    ],
)
def test_a_method_that_is_not_there(name: str | None, message: str) -> None:
    class Thing:
        def step(self) -> None: ...

    with pytest.raises(UnfitError) as raised:
        method_of(Thing(), name)
    assert message in str(raised.value)
    step: Callable[..., Any] = method_of(Thing(), "step")
    assert step() is None
