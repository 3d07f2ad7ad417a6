// In which order the lights stand, and which of them: as in the level, until a person wants it otherwise.

import { isCloseCall } from "./answers.js";
import { at, html, show, techniqueTitle } from "./elements.js";
import { counted, offWords } from "./words.js";

const FEWEST_TO_SEARCH = 8;

const best = (light) => (light.measured?.chosen ? light.measured : light.predicted);

// What each column is sorted by, and in which direction first: what somebody looks for stands on top.
const COLUMNS = new Map([
  ["Light", { value: (light) => light.name.toLowerCase(), first: 1 }],
  ["Use", { value: (light) => best(light)?.chosen?.name, first: 1 }],
  ["Shadow time", { value: (light) => best(light)?.chosen?.ms, first: -1 }],
  ["Edge off", { value: (light) => best(light)?.chosen?.off, first: -1 }],
  ["Confidence", { value: (light) => best(light)?.confidence, first: 1 }],
]);

let column = null;
let direction = 1;
let words = [];

export function forgetOrder() {
  column = null;
  words = [];
  at("find").value = "";
}

// A column's header, which sorts by it: first one way, then the other, then as in the level.
export function header(name, kind) {
  const attributes = { scope: "col", role: "columnheader", class: kind, "data-column": name };
  if (!COLUMNS.has(name)) return html("th", attributes, name);
  return html("th", attributes, html("button", { type: "button", class: "sort" }, name));
}

// Makes a table, whose rows stand as the lights do, follow what is wanted, at once and whenever that changes.
export function keepInOrder(table, lights, arranged) {
  const groups = lights.map((light, index) => ({ light, body: table.tBodies[index], text: wordsOf(light) }));
  for (const button of table.querySelectorAll(".sort")) {
    button.addEventListener("click", () => {
      turn(button.parentElement.dataset.column);
      arrange(table, groups);
      arranged();
      at("status").textContent = column ? `Sorted by ${column.toLowerCase()}, ${direction > 0 ? "ascending" : "descending"}.` : "Sorted as in the level.";
    });
  }
  at("find").oninput = () => {
    words = at("find").value.normalize().toLowerCase().split(/\s+/).filter(Boolean);
    arrange(table, groups);
    arranged();
  };
  show(at("search"), lights.length >= FEWEST_TO_SEARCH);
  arrange(table, groups);
  arranged();
}

function turn(name) {
  const { first } = COLUMNS.get(name);
  if (column !== name) [column, direction] = [name, first];
  else if (direction === first) direction = -first;
  else column = null;
}

// A word may stand anywhere in a name, but only begin what is said of a light: 12 is no part of 512.
function wordsOf({ name, kind, predicted, measured }) {
  const answers = [predicted, measured].filter(Boolean);
  const said = answers.flatMap((one) => (one.chosen ? [
    one.mobility, one.chosen.name, techniqueTitle(one.chosen.technique), offWords(one.chosen),
    one.within ? "" : "over the limit", one.outside.length > 0 ? "unusual" : "", isCloseCall(one) ? "close call" : "",
  ] : [one.problem, "no answer"]));
  const parts = [kind, ...said].filter(Boolean).join(" ").toLowerCase().split(/\s+/);
  return { name: name.normalize().toLowerCase(), parts };
}

function holds({ name, parts }, word) {
  const fits = /^\d+$/.test(word) ? (part) => part === word : (part) => part.startsWith(word);
  return name.includes(word) || parts.some(fits);
}

function arrange(table, groups) {
  for (const head of table.querySelectorAll("thead [data-column]")) {
    const sorted = head.dataset.column === column;
    if (sorted) head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
    else head.removeAttribute("aria-sort");
  }
  // Moving hundreds of rows takes a tenth of a second, which nobody waits for at every key.
  const bodies = inOrder(groups).map(({ body }) => body);
  if (bodies.some((body, index) => table.tBodies[index] !== body)) table.append(...bodies);
  let left = 0;
  for (const { body, text } of groups) {
    const wanted = words.every((word) => holds(text, word));
    show(body, wanted);
    if (wanted) left += 1;
  }
  at("found").textContent = words.length > 0 ? `${left === 0 ? "none" : left.toLocaleString("en")} of ${counted(groups.length, "light")}` : "";
}

function inOrder(groups) {
  if (!column) return groups;
  const { value } = COLUMNS.get(column);
  // What has no value comes last, whichever way.
  return groups.toSorted((one, other) => {
    const [a, b] = [value(one.light), value(other.light)];
    const [none, neither] = [a ?? null, b ?? null].map((each) => each === null);
    if (none || neither) return none - neither;
    return direction * (typeof a === "string" ? a.localeCompare(b, "en", { numeric: true }) : a - b);
  });
}
