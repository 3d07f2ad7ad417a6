// A job's events. By fetch, not EventSource, which cannot send a token; the line is taken up again when it breaks.

import { ask, askJson, back } from "./service.js";

export const ended = (job) => ["done", "failed", "cancelled"].includes(job.state);

const PAUSE_MS = 1000;

// Calls `each` with the job whenever something has happened; gives the job as it ended.
export async function watch(id, each, signal) {
  let last = "";
  for (;;) {
    try {
      last = await listen(id, last, each, signal);
    } catch (error) {
      // What the service refuses stays refused; a line that breaks in the middle is a TypeError.
      if (!(error instanceof TypeError)) throw error;
      await back();
    }
    signal.throwIfAborted();
    const job = await askJson(`/v1/jobs/${id}`, { signal });
    each(job);
    if (ended(job)) return job;
    await new Promise((resolve) => { setTimeout(resolve, PAUSE_MS); });
  }
}

async function listen(id, last, each, signal) {
  const headers = { Accept: "text/event-stream", ...(last ? { "Last-Event-ID": last } : {}) };
  const answer = await ask(`/v1/jobs/${id}/events`, { headers, signal });
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let held = "";
  let seen = last;
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return seen;
    const blocks = (held + value).replaceAll("\r\n", "\n").split("\n\n");
    held = blocks.pop();
    for (const block of blocks) {
      const event = fields(block);
      seen = event.id ?? seen;
      if (event.data) each(JSON.parse(event.data));
    }
  }
}

function fields(block) {
  const found = {};
  for (const line of block.split("\n")) {
    const [, name, value] = /^([a-z]+): ?(.*)$/.exec(line) ?? [];
    if (name) found[name] = name === "data" && found.data ? `${found.data}\n${value}` : value;
  }
  return found;
}
