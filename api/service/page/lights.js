// The table of lights: one group of rows a light, predicted above measured, and what is behind them below.

import { closeCall, differences, isCloseCall, lightsOf, verdict } from "./answers.js";
import { at, badge, breakable, html, mark, meter, techniqueTitle } from "./elements.js";
import { details } from "./details.js";
import { forgetOrder, header, keepInOrder } from "./order.js";
import { counted, ms, offWords, percent, range, sentence } from "./words.js";

const COLUMNS = ["Light", "Use", "Shadow time", "Edge off", "Confidence", "Why"];
const NUMBERS = new Set(["Shadow time", "Edge off", "Confidence"]);

const open = new Set();
let before = new Map();

export function forgetRows() {
  open.clear();
  before = new Map();
  forgetOrder();
}

export function showLights(predicted, measured) {
  const lights = lightsOf(predicted, measured);
  const unlike = predicted && measured ? differences(predicted, measured, lights) : [];
  const head = COLUMNS.map((name) => header(name, NUMBERS.has(name) ? "number" : name === "Why" ? "why-head" : ""));
  const table = html("table", { class: measured && predicted ? "lights both" : "lights", role: "table", "aria-label": "Lights" },
    html("thead", { role: "rowgroup" }, html("tr", { role: "row" }, ...head)),
    ...lights.map((light) => group(light, unlike.length === 0)));
  const focused = document.activeElement?.closest?.("[data-node]")?.dataset.node;
  const column = document.activeElement?.closest?.("[data-column]")?.dataset.column;
  at("lights").replaceChildren(table);
  keepInOrder(table, lights, () => nameExpand(table));
  if (focused !== undefined) table.querySelector(`[data-node="${focused}"] .opens`)?.focus();
  if (column !== undefined) table.querySelector(`[data-column="${column}"] .sort`)?.focus();
  before = new Map(lights.map((light) => [light.node, light.predicted?.chosen?.name]));
  at("expand").onclick = () => all(table, !opened(table));
  return { lights, unlike };
}

// Of the lights that are shown.
const opened = (table) => table.querySelector("tbody.open:not([hidden])") !== null;

function nameExpand(table) {
  at("expand").textContent = opened(table) ? "Close all" : "Open all";
}

function all(table, wanted) {
  for (const button of table.querySelectorAll("tbody:not([hidden]) .opens")) {
    if ((button.getAttribute("aria-expanded") === "true") !== wanted) button.click();
  }
}

function group(light, comparable) {
  const answers = [light.predicted, light.measured].filter(Boolean);
  const key = String(light.node);
  const id = `behind-${key}`;
  const button = html("button", { type: "button", class: "opens", "aria-expanded": "false", "aria-controls": id }, html("bdi", {}, ...breakable(light.name || "unnamed")));
  const mobility = answers.find((one) => one.mobility)?.mobility;
  const facts = [light.kind, mobility].filter(Boolean).join(", ");
  const name = html("th", { scope: "rowgroup", role: "rowheader", rowspan: answers.length, class: "light" }, button, html("span", { class: "under" }, facts || `node ${light.node}`));
  const rows = answers.map((answer, index) => row(light, answer, index === 0 ? name : null, comparable));
  const behind = html("tr", { role: "row", class: "behind", id, hidden: true }, html("td", { role: "cell", colspan: COLUMNS.length }));
  const changed = light.predicted?.chosen && before.has(light.node) && before.get(light.node) !== light.predicted.chosen.name;
  const body = html("tbody", { role: "rowgroup", "data-node": key, class: changed ? "changed" : "" }, ...rows, behind);
  // Once is enough: a row that is sorted anew would light up again.
  body.addEventListener("animationend", () => body.classList.remove("changed"));
  const turn = (wanted) => {
    button.setAttribute("aria-expanded", String(wanted));
    behind.hidden = !wanted;
    body.classList.toggle("open", wanted);
    if (wanted) open.add(key); else open.delete(key);
    behind.firstChild.replaceChildren(...(wanted ? [details(light)] : []));
    if (body.parentElement) nameExpand(body.parentElement);
  };
  button.addEventListener("click", () => turn(behind.hidden));
  for (const one of rows) {
    one.addEventListener("click", (event) => {
      if (!event.target.closest("button, a") && String(getSelection()) === "") turn(behind.hidden);
    });
  }
  if (open.has(key)) turn(true);
  return body;
}

function row(light, answer, name, comparable) {
  const measured = answer.source === "measured";
  const attributes = { role: "row", class: `answer ${answer.source}` };
  const both = light.predicted && light.measured;
  if (!answer.chosen) {
    return html("tr", attributes, name, cell("Use", html("span", { class: "failure" }, both ? `${sentence(answer.source)}: ` : "", answer.problem), "none", { colspan: COLUMNS.length - 1 }));
  }
  const { chosen } = answer;
  return html("tr", attributes, name,
    cell("Use", [html("span", { class: "name", title: chosen.meaning || null }, mark(chosen.technique), chosen.name), html("span", { class: "under" }, both ? answer.source : techniqueTitle(chosen.technique), badges(light, answer, comparable))], "use"),
    cell("Shadow time", figure(ms(chosen.ms), chosen.msRange && range(chosen.msRange, "ms")), "number"),
    cell("Edge off", figure(offWords(chosen), belowEdge(chosen)), answer.within ? "number" : "number over"),
    cell("Confidence", confidence(answer), "number"),
    cell("Why", html("span", { class: "brief" }, measured ? answer.reason : why(answer)), "why"));
}

function cell(label, content, kind, more = {}) {
  return html("td", { role: "cell", class: kind, "data-label": label, ...more }, ...[content].flat());
}

function belowEdge({ px: edge, pxRange, edgeSeen }) {
  if (pxRange) return range(pxRange, "px");
  return edge === null && edgeSeen ? html("span", { class: "hint", title: "The views show too little of this shadow's edge to say by how many pixels it is off." }, "short edge") : "";
}

function figure(value, below) {
  return [html("span", { class: "figure" }, value), below ? html("span", { class: "under" }, below) : null];
}

function confidence(answer) {
  const share = answer.confidence;
  if (share === null || share === undefined) return "-";
  return [html("span", { class: "figure" }, percent(share)), isCloseCall(answer) ? html("span", { class: "under hint", title: closeCall(answer) }, "close call") : meter(share, "meter")];
}

function why(answer) {
  return answer.decidedBy.length > 0 ? sentence(answer.decidedBy.map((one) => one.words).join(", ")) : answer.reason;
}

function badges(light, answer, comparable) {
  const found = [];
  if (!answer.within) found.push(badge("over the limit", "over", "No candidate keeps the limit; this one comes closest."));
  if (answer.outside.length > 0) found.push(badge("unusual", "", `${counted(answer.outside.length, "feature")} outside of what the model has learnt from`));
  const judged = answer.source === "measured" && comparable ? verdict(light) : null;
  if (judged) found.push(badge(...judged));
  return found.length > 0 ? html("span", { class: "badges" }, ...found) : null;
}
