// One shape for what was predicted and what was measured about a light, whichever the service said.

import { techniqueIsExact } from "./elements.js";
import { candidate, settingsMeaning } from "./words.js";

const LIKELY = 0.5;
const ROUNDING_PX = 0.01;
const CLOSE_CALL = 0.6;
// As in selector/recommendation.py.
const SHORT_EDGE_PX = 64;

const nameOf = (one) => candidate(one.technique, one.settings);
const measuredName = (one) => candidate(one.label, one.settings);

function edge(label, error) {
  return techniqueIsExact(label) && error !== null && error < ROUNDING_PX ? 0 : error;
}

function predictedCandidate(one, chosen) {
  return {
    technique: one.technique, name: nameOf(one), meaning: settingsMeaning(one.settings), chosen,
    ms: one.shadow_ms, msRange: one.shadow_ms_range, px: edge(one.technique, one.edge_error_px), off: one.edge_error_px, pxRange: one.edge_error_px_range,
    keeps: one.keeps_limit, failure: "",
  };
}

function predictedAnswer(light) {
  if (light.problem) return { source: "predicted", problem: light.problem };
  const candidates = [predictedCandidate(light, true), ...light.alternatives.map((one) => predictedCandidate(one, false))];
  return {
    source: "predicted", problem: "", mobility: light.mobility, limit: light.max_edge_error_px,
    chosen: candidates[0], candidates,
    runnerUp: light.runner_up && candidates.find((one) => one.name === nameOf(light.runner_up)),
    confidence: light.confidence, reason: light.reason,
    within: light.keeps_limit >= LIKELY,
    refused: light.refused.map((one) => ({ technique: one.technique, name: nameOf(one), reason: one.reason })),
    decidedBy: light.decided_by, outside: light.outside_training,
  };
}

// What candidates are sorted by: pixels of displacement, or what stands for them where the edge is short.
function off({ px, wrong }, pixels) {
  return px ?? (wrong * pixels) / SHORT_EDGE_PX;
}

function measuredAnswer(light, limit, pixels) {
  if (!light.chosen) return { source: "measured", problem: light.problem };
  const candidates = light.candidates.map((one) => ({
    technique: one.label, name: measuredName(one), meaning: settingsMeaning(one.settings), chosen: measuredName(one) === measuredName(light.chosen),
    ms: one.shadow_ms, px: edge(one.label, one.edge_error_px), wrong: one.wrong_share ?? 0, failure: one.status === "ok" ? "" : one.reason || one.status.replaceAll("_", " "),
  }));
  // Too little of an edge to say by how many pixels it is off, or none at all.
  const edgeSeen = candidates.some((one) => one.px !== null || one.wrong > 0);
  for (const one of candidates) Object.assign(one, { edgeSeen, off: off(one, pixels) });
  return {
    source: "measured", problem: "", mobility: light.mobility, limit,
    chosen: candidates.find((one) => one.chosen), candidates: candidates.filter((one) => !one.failure), edgeSeen,
    runnerUp: light.runner_up && candidates.find((one) => one.name === measuredName(light.runner_up)),
    confidence: light.confidence, reason: light.reason, within: light.within_limit,
    refused: candidates.filter((one) => one.failure).map((one) => ({ technique: one.technique, name: one.name, reason: one.failure })),
    decidedBy: [], outside: [],
  };
}

// Lights by node, as in the level; either side may be missing.
export function lightsOf(predicted, measured) {
  const found = new Map();
  const [width, height] = measured?.resolution ?? [0, 0];
  for (const light of predicted?.lights ?? []) {
    found.set(light.node, { node: light.node, name: light.light, kind: light.kind, predicted: predictedAnswer(light) });
  }
  for (const light of measured?.lights ?? []) {
    const before = found.get(light.node) ?? { node: light.node, name: light.name };
    found.set(light.node, { ...before, kind: light.kind, measured: measuredAnswer(light, measured.max_edge_error_px, width * height) });
  }
  return [...found.values()];
}

// How a prediction fared: in words and a kind.
export function verdict({ predicted, measured }) {
  if (!predicted?.chosen || !measured?.chosen) return null;
  if (predicted.chosen.name === measured.chosen.name) return ["as predicted", "right"];
  return predicted.chosen.technique === measured.chosen.technique ? ["other settings", ""] : ["other technique", "differs"];
}

// In what the two were asked differently, in words; nothing if they may be compared.
export function differences(predicted, measured, lights) {
  const found = [];
  const add = (before, one, other, after = "") => { if (one !== other) found.push(`measured ${before}${other}${after}, predicted ${before}${one}${after}`); };
  add("for edges off by at most ", predicted.max_edge_error_px, measured.max_edge_error_px, " px");
  add("at ", predicted.resolution.join("x"), measured.resolution.join("x"));
  const both = lights.filter((one) => one.predicted?.mobility && one.measured?.mobility);
  const moved = both.find((one) => one.predicted.mobility !== one.measured.mobility);
  if (moved) add("for lights that are ", moved.predicted.mobility, moved.measured.mobility);
  return found;
}

// How many lights get which technique, and what all of them cost together.
export function summary(lights, source) {
  const answers = lights.map((one) => one[source]).filter(Boolean);
  const chosen = answers.filter((one) => one.chosen).map((one) => one.chosen);
  if (lights.length < 2 || chosen.length === 0) return null;
  const counts = new Map();
  for (const { technique } of chosen) counts.set(technique, (counts.get(technique) ?? 0) + 1);
  const most = [...counts].sort(([, one], [, other]) => other - one);
  const times = chosen.map((one) => one.ms).filter((one) => typeof one === "number");
  return { counts: most, without: answers.length - chosen.length, ms: times.reduce((sum, one) => sum + one, 0) };
}

export const isCloseCall = ({ confidence }) => confidence !== null && confidence !== undefined && confidence < CLOSE_CALL;

export function closeCall({ runnerUp, source }) {
  return `Close call: the runner-up${runnerUp ? `, ${runnerUp.name},` : ""} may well be better; the choice ${source === "predicted" ? "has the lower expected cost" : "costs less on average"}.`;
}
