// Sankey diagrams of one run.
const NODE_COLOURS = [
  [/losses|ambient|panels|Ventilation|hoses|drag|resistance|brakes/i, "#9aa5b0"],
  [/chiller|exhaust/i, SKY], [/refrigerant/i, GREEN], [/HTC|PTC/, HOT], [/cabin|air/i, YELLOW],
  [/battery|cells|bus/i, COLD], [/compressor/i, GREEN],
];
const colour_of = (name) => (NODE_COLOURS.find(([pattern]) => pattern.test(name)) || [null, "#8c7aa9"])[1];
const faint = (colour) => `${colour}66`;

function draw_energy(place, links, title, height) {
  const names = [...new Set(links.flatMap(([source, target]) => [source, target]))];
  const sum = (name, end) => links.filter((link) => link[end] === name).reduce((total, link) => total + link[2], 0);
  const through = (name) => Math.max(sum(name, 0), sum(name, 1));
  const number = new Map(names.map((name, order) => [name, order]));
  Plotly.react(place, [{
    type: "sankey", arrangement: "snap", valueformat: ".2f", valuesuffix: " kWh",
    node: { label: names.map((name) => `${name} ${through(name).toFixed(2)}`), color: names.map(colour_of),
      pad: 14, thickness: 12, line: { width: 0 } },
    link: { source: links.map(([source]) => number.get(source)), target: links.map(([, target]) => number.get(target)),
      value: links.map(([, , kwh]) => kwh), color: links.map(([source]) => faint(colour_of(source))) },
  }], { title: { text: title, x: 0, xref: "paper", font: { size: 15 } }, font: { ...FONT, size: 12 }, height,
    margin: { l: 4, r: 4, t: 40, b: 12 }, paper_bgcolor: "#fff" }, CONFIG);
}
