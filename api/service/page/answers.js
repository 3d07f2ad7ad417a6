// One shape for what was predicted and what was measured about a light, whichever the service said.

import { candidate } from "./words.js";

const LIKELY = 0.5;

const nameOf = (one) => candidate(one.technique, one.settings);
const measuredName = (one) => candidate(one.label, one.settings);

function predictedCandidate(one, chosen) {
  return {
    technique: one.technique, name: nameOf(one), chosen,
    ms: one.shadow_ms, msRange: one.shadow_ms_range, px: one.edge_error_px, pxRange: one.edge_error_px_range,
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

function measuredAnswer(light, limit) {
  if (!light.chosen) return { source: "measured", problem: light.problem };
  const candidates = light.candidates.map((one) => ({
    technique: one.label, name: measuredName(one), chosen: measuredName(one) === measuredName(light.chosen),
    ms: one.shadow_ms, px: one.edge_error_px, failure: one.status === "ok" ? "" : one.reason || one.status.replaceAll("_", " "),
  }));
  return {
    source: "measured", problem: "", mobility: light.mobility, limit,
    chosen: candidates.find((one) => one.chosen), candidates: candidates.filter((one) => !one.failure),
    runnerUp: light.runner_up && candidates.find((one) => one.name === measuredName(light.runner_up)),
    confidence: light.confidence, reason: light.reason, within: light.within_limit,
    refused: candidates.filter((one) => one.failure).map((one) => ({ technique: one.technique, name: one.name, reason: one.failure })),
    decidedBy: [], outside: [],
  };
}

function kindOf(features = {}) {
  return ["spot", "point", "directional"].find((kind) => features[`is_${kind}`] > LIKELY) ?? "";
}

// Lights by node, as in the level; either side may be missing.
export function lightsOf(predicted, measured) {
  const found = new Map();
  for (const light of predicted?.lights ?? []) {
    found.set(light.node, { node: light.node, name: light.light, kind: kindOf(light.features), predicted: predictedAnswer(light) });
  }
  for (const light of measured?.lights ?? []) {
    const before = found.get(light.node) ?? { node: light.node, name: light.name };
    found.set(light.node, { ...before, kind: light.kind, measured: measuredAnswer(light, measured.max_edge_error_px) });
  }
  return [...found.values()];
}

// How a prediction fared: in words and a kind.
export function verdict({ predicted, measured }) {
  if (!predicted?.chosen || !measured?.chosen) return null;
  if (predicted.chosen.name === measured.chosen.name) return ["as predicted", "right"];
  return predicted.chosen.technique === measured.chosen.technique ? ["other settings", ""] : ["other technique", "differs"];
}
