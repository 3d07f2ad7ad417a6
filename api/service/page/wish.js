// The controls: policy, mobility and resolution, as the query of a request.

import { at, html, show } from "./elements.js";
import { keepWish, keptWish } from "./kept.js";

const OWN = "";
const SETTLED_MS = 350;
// As the service takes them: api/service/asked.py.
const MOST_PX = 10000;
const ALLOWED = { own: "0 to 10,000 pixels", width: "16 to 4096 pixels", height: "16 to 4096 pixels" };

let fallback = "balanced";

// Calls `changed` when something else is asked, and `refused` as soon as that cannot be asked.
export function offerPolicies({ policies, default: usual }, { changed, refused }) {
  fallback = usual;
  const choices = policies.map((one) => choice(one.name, [one.name, html("small", {}, `${one.max_edge_error_px} px`)]));
  const own = html("input", { type: "number", id: "own", min: 0, max: MOST_PX, step: "any", value: "1", required: true, "aria-label": "Pixels that edges may be off by", "aria-describedby": "own-problem" });
  const problem = html("span", { class: "problem", id: "own-problem", role: "alert" });
  at("policies").append(...choices, choice(OWN, ["own"]), html("span", { class: "row tight own", id: "own-field" }, own, "px", problem));
  putWish(keptWish());
  const form = at("wish");
  let timer;
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", (event) => {
    settle();
    clearTimeout(timer);
    if (!wishHolds()) {
      refused();
      return;
    }
    keepWish(currentWish());
    // Numbers are typed digit by digit.
    timer = setTimeout(changed, event.target.type === "number" ? SETTLED_MS : 0);
  });
}

function choice(value, words) {
  const input = html("input", { type: "radio", name: "policy", value, checked: value === fallback });
  return html("label", {}, input, " ", html("span", {}, ...words));
}

const picked = (name) => at("wish").elements[name].value;

export function currentWish() {
  return { policy: picked("policy"), own: at("own").value, mobility: picked("mobility"), size: at("resolution").value, width: at("width").value, height: at("height").value };
}

export function putWish(wish) {
  const set = (id, value) => { if (typeof value === "string") at(id).value = value; };
  for (const name of ["policy", "mobility"]) {
    if ([...at("wish").elements[name]].some((one) => one.value === wish[name])) at("wish").elements[name].value = wish[name];
  }
  set("own", wish.own);
  if ([...at("resolution").options].some((one) => one.value === wish.size)) at("resolution").value = wish.size;
  set("width", wish.width);
  set("height", wish.height);
  settle();
  if (!at("wish").checkValidity()) at("wish").reset();
  settle();
  wishHolds();
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

// Whether this can be asked; if not, what is allowed stands beside the field.
export function wishHolds() {
  const wrong = Object.keys(ALLOWED).filter((id) => !at(id).disabled && !at(id).validity.valid);
  for (const id of Object.keys(ALLOWED)) at(id).setAttribute("aria-invalid", String(wrong.includes(id)));
  tell("own-problem", wrong.includes("own") ? ALLOWED.own : "");
  tell("size-problem", ALLOWED[wrong.find((id) => id !== "own")] ?? "");
  return wrong.length === 0;
}

// An alert is spoken whenever it is written, so it is written once.
function tell(id, words) {
  if (at(id).textContent !== words) at(id).textContent = words;
}

export function showWhatIsWrong() {
  at("wish").querySelector("input:enabled:invalid")?.focus();
}

export function query(name) {
  const { policy, own, mobility, size, width, height } = currentWish();
  const found = new URLSearchParams({ name, resolution: size || `${width}x${height}` });
  if (policy === OWN) found.set("max_edge_error_px", own);
  else found.set("policy", policy);
  if (mobility) found.set("mobility", mobility);
  return found;
}

export function enableWish(wanted) {
  for (const one of at("wish").querySelectorAll("fieldset, select")) one.disabled = !wanted;
}
