// Asks the service. What it refuses is a Problem; while it is away, asking waits for it.

import { at, show } from "./elements.js";

const TOKEN = "gnomon.token";
const WAITS_S = [1, 2, 3, 5];

export class Problem extends Error {
  constructor(record, status = record.status) {
    super(record.detail || record.title || "The service refused without saying why.");
    this.status = status;
    this.known = record.known ?? "";
    this.remedy = record.remedy ?? "";
  }
}

class AwayError extends Error {}

export const hasToken = () => sessionStorage.getItem(TOKEN) !== null;

function headersWith(headers) {
  const token = sessionStorage.getItem(TOKEN);
  return token === null ? headers : { ...headers, Authorization: `Bearer ${token}` };
}

async function once(path, { query, headers = {}, ...options }) {
  const url = query ? `${path}?${query}` : path;
  let answer;
  try {
    answer = await fetch(url, { ...options, headers: headersWith(headers), cache: "no-store" });
  } catch (error) {
    throw error.name === "AbortError" ? error : new AwayError();
  }
  if (!answer.ok) throw await problemOf(answer);
  return answer;
}

async function problemOf(answer) {
  try {
    return new Problem(await answer.json(), answer.status);
  } catch {
    return new Problem({ detail: `The service answered with status ${answer.status}.` }, answer.status);
  }
}

async function alive() {
  try {
    return (await fetch("/healthz", { cache: "no-store" })).ok;
  } catch {
    return false;
  }
}

let waiting = null;

// Resolves when the service answers again; all that wait share one series of tries.
export function back() {
  waiting ??= wait().finally(() => { waiting = null; });
  return waiting;
}

async function wait() {
  if (await alive()) return;
  say("away", "away");
  show(at("away"));
  for (let tries = 0; !(await alive()); tries += 1) await pause(WAITS_S[Math.min(tries, WAITS_S.length - 1)]);
  show(at("away"), false);
  say("ready", "ready");
}

function pause(count) {
  return new Promise((resolve) => {
    let left = count;
    const words = () => { at("away-when").textContent = `Trying again in ${left} s.`; };
    const done = () => { clearInterval(timer); at("away-now").onclick = null; resolve(); };
    const timer = setInterval(() => { left -= 1; if (left <= 0) done(); else words(); }, 1000);
    at("away-now").onclick = done;
    words();
  });
}

export function say(kind, words) {
  at("service").dataset.kind = kind;
  at("service-words").textContent = words;
}

// A token that is missing or wrong is asked for, and then the question is asked again.
let askingToken = null;

function token(refused) {
  askingToken ??= new Promise((resolve) => {
    const form = at("token");
    show(form);
    at("token-problem").textContent = refused ? "That is not its token." : "";
    at("token-field").focus();
    form.onsubmit = (event) => {
      event.preventDefault();
      sessionStorage.setItem(TOKEN, at("token-field").value.trim());
      at("token-field").value = "";
      show(form, false);
      askingToken = null;
      resolve();
    };
  });
  return askingToken;
}

export async function ask(path, options = {}) {
  for (let broken = 0; ; ) {
    const had = sessionStorage.getItem(TOKEN);
    try {
      const answer = await once(path, options);
      if (!waiting) say("ready", "ready");
      return answer;
    } catch (error) {
      if (error instanceof Problem && error.status === 401) {
        // Another question may have brought a new token meanwhile.
        if (sessionStorage.getItem(TOKEN) === had) await token(had !== null);
      } else if (error instanceof AwayError) {
        broken += 1;
        if (broken > 2 && (await alive())) throw brokenOff();
        await back();
      } else throw error;
    }
    options.signal?.throwIfAborted();
  }
}

function brokenOff() {
  return new Problem({
    status: 0,
    detail: "The service broke the connection off while the level was on its way.",
    remedy: "The level may be larger than the service takes; the command line has no such limit.",
  });
}

export const askJson = async (path, options) => (await ask(path, options)).json();

export async function download(path, options, fallback) {
  const answer = await ask(path, options);
  const name = /filename="([^"]+)"/.exec(answer.headers.get("Content-Disposition") ?? "")?.[1] ?? fallback;
  save(await answer.blob(), named(answer.headers.get("Content-Disposition")) ?? name);
}

// RFC 6266: the name in UTF-8 where there is one.
function named(disposition) {
  const found = /filename\*=UTF-8''([^;]+)/i.exec(disposition ?? "");
  return found ? decodeURIComponent(found[1]) : null;
}

function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
