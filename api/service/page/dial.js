// A sundial that shows the hour: a gnomon, the part that casts the shadow, on a horizontal plate.

import { svg } from "./elements.js";

const RADIUS = 100;
const LATITUDE = (55.8 * Math.PI) / 180;
const TURN = (36 * Math.PI) / 180;
const RISE = (38 * Math.PI) / 180;
const FOOT = -0.3;
const HEAD = 0.36;

// Seen from the side on which the shadow falls: after noon, from the east.
let turn = TURN;

function seen(x, y, z = 0) {
  const [across, away] = [x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn)];
  return [RADIUS * across, -RADIUS * (away * Math.sin(RISE) + z * Math.cos(RISE))].map((one) => one.toFixed(1)).join(",");
}

// The shadow of the style lies on the line of the hour, which starts at its foot.
function hourLine(hour) {
  const angle = ((hour - 12) * Math.PI) / 12;
  return Math.atan2(Math.sin(LATITUDE) * Math.sin(angle), Math.cos(angle));
}

function onLine(hour, distance) {
  const angle = hourLine(hour);
  return [distance * Math.sin(angle), FOOT + distance * Math.cos(angle)];
}

// Where the line of the hour meets a circle about the plate's middle.
function onCircle(hour, radius) {
  const along = Math.cos(hourLine(hour)) * -FOOT;
  return onLine(hour, along + Math.sqrt(Math.max(along * along + radius * radius - FOOT * FOOT, 0)));
}

function circle(radius, lift) {
  return Array.from({ length: 72 }, (_, index) => {
    const angle = (index * Math.PI) / 36;
    return seen(radius * Math.cos(angle), radius * Math.sin(angle), lift);
  }).join(" ");
}

export function draw(place, now = new Date()) {
  const clock = now.getHours() + now.getMinutes() / 60;
  const day = clock >= 6 && clock <= 18;
  // By night the moon does it.
  const hour = day ? clock : 6 + ((clock + 6) % 12);
  turn = hour < 12 ? TURN : -TURN;
  const hours = Array.from({ length: 13 }, (_, index) => index + 6);
  const ticks = hours.map((one) => {
    const [from, to] = [onCircle(one, one % 3 === 0 ? 0.74 : 0.8), onCircle(one, 0.87)];
    return svg("polyline", { class: one % 3 === 0 ? "tick strong" : "tick", points: `${seen(...from)} ${seen(...to)}` });
  });
  const tip = onCircle(hour, 0.7);
  const apex = (HEAD - FOOT) * Math.tan(LATITUDE) * 0.78;
  place.replaceChildren(
    svg("polygon", { class: "side", points: circle(1, -0.07) }),
    svg("polygon", { class: "plate", points: circle(1, 0) }),
    svg("polygon", { class: "ring", points: circle(0.87, 0) }),
    ...ticks,
    svg("polygon", { class: day ? "cast" : "cast night", points: [seen(0, FOOT), seen(0, HEAD), seen(...tip)].join(" ") }),
    svg("polygon", { class: "gnomon", points: [seen(0, FOOT), seen(0, HEAD), seen(0, HEAD, apex)].join(" ") }),
  );
}
