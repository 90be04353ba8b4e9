
"use strict";
const { steps, why, kinds, names, texts: sentences, answers, path } = JSON.parse(document.getElementById("traces").textContent);
const topics = [...document.querySelectorAll("details.topic")];
// What is searched: what was opened since does not change what is found.
const texts = new Map(topics.map((topic) => [topic, topic.textContent.toLowerCase()]));
const [search, told, files, kind, module] =
  ["#search", "#told", ".files", "#kind", "#module"].map((name) => document.querySelector(name));
const MOST = 150;
// Stands for the module in a sentence that is said of many.
const NAME = "\u0001";
// What a `details` is filled with when it is opened first.
const pending = new WeakMap();
let marked = new Set();

// Names come from files of others: they only ever become text.
function element(name, className, ...inside) {
  const made = document.createElement(name);
  if (className) made.className = className;
  made.append(...inside);
  return made;
}

// What stands between backticks is a name.
function words(text) {
  return text.split("`").map((part, k) => (k % 2 ? element("code", "", part) : part));
}

function placeLink(id) {
  const line = document.getElementById(id);
  const { name } = line.closest("section").dataset;
  const link = element("a", "place", `${name}:${line.value}`);
  link.href = `#${id}`;
  return link;
}

// A step without words gives way to what it rests on.
function spoken(numbers) {
  const [waiting, seen, found] = [[...numbers].reverse(), new Set(), []];
  while (waiting.length) {
    const number = waiting.pop();
    if (seen.has(number)) continue;
    seen.add(number);
    const { says, at, from = [], others } = steps[number - 1];
    if (says || others || (at && !from.length)) found.push(number);
    else for (let k = from.length; k--; ) waiting.push(from[k]);
  }
  return found;
}

function remarks(step) {
  const rule = step.rule ? [element("span", "rule", `  [${step.rule}]`)] : [];
  return [step.kind === "chosen" ? ", chosen as the cheapest" : "", ...rule];
}

// A line of a file; a long one is cut.
function quoted(id) {
  const line = document.getElementById(id).textContent.trim();
  return element("code", "", line.length > MOST ? `${line.slice(0, MOST)}…` : line);
}

// A line says by itself what it states, unless that names what cannot be seen in it.
function leaf({ kind, says = "", at }) {
  if (!at) return words(says);
  if (kind !== "given") return [...words(says), ` (${kind} from `, placeLink(at), ")"];
  const line = document.getElementById(at).textContent.trim();
  const names = says.split("`").filter((_, k) => k % 2);
  const beside = names.every((name) => line.includes(name)) ? [] : ["  ", ...words(says)];
  return [placeLink(at), "  ", quoted(at), ...beside];
}

function item(number, before = "") {
  const step = steps[number - 1];
  const inside = spoken(step.from ?? []);
  if (!inside.length && !step.others) {
    return element("li", step.kind, before, ...leaf(step), ...remarks(step));
  }
  const said = step.says ?? "this";
  const details = element("details", "",
    element("summary", "", before, ...words(said), ...remarks(step)));
  pending.set(details, [inside, step.others ?? []]);
  return element("li", step.kind, details);
}

function list(numbers, others) {
  const stated = new Set();
  const once = numbers.filter((number) => {
    const { at, kind } = steps[number - 1];
    if (!at || kind !== "given") return true;
    return !stated.has(at) && stated.add(at);
  });
  const made = element("ul", "");
  for (const number of once) made.append(item(number));
  for (const number of others) made.append(item(number, "or: "));
  return made;
}

function addTrace(topic) {
  const [root, ...others] = why[Number(topic.id.slice(1)) - 1] ?? [];
  if (!root || topic.querySelector(".trace")) return;
  const trace = element("details", "trace", element("summary", "", "Trace"));
  pending.set(trace, [spoken([root]), others]);
  topic.append(trace);
}

// Marks the lines that are cited inside of an element, if there are any, and shows the first.
function mark(inside) {
  const links = [...inside.querySelectorAll("a.place")];
  if (!links.length) return;
  for (const line of marked) line.removeAttribute("aria-current");
  marked = new Set(links.map((link) => document.getElementById(link.hash.slice(1))));
  for (const line of marked) line.setAttribute("aria-current", "true");
  const [first] = marked;
  if (first) files.scrollTop = first.offsetTop - files.clientHeight / 3;
  told.textContent = `${marked.size} line${marked.size === 1 ? "" : "s"} marked in the files`;
}

