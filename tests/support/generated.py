"""Function declarations of seven languages, put together at random."""

import random
from collections.abc import Callable

_NAMES = ["scan", "pose2", "a_b", "x", "Frame", "left"]
_DATA = ["Scan", "Imu", "Pose3", "Map_t", "GridMap"]


def _parameters(rng: random.Random, one: Callable[[random.Random, str], str]) -> str:
    names = rng.sample(_NAMES, rng.randint(0, 4))
    gap = rng.choice([", ", ",", " ,\n    "])
    return gap.join(one(rng, name) for name in names)


def _c_type(rng: random.Random, templates: bool, depth: int = 0) -> str:
    kind = rng.choice([*_DATA, "int", "unsigned long", "double", "const Scan", "struct Imu"])
    if templates and depth < 3 and rng.random() < 0.5:
        inner = _c_type(rng, templates, depth + 1)
        other = _c_type(rng, templates, depth + 1)
        kind = rng.choice(
            [
                f"std::vector<{inner}>",
                f"std::map<{inner}, {other}>",
                f"ns::Topic<{inner}>::Ptr",
                f"std::function<{inner}({other})>",
                f"std::array<{inner}, 3>",
                "sensor_msgs::msg::LaserScan",
            ]
        )
    return kind


def _c_parameter(templates: bool) -> Callable[[random.Random, str], str]:
    def one(rng: random.Random, name: str) -> str:
        kind = _c_type(rng, templates)
        signs = rng.choice(["", "", "*", "* const ", "**", *(["&", "&&"] if templates else [])])
        form = rng.random()
        if form < 0.1:
            return f"{kind} (*{name})({_c_type(rng, templates)}, int)"
        if form < 0.2:
            return f"{kind} {name}[{rng.choice(['', '3', 'N + 1'])}]"
        default = ""
        if templates and form > 0.8:
            default = rng.choice([" = X{1, 2}", " = f(1, 2)", " = 3", " = T<A, B>()"])
        attribute = "[[maybe_unused]] " if templates and 0.2 < form < 0.25 else ""
        return f"{attribute}{kind} {signs}{name}{default}"

    return one


def _c(rng: random.Random) -> str:
    before = rng.choice(["", "static ", "extern ", "static inline ", "const "])
    stars = rng.choice([" ", " *", "\n", " **"])
    inside = _parameters(rng, _c_parameter(False)) or "void"
    return f"{before}{_c_type(rng, False)}{stars}build({inside}){rng.choice([';', ' { }'])}"


def _cpp(rng: random.Random) -> str:
    before = rng.choice(
        ["", "[[nodiscard]] ", "virtual ", "template <typename T> ", "static inline constexpr "]
    )
    name = rng.choice(["build", "ns::Rig::build", "operator()", "operator==", "operator+="])
    inside = _parameters(rng, _c_parameter(True))
    kind, after = _c_type(rng, True), rng.choice(["", " const", " noexcept", " const noexcept"])
    if rng.random() < 0.3:
        kind, after = "auto", f"{after} -> {kind}"
    signs = rng.choice(["", "", " *", " &"]) if kind != "auto" else ""
    return f"{before}{kind}{signs} {name}({inside}){after}{rng.choice([';', ' { return {}; }'])}"


def _java_type(rng: random.Random, depth: int = 0) -> str:
    if depth < 3 and rng.random() < 0.4:
        inner, other = _java_type(rng, depth + 1), _java_type(rng, depth + 1)
        return rng.choice(
            [
                f"List<{inner}>",
                f"java.util.Map<{inner}, {other}>",
                f"List<? extends {inner}>",
                f"Outer.Inner<{inner}>",
                f"{inner}[]",
            ]
        )
    return rng.choice([*_DATA, "Integer", "ns.Pose"])


def _java(rng: random.Random) -> str:
    def one(rng: random.Random, name: str) -> str:
        before = rng.choice(["", "", "final ", "@Nullable ", "final @Size(min = 2, max = 3) "])
        return f"{before}{_java_type(rng)} {name}{rng.choice(['', '', '[]'])}"

    before = rng.choice(["", "@Override\n", '@A("x, y(") public ', "public static "])
    generic = rng.choice(["", "", "<T> ", "<K, V extends List<K>> "])
    thrown = rng.choice(["", " throws E", " throws a.B, C"])
    return f"{before}{generic}{_java_type(rng)} build({_parameters(rng, one)}){thrown} {{ }}"


