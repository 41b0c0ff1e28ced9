// Colours that stay apart for colour-blind eyes (after Okabe and Ito): right blue, left vermillion.
"use strict";

const COLOURS = {
  r: "#0072b2", l: "#d55e00", "": "#37424f",
  measured: "#1d2733", predicted: "#0a8f6a", hidden: "#e69f00", refused: "#c2428f", unlabelled: "#9aa5b1",
  target: "#009e73", other: "#6a4c93", grid: "#e3e8ee", axis: "#6b7785", text: "#24303d",
};
