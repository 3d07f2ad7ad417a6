// What the page shows at present.

export const now = {
  level: null,
  predicted: null,
  measured: null,
  // What the predictions were asked with, and whether they no longer answer what the controls say.
  answeredWish: null,
  stale: false,
  // Whether a level is being read that is not the one shown.
  reading: false,
};
