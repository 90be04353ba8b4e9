"""Places of keys and entries: those that a writer of TOML notes, and of texts that are odd."""

import json
import random
import tomllib

import pytest

from mars_asp.language.toml_text import Places

Path = tuple[str | int, ...]
NAMES = ["a", "b-1", "c_2", "D", "ü b", "d.e", '"', "f'", "# g", "\U0001f916", "x=1", "[h]"]
BARE = set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")


class Writer:
    """Writes random TOML and notes the location of every key and value."""

    def __init__(self, seed: int) -> None:
        self.rng, self.text = random.Random(seed), ""
        self.noted: dict[Path, tuple[int, int]] = {}

    def note(self, path: Path) -> None:
        line = self.text.count("\n") + 1
        column = len(self.text) - (self.text.rfind("\n") + 1) + 1
        self.noted.setdefault(path, (line, column))

    def put(self, *choices: str) -> None:
        self.text += self.rng.choice(choices)

    def key(self, parts: tuple[str, ...], under: Path) -> None:
        for count, part in enumerate(parts, 1):
            self.note((*under, *parts[:count]))
            forms = [json.dumps(part, ensure_ascii=self.rng.random() < 0.5 and part.isascii())]
            if set(part) <= BARE:
                forms.append(part)
            if "'" not in part:
                forms.append(f"'{part}'")
            self.put(*forms)
            if count < len(parts):
                self.put(".", " . ")

    def names(self, count: int) -> list[str]:
        return self.rng.sample(NAMES, count)

    def value(self, path: Path, depth: int) -> None:
        sort = self.rng.randrange(5 if depth < 4 else 3)
        if sort < 2:
            self.put("1", "-0.5e3", "true", "1979-05-27", "nan", '"]},# "', "'''\n[x]\n'''")
        elif sort == 2:
            self.put('"""\n a = [1]\n"""', '"é 🤖"', r'"\" = \\"', "''")
        elif sort == 3:
            self.put("[", "[ ", "[ # ], [\n", "[\n\n")
            for number in range(self.rng.randrange(4)):
                self.note((*path, number))
                self.value((*path, number), depth + 1)
                self.put(",", " , ", ",\n", ", # ü ]\n")
            self.put("]", " ]")
        else:
            self.put("{", "{ ")
            for index, name in enumerate(self.names(self.rng.randrange(4))):
                self.put(", ") if index else None
                parts = (name, *self.names(self.rng.randrange(2)))
                self.key(parts, path)
                self.put("=", " = ")
                self.value((*path, *parts), depth + 1)
            self.put("}", " }")

    def pairs(self, under: Path) -> None:
        for name in self.names(self.rng.randrange(4)):
            self.put("", "  ")
            parts = (name, *self.names(self.rng.randrange(3)))
            self.key(parts, under)
            self.put("=", " = ", "\t=  ")
            self.value((*under, *parts), 0)
            self.put("\n", " # a = 1\n", "\r\n")

    def document(self) -> str:
        self.pairs(())
        for name in (f"t{index}" for index in range(self.rng.randrange(4))):
            if self.rng.random() < 0.5:
                self.put("[", "[ ")
                parts = (name, *self.names(self.rng.randrange(2)))
                self.key(parts, ())
                self.put("]\n", " ] # [y]\n")
                self.pairs(parts)
                continue
            for number in range(self.rng.randrange(1, 4)):
                self.note((name, number))
                self.put("[[")
                self.key((name,), ())
                self.put("]]\n")
                self.pairs((name, number))
                if self.rng.random() < 0.5:
                    self.put("[")
                    self.note((name,))
                    self.text += f"{name}."
                    self.key(("inner",), (name, number))
                    self.put("]\n")
                    self.pairs((name, number, "inner"))
        return self.text


def test_places_are_those_that_the_writer_notes() -> None:
    for writer in map(Writer, range(400)):
        text = writer.document()
        tomllib.loads(text)
        places = Places(text.replace("\r\n", "\n"), "s.toml")
        paths = list(writer.noted)
        writer.rng.shuffle(paths)
        for path in paths:
            place = places.of(*path)
            assert (place.line, place.column) == writer.noted[path], (path, text)


@pytest.mark.parametrize(
    ("path", "place"),
    [
        (("robot", "nothing"), (2, 2)),
        (("robot", "start", 7), (3, 1)),
        (("nothing", 3, "at"), (0, 0)),
        ((), (0, 0)),
    ],
)
def test_a_missing_key_has_the_location_of_its_table(path: Path, place: tuple[int, int]) -> None:
    found = Places("seed = 1\n[robot]\nstart = [1, 2]\n", "s.toml").of(*path)
    assert (found.line, found.column) == place


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a = ",
        "]" * 10_000,
        "a = " + "[" * 100_000,
        "a = " + "{b=" * 100_000,
        "[" * 100_000,
        ".".join(["a"] * 100) + " = 1",
        "a = '" + "x" * 1_000_000,
        "a = [" + "[1, 2], " * 100_000 + "]",
    ],
    ids=lambda text: f"{text[:8]}...{len(text)}",
)
def test_no_text_is_too_much(text: str) -> None:
    places = Places(text, "s.toml")
    assert places.of("a").line == places.of("a", 99_999, 1, "b").line <= 1
