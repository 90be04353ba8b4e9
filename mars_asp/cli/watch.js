"use strict";
const [picture, state] = ["#picture", "#state"].map((name) => document.querySelector(name));
const source = new EventSource("events");
let over = false;

// Names come from files of others. The picture is shown as an image, in which no script runs.
source.addEventListener("message", ({ data }) => {
  const told = JSON.parse(data);
  const address = URL.createObjectURL(new Blob([told.svg], { type: "image/svg+xml" }));
  const image = new Image();
  image.alt = told.state;
  image.addEventListener("load", () => {
    // What is drawn may be overtaken by what was told later.
    if (Number(image.dataset.number) > Number(picture.firstChild?.dataset.number ?? 0)) {
      picture.replaceChildren(image);
    }
    URL.revokeObjectURL(address);
  });
  image.dataset.number = performance.now();
  image.src = address;
  if (told.verdict) {
    over = true;
    source.close();
    state.setAttribute("aria-live", "polite");
    document.title = `${told.verdict}: ${document.title}`;
  }
  state.textContent = told.state;
});
source.addEventListener("error", () => {
  if (over) return;
  source.close();
  state.textContent = `The run ended without a verdict. ${state.textContent}`;
});
