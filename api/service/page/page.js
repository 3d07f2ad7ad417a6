// The page: what it shows at present, and what happens when something is dropped, chosen or asked.

import { verdict } from "./answers.js";
import { draw as drawDial } from "./dial.js";
import { setFeatures } from "./details.js";
import { at, setTechniques, show } from "./elements.js";
import { ended } from "./events.js";
import { chosen, dropped, levelOf, sent } from "./files.js";
import { cancel, currentJob, downloadMeasured, downloadReport, follow, leave, listJobs } from "./job.js";
import { closeLevel, forgetJob, jobInAddress, keepLevel, keptLevel, putJobInAddress, wasOpen } from "./kept.js";
import { forgetRows, showLights } from "./lights.js";
import { ask, askJson, download, Problem } from "./service.js";
import { enableWish, offerPolicies, query, sameAsked } from "./wish.js";
import { counted } from "./words.js";

const INVITATION = at("drop-name").textContent;

let level = null;
let predicted = null;
let measured = null;
let asking = null;
let ready = null;

function say(words) {
  at("status").textContent = words;
}

// Runs what a person has asked for; what goes wrong is said, with a way to try it again.
async function attempt(act) {
  show(at("problem"), false);
  try {
    await act();
  } catch (error) {
    if (error.name === "AbortError") return;
    if (!(error instanceof Problem)) throw error;
    for (const part of ["known", "remedy"]) {
      at(`problem-${part}`).textContent = error[part];
      show(at(`problem-${part}`), error[part] !== "");
    }
    at("problem-what").textContent = error.message;
    at("problem-again").onclick = () => attempt(act);
    show(at("problem-again"), error.status === 0 || error.status >= 500 || error.status === 429);
    show(at("problem"));
    at("problem").scrollIntoView({ block: "nearest" });
  }
}

async function take(files) {
  if (files.length === 0) return;
  await ready;
  const next = await levelOf(files);
  await openLevel(next);
  await keepLevel(next);
}

// What is open stays open until the next level has been understood.
async function openLevel(next) {
  at("drop-name").textContent = `Reading ${next.name}`;
  try {
    const answer = await answered(next);
    leave();
    forgetRows();
    [level, predicted, measured] = [next, answer, null];
  } finally {
    at("drop-name").textContent = INVITATION;
  }
  tell();
  at("level-name").focus({ preventScroll: true });
  scrollTo({ top: 0 });
}

async function predict() {
  predicted = await answered(level);
  tell();
}

function tell() {
  draw();
  say(`Answers for ${counted(predicted.lights.length, "light")} of ${predicted.level}, edges off by at most ${predicted.max_edge_error_px} pixels.`);
}

async function answered(asked) {
  asking?.abort();
  const control = new AbortController();
  asking = control;
  busy(true);
  try {
    return await askJson("/v1/levels", { ...sent(asked), query: query(asked.name), signal: control.signal });
  } finally {
    if (asking === control) busy(false);
  }
}

function busy(wanted) {
  document.body.classList.toggle("asking", wanted);
  at("lights").setAttribute("aria-busy", String(wanted));
}

function draw() {
  const shown = predicted ?? measured;
  const job = currentJob();
  show(at("welcome"), !shown && !job);
  show(at("level"), Boolean(shown) || Boolean(job));
  if (!shown && !job) return;
  at("level-name").textContent = level?.name ?? job?.level ?? shown.level;
  at("level-kicker").textContent = measured ? (predicted ? "Predicted and measured" : "Measured") : "Predicted";
  document.title = `${at("level-name").textContent} · Gnomon`;
  show(at("measure"), Boolean(level) && !(job && !ended(job)));
  at("measure").textContent = measured ? "Measure again" : "Measure this level";
  at("measure").classList.toggle("strong", !measured);
  show(at("download"), Boolean(predicted?.lights.some((one) => !one.problem)));
  enableWish(Boolean(level));
  show(at("wish"), Boolean(level));
  if (!shown) return;
  at("level-facts").textContent = [counted(shown.lights.length, "light"), shown.format, `seen at ${shown.resolution.join("x")}`].join(" · ");
  at("table-note").textContent = note(showLights(predicted, measured));
  if (predicted) at("model").textContent = `Predicted by a model of ${predicted.model.generator} with times of ${predicted.model.device}.`;
}

