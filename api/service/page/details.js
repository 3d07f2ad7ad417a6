// What is behind a light's answer: reason, rivals, plot, what decided, what was refused.

import { closeCall, isCloseCall } from "./answers.js";
import { html, mark, techniqueSummary, techniqueTitle } from "./elements.js";
import { plot } from "./plot.js";
import { counted, listed, ms, offWords, percent, plainly, range } from "./words.js";

let meanings = new Map();

export function setFeatures(features) {
  meanings = new Map(features.map((one) => [one.name, one]));
}

export function details(light) {
  const answers = [light.measured, light.predicted].filter((one) => one?.chosen);
  const parts = answers.map((answer) => side(light, answer));
  if (parts.length === 0) {
    const words = light.measured?.problem || light.predicted?.problem;
    return html("div", { class: "details" }, html("p", { class: "reason" }, words));
  }
  if (parts.length === 1) return parts[0];
  return html("div", { class: "sides" }, switching(light, answers, parts), ...parts);
}

function switching(light, answers, parts) {
  const name = `side-${light.node}`;
  const labels = answers.map((answer, index) => {
    const input = html("input", { type: "radio", name, checked: index === 0, onchange: () => parts.forEach((one, other) => { one.hidden = other !== index; }) });
    return html("label", {}, input, " ", html("span", {}, answer.source));
  });
  parts[1].hidden = true;
  return html("fieldset", { class: "switch" }, html("legend", {}, "Show what was"), ...labels);
}

function side(light, answer) {
  return html("div", { class: "details" },
    html("div", { class: "words" },
      html("p", { class: "reason" }, answer.reason),
      answer.outside.length > 0 ? warning(answer) : null,
      html("dl", { class: "rivals" }, ...rivals(light, answer)),
      answer.decidedBy.length > 0 ? decided(answer) : null,
      answer.refused.length > 0 ? refused(answer) : null),
    html("div", { class: "picture" }, plot(answer), everyCandidate(answer)));
}

function warning({ outside }) {
  const named = outside.map((name) => name.replaceAll("_", " "));
  const words = `This light is unlike those that the model has learnt from, in ${counted(named.length, "feature")}. Measure it to be sure.`;
  return html("details", { class: "warning" }, html("summary", {}, words), html("p", { class: "fine" }, `${listed(named)}.`));
}

function rivals(light, answer) {
  const found = [];
  const add = (term, one) => {
    if (one) found.push(html("div", {}, html("dt", {}, term), html("dd", {}, html("span", { class: "name", title: one.meaning || null }, mark(one.technique), one.name), ` ${ms(one.ms)}, ${offWords(one)}`)));
  };
  add("Choice", answer.chosen);
  found[0].append(html("dd", { class: "under" }, about(answer.chosen)));
  add("Runner-up", answer.runnerUp);
  if (answer.runnerUp && isCloseCall(answer)) found[1].append(html("dd", { class: "under" }, closeCall(answer)));
  if (answer.source === "measured" && light.predicted?.chosen && light.predicted.chosen.name !== answer.chosen.name) {
    add("Predicted one, measured", answer.candidates.find((one) => one.name === light.predicted.chosen.name));
  }
  return found;
}

function about({ technique, meaning }) {
  const settings = meaning ? ` Here: ${meaning}.` : "";
  return `${techniqueTitle(technique)}. ${techniqueSummary(technique)}${settings}`;
}

function decided({ decidedBy }) {
  const items = decidedBy.map((one) => {
    const known = meanings.get(one.feature);
    const value = `${one.feature.replaceAll("_", " ")} ${plainly(one.value, known?.unit ?? "none")}`;
    return html("li", {}, html("strong", {}, one.words), html("span", { class: "under" }, `${one.group}: ${value}`), known ? html("span", { class: "under" }, known.meaning) : null);
  });
  return html("div", {}, html("h4", {}, "What decided"), html("ul", { class: "decided" }, ...items));
}

function refused(answer) {
  const items = answer.refused.map((one) => html("li", {}, html("span", { class: "name" }, mark(one.technique), one.name), html("span", { class: "under" }, one.reason)));
  return html("details", {}, html("summary", {}, `${counted(items.length, "candidate")} cannot serve it`), html("ul", { class: "decided" }, ...items));
}

function everyCandidate(answer) {
  const predicted = answer.source === "predicted";
  const sorted = [...answer.candidates].sort((one, other) => one.ms - other.ms);
  const over = (one) => one.off !== null && one.off > answer.limit;
  const rows = sorted.map((one) => html("tr", { "data-key": one.name, class: one.chosen ? "chosen" : "" },
    html("th", { scope: "row", title: one.meaning || null }, mark(one.technique), one.name),
    html("td", { class: "number" }, ms(one.ms)),
    predicted ? html("td", { class: "number soft" }, range(one.msRange, "ms")) : null,
    html("td", { class: over(one) ? "number over" : "number" }, offWords(one)),
    predicted ? html("td", { class: "number" }, percent(one.keeps)) : null));
  const head = ["Candidate", "Time", ...(predicted ? ["Range"] : []), "Edge off", ...(predicted ? ["Keeps the limit"] : [])];
  const table = html("table", { class: "candidates" },
    html("thead", {}, html("tr", {}, ...head.map((name, index) => html("th", { scope: "col", class: index > 0 ? "number" : "" }, name)))),
    html("tbody", {}, ...rows));
  return html("details", {}, html("summary", {}, `All ${counted(rows.length, "candidate")} as a table`), html("div", { class: "scroll" }, table));
}
