// Makes elements. Text goes in as text only: names in levels are written by strangers.

// Their edges are off by rounding alone, which is no finding.
const EXACT = new Set(["shadow_volume"]);
const SVG = "http://www.w3.org/2000/svg";

export const at = (id) => document.getElementById(id);

export function show(element, wanted = true) {
  element.hidden = !wanted;
}

function filled(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat().filter((one) => one !== null && one !== undefined && one !== ""));
  return element;
}

export function html(tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

export function svg(tag, attributes = {}, ...children) {
  return filled(document.createElementNS(SVG, tag), attributes, children);
}

// The style sheet may not come with the markup under the page's content policy, so widths are set here.
export function meter(share, kind) {
  const bar = html("i");
  bar.style.width = `${100 * Math.min(Math.max(share, 0), 1)}%`;
  return html("span", { class: kind, "aria-hidden": "true" }, bar);
}

let order = [];

export function setTechniques(techniques) {
  order = techniques;
}

export function techniqueIndex(label) {
  const index = order.findIndex((one) => one.label === label);
  return index < 0 ? 5 : index % 6;
}

export function techniqueTitle(label) {
  const id = order.find((one) => one.label === label)?.id ?? "";
  return `${id.charAt(0).toUpperCase()}${id.slice(1).replaceAll("_", " ")}`;
}

export function techniqueSummary(label) {
  return order.find((one) => one.label === label)?.summary ?? "";
}

export function mark(label) {
  const index = techniqueIndex(label);
  const shape = svg("use", { href: `#shape-${index}` });
  return svg("svg", { class: `mark t${index}`, viewBox: "-7 -7 14 14", "aria-hidden": "true" }, shape);
}

// Long names may break after what parts their words.
export function breakable(text) {
  return String(text).split(/(?<=[_.-])(?=[^_.-])/).flatMap((piece, index) => (index > 0 ? [document.createElement("wbr"), piece] : [piece]));
}

export function techniqueIsExact(label) {
  return EXACT.has(order.find((one) => one.label === label)?.id);
}

export function badge(words, kind = "", title = null) {
  return html("span", { class: `badge ${kind}`, title }, words);
}
