// A measuring job: started, watched, cancelled; its results.

import { at, breakable, html, show } from "./elements.js";
import { ended, watch } from "./events.js";
import { forgetJob, keepJob, keptJobs } from "./kept.js";
import { ask, askJson, download, hasToken } from "./service.js";
import { ago, counted, seconds } from "./words.js";

const NAMES = { queued: "Waiting for its turn", running: "Measuring", done: "Measured", failed: "Measuring failed", cancelled: "Cancelled" };

let following = null;
let current = null;

export const currentJob = () => current;

export const stateName = (job) => NAMES[job.state];

// Shows the job and follows it; `said` hears of every new state, `finished` of the result.
export async function follow(first, { finished, said }) {
  leave();
  const control = new AbortController();
  following = control;
  const each = (job) => {
    if (control.signal.aborted) return;
    const news = current?.state !== job.state;
    current = job;
    keepJob({ id: job.id, level: job.level, state: job.state, created: job.created });
    draw(job);
    if (news) said(job, `${NAMES[job.state]}: ${job.level}.`);
  };
  each(first);
  show(at("job"));
  const last = ended(first) ? first : await watch(first.id, each, control.signal);
  if (last.state === "done") {
    const result = await askJson(`/v1/jobs/${last.id}/result`, { signal: control.signal });
    at("job-facts").textContent = facts(last, result);
    if (!control.signal.aborted) finished(last, result);
  } else finished(last, null);
}

export function leave() {
  following?.abort();
  following = null;
  current = null;
  show(at("job"), false);
}

function draw(job) {
  const { state, progress, problem } = job;
  const over = ended(job);
  at("job").dataset.state = state;
  const share = progress?.total > 0 ? progress.done / progress.total : 0;
  const name = state === "running" ? `Measuring, ${Math.floor(100 * share)} %` : NAMES[state];
  if (at("job-name").textContent !== name) at("job-name").textContent = name;
  at("job-facts").textContent = over ? (state === "cancelled" ? "Nothing was kept of it." : "") : [progress?.what, left(job, share)].filter(Boolean).join(" · ") || "The page may be closed meanwhile: the service goes on.";
  bar(share, progress, over, state === "queued");
  show(at("job-cancel"), !over);
  show(at("job-report"), state === "done" && !hasToken());
  // A link cannot send a token.
  show(at("job-report-saved"), state === "done" && hasToken());
  show(at("job-download"), state === "done");
  show(at("job-close"), over);
  at("job-report").href = `/v1/jobs/${job.id}/report`;
  show(at("job-problem"), Boolean(problem));
  const sentences = [problem?.detail, problem?.known, problem?.remedy].filter(Boolean);
  at("job-problem").replaceChildren(...sentences.map((one) => html("p", {}, one)));
  document.title = over ? `${job.level} · Gnomon` : `${Math.floor(100 * share)} % · ${job.level} · Gnomon`;
}

function bar(share, progress, over, waiting) {
  const place = at("job-bar");
  show(place, !over);
  place.classList.toggle("waiting", waiting);
  place.firstElementChild.style.width = `${100 * share}%`;
  place.setAttribute("aria-valuemax", progress?.total || 1);
  place.setAttribute("aria-valuenow", progress?.done ?? 0);
  place.setAttribute("aria-valuetext", `${Math.floor(100 * share)} percent`);
}

const ENOUGH_TO_GUESS = 0.05;

function left(job, share) {
  if (job.state !== "running" || share < ENOUGH_TO_GUESS || !job.started) return "";
  const past = (Date.now() - new Date(job.started).getTime()) / 1000;
  return past > 0 ? `about ${seconds((past * (1 - share)) / share)} left` : "";
}

function facts(job, result) {
  const took = (new Date(job.finished) - new Date(job.started)) / 1000;
  const [width, height] = result.resolution;
  const words = [`on ${result.device.renderer}`, `${width}x${height}`, counted(result.rounds, "round")];
  return [...words, took > 0 ? `took ${seconds(took)}` : ""].filter(Boolean).join(" · ");
}

export const cancel = () => ask(`/v1/jobs/${current.id}`, { method: "DELETE" });

export const downloadMeasured = () => download(`/v1/jobs/${current.id}/annotated`, {}, "annotated.glb");

export const downloadReport = () => download(`/v1/jobs/${current.id}/report`, {}, `${current.level}.html`);

export function listJobs(openJob) {
  const kept = keptJobs();
  show(at("recent"), kept.length > 0);
  at("jobs").replaceChildren(...kept.map((job) => html("li", {},
    html("a", { href: `#job=${job.id}`, onclick: (event) => { event.preventDefault(); openJob(job.id); } }, html("bdi", {}, ...breakable(job.level || "unnamed"))),
    html("span", { class: `badge ${job.state}` }, job.state),
    html("span", { class: "under" }, ago(job.created)),
    html("button", { type: "button", class: "quiet", "aria-label": `Forget ${job.level}`, title: "Takes it off this list only", onclick: () => { forgetJob(job.id); listJobs(openJob); } }, "Forget"))));
}
