// Draws what the page shows: the level's head, the controls, the table and what is said below it.

import { summary, verdict } from "./answers.js";
import { at, breakable, html, mark, show } from "./elements.js";
import { ended } from "./events.js";
import { currentJob, stateName } from "./job.js";
import { showLights } from "./lights.js";
import { now } from "./now.js";
import { enableWish } from "./wish.js";
import { counted, deviceName, listed, ms } from "./words.js";

export function draw() {
  const { level, predicted, measured, reading } = now;
  const shown = predicted ?? measured;
  const job = currentJob();
  show(at("welcome"), !shown && !job);
  show(at("level"), Boolean(shown) || Boolean(job));
  if (!shown && !job) return;
  if (!shown) show(at("search"), false);
  at("level-name").replaceChildren(...breakable(level?.name ?? job?.level ?? shown.level));
  at("level-kicker").textContent = kicker(job);
  document.title = `${at("level-name").textContent} · Gnomon`;
  show(at("measure"), Boolean(level) && !(job && !ended(job)));
  at("measure").textContent = measured ? "Measure again" : "Measure this level";
  at("measure").classList.toggle("strong", !measured);
  show(at("download"), Boolean(predicted?.lights.some((one) => !one.problem)));
  show(at("job-again"), !level && ["failed", "cancelled"].includes(job?.state));
  enableWish(Boolean(level) && !reading);
  show(at("wish"), Boolean(level));
  facts(shown, job);
  drawTable(shown);
}

function kicker(job) {
  const { predicted, measured } = now;
  if (measured) return predicted ? "Predicted and measured" : "Measured";
  return predicted ? "Predicted" : stateName(job);
}

function drawTable(shown) {
  const { predicted, measured, stale } = now;
  at("lights").classList.toggle("stale", stale);
  show(at("lights"), Boolean(shown));
  show(at("expand"), Boolean(shown));
  const { lights, unlike } = shown ? showLights(predicted, measured) : { lights: [], unlike: [] };
  at("table-note").textContent = note(lights, unlike);
  const sources = ["predicted", "measured"].map((name) => [name, summary(lights, name)]).filter(([, one]) => one);
  at("level-summary").replaceChildren(...sources.map(([name, one]) => html("p", { class: "facts" }, ...summed(one, sources.length > 1 ? name : ""))));
}

function summed({ counts, without, ms: together }, source) {
  const words = counts.map(([technique, count], index) => html("span", { class: "share" }, mark(technique), html("strong", {}, technique), ` for ${index === 0 ? counted(count, "light") : count.toLocaleString("en")}`));
  const rest = without > 0 ? html("span", { class: "share" }, `no answer for ${without.toLocaleString("en")}`) : null;
  const whose = source ? html("span", { class: "source" }, source) : null;
  return [whose, ...words, rest, html("span", { class: "share" }, html("strong", {}, ms(together)), " if all are drawn")];
}

// What the table is about: light count, format, size and device.
function facts(shown, job) {
  const resolution = shown ? shown.resolution.join("x") : job.options.resolution;
  const count = shown ? shown.lights.length : job.lights;
  const words = [typeof count === "number" ? counted(count, "light") : "", shown?.format ?? "", resolution ? `seen at ${resolution}` : ""];
  const renderer = shown ? shown.model?.device ?? shown.device?.renderer : "";
  // An opened explanation stays open while the figures change.
  const before = at("device")?.closest("details").open ?? false;
  at("level-facts").replaceChildren(html("span", {}, words.filter(Boolean).join(" · ")), ...(renderer ? [timesOf(renderer, before)] : []));
  const { predicted } = now;
  if (predicted) at("model").textContent = `Predicted by a model of ${predicted.model.generator} with times of ${predicted.model.device}.`;
}

function timesOf(renderer, open) {
  const summary = html("summary", { id: "device", title: renderer }, `times of ${deviceName(renderer)}`);
  const command = (words) => html("code", {}, words);
  const words = now.predicted
    ? ["Times are predicted for ", html("strong", {}, renderer), ". For those of another device, run ", command("gnomon benchmark"), " on it, let ", command("gnomon train"), " learn from that, and start ", command("gnomon serve --model FILE"), " with the model."]
    : ["Measured on ", html("strong", {}, renderer), ", the device of this service."];
  return html("details", { class: "times", open }, summary, html("p", {}, ...words));
}

function note(lights, unlike) {
  const { level, predicted, measured, stale, reading } = now;
  if (stale) return "The table answers what was asked before, not what the controls say now.";
  if (!predicted && !level) return reading ? "" : `This level is not open here. Drop it again to see predictions${measured ? " beside" : ""}.`;
  if (!measured || !predicted) return "";
  if (unlike.length > 0) return `Not compared: ${listed(unlike)}.`;
  const judged = lights.map(verdict).filter(Boolean);
  const right = judged.filter(([, kind]) => kind !== "differs").length;
  return `The technique came out as predicted for ${right} of ${counted(judged.length, "light")}.`;
}
