// The page: what happens when something is dropped, chosen or asked.

import { draw as drawDial } from "./dial.js";
import { setFeatures } from "./details.js";
import { draw } from "./drawing.js";
import { at, setTechniques, show } from "./elements.js";
import { chosen, dropped, levelOf, sent } from "./files.js";
import { cancel, currentJob, downloadMeasured, downloadReport, follow, leave, listJobs } from "./job.js";
import { closeLevel, forgetJob, jobInAddress, keepLevel, keptLevel, putInAddress, wasOpen } from "./kept.js";
import { forgetRows } from "./lights.js";
import { now } from "./now.js";
import { announce } from "./reading.js";
import { ask, askJson, download, Problem } from "./service.js";
import { currentWish, enableWish, offerPolicies, putWish, query, showWhatIsWrong, wishHolds } from "./wish.js";
import { counted } from "./words.js";

let asking = null;
let ready = null;

// Levels that the browser's Back may come back to, by the key in its entry.
const visited = new Map();
let key = "";
let moves = 0;

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
    show(at("problem-again"), error.status === 0 || error.status >= 500);
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
async function openLevel(next, anew = true) {
  const answer = await answered(next, "Reading");
  if (!anew && currentJob() && currentJob().level !== next.name) return;
  const beside = currentJob() && staysBeside(currentJob(), next, answer, anew);
  if (!beside) {
    leave();
    now.measured = null;
  }
  forgetRows();
  moves += 1;
  key = `${Date.now()}-${moves}`;
  [now.level, now.predicted] = [next, answer];
  setPlace(anew && !beside);
  tell();
  at("level-name").focus({ preventScroll: true });
  scrollTo({ top: 0 });
}

// A job stays when its own level is opened beside it.
function staysBeside(job, next, answer, anew) {
  if (job.level !== next.name || (now.measured && now.measured.digest !== answer.digest)) return false;
  return !anew || (!now.level && ["queued", "running", "done"].includes(job.state));
}

// Names in the address and in the browser's history what is shown.
function setPlace(anew) {
  const job = currentJob();
  const place = { view: job ? "job" : now.level ? "level" : "home", key: now.level ? key : "", name: now.level?.name ?? "", over: Boolean(job && anew && history.state?.view === "level") };
  putInAddress(place, job?.id, anew);
  if (now.level) remember();
}

function remember() {
  const { level, predicted, answeredWish } = now;
  visited.set(key, { level, predicted, answeredWish });
}

async function predict() {
  try {
    now.predicted = await answered(now.level, "Asking again:");
    remember();
  } catch (error) {
    if (error.name !== "AbortError") outdate();
    throw error;
  }
  tell();
}

// The table stays, but does not look like the answer to what is asked now.
function outdate() {
  asking?.abort();
  now.stale = true;
  draw();
}

function stopAsking() {
  asking?.abort();
  if (now.predicted && now.answeredWish) putWish(now.answeredWish);
  now.stale = false;
  say("Cancelled.");
  draw();
}

function tell() {
  draw();
  say(`Answers for ${counted(now.predicted.lights.length, "light")} of ${now.predicted.level}, edges off by at most ${now.predicted.max_edge_error_px} pixels.`);
}

async function answered(asked, verb) {
  asking?.abort();
  const control = new AbortController();
  asking = control;
  const again = asked === now.level;
  const wish = currentWish();
  const quiet = announce(verb, asked.name, { late: again, cancel: stopAsking });
  busy(again, !again);
  if (!again) say(`Reading ${asked.name}`);
  try {
    const answer = await askJson("/v1/levels", { ...sent(asked), query: query(asked.name), signal: control.signal });
    [now.answeredWish, now.stale] = [wish, false];
    return answer;
  } finally {
    quiet();
    if (asking === control) {
      asking = null;
      busy(false, false);
      if (!again) draw();
    }
  }
}

function busy(again, anew) {
  now.reading = anew;
  document.body.classList.toggle("asking", again);
  document.body.classList.toggle("reading", anew);
  at("lights").setAttribute("aria-busy", String(again));
  enableWish(Boolean(now.level) && !anew);
}

const sameWish = (one, other) => JSON.stringify(one) === JSON.stringify(other);

const heard = { said: (job, words) => {
  say(words);
  listJobs(openJob);
  draw();
}, finished: (job, result) => {
  now.measured = result;
  // Another level of the same name, or the same one before it was changed.
  if (result && now.predicted && now.predicted.digest !== result.digest) [now.level, now.predicted] = [null, null];
  listJobs(openJob);
  draw();
  if (result) say(`${job.level} is measured: ${counted(result.lights.length, "light")}.`);
} };

// Nothing is asked that the service would refuse.
const checked = (act) => async () => {
  if (wishHolds()) await act();
  else showWhatIsWrong();
};

