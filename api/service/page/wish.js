// The controls: policy, mobility and resolution, as the query of a request.

import { at, html, show } from "./elements.js";
import { keepWish, keptWish } from "./kept.js";

const OWN = "";
const SETTLED_MS = 350;

let fallback = "balanced";

export function offerPolicies({ policies, default: usual }, changed) {
  fallback = usual;
  const choices = policies.map((one) => choice(one.name, [one.name, html("small", {}, `${one.max_edge_error_px} px`)]));
  const own = html("input", { type: "number", id: "own", min: 0, max: 10000, step: "any", value: "1", "aria-label": "Pixels that edges may be off by" });
  at("policies").append(...choices, choice(OWN, ["own"]), html("span", { class: "row tight own", id: "own-field" }, own, "px"));
  restore();
  const form = at("wish");
  let timer;
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", (event) => {
    settle();
    keepWish(values());
    clearTimeout(timer);
    // Numbers are typed digit by digit.
    if (form.checkValidity()) timer = setTimeout(changed, event.target.type === "number" ? SETTLED_MS : 0);
  });
}

function choice(value, words) {
  const input = html("input", { type: "radio", name: "policy", value, checked: value === fallback });
  return html("label", {}, input, " ", html("span", {}, ...words));
}

const picked = (name) => at("wish").elements[name].value;

function values() {
  return { policy: picked("policy"), own: at("own").value, mobility: picked("mobility"), size: at("resolution").value, width: at("width").value, height: at("height").value };
}

function restore() {
  const wish = keptWish();
  const set = (id, value) => { if (typeof value === "string") at(id).value = value; };
  for (const name of ["policy", "mobility"]) {
    if ([...at("wish").elements[name]].some((one) => one.value === wish[name])) at("wish").elements[name].value = wish[name];
  }
  set("own", wish.own);
  if ([...at("resolution").options].some((one) => one.value === wish.size)) at("resolution").value = wish.size;
  set("width", wish.width);
  set("height", wish.height);
  if (!at("wish").checkValidity()) at("wish").reset();
  settle();
}

// Fields that mean nothing at present are neither shown nor checked.
function settle() {
  const own = picked("policy") === OWN;
  const other = at("resolution").value === "";
  show(at("own-field"), own);
  show(at("size"), other);
  at("own").disabled = !own;
  at("width").disabled = !other;
  at("height").disabled = !other;
}

export function query(name) {
  const { policy, own, mobility, size, width, height } = values();
  const found = new URLSearchParams({ name, resolution: size || `${width}x${height}` });
  if (policy === OWN) found.set("max_edge_error_px", own);
  else found.set("policy", policy);
  if (mobility) found.set("mobility", mobility);
  return found;
}

// Whether a job was asked the same as the table.
export function sameAsked(options) {
  const now = query("");
  const asked = (name, usual) => String(options[name] ?? usual);
  return ["max_edge_error_px", "mobility"].every((name) => (now.get(name) ?? "") === asked(name, ""))
    && now.get("resolution") === asked("resolution", "640x360")
    && (now.has("max_edge_error_px") || now.get("policy") === asked("policy", fallback));
}

export function enableWish(wanted) {
  for (const one of at("wish").querySelectorAll("fieldset, select")) one.disabled = !wanted;
}
