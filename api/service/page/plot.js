// Time against error, both logarithmic; errors too small for a logarithm lie in a lane below.

import { html, svg, techniqueIndex } from "./elements.js";
import { ms, px } from "./words.js";

// Letters keep their size on a narrow screen, so the drawing has less room there.
const WIDTH = matchMedia("(max-width: 44rem)").matches ? 380 : 640;
const HEIGHT = 340;
const [LEFT, RIGHT, TOP, BOTTOM] = [56, WIDTH - 18, 14, 292];
const LANE = 30;
const [LEAST_PX, LEAST_MS] = [0.01, 0.001];
const ROOM = 1.4;
const LEAST_SPAN = 4;
const MANY_STEPS = 3000;
const LETTER = 6.4;
const NONE = "No view shows an edge of this light's shadow, so only times tell candidates apart.";
const SHORT = "The views show too little of this shadow's edge to say by how many pixels it is off, so nothing is drawn. The table tells how much of the picture each candidate gets wrong.";

function axis(values, start, end) {
  let [low, high] = [Math.min(...values) / ROOM, Math.max(...values) * ROOM];
  const widen = Math.sqrt(Math.max(LEAST_SPAN / (high / low), 1));
  low /= widen;
  high *= widen;
  const at = (value) => start + (Math.log(value / low) / Math.log(high / low)) * (end - start);
  const steps = high / low < MANY_STEPS ? [1, 2, 5] : [1];
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += 1) {
    ticks.push(...steps.map((step) => Number(`${step}e${power}`)).filter((one) => one >= low && one <= high));
  }
  return { at, ticks };
}

export function plot(answer) {
  const points = answer.candidates.filter((one) => one.px !== null && one.ms !== null);
  if (points.length === 0) return html("p", { class: "note" }, answer.edgeSeen ? SHORT : NONE);
  const lane = BOTTOM - LANE;
  const shown = [...points.map((one) => one.px), answer.limit].filter((one) => one >= LEAST_PX);
  const across = axis(points.map((one) => Math.max(one.ms, LEAST_MS)), LEFT, RIGHT);
  const up = axis(shown.length > 0 ? shown : [1], lane, TOP);
  const x = (value) => across.at(Math.max(value, LEAST_MS));
  const y = (value) => (value >= LEAST_PX ? Math.max(Math.min(up.at(value), lane), TOP) : (lane + BOTTOM) / 2);
  const places = points.map((one) => ({ one, x: x(one.ms), y: y(one.px) }));
  const corners = front(places);
  const dots = labelled(places, answer, corners);
  const drawing = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": spoken(answer, points) },
    ...frame(answer, across, up, lane, y),
    svg("polyline", { class: "front", points: corners.map((one) => one.map((value) => value.toFixed(1)).join(",")).join(" ") }),
    answer.chosen.msRange ? whiskers(answer.chosen, x, y) : null,
    ...dots.map((one) => dot(one, answer)));
  return html("figure", { class: "plot", onmouseover: lightUp, onmouseout: lightUp }, drawing);
}

function spoken(answer, points) {
  return `Time against error of ${points.length} candidates; ${answer.chosen.name} at ${ms(answer.chosen.ms)} and ${px(answer.chosen.px)} is the choice. The table below has all figures.`;
}

function frame(answer, across, up, lane, y) {
  const line = (kind, x1, y1, x2, y2) => svg("line", { class: kind, x1, y1, x2, y2 });
  const text = (kind, x, at, anchor, words) => svg("text", { class: kind, x, y: at, "text-anchor": anchor }, words);
  const limit = answer.limit >= LEAST_PX ? y(answer.limit) : lane;
  return [
    svg("rect", { class: "band", x: LEFT, y: limit, width: RIGHT - LEFT, height: BOTTOM - limit }),
    ...across.ticks.flatMap((one) => [line("grid", across.at(one), TOP, across.at(one), BOTTOM), text("tick", across.at(one), BOTTOM + 17, "middle", one.toLocaleString("en", { maximumFractionDigits: 4 }))]),
    ...up.ticks.flatMap((one) => [line("grid", LEFT, up.at(one), RIGHT, up.at(one)), text("tick", LEFT - 8, up.at(one) + 4, "end", one.toLocaleString("en", { maximumFractionDigits: 4 }))]),
    line("lane", LEFT, lane, RIGHT, lane),
    text("tick", LEFT - 8, (lane + BOTTOM) / 2 + 4, "end", `< ${LEAST_PX}`),
    line("axis", LEFT, BOTTOM, RIGHT, BOTTOM),
    line("limit", LEFT, limit, RIGHT, limit),
    text("tick", RIGHT - 4, limit + 14, "end", `within ${answer.limit} px`),
    text("title", RIGHT, HEIGHT - 10, "end", "time of the shadow, ms"),
    svg("text", { class: "title", transform: `translate(13 ${TOP}) rotate(-90)`, "text-anchor": "end" }, "edge off by, px"),
  ];
}

