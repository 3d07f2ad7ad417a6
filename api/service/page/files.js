// A level out of chosen or dropped files: which one it is, what goes with it, and how it is sent.

import { counted, listed } from "./words.js";
import { Problem } from "./service.js";

const GLB = "model/gltf-binary";
const GLTF = "model/gltf+json";
const MOST_FILES = 2000;
const MOST_NAMED = 3;
const OTHER_LEVELS = /\.(map|usd[acz]?|obj|ply|stl)$/i;

const isLevel = (path) => /\.(glb|gltf)$/i.test(path);
const lastOf = (path) => path.split(/[\\/]/).at(-1);

// Files of an <input>, or of a folder in one.
export function chosen(list) {
  return [...list].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
}

// Files of a drop; folders are opened.
export async function dropped(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (entries.length === 0) return chosen(transfer.files);
  const found = [];
  for (const entry of entries) await walk(entry, found);
  return found;
}

async function walk(entry, found) {
  if (found.length >= MOST_FILES) return;
  if (entry.isFile) {
    const file = await new Promise((resolve, reject) => { entry.file(resolve, reject); });
    found.push({ path: entry.fullPath.replace(/^\//, ""), file });
    return;
  }
  const reader = entry.createReader();
  for (;;) {
    const some = await new Promise((resolve, reject) => { reader.readEntries(resolve, reject); });
    if (some.length === 0) return;
    for (const one of some) await walk(one, found);
  }
}

// Gives {name, type, file, beside: [{place, file}]}; throws a Problem in words.
export async function levelOf(files) {
  const levels = files.filter((one) => isLevel(one.path));
  if (levels.length === 0) throw noLevel(files);
  if (levels.length > 1) {
    const names = levels.slice(0, MOST_NAMED).map((one) => lastOf(one.path));
    throw refusal(`These are ${counted(levels.length, "level")}: ${names.join(", ")}${levels.length > MOST_NAMED ? " and more" : ""}.`, "Choose one at a time.");
  }
  const [level] = levels;
  const name = lastOf(level.path);
  if (/\.glb$/i.test(name)) return { name, type: GLB, file: level.file, beside: [] };
  const beside = companions(await uris(level.file), level, files);
  return { name, type: GLTF, file: level.file, beside };
}

// The command line reads more formats than this page.
function noLevel(files) {
  const other = files.map((one) => lastOf(one.path)).find((name) => OTHER_LEVELS.test(name));
  if (!other) return refusal("There is no .glb or .gltf among these files.", "Choose a glTF level, and with a .gltf the files that it names.");
  const named = /^[\w.-]+$/.test(other) ? other : `"${other}"`;
  return refusal(`This page reads glTF; for ${other} run: gnomon recommend ${named}`, "Or export the level as .glb, and drop that.");
}

// Buffers only: pictures cast no shadow. What is no glTF has none, and the service says what is wrong with it.
async function uris(file) {
  try {
    const { buffers = [] } = JSON.parse(await file.text());
    return [...new Set(buffers.map((one) => one.uri))].filter((uri) => typeof uri === "string" && !uri.startsWith("data:"));
  } catch {
    return [];
  }
}

function companions(wanted, level, files) {
  const folder = level.path.slice(0, level.path.length - lastOf(level.path).length);
  const found = wanted.map(placeOf).map((place) => ({ place, file: fileOf(place, folder, files) }));
  const missing = found.filter((one) => !one.file).map((one) => one.place);
  if (missing.length > 0) {
    const names = missing.length > MOST_NAMED ? [...missing.slice(0, MOST_NAMED), "others"] : missing;
    throw refusal(`${lastOf(level.path)} names ${counted(missing.length, "file")} that ${missing.length === 1 ? "was" : "were"} not chosen with it: ${listed(names)}.`, "Choose them together, or drop the folder that holds them all.");
  }
  return found;
}

// The path beside the level that a uri stands for: uris write a space as %20.
function placeOf(uri) {
  try { return decodeURIComponent(uri).replace(/^\.\//, ""); } catch { return uri; }
}

// By its place beside the level, or else by its name where only one file is called so.
function fileOf(place, folder, files) {
  const exact = files.find((one) => one.path === folder + place);
  const alike = files.filter((one) => lastOf(one.path) === lastOf(place));
  return exact?.file ?? (alike.length === 1 ? alike[0].file : undefined);
}

// Trying again with the same files does not help, so this is no problem of the network.
function refusal(detail, remedy) {
  return new Problem({ status: 400, detail, remedy });
}

// What fetch needs to send it.
export function sent(level) {
  if (level.beside.length === 0) return { method: "POST", headers: { "Content-Type": level.type }, body: level.file };
  const form = new FormData();
  form.append("level", new File([level.file], level.name, { type: level.type }), level.name);
  for (const { place, file } of level.beside) {
    form.append("file", new File([file], place, { type: "application/octet-stream" }), place);
  }
  return { method: "POST", body: form };
}
