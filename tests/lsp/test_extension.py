"""The extension for Visual Studio Code: its highlighting and its languages."""

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from mars_asp.annotations.languages import LANGUAGES
from mars_asp.lsp.keyword_docs import ANNOTATIONS, MODES, STATEMENTS
from tests.support.documents import ROOT

FOLDER = ROOT / "editors" / "vscode"
PACKAGE: Any = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))
#: Languages as the editor calls them; one of ours is two there.
SOURCES = {"cpp": "c"}


def patterns(found: Any) -> list[str]:
    """Return all regular expressions of a grammar."""
    if isinstance(found, dict):
        own = [found[key] for key in ("match", "begin", "end") if key in found]
        return own + [each for value in found.values() for each in patterns(value)]
    return [each for value in found for each in patterns(value)] if isinstance(found, list) else []


def test_every_word_is_highlighted() -> None:
    grammar = json.loads((FOLDER / "syntaxes" / "mars.tmLanguage.json").read_text())
    regular = [re.compile(each) for each in patterns(grammar)]
    words = [*STATEMENTS, *MODES, *(f"@{each}" for each in ANNOTATIONS)]
    left = [word for word in words if not any(each.match(f"{word} x") for each in regular)]
    assert left == []


def test_every_file_that_it_names_is_there() -> None:
    contributed = PACKAGE["contributes"]
    named = [each["configuration"] for each in contributed["languages"]]
    named += [each["path"] for each in contributed["grammars"]]
    for name in (*named, PACKAGE["main"]):
        text = (FOLDER / name).read_text(encoding="utf-8")
        assert text if name.endswith(".js") else json.loads(text)


def test_it_serves_the_languages_of_sources() -> None:
    events = [each.removeprefix("onLanguage:") for each in PACKAGE["activationEvents"]]
    assert {SOURCES.get(each, each) for each in events} == set(LANGUAGES.values())
    script = (FOLDER / PACKAGE["main"]).read_text(encoding="utf-8")
    listed = re.search(r"SOURCES = (\[.*?\]);", script)
    assert listed is not None
    assert json.loads(listed[1]) == events
    page = (ROOT / "docs" / "how-to" / "editors.md").read_text(encoding="utf-8")
    line = re.search(r"filetypes = \{(.*?)\}", page)
    assert line is not None
    named = re.findall(r'"(.*?)"', line[1])
    assert named == [each["id"] for each in PACKAGE["contributes"]["languages"]] + events


@pytest.mark.skipif(shutil.which("node") is None, reason="needs Node.js")
def test_the_script_begins_the_server() -> None:
    """With mocks of the editor and the client, it starts `mars-asp lsp`."""
    script = r"""
const Module = require("module");
const started = [];
const settings = { get: (key) => ({ command: "mars-asp", arguments: ["--rules=r"] })[key] };
const stands = {
  vscode: { workspace: { getConfiguration: () => settings, createFileSystemWatcher: () => ({}) } },
  "vscode-languageclient/node": {
    LanguageClient: class {
      constructor(id, name, server, options) { started.push([server, options.documentSelector]); }
      start() { return Promise.resolve(); }
      stop() { return "stopped"; }
    },
  },
};
const load = Module._load;
Module._load = (name, ...rest) => stands[name] || load(name, ...rest);
const extension = require(process.argv[1]);
extension.activate({ subscriptions: [] });
console.log(JSON.stringify([started, extension.deactivate()]));
"""
    path = str(FOLDER / "extension.js")
    done = subprocess.run(["node", "-e", script, path], capture_output=True, text=True, check=True)
    [[server, selector]], stopped = json.loads(done.stdout)
    assert server == {"command": "mars-asp", "args": ["lsp", "--rules=r"]}
    assert {"scheme": "file", "language": "mars"} in selector
    assert stopped == "stopped"


def test_the_folder_is_not_in_the_package() -> None:
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert Path(FOLDER / "README.md").is_file()
    assert "editors" not in project
