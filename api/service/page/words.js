// Figures and times as people read them.

export function digits(value) {
  if (value === 0) return "0";
  if (Math.abs(value) >= 100) return Math.round(value).toLocaleString("en");
  return Math.abs(value) < 1 ? Number(value.toPrecision(2)).toString() : value.toPrecision(3);
}

export const ms = (value) => (value === null || value === undefined ? "-" : `${digits(value)} ms`);

const LEAST_PX = 0.01;

export function px(value) {
  if (value === null || value === undefined) return "no edge";
  if (value === 0) return "exact";
  return value < LEAST_PX ? `< ${LEAST_PX} px` : `${digits(value)} px`;
}

// How far a candidate's edge is off; where too little of it is seen, how much of the picture is wrong.
export function offWords({ px: edge, wrong, edgeSeen }) {
  if (edge !== null || !edgeSeen) return px(edge);
  if (!wrong) return "none wrong";
  const value = Number((100 * wrong).toPrecision(2));
  return value < 0.001 ? "< 0.001 % wrong" : `${value} % wrong`;
}

export function range([low, high], unit) {
  if (high < LEAST_PX && unit === "px") return "";
  const [from, to] = [digits(low), digits(high)];
  return from === to ? "" : `${from} to ${to}`;
}

export const percent = (share) => (share === null || share === undefined ? "-" : `${Math.round(100 * share)} %`);

// What a map covers is said only where it is not all that the light reaches.
export function candidate(label, settings) {
  const shown = Object.entries(settings ?? {}).filter(([name, value]) => name !== "focus" || value !== "light");
  return [label, ...shown.map(([, value]) => value)].join(" ");
}

const COVERS = { view: "covering what the camera sees", light: "covering all that the light reaches" };

// What the settings beside a technique's label mean; empty where there are none.
export function settingsMeaning(settings) {
  const { map_size: size, filter, kernel, focus, ...others } = settings ?? {};
  const taps = filter ?? kernel;
  const parts = [
    size && `a map of ${size} x ${size} texels`,
    taps && (taps === "1x1" ? "not filtered" : `filtered over ${taps.replace("x", " x ")} texels`),
    COVERS[focus],
    ...Object.entries(others).map(([name, value]) => `${name.replaceAll("_", " ")} ${value}`),
  ];
  return parts.filter(Boolean).join(", ");
}

// Undoes the logarithm of a feature, which only a model reads easily.
export function plainly(value, unit) {
  const [, plus, of] = /^log2(?:\((1 \+ )?(\w+)\))?$/.exec(unit) ?? [];
  if (!unit.startsWith("log2")) return `${Number(value.toPrecision(3))}${unit === "none" ? "" : ` ${unit}`}`;
  const plain = 2 ** value - (plus ? 1 : 0);
  if (of === undefined) return `${digits(plain)} times`;
  return of === "count" ? Math.round(plain).toLocaleString("en") : `${digits(plain)} ${of}`;
}

// The device by name: a link's width and instructions of the processor tell nobody anything.
export function deviceName(renderer) {
  const software = /llvmpipe|softpipe|swiftshader|lavapipe/i.exec(renderer);
  return software ? `${software[0]} (no GPU)` : renderer.replace(/\/PCIe.*$/, "").replace(/\s*\((?:LLVM|DRM|Mesa)[^)]*\)/i, "");
}

export const counted = (count, noun) => `${count.toLocaleString("en")} ${noun}${count === 1 ? "" : "s"}`;

export function seconds(count) {
  if (count < 60) return `${Math.max(1, Math.round(count))} s`;
  const minutes = Math.floor(count / 60);
  return minutes < 60 ? `${minutes} min ${Math.round(count % 60)} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

export function ago(moment) {
  const past = (Date.now() - new Date(moment).getTime()) / 1000;
  if (!Number.isFinite(past)) return "";
  if (past < 60) return "just now";
  if (past < 3600) return `${Math.round(past / 60)} min ago`;
  return past < 86400 ? `${Math.round(past / 3600)} h ago` : new Date(moment).toLocaleDateString();
}

export function listed(words) {
  return words.length < 2 ? words.join("") : `${words.slice(0, -1).join(", ")} and ${words.at(-1)}`;
}

export const sentence = (words) => words.charAt(0).toUpperCase() + words.slice(1);