def _rust_type(rng: random.Random, depth: int = 0) -> str:
    if depth < 3 and rng.random() < 0.5:
        inner, other = _rust_type(rng, depth + 1), _rust_type(rng, depth + 1)
        return rng.choice(
            [
                f"Vec<{inner}>",
                f"Result<{inner}, {other}>",
                f"&'a {inner}",
                f"&mut {inner}",
                f"[{inner}; 3]",
                f"({inner}, {other})",
                f"Box<dyn Fn({inner}) -> {other} + Send>",
                f"impl Iterator<Item = {inner}>",
            ]
        )
    return rng.choice([*_DATA, "u8", "crate::msg::Pose"])


def _rust(rng: random.Random) -> str:
    def one(rng: random.Random, name: str) -> str:
        return f"{rng.choice(['', '', 'mut '])}{name}: {_rust_type(rng)}"

    before = rng.choice(["", "pub ", "pub(crate) async ", "#[inline]\npub ", "unsafe "])
    generic = rng.choice(["", "<T>", "<'a, T: Into<A> + 'a>", "<F: Fn(A) -> B, const N: usize>"])
    output = rng.choice(["", f" -> {_rust_type(rng)}", f" -> {_rust_type(rng)}"])
    where = rng.choice(["", " where T: Fn(A) -> B"])
    receiver = rng.choice(["", "&self, ", "&'a mut self, "])
    return f"{before}fn build{generic}({receiver}{_parameters(rng, one)}){output}{where} {{ }}"


def _go_type(rng: random.Random, depth: int = 0) -> str:
    if depth < 3 and rng.random() < 0.5:
        inner, other = _go_type(rng, depth + 1), _go_type(rng, depth + 1)
        return rng.choice(
            [
                f"[]{inner}",
                f"*{inner}",
                f"map[string]{inner}",
                f"<-chan {inner}",
                f"chan<- {inner}",
                f"func({inner}) ({other}, error)",
                f"[4]{inner}",
            ]
        )
    return rng.choice([*_DATA, "int", "pkg.Pose", "interface{}", "pkg.Box[Scan]"])


def _go(rng: random.Random) -> str:
    named = rng.random() < 0.7
    last = rng.choice(["", "", f", rest ...{_go_type(rng)}"]) if named else ""

    def one(rng: random.Random, name: str) -> str:
        kind = _go_type(rng)
        return rng.choice([f"{name} {kind}", f"{name}, {name}2 {kind}"]) if named else kind

    inside = _parameters(rng, one).replace("\n", "")
    inside = f"{inside}{last}" if inside else ""
    receiver = rng.choice(["", "(r *Rig) ", "(Rig) "])
    generic = "" if receiver else rng.choice(["", "[T any]", "[K comparable, V any]"])
    kind = _go_type(rng)
    output = rng.choice(["", kind, f"({kind}, error)", f"(out {kind}, err error)"])
    return f"func {receiver}Build{generic}({inside}) {output} {{ }}"


def _python_type(rng: random.Random, depth: int = 0) -> str:
    if depth < 3 and rng.random() < 0.5:
        inner, other = _python_type(rng, depth + 1), _python_type(rng, depth + 1)
        return rng.choice(
            [
                f"list[{inner}]",
                f"dict[str, {inner}]",
                f"{inner} | None",
                f"Callable[[{inner}], {other}]",
                f"typing.Optional[{inner}]",
            ]
        )
    return rng.choice([*_DATA, "int", "np.ndarray"])


def _python(rng: random.Random) -> str:
    def one(rng: random.Random, name: str) -> str:
        kind = rng.choice(["", f": {_python_type(rng)}", f': "{_python_type(rng)}"'])
        return f"{name}{kind} = {rng.choice(['None', '(1, 2)', '{3: 4}', 'lambda: 5'])}"

    before = rng.choice(["", "async ", "@a(b=[1, 2])\n", "@a\n@b.c\nasync "])
    inside = _parameters(rng, one)
    first = rng.choice(["", "self, ", "p: Pose, /, ", "*, k: int, "]) if inside else ""
    output = rng.choice(["", f" -> {_python_type(rng)}", f' -> "{_python_type(rng)}"'])
    return f"{before}def build({first}{inside}){output}:\n    pass"


def _matlab(rng: random.Random) -> str:
    names = rng.sample(_NAMES, rng.randint(0, 4))
    outputs = rng.sample(["u", "v", "w"], rng.randint(0, 3))
    left = (
        f"[{', '.join(outputs)}] = " if len(outputs) > 1 else f"{outputs[0]} = " if outputs else ""
    )
    inside = f"({', '.join(names)})" if names or rng.random() < 0.5 else ""
    return f"function {left}build{inside}\n x = 1;\nend"


GENERATORS: dict[str, Callable[[random.Random], str]] = {
    "c": _c,
    "cpp": _cpp,
    "go": _go,
    "java": _java,
    "matlab": _matlab,
    "python": _python,
    "rust": _rust,
}