async function measure() {
  at("measure").disabled = true;
  try {
    const answer = await ask("/v1/jobs", { ...sent(now.level), query: query(now.level.name) });
    const job = await answer.json();
    now.measured = null;
    setTimeout(() => at("job").scrollIntoView({ block: "nearest" }));
    moves += 1;
    attempt(() => follow(job, heard));
    setPlace(true);
    draw();
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
      setPlace(false);
      listJobs(openJob);
    }
    throw error;
  }
}

// Shows the job; that it is followed from then on is not waited for.
async function showJob(id, anew) {
  moves += 1;
  const mine = moves;
  const job = await knownJob(id);
  if (mine !== moves) return;
  if (now.level && now.level.name !== job.level) [now.level, now.predicted] = [null, null];
  now.measured = null;
  forgetRows();
  attempt(() => follow(job, heard));
  setPlace(anew);
  draw();
  at("level-name").focus({ preventScroll: true });
}

const openJob = (id, anew = true) => attempt(() => showJob(id, anew));

function showHome() {
  moves += 1;
  asking?.abort();
  leave();
  closeLevel();
  [now.level, now.predicted, now.measured, now.stale] = [null, null, null, false];
  show(at("problem"), false);
  document.title = "Gnomon";
  draw();
  listJobs(openJob);
}

function home(event) {
  event.preventDefault();
  const away = Boolean(now.level || currentJob());
  showHome();
  if (away) setPlace(true);
  at("drop").focus();
}

function closeJob() {
  const back = history.state?.over;
  leave();
  now.measured = null;
  if (!now.predicted) showHome();
  draw();
  listJobs(openJob);
  // The level's own entry lies below, and there should not be two of it.
  if (back) history.back();
  else setPlace(false);
}

// Back or Forward, or another fragment in the address.
async function travelled() {
  // A link within the page, such as the one that skips to the content, leads nowhere else.
  if (!history.state && !jobInAddress() && location.hash) {
    setPlace(false);
    return;
  }
  moves += 1;
  asking?.abort();
  show(at("problem"), false);
  const place = history.state ?? { view: "home" };
  const job = jobInAddress();
  const known = visited.get(place.key);
  if (!job && place.view !== "level") showHome();
  else if (known) takeUp(known, place);
  if (job) {
    if (job !== currentJob()?.id) await showJob(job, false);
    return;
  }
  if (place.view !== "level") return;
  leave();
  now.measured = null;
  listJobs(openJob);
  if (known) draw();
  else await reopen(place.name);
  if (now.level && now.predicted && !sameWish(currentWish(), now.answeredWish)) await predict();
}

// The controls are the person's, so a table of another time is asked for again where they differ.
function takeUp(known, place) {
  Object.assign(now, known, { stale: false });
  key = place.key;
  forgetRows();
  keepLevel(now.level);
}

// A level of before the last reload: the browser has kept one.
async function reopen(name) {
  const kept = await keptLevel();
  if (!kept || kept.name !== name) {
    showHome();
    setPlace(false);
    return;
  }
  await openLevel(kept, false);
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
  for (const id of ["drop", "another", "job-again"]) at(id).addEventListener("click", () => at("files").click());
  at("files").addEventListener("change", () => {
    const files = chosen(at("files").files);
    at("files").value = "";
    attempt(() => take(files));
  });
}

function wire() {
  watchDrops();
  const press = { measure: checked(measure), example: tryExample, "job-cancel": cancel, "job-download": downloadMeasured, "job-report-saved": downloadReport };
  for (const [id, act] of Object.entries(press)) at(id).addEventListener("click", () => attempt(act));
  at("download").addEventListener("click", () => attempt(checked(() => download("/v1/levels/annotated", { ...sent(now.level), query: query(now.level.name) }, now.level.name))));
  at("problem-close").addEventListener("click", () => show(at("problem"), false));
  at("job-close").addEventListener("click", closeJob);
  at("home").addEventListener("click", home);
  addEventListener("popstate", () => attempt(travelled));
}

// The job first, as that is there at once.
async function restore() {
  const job = jobInAddress();
  const kept = wasOpen() ? await keptLevel() : null;
  if (job) await openJob(job, false);
  if (!kept) return;
  try {
    await openLevel(kept, false);
  } catch (error) {
    if (error.name === "AbortError" && !now.level) closeLevel();
    throw error;
  }
}

async function tryExample() {
  const answer = await ask("/page/street.glb");
  await take([{ path: "street.glb", file: await answer.blob() }]);
}

async function start() {
  const [techniques, policies, features] = await Promise.all(["/v1/techniques", "/v1/policies", "/v1/features"].map((path) => askJson(path)));
  setTechniques(techniques.techniques);
  setFeatures(features.features);
  offerPolicies(policies, { changed: () => { if (now.level) attempt(predict); }, refused: () => { if (now.level) outdate(); } });
}

drawDial(at("dial"));
wire();
listJobs(openJob);
attempt(() => {
  ready = start();
  // Reading a level again may take a minute, in which the page is of use.
  return ready.then(() => document.body.classList.remove("starting")).then(restore);
}).finally(() => document.body.classList.remove("starting"));