// Whatever the limit, the best are on this line: each buys its error for all times from its own on.
function front(dots) {
  const corners = [];
  let least = Infinity;
  for (const dot of [...dots].sort((one, other) => one.one.ms - other.one.ms || one.one.px - other.one.px)) {
    if (dot.one.px >= least) continue;
    if (corners.length > 0) corners.push([dot.x, corners.at(-1)[1]]);
    corners.push([dot.x, dot.y]);
    least = dot.one.px;
  }
  return corners;
}

function whiskers({ ms: time, px: error, msRange, pxRange }, x, y) {
  const path = `M${x(msRange[0])} ${y(error)}H${x(msRange[1])}M${x(time)} ${y(pxRange[0])}V${y(pxRange[1])}`;
  return svg("path", { class: "whiskers", d: path });
}

// Labels that would cover a dot, the line or another label wait until the dot is pointed at.
function labelled(dots, answer, corners) {
  const first = (dot) => (dot.one.chosen ? 0 : dot.one === answer.runnerUp ? 1 : 2);
  const taken = dots.map((dot) => [dot.x - 6, dot.y - 6, dot.x + 6, dot.y + 6]);
  for (const [index, [right, low]] of corners.slice(1).entries()) {
    const [left, high] = corners[index];
    taken.push([Math.min(left, right), Math.min(low, high), Math.max(left, right), Math.max(low, high)]);
  }
  const apart = (one, other) => one[2] < other[0] || other[2] < one[0] || one[3] < other[1] || other[3] < one[1];
  for (const dot of [...dots].sort((one, other) => first(one) - first(other))) {
    // The name of the choice is bold.
    const width = dot.one.name.length * LETTER * (dot.one.chosen ? 1.2 : 1) + 4;
    const gap = dot.one.chosen ? 15 : 10;
    const places = [["start", gap, 4], ["end", -gap, 4], ["middle", 0, -gap], ["middle", 0, gap + 9]];
    const boxes = places.map(([anchor, dx, dy]) => {
      const left = dot.x + dx - (anchor === "start" ? 0 : anchor === "end" ? width : width / 2);
      return { anchor, dx, dy, box: [left, dot.y + dy - 11, left + width, dot.y + dy + 3] };
    });
    const inside = boxes.filter(({ box }) => box[0] > LEFT - 4 && box[2] < WIDTH && box[1] > 0 && box[3] < BOTTOM + 4);
    const free = inside.find(({ box }) => taken.every((other) => apart(box, other)));
    dot.label = free ?? inside[0] ?? boxes[0];
    dot.crowded = !free && !dot.one.chosen;
    if (free || dot.one.chosen) taken.push(dot.label.box);
  }
  return dots;
}

function dot({ one, x, y, label, crowded }) {
  const index = techniqueIndex(one.technique);
  const kind = `dot t${index}${one.chosen ? " chosen" : ""}${crowded ? " crowded" : ""}`;
  return svg("g", { class: kind, "data-key": one.name },
    svg("title", {}, `${one.name}: ${ms(one.ms)}, ${px(one.px)}`),
    one.chosen ? svg("circle", { class: "ring", cx: x, cy: y, r: 11 }) : null,
    svg("use", { href: `#shape-${index}`, x, y }),
    svg("text", { x: x + label.dx, y: y + label.dy, "text-anchor": label.anchor }, one.name));
}

// A dot and its row in the table below light up together.
export function lightUp(event) {
  const key = event.target.closest("[data-key]")?.dataset.key;
  const both = event.currentTarget.closest(".picture") ?? event.currentTarget;
  for (const one of both.querySelectorAll("[data-key]")) one.classList.toggle("hot", event.type === "mouseover" && one.dataset.key === key);
}