// Marks the boxes and lines of a finding in the picture, and shows the first.
function choose({ dataset: { finding } }) {
  for (const part of document.querySelectorAll(".picture .chosen")) part.classList.remove("chosen");
  if (!finding) return;
  const parts = [...document.querySelectorAll(`.picture [data-finding~="${finding}"]`)];
  for (const part of parts) part.classList.add("chosen");
  const drawing = document.querySelector(".drawing");
  if (!parts.length) return;
  const [shown, first] = [drawing.getBoundingClientRect(), parts[0].getBoundingClientRect()];
  drawing.scrollBy(
    first.x + first.width / 2 - shown.x - shown.width / 2,
    first.y + first.height / 2 - shown.y - shown.height / 2);
}

// One answer: the sentence, what of the page it leads to, and the lines that it speaks of.
function answered(name, [number, ...places]) {
  const lines = places.filter((id) => id.startsWith("f"));
  const topic = places.find((id) => id.startsWith("t"));
  const made = element("li", "", ...words(sentences[number].replaceAll(NAME, name)));
  if (topic) {
    const link = element("a", "", "Why it is there");
    link.href = `#${topic}`;
    made.append(" ", link);
  }
  const cited = lines.map((id) => element("li", "", placeLink(id), "  ", quoted(id)));
  if (cited.length) made.append(element("ul", "lines", ...cited));
  return made;
}

// Says why there is nothing of the kind that is asked for, or of each kind of nodes or the rest.
function ask() {
  const name = module.value.trim();
  const row = answers[names.indexOf(name)];
  const list = document.querySelector("#answers");
  list.replaceChildren();
  if (!row) {
    if (name) list.append(element("p", "", "There is no module ", element("code", "", name), "."));
    return;
  }
  const every = kind.selectedOptions[0].value.match(/^(node|consequence)$/);
  const group = [...kind.selectedOptions[0].parentElement.children].map((each) => each.value);
  const wanted = every ? group.slice(1) : [kind.value];
  const found = kinds.flatMap((each, k) => (wanted.includes(each) && row[k] ? [row[k]] : []));
  const title = `${every ? "KIND" : kind.value}(${name})`;
  const command = `mars-asp explain ${path} --why-not '${title.replaceAll("'", "'\\''")}'`;
  list.append(
    element("ul", "answers", ...found.map((each) => answered(name, each))),
    element("p", "quiet", "What would give one, and what that costs: ",
      element("code", "", command)));
  mark(list);
}

function askFor(number) {
  module.value = names[number];
  ask();
  document.querySelector("#why-not").scrollIntoView({ block: "nearest" });
  kind.focus();
}

function open(topic) {
  if (topic.hidden) {
    search.value = "";
    find();
  }
  topic.open = true;
  topic.querySelector("summary").focus();
}

function follow(hash) {
  const topic = hash && document.getElementById(hash.slice(1))?.closest("details.topic");
  if (topic) open(topic);
  if (/^#n\d+$/.test(hash) && names[hash.slice(2)]) askFor(hash.slice(2));
}

function find() {
  const wanted = search.value.trim().toLowerCase();
  let count = 0;
  for (const topic of topics) {
    topic.hidden = !texts.get(topic).includes(wanted);
    count += topic.hidden ? 0 : 1;
  }
  for (const section of document.querySelectorAll("section.sort")) {
    section.hidden = !section.querySelector("details.topic:not([hidden])");
  }
  for (const box of document.querySelectorAll(".picture g")) {
    const name = box.querySelector("title").textContent.toLowerCase();
    box.classList.toggle("faint", !name.includes(wanted));
  }
  told.textContent = wanted ? `${count} of ${topics.length} match` : "";
}

document.addEventListener("toggle", ({ target }) => {
  if (!target.open) return;
  if (target.matches("details.topic")) {
    addTrace(target);
    choose(target);
  }
  if (pending.has(target)) {
    target.append(list(...pending.get(target)));
    pending.delete(target);
  }
  mark(target);
}, true);
document.addEventListener("click", ({ target }) => {
  follow(target.closest?.('a[href^="#t"], a[href^="#n"]')?.getAttribute("href"));
});
search.addEventListener("input", find);
search.addEventListener("keydown", ({ key }) => {
  const first = topics.find((topic) => !topic.hidden);
  if (key === "Enter" && first) open(first);
});
if (names.length) {
  document.querySelector("#why-not").hidden = false;
  kind.addEventListener("change", ask);
  module.addEventListener("input", () => {
    if (names.includes(module.value.trim()) || !module.value) ask();
  });
  module.addEventListener("change", ask);
  module.addEventListener("keydown", ({ key }) => key === "Enter" && ask());
}
window.addEventListener("hashchange", () => follow(location.hash));
follow(location.hash);
