// What a reload comes back to: the last level, what was asked of it, and the jobs that were started here.

const DATABASE = "gnomon";
const LEVELS = "levels";
const JOBS = "gnomon.jobs";
const WISH = "gnomon.wish";
const OPEN = "gnomon.open";
const MOST_JOBS = 8;

function database() {
  return new Promise((resolve, reject) => {
    const request = indexedDB.open(DATABASE, 1);
    request.onupgradeneeded = () => request.result.createObjectStore(LEVELS);
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

async function within(mode, act) {
  const opened = await database();
  try {
    return await new Promise((resolve, reject) => {
      const request = act(opened.transaction(LEVELS, mode).objectStore(LEVELS));
      request.onsuccess = () => resolve(request.result);
      request.onerror = () => reject(request.error);
    });
  } finally {
    opened.close();
  }
}

// A browser that keeps nothing, or has no room, only means that a reload starts afresh.
export async function keepLevel(level) {
  sessionStorage.setItem(OPEN, "yes");
  await within("readwrite", (store) => store.put(level, "last")).catch(() => null);
}

export const keptLevel = () => within("readonly", (store) => store.get("last")).catch(() => null);

export const wasOpen = () => sessionStorage.getItem(OPEN) !== null;

export const closeLevel = () => sessionStorage.removeItem(OPEN);

function read(name, otherwise) {
  try {
    return JSON.parse(localStorage.getItem(name)) ?? otherwise;
  } catch {
    return otherwise;
  }
}

function write(name, value) {
  try { localStorage.setItem(name, JSON.stringify(value)); } catch { /* As above. */ }
}

export const keptWish = () => read(WISH, {});

export const keepWish = (wish) => write(WISH, wish);

export const keptJobs = () => read(JOBS, []).filter((one) => typeof one.id === "string");

export function keepJob(job) {
  const others = keptJobs().filter((one) => one.id !== job.id);
  const before = keptJobs().find((one) => one.id === job.id);
  write(JOBS, [{ ...before, ...job }, ...others].slice(0, MOST_JOBS));
}

export const forgetJob = (id) => write(JOBS, keptJobs().filter((one) => one.id !== id));

// The fragment names the job, so that a reload, a bookmark or a second window finds it.
export const jobInAddress = () => /^#job=([\w-]+)$/.exec(location.hash)?.[1] ?? null;

// `place` is what the page shows there, so that the browser's Back can come back to it.
export function putInAddress(place, job, anew) {
  const address = job ? `#job=${job}` : location.pathname;
  if (anew) history.pushState(place, "", address);
  else history.replaceState(place, "", address);
}
