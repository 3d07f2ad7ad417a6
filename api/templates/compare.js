"use strict";
// Niceties only: everything on the page is there without this.
document.documentElement.classList.add("js");

function highlight(event) {
  const key = event.target.closest?.("[data-key]")?.dataset.key;
  document.querySelectorAll(".hot").forEach((one) => one.classList.remove("hot"));
  if (key && event.type !== "mouseout") {
    document.querySelectorAll(`[data-key="${key}"]`).forEach((one) => one.classList.add("hot"));
  }
}
for (const kind of ["mouseover", "mouseout", "focusin", "focusout"]) {
  document.addEventListener(kind, highlight);
}

const look = document.querySelector("dialog.look");
const stage = look.querySelector(".stage");
const below = stage.querySelector(".below");
const over = stage.querySelector(".over");
const range = look.querySelector("input[type=range]");
const errors = look.querySelector(".errors");
const zoom = look.querySelector("select");
let shots = null;

function show(next) {
  shots = next;
  const [picture, map] = shots.querySelectorAll(".over");
  const wanted = errors.checked ? map : picture;
  look.querySelector("h2").textContent = `${shots.dataset.name}, view ${shots.dataset.place}`;
  below.className = `shot below ${errors.checked ? "m" : "p"}-${shots.dataset.view}`;
  over.src = wanted.src;
  over.alt = wanted.alt;
  stage.classList.toggle("errors", errors.checked);
  range.disabled = errors.checked;
}

function step(by) {
  const all = [...shots.closest(".cards").querySelectorAll(".shots")];
  show(all[(all.indexOf(shots) + by + all.length) % all.length]);
}

// Whole pixels only, as many as fit.
function enlarge() {
  const pane = look.querySelector(".pane");
  const style = getComputedStyle(document.documentElement);
  const [width, height] = ["--width", "--height"].map((name) => Number(style.getPropertyValue(name)));
  const fits = (factor) => factor * width <= pane.clientWidth && factor * height <= 0.74 * innerHeight;
  zoom.value = [4, 2].find(fits) ?? 1;
  zoom.dispatchEvent(new Event("change"));
}

for (const one of document.querySelectorAll(".shots")) {
  const open = () => { show(one); look.showModal(); enlarge(); range.focus(); };
  one.tabIndex = 0;
  one.setAttribute("role", "button");
  one.setAttribute("aria-label", `Look closely at ${one.dataset.name}`);
  one.addEventListener("click", open);
  one.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") { event.preventDefault(); open(); }
  });
}
range.addEventListener("input", () => stage.style.setProperty("--at", `${range.value}%`));
errors.addEventListener("change", () => show(shots));
zoom.addEventListener("change", () => stage.style.setProperty("--zoom", zoom.value));
look.querySelectorAll("[data-step]").forEach((one) => one.addEventListener("click", () => step(Number(one.dataset.step))));
look.addEventListener("click", (event) => { if (event.target === look) look.close(); });
stage.addEventListener("pointermove", (event) => {
  if (event.buttons !== 1) return;
  const box = stage.getBoundingClientRect();
  range.value = Math.min(Math.max(100 * (event.clientX - box.left) / box.width, 0), 100);
  range.dispatchEvent(new Event("input"));
});
