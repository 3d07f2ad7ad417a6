// While a level is read or asked again: which one, for how long, and a way to stop.

import { at, breakable, show } from "./elements.js";
import { seconds } from "./words.js";

const SHORT_MS = 1500;

let stop = () => {};

// Gives what ends it. An answer that comes soon is not announced where `late` is set.
export function announce(verb, name, { late, cancel }) {
  stop();
  const since = Date.now();
  const hadFocus = document.activeElement?.closest?.("#drop, .after-drop");
  const tick = () => { at("reading-time").textContent = `, ${seconds((Date.now() - since) / 1000)}`; };
  const begin = () => {
    at("reading-name").replaceChildren(`${verb} `, ...breakable(name));
    tick();
    show(at("reading"));
    // Beside a level it is in view wherever the page is scrolled to; in place of the drop field it may be below.
    if (!at("welcome").hidden) at("reading").scrollIntoView({ block: "nearest" });
    if (hadFocus) at("reading").focus({ preventScroll: true });
  };
  const timer = setInterval(tick, 1000);
  const delay = late ? setTimeout(begin, SHORT_MS) : null;
  at("reading-cancel").onclick = cancel;
  if (!late) begin();
  const mine = () => {
    clearInterval(timer);
    clearTimeout(delay);
    if (stop !== mine) return;
    show(at("reading"), false);
    stop = () => {};
  };
  stop = mine;
  return mine;
}
