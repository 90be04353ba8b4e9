"use strict";
const run = JSON.parse(document.getElementById("run").textContent);
const [svg, slider, play, speed, why] = ["#picture svg", "#slider", "#play", "#speed", "#why"].map(
  (name) => document.querySelector(name));
const [robots, moving] = ['[id^="robot"]', ".moving"].map((name) => svg.querySelectorAll(name));
const cursor = document.createElementNS("http://www.w3.org/2000/svg", "path");
let [now, asked, frame, before] = [0, null, 0, 0];

// Which entry is the last that begins (its first member) at or before a time; -1 before the first.
function indexAt(entries, time) {
  let [low, high] = [0, entries.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (entries[middle][0] <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

function pixels(forward, side) {
  const { corner, scale, left, top } = run.view;
  return [left + (corner[1] - side) * scale, top + (corner[0] - forward) * scale];
}

function poseAt(poses, time) {
  const index = Math.max(0, indexAt(poses, time));
  const [from, to] = [poses[index], poses[index + 1] ?? poses[index]];
  const share = to[0] > from[0] ? Math.max(0, (time - from[0]) / (to[0] - from[0])) : 0;
  return from.map((value, k) => value + share * (to[k] - value)).slice(1);
}

// There and back for ever, as the simulator moves it.
function placeAt({ round, speed }, time) {
  const legs = round.slice(1).map(([x, y], k) => Math.hypot(x - round[k][0], y - round[k][1]));
  const whole = legs.reduce((sum, leg) => sum + leg, 0);
  let left = whole ? (time * speed) % whole : 0;
  const last = legs.findIndex((leg) => left < leg || ((left -= leg), false));
  const k = Math.max(last, 0);
  const share = legs[k] ? left / legs[k] : 0;
  const [[x, y], [tx, ty]] = [round[k], round[k + 1]];
  return pixels(x + share * (tx - x), y + share * (ty - y));
}

// Names come from files of others: they only ever become text.
function element(name, text, className) {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

function seconds(time) {
  return `${time.toFixed(2)} s`;
}

function stretchAt(input, time) {
  const stretch = input.in_force[indexAt(input.in_force, time)];
  if (!stretch) return [false, "not heard yet"];
  return time < stretch[1]
    ? [true, `in force until ${seconds(stretch[1])}`]
    : [false, `silent since ${seconds(stretch[1])}`];
}

function verdict(arbiter, holding) {
  const input = arbiter.inputs.find(({ name }) => name === asked);
  if (!input) return null;
  if (holding && holding[2] === asked) return `${asked} won: ${holding[3]}.`;
  if (!stretchAt(input, now)[0]) return `${asked} did not want control.`;
  const winner = arbiter.inputs.find(({ name }) => holding && name === holding[2]);
  if (!winner) return null;
  return winner.priority > input.priority
    ? `${asked} lost to ${winner.name}: priority ${input.priority} against ${winner.priority}.`
    : `${asked} lost to ${winner.name}: of equal priority, and heard earlier.`;
}

// What asks about an input at this moment, as a click on its lane does at another.
function button(arbiter, { name }) {
  const made = element("button", name);
  made.type = "button";
  made.dataset.key = JSON.stringify([arbiter.node, name]);
  made.setAttribute("aria-pressed", name === asked);
  made.addEventListener("click", () => {
    stop();
    asked = name;
    show(now);
  });
  return made;
}

function explain(arbiter) {
  const section = document.createElement("section");
  section.append(element("h2", arbiter.node));
  if (arbiter.period_ms !== undefined) {
    section.append(element("p", `sends the mean of each ${arbiter.period_ms} ms`));
    return section;
  }
  const holding = arbiter.holdings[indexAt(arbiter.holdings, now)];
  const told = holding
    ? `${holding[1] || "no controller"} holds control since ${seconds(holding[0])}: ${holding[3]}`
    : "nothing has been heard";
  section.append(element("p", told, "told"));
  const answer = verdict(arbiter, holding);
  if (answer) section.append(element("p", answer, "verdict"));
  const table = document.createElement("table");
  for (const input of arbiter.inputs) {
    const row = document.createElement("tr");
    row.className = input.name === asked ? "asked" : "";
    const wins = holding && holding[2] === input.name ? "wins" : "";
    const named = element("td", "", wins);
    named.append(button(arbiter, input));
    row.append(named, element("td", `priority ${input.priority}`));
    row.append(element("td", stretchAt(input, now)[1]));
    table.append(row);
  }
  section.append(table);
  return section;
}

// Put a robot where it is now, and return what to say of it.
function state({ called, poses, commands, contacts }, shape) {
  const [forward, side, heading] = poseAt(poses, now);
  const [x, y] = pixels(forward, side);
  shape.setAttribute("transform", `translate(${x} ${y}) rotate(${-heading})`);
  const command = commands[indexAt(commands, now)];
  const rates = Object.entries(command ? command[2] : {});
  const obeyed = rates.length
    ? `${called} obeys ${command[1]}: ${rates.map(([name, rate]) => `${name} ${rate}`).join(", ")}.`
    : `${called} rests: no command is in force.`;
  const collisions = indexAt(contacts.map((at) => [at]), now) + 1;
  return `${obeyed} It is at (${forward.toFixed(0)}, ${side.toFixed(0)}) mm, ` +
    `heads ${heading.toFixed(0)} degrees, and has collided ${collisions} times.`;
}

function show(time) {
  now = Math.min(Math.max(time, 0), run.duration);
  const states = run.robots.map((robot, k) => state(robot, robots[k]));
  run.moving.forEach((circle, k) => {
    const [cx, cy] = placeAt(circle, now);
    moving[k].setAttribute("cx", cx);
    moving[k].setAttribute("cy", cy);
  });
  const { left, wide, top, bottom } = run.lanes;
  cursor.setAttribute("d", `M${left + now * wide} ${top}V${bottom}`);
  slider.value = now;
  document.getElementById("time").textContent = seconds(now);
  document.getElementById("state").textContent = states.join(" ");
  const focused = document.activeElement?.dataset.key;
  why.replaceChildren(...run.arbiters.map(explain));
  if (focused) {
    [...why.querySelectorAll("button")].find(({ dataset }) => dataset.key === focused)?.focus();
  }
}

function stop() {
  cancelAnimationFrame(frame);
  frame = 0;
  play.textContent = "Play";
  why.setAttribute("aria-live", "polite");
}

function go(stamp) {
  show(now + ((stamp - before) / 1000) * Number(speed.value));
  before = stamp;
  if (now < run.duration) frame = requestAnimationFrame(go);
  else stop();
}

function toggle() {
  if (frame) return stop();
  if (now >= run.duration) show(0);
  play.textContent = "Stop";
  // Nobody can listen to each frame.
  why.setAttribute("aria-live", "off");
  before = performance.now();
  frame = requestAnimationFrame(go);
}

cursor.setAttribute("stroke", "black");
cursor.setAttribute("pointer-events", "none");
svg.append(cursor);
slider.max = run.duration;
slider.addEventListener("input", () => {
  stop();
  show(Number(slider.value));
});
play.addEventListener("click", toggle);
document.addEventListener("keydown", (event) => {
  if (event.target === slider || event.target === speed) return;
  const step = { ArrowLeft: -0.1, ArrowRight: 0.1 }[event.key];
  if (step) show(now + step);
  else if (event.key === " " && event.target.localName !== "button") toggle();
  else return;
  event.preventDefault();
});
svg.addEventListener("click", (event) => {
  if (!event.target.classList.contains("lane")) return;
  stop();
  asked = event.target.dataset.name;
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(
    svg.getScreenCTM().inverse());
  show((at.x - run.lanes.left) / run.lanes.wide);
});
show(0);
