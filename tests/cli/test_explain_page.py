"""The page of `explain -o`: held against the JSON of the same question and the files themselves."""

import json
import re
import shutil
from base64 import b64encode
from collections.abc import Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest

from mars_asp.cli import explain
from tests.support.browser import Browser, in_a_browser
from tests.support.configurations import IMPOSSIBLE
from tests.support.documents import ROOT, run
from tests.support.fixtures import Patch
from tests.support.pages import Page

HOSTILE = """\
@configuration hierarchical // </script><script>alert(1)</script> <!-- & "q"
@modules Src, Grüße, B, Base
@sources odd.cpp
Grüße uses_data_from Src
B uses_data_from Src // </li></ol><img src=x onerror=alert(1)>'"`</title>
Base is_controlled_by B 1
Base is_controlled_by Grüße 1
"""
SOURCE = """\
/* @module_start
@module_name Src
@Sense NotifyAtFrequency 25 */
std::map<Ray, Ray> grab();
/* @module_end */
/* @module_start
@module_name B
@ControlOut */
Motion act(std::map<Key, Value> x);
/* @module_end */
// \u202e</script>
"""
PLAIN = "@configuration\n@modules A, B\nA uses_data_from B\n"


@pytest.fixture(scope="module", params=["level1", "module-conflict", "scara", "gripper-arm", "odd"])
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a robot, `config.mars`."""
    if request.param != "odd":
        return ROOT / "examples" / str(request.param)
    made = tmp_path_factory.mktemp("odd")
    (made / "config.mars").write_text(HOSTILE, encoding="utf-8")
    (made / "odd.cpp").write_text(SOURCE, encoding="utf-8")
    return made


@cache
def page_and_json(folder: Path, words: str = "") -> tuple[str, Any]:
    """Return the page of a question, and its JSON."""
    page = run(f"mars-asp explain config.mars {words} --quiet -o -", folder)
    begin = page.index("<!DOCTYPE")
    known = run(f"mars-asp explain config.mars {words} --quiet --format json", folder)
    (line,) = (line for line in known.splitlines() if line.startswith('{"format"'))
    return page[begin:], json.loads(line)


def test_ids_links_and_labels_lead_somewhere_in_the_page(folder: Path) -> None:
    page = Page(page_and_json(folder)[0])
    ids = page.by_id()
    for each in page.top.all():
        for name in ("href", "aria-labelledby", "for"):
            if name in each.attributes:
                assert each.attributes[name].removeprefix("#") in ids
        assert not [name for name in each.attributes if name.startswith("on") or name == "src"]
        if each.name in ("a", "summary"):
            assert each.text.strip()


def test_every_topic_has_its_answer_and_the_lines_that_it_cites(folder: Path) -> None:
    text, known = page_and_json(folder)
    page = Page(text)
    ids = page.by_id()
    assert known["topics"]
    for number, topic in enumerate(known["topics"], 1):
        shown = ids[f"t{number}"]
        (summary,) = shown.all("summary")
        answer = f"{topic['name']}: {plain(topic['answer']).removesuffix('.')}"
        links = list(shown.all("a", "place"))
        if "data-finding" in shown.attributes:
            assert summary.text.startswith(f"{shown.attributes['data-finding']} ")
            assert summary.text.endswith(f"{answer}. {links[0].text}")
        else:
            assert summary.text.removesuffix(".").endswith(answer)
        cited = [each.removesuffix("\n") for each in lines_of(folder, topic["lines"])]
        found = [ids[each.attributes["href"][1:]].text for each in links]
        assert found == cited
        for note in topic["notes"]:
            assert plain(note) in [each.text for each in shown.all("p")]
        for name in topic["resolves"]:
            assert name in [each.text for each in shown.all("a")]


def plain(text: str) -> str:
    return re.sub("`([^`]*)`", r"\1", text)


def lines_of(folder: Path, places: list[dict[str, Any]]) -> list[str]:
    """Return the lines of files at locations, with control characters made visible."""
    found = []
    for place in places:
        whole = (folder / place["path"]).read_text(encoding="utf-8").split("\n")
        found.append(whole[place["line"] - 1].expandtabs(4).replace("\u202e", r"\u202e"))
    return found


def test_a_file_is_shown_whole(folder: Path) -> None:
    page = Page(page_and_json(folder)[0])
    (configuration, *_) = (
        each for each in page.top.all("section") if "data-name" in each.attributes
    )
    assert configuration.attributes["data-name"] == "config.mars"
    whole = (folder / "config.mars").read_text(encoding="utf-8").removesuffix("\n").split("\n")
    lines = list(configuration.all("li"))
    assert [each.text for each in lines] == [line.expandtabs(4) for line in whole]
    assert [int(each.attributes["value"]) for each in lines] == list(range(1, len(whole) + 1))


@pytest.mark.parametrize("words", ["", "--all"])
def test_a_trace_leads_to_the_lines_that_the_json_document_has(folder: Path, words: str) -> None:
    text, known = page_and_json(folder, words)
    page = Page(text)
    ids = page.by_id()
    traces = json.loads(ids["traces"].text)
    in_document: dict[int, Any] = {}
    for trace in known["traces"]:
        number_steps(trace, in_document)
    for trace, why in zip(known["traces"], traces["why"], strict=True):
        wanted = {
            (place["path"], place["line"])
            for step in reached_in_json(trace, in_document)
            if (place := step.get("location"))
        }
        found = set()
        for step in reached(traces["steps"], why):
            assert step["kind"] in ("given", "derived", "chosen", "absent", "computed")
            if "at" in step:
                line = ids[step["at"]]
                section = next(s for s in page.top.all("section") if line in s.all("li"))
                found.add((section.attributes["data-name"], int(line.attributes["value"])))
        assert found == wanted


def number_steps(step: Any, found: dict[int, Any]) -> None:
    if "id" in step:
        found[step["id"]] = step
    for each in (*step.get("premises", ()), *step.get("others", ())):
        number_steps(each, found)


def reached_in_json(trace: Any, numbered: dict[int, Any]) -> Iterator[Any]:
    waiting, seen = [trace], set()
    while waiting:
        step = waiting.pop()
        step = numbered[step["ref"]] if "ref" in step else step
        if step["id"] not in seen:
            seen.add(step["id"])
            yield step
            waiting += [*step["premises"], *step.get("others", ())]


def reached(steps: list[Any], why: list[int]) -> Iterator[Any]:
    waiting, seen = list(why), set()
    while waiting:
        number = waiting.pop()
        if number not in seen:
            seen.add(number)
            step = steps[number - 1]
            yield step
            waiting += [*step.get("from", ()), *step.get("others", ())]


def test_nothing_is_fetched_and_no_text_of_others_becomes_markup(folder: Path) -> None:
    text, _ = page_and_json(folder)
    page = Page(text)
    assert set(re.findall(r"https?://[^\"]*", text)) == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"@import|url\((?!#)|fetch\(|import\(", text)
    names = {each.name for each in page.top.all()}
    assert not names & {"img", "iframe", "object", "link", "base", "form", "embed"}
    assert not re.search("[\u202e\0]", text)
    data, script = page.top.all("script")
    assert data.attributes["type"] == "application/json"
    (style,) = page.top.all("style")
    policy = next(
        each.attributes["content"]
        for each in page.top.all("meta")
        if each.attributes.get("http-equiv") == "Content-Security-Policy"
    )
    assert policy.startswith("default-src 'none'; ")
    for part, of in (("style", style), ("script", script)):
        digest = b64encode(sha256(of.text.encode()).digest()).decode()
        assert f"{part}-src 'sha256-{digest}'" in policy


def test_boxes_of_nodes_link_to_their_explanations(folder: Path) -> None:
    text, known = page_and_json(folder)
    page = Page(text)
    ids = page.by_id()
    (svg,) = page.top.all("svg")
    boxes = {
        each.attributes["aria-label"]: each
        for each in svg.all("a")
        if " is_" not in each.attributes["aria-label"]
    }
    nodes = {topic["name"] for topic in known["topics"] if topic["sort"] == "node"}
    assert nodes <= boxes.keys()
    for name, box in boxes.items():
        target = ids[box.attributes["href"][1:]]
        if target.name == "option":
            assert name == target.attributes["value"]
            assert not any(topic["name"].endswith(f"({name})") for topic in known["topics"])
            continue
        (group,) = (each for each in box.all("g"))
        if "data-finding" in group.attributes:
            first, *_ = group.attributes["data-finding"].split()
            assert target.attributes["data-finding"] == first
            continue
        summary = next(target.all("summary")).text
        assert f"{name}:" in summary if name in nodes else f"({name})" in summary


def test_errors_come_first(tmp_path: Path) -> None:
    (tmp_path / "config.mars").write_text(IMPOSSIBLE)
    text, _ = page_and_json(tmp_path)
    first, *_ = [each.text for each in Page(text).top.all("h2")]
    assert first == "Errors (1)"
    assert text.index("Errors (1)") < text.index("<svg") < text.index("Why not?")
    assert 'class="topic error"' in text
    assert "✖ 1 error<" in text
    assert "no specification realises this configuration" in text


def test_the_head_counts_errors_and_warnings(tmp_path: Path) -> None:
    text = "@configuration hierarchical\n@modules A, B, C\nA is_controlled_by B 1\n"
    (tmp_path / "config.mars").write_text(f"{text}A is_controlled_by C 1\n", encoding="utf-8")
    for folder, counts in (
        (ROOT / "examples" / "module-conflict", "✖ 3 errors"),
        (ROOT / "examples" / "level1", "✔ no errors and no warnings"),
        (tmp_path, "▲ 1 warning"),
    ):
        page = Page(page_and_json(folder)[0])
        assert [each.text for each in page.top.all("p", "counts")] == [counts]


def test_a_finding_has_one_number_in_the_list_and_the_picture() -> None:
    page = Page(page_and_json(ROOT / "examples" / "module-conflict")[0])
    numbers = [f"{number}" for number in (1, 2, 3)]
    topics = [each for each in page.top.all("details") if "data-finding" in each.attributes]
    assert [each.attributes["data-finding"] for each in topics] == numbers
    assert [next(each.all("span", "number")).text for each in topics] == numbers
    (svg,) = page.top.all("svg")
    marked = [each.attributes for each in svg.all("g") if "data-finding" in each.attributes]
    assert {each for marks in marked for each in marks["data-finding"].split()} == set(numbers)
    assert all("finding error" in each["class"] for each in marked)
    links = {each.attributes["aria-label"]: each.attributes["href"] for each in svg.all("a")}
    assert links["Laser is_mounted_on Head 1 (_,_,_,_,_,20)"] == f"#{topics[0].attributes['id']}"


def test_a_robot_without_anything_to_explain_has_a_page(tmp_path: Path) -> None:
    (tmp_path / "config.mars").write_text(PLAIN)
    text, _ = page_and_json(tmp_path)
    assert "nothing to resolve, so nothing to explain" in text
    assert not list(Page(text).top.all("details"))
    assert len(list(Page(text).top.all("svg"))) == 1


def test_an_atom_has_its_trace(tmp_path: Path) -> None:
    text, _ = page_and_json(ROOT / "examples" / "scara", '\'gives("Tool","Wrist","Rotn_Z")\'')
    page = Page(text)
    (topic,) = page.top.all("details")
    assert "config.mars:" in topic.text
    assert json.loads(page.by_id()["traces"].text)["why"][0]


def test_files_that_are_too_large_are_left_out(tmp_path: Path, monkeypatch: Patch) -> None:
    names = [f"M{number}" for number in range(501)]
    uses = [f"{name} uses_data_from M0" for name in names[1:3]]
    written = "\n".join(["@configuration", f"@modules {', '.join(names)}", *uses, ""])
    (tmp_path / "config.mars").write_text(written)
    monkeypatch.setattr(explain, "_MOST_TRACED", 500)
    text = run("mars-asp explain config.mars -o -", tmp_path)
    page = Page(text)
    assert not list(page.top.all("svg"))
    assert "There is no picture here: 502 boxes with 3 lines are too many to be read." in text
    assert "as there are more than" in text
    traces = json.loads(page.by_id()["traces"].text)
    assert traces["steps"] == []
    assert not any(traces["why"])


EXAMPLE = "examples/figure04-divergence"


def test_a_page_is_written_as_in_the_readme(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples" / "figure04-divergence", tmp_path / EXAMPLE)
    (command,) = re.findall("^mars-asp explain .* -o .*$", (ROOT / "README.md").read_text(), re.M)
    assert run(command, tmp_path) == ""
    written = (tmp_path / command.split()[-1]).read_text(encoding="utf-8")
    assert written == run(f"mars-asp explain {EXAMPLE}/config.mars -o -", tmp_path)


def page_of(browser: Browser, folder: Path, path: Path, **words: Any) -> None:
    path.write_text(page_and_json(folder)[0], encoding="utf-8")
    browser.show(path, **words)


def marks(browser: Browser) -> list[str]:
    found: list[str] = browser.run(
        "[...document.querySelectorAll('.files [aria-current]')].map((line) => line.id)"
    )
    return found


def focus(browser: Browser) -> str:
    return str(browser.run("document.activeElement.textContent"))


@in_a_browser
def test_a_click_on_a_box_opens_it_and_its_trace_marks_its_lines(
    browser: Browser, tmp_path: Path
) -> None:
    page_of(browser, ROOT / "examples" / "level1", tmp_path / "page.html")
    browser.click('svg a[aria-label="ArbitrationNode"]')
    browser.wait("document.querySelector('details.topic[open]')")
    assert focus(browser).startswith("ArbitrationNode: 4 modules control")
    assert marks(browser) == ["f1-11", "f1-12", "f1-13", "f1-14"]
    # The four lines, what it resolves, and its trace.
    browser.press("Tab", 6)
    assert focus(browser) == "Trace"
    browser.press("Enter")
    browser.wait("document.querySelector('.trace li details')")
    browser.run(
        "document.querySelectorAll('.files li').forEach((x) => x.removeAttribute('aria-current'))"
    )
    # From the trace to its first step, and to the first of that.
    for _ in range(2):
        browser.press("Tab")
        browser.press("Enter")
        browser.wait("document.activeElement.nextElementSibling")
    assert marks(browser) == ["f1-1", "f1-11", "f1-12", "f1-13", "f1-14"]
    assert browser.run(
        "(({ top, bottom }) => top >= 0 && bottom <= innerHeight)"
        "(document.querySelector('.files [aria-current]').getBoundingClientRect())"
    )
    assert not browser.complaints
    assert not browser.fetched


@in_a_browser
def test_a_finding_is_chosen_in_the_list_and_in_the_picture(
    browser: Browser, tmp_path: Path
) -> None:
    chosen = "[...document.querySelectorAll('.chosen > title')].map((each) => each.textContent)"
    page_of(browser, ROOT / "examples" / "module-conflict", tmp_path / "page.html")
    browser.click("details[data-finding='2'] summary")
    browser.wait("document.querySelector('.chosen')")
    assert sorted(browser.run(chosen)) == [
        "Head",
        "Sonar",
        "Sonar is_mounted_on Head",
        "Sonar is_mounted_on UpperPlate",
        "UpperPlate",
    ]
    browser.click("svg a[aria-label='Laser']")
    browser.wait("document.querySelector('details[data-finding=\\'1\\'][open]')")
    browser.wait("document.querySelector('a[aria-label=Laser] .chosen')")
    assert "Sonar" not in browser.run(chosen)
    assert not browser.complaints


@in_a_browser
def test_names_are_found(browser: Browser, tmp_path: Path) -> None:
    page_of(browser, ROOT / "examples" / "level1", tmp_path / "page.html")
    browser.press("Tab")
    browser.write("turn")
    assert browser.run("document.querySelector('#told').textContent") == "4 of 6 match"
    assert browser.run("document.querySelectorAll('details.topic:not([hidden])').length") == 4


@in_a_browser
def test_why_not_works_by_keyboard(browser: Browser, tmp_path: Path) -> None:
    page_of(browser, ROOT / "examples" / "level1", tmp_path / "page.html")
    assert browser.spoken("heading")[1] == "Why not?"
    assert "for the module" in browser.spoken("combobox")
    # A box without an answer leads to the form, with its name filled in.
    browser.run("document.querySelector('svg a[aria-label=\"Turn\"]').focus()")
    browser.press("Enter")
    browser.wait("document.activeElement.id === 'kind'")
    assert browser.run("document.querySelector('#module').value") == "Turn"
    answers = "document.querySelector('#answers').innerText"
    assert len(browser.run(answers).split("No ")) == 7  # six kinds of nodes
    browser.press("ArrowDown", 3)
    browser.wait(f"{answers}.startsWith('No ArbitrationNode')")
    assert browser.run(answers).splitlines() == [
        "No ArbitrationNode(Turn): nothing controls Turn, and an arbiter needs two controllers.",
        "",
        "What would give one, and what that costs: "
        "mars-asp explain config.mars --why-not 'ArbitrationNode(Turn)'",
    ]
    browser.press("ArrowDown")
    browser.wait(f"{answers}.includes('ControlSplitter')")
    assert marks(browser) == ["f1-13"]
    browser.press("Tab")
    browser.run("document.activeElement.select()")
    browser.write("Turm")
    browser.press("Enter")
    assert browser.run(answers) == "There is no module Turm."
    assert not browser.complaints
    assert not browser.fetched


@in_a_browser
def test_hostile_names_stay_text_in_a_browser(browser: Browser, tmp_path: Path) -> None:
    made = tmp_path / "robot"
    made.mkdir()
    (made / "config.mars").write_text(HOSTILE, encoding="utf-8")
    (made / "odd.cpp").write_text(SOURCE, encoding="utf-8")
    page_of(browser, made, tmp_path / "page.html")
    browser.run("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    browser.run("document.querySelector('#module').focus()")
    browser.write("Grüße")
    assert browser.run("document.querySelectorAll('img, iframe, object').length") == 0
    assert browser.run("document.querySelectorAll('script').length") == 2
    assert "Grüße" in browser.run("document.querySelector('#answers').innerText")
    assert not browser.complaints
    assert not browser.fetched


@in_a_browser
def test_the_files_do_not_cover_the_focused_element(browser: Browser, tmp_path: Path) -> None:
    page_of(browser, ROOT / "examples" / "level1", tmp_path / "page.html", width=400)
    # The search, the picture, its 12 boxes and the files come first.
    browser.press("Tab", 15)
    for _ in range(8):
        browser.press("Tab")
        assert browser.run(
            "document.activeElement.getBoundingClientRect().bottom"
            " <= document.querySelector('.files').getBoundingClientRect().top"
        )


@in_a_browser
@pytest.mark.parametrize("width", [400, 1400])
def test_nothing_is_wider_than_the_window(browser: Browser, tmp_path: Path, width: int) -> None:
    page_of(browser, ROOT / "examples" / "level1", tmp_path / "page.html", width=width)
    browser.run("document.querySelectorAll('details').forEach((each) => { each.open = true; })")
    assert browser.run("document.documentElement.scrollWidth <= innerWidth")
