"use strict";
// What all figures share. Without plotly's bar of buttons, which covers titles: dragging zooms, a double click resets.
const data = (id) => JSON.parse(document.getElementById(id).textContent);
const INK = "#1c242c", MUTED = "#5a6672", LINE = "#e4e8ec";
const HOT = "#d55e00", COLD = "#0072b2", SKY = "#56b4e9", GREY = "#7f7f7f", GREEN = "#009e73", YELLOW = "#e69f00";
const FONT = { family: 'system-ui, "Segoe UI", "DejaVu Sans", sans-serif', size: 13, color: INK };
const AXIS = { gridcolor: LINE, linecolor: MUTED, zeroline: false, automargin: true, ticks: "outside", ticklen: 4, tickcolor: LINE };
const CONFIG = { responsive: true, displayModeBar: false, plotlyServerURL: "" };
const NARROW_PX = 700;

// Plotly reads names as a little HTML.
const plain = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

function merged(below, above) {
  const both = { ...below };
  for (const [key, value] of Object.entries(above || {})) {
    const object = value && typeof value === "object" && !Array.isArray(value);
    both[key] = object && typeof both[key] === "object" ? merged(both[key], value) : value;
  }
  return both;
}