function note(lights) {
  if (!measured) return "";
  if (!predicted) return "This level is not open here. Drop it again to see predictions beside.";
  const judged = lights.map(verdict).filter(Boolean);
  const right = judged.filter(([, kind]) => kind !== "differs").length;
  const words = `The technique came out as predicted for ${right} of ${counted(judged.length, "light")}.`;
  return sameAsked(currentJob().options) ? words : `${words} What was measured was asked otherwise: edges off by at most ${measured.max_edge_error_px} px, at ${measured.resolution.join("x")}.`;
}

const heard = { said: (job, words) => {
  say(words);
  listJobs(openJob);
  draw();
}, finished: (job, result) => {
  measured = result;
  // Another level of the same name, or the same one before it was changed.
  if (result && predicted && predicted.digest !== result.digest) [level, predicted] = [null, null];
  listJobs(openJob);
  draw();
  if (result) say(`${job.level} is measured: ${counted(result.lights.length, "light")}.`);
} };

async function measure() {
  at("measure").disabled = true;
  try {
    const answer = await ask("/v1/jobs", { ...sent(level), query: query(level.name) });
    const job = await answer.json();
    measured = null;
    draw();
    setTimeout(() => at("job").scrollIntoView({ block: "nearest" }));
    attempt(() => follow(job, heard));
    listJobs(openJob);
  } finally {
    at("measure").disabled = false;
  }
}

// The service keeps jobs for a while only, and one started anew elsewhere knows none.
async function knownJob(id) {
  try {
    return await askJson(`/v1/jobs/${id}`);
  } catch (error) {
    if (error.status === 404) {
      forgetJob(id);
      putJobInAddress(currentJob()?.id ?? null);
      listJobs(openJob);
    }
    throw error;
  }
}

const openJob = (id) => attempt(async () => {
  const job = await knownJob(id);
  if (level && level.name !== job.level) [level, predicted] = [null, null];
  measured = null;
  forgetRows();
  const following = follow(job, heard);
  draw();
  at("level-name").focus({ preventScroll: true });
  await following;
});

function home(event) {
  event.preventDefault();
  asking?.abort();
  leave();
  closeLevel();
  [level, predicted, measured] = [null, null, null];
  show(at("problem"), false);
  document.title = "Gnomon";
  draw();
  listJobs(openJob);
  at("drop").focus();
}

function watchDrops() {
  let depth = 0;
  const over = (wanted) => { depth = wanted ? depth : 0; show(at("veil"), wanted); };
  addEventListener("dragenter", (event) => { event.preventDefault(); depth += 1; over(true); });
  addEventListener("dragleave", () => { depth -= 1; if (depth <= 0) over(false); });
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    over(false);
    const files = dropped(event.dataTransfer);
    attempt(async () => take(await files));
  });
  for (const id of ["drop", "another"]) at(id).addEventListener("click", () => at("files").click());
  at("files").addEventListener("change", () => {
    const files = chosen(at("files").files);
    at("files").value = "";
    attempt(() => take(files));
  });
}

function wire() {
  watchDrops();
  const press = { measure, example: tryExample, "job-cancel": cancel, "job-download": downloadMeasured, "job-report-saved": downloadReport };
  for (const [id, act] of Object.entries(press)) at(id).addEventListener("click", () => attempt(act));
  at("download").addEventListener("click", () => attempt(() => download("/v1/levels/annotated", { ...sent(level), query: query(level.name) }, level.name)));
  at("problem-close").addEventListener("click", () => show(at("problem"), false));
  at("job-close").addEventListener("click", () => { leave(); measured = null; if (predicted) draw(); else home(new Event("close")); });
  at("home").addEventListener("click", home);
  addEventListener("hashchange", () => { if (jobInAddress() && jobInAddress() !== currentJob()?.id) openJob(jobInAddress()); });
}

async function restore() {
  const job = jobInAddress();
  const kept = wasOpen() ? await keptLevel() : null;
  if (kept) await openLevel(kept);
  if (job) await openJob(job);
}

async function tryExample() {
  const answer = await ask("/page/street.glb");
  await take([{ path: "street.glb", file: await answer.blob() }]);
}

async function start() {
  const [techniques, policies, features] = await Promise.all(["/v1/techniques", "/v1/policies", "/v1/features"].map((path) => askJson(path)));
  setTechniques(techniques.techniques);
  setFeatures(features.features);
  offerPolicies(policies, () => { if (level) attempt(predict); });
}

drawDial(at("dial"));
wire();
listJobs(openJob);
attempt(() => {
  ready = start();
  return ready.then(restore);
}).finally(() => document.body.classList.remove("starting"));
