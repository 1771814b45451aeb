// Two controllers on the same trip: curves and connections over time.
// Loops, members and curves are those of the vehicles that were driven.
const DRIVEN = document.getElementById("traces") ? data("traces") : { members: [], loops: [], curves: {} };
const LOOP_COLOURS = { hot: [HOT, YELLOW, "#cc79a7"], cold: [SKY, GREEN, "#8c7aa9"] };
const LOOPS = [["isolated", "#e9ecef"]];
const SUPPLY_COLOURS = [];
for (const [label, side] of DRIVEN.loops) {
  const place = DRIVEN.loops.filter((loop) => loop[1] === side).findIndex((loop) => loop[0] === label);
  const colour = LOOP_COLOURS[side][place % LOOP_COLOURS[side].length];
  LOOPS.push([label, colour]);
  SUPPLY_COLOURS.push(colour === SKY ? COLD : colour);
}
const CABINS = [HOT, COLD, YELLOW, GREEN], POWERS = { compressor_kw: COLD }, HEATERS = [YELLOW, HOT, GREEN];
const own = (panel, colours) => (DRIVEN.curves[panel] || []).map(([key, label], place) => [key, label, colours(key, place)]);
const heater = (key) => DRIVEN.curves.power.filter(([other]) => !POWERS[other]).findIndex(([other]) => other === key);
const ROWS = [
  { title: "Speed, km/h", weight: 0.6, curves: [["speed_km_h", "", GREY]] },
  { title: "Temperature, °C", weight: 1.3, band: [21, 23], curves: [
    ...own("temperature", (_, place) => CABINS[place % CABINS.length]), ["ambient_degc", "ambient", GREY]] },
  { title: "Coolant supply, °C", weight: 1.1, curves: own("supply", (_, place) => SUPPLY_COLOURS[place]) },
  { title: "Power, kW", weight: 1.1, curves: own("power", (key) => POWERS[key] || HEATERS[heater(key) % HEATERS.length]) },
  { title: "Drawn from the cells so far, kWh", weight: 0.9, curves: [["cells_kwh", "", GREEN]] },
  { title: "Usable state of charge, %", weight: 0.8, curves: [["soc_pct", "", GREEN]] },
].filter((row) => row.curves.length);
const GAP = 0.045, ROW_PX = 150;

const marks = (curves) => curves.filter(([, name]) => name)
  .map(([, name, colour]) => `<span style="color:${colour}"><b>━ ${name}</b></span>`).join("   ");

// Domains from the top for rows of the given weights.
function domains(weights) {
  const free = 1 - GAP * (weights.length - 1), total = weights.reduce((sum, weight) => sum + weight, 0);
  let top = 1;
  return weights.map((weight) => {
    const height = free * weight / total, domain = [Math.max(top - height, 0), top];
    top -= height + GAP;
    return domain;
  });
}

// A member that a vehicle lacks stays blank.
const place_of_loop = (digit) => (digit === "-" ? null : parseInt(digit, 36));

const connections = (run, members, axes, showing) => ({
  type: "heatmap", x: run.time_min, y: members, z: run.connections.map((text) => [...text].map(place_of_loop)),
  text: run.connections.map((text) => [...text].map((digit) => (LOOPS[place_of_loop(digit)] || ["not there"])[0])),
  hovertemplate: `%{y}: %{text}<extra>${showing}</extra>`, zmin: -0.5, zmax: LOOPS.length - 0.5, ygap: 4, showscale: false,
  colorscale: LOOPS.flatMap(([, colour], place) => [[place / LOOPS.length, colour], [(place + 1) / LOOPS.length, colour]]), ...axes,
});

function draw_pair(place, traces, runs, names, over, narrow) {
  const traces_drawn = [], annotations = [], shapes = [], layout = {};
  const count = over ? 1 : 2;
  const timelines = over ? 2 : 1;
  const weights = [...ROWS.map((row) => row.weight), ...Array(timelines).fill(1.3)];
  const rows = domains(weights);
  const width = over ? 1 : 0.485;
  const axis = (row, column) => { const number = row * count + column + 1; return number === 1 ? "" : String(number); };
  const heading = (text, x, y, size = narrow ? 11 : 13) => annotations.push({
    text, x, y, xshift: narrow ? -75 : 0, xref: "paper", yref: "paper", xanchor: "left", yanchor: "bottom", showarrow: false, font: { ...FONT, size } });

  rows.forEach((domain, row) => {
    for (let column = 0; column < count; column += 1) {
      const id = axis(row, column), left = column * (1 - width);
      const last = row === rows.length - 1, timeline = row >= ROWS.length;
      layout[`xaxis${id}`] = { ...AXIS, domain: [left, left + width], anchor: `y${id}`, showticklabels: last,
        title: last ? { text: "time, min" } : undefined, ...(id ? { matches: "x" } : {}) };
      layout[`yaxis${id}`] = { ...AXIS, domain, anchor: `x${id}`, showticklabels: column === 0, nticks: timeline ? undefined : 5,
        ...(column ? { matches: `y${axis(row, 0)}` } : {}), ...(timeline ? { autorange: "reversed", ticks: "", showgrid: false } : {}) };
      if (ROWS[row] && ROWS[row].band) {
        shapes.push({ type: "rect", xref: `x${id} domain`, yref: `y${id}`, x0: 0, x1: 1, y0: ROWS[row].band[0],
          y1: ROWS[row].band[1], fillcolor: GREEN, opacity: 0.18, line: { width: 0 }, layer: "below" });
      }
    }
  });

  ["left", "right"].forEach((side, place_of) => {
    const run = runs[side], column = over ? 0 : place_of;
    ROWS.forEach((row, number) => row.curves.filter(([key]) => run[key]).forEach(([key, name, colour]) => {
      const id = axis(number, column);
      traces_drawn.push({ type: "scatter", mode: "lines", x: run.time_min, y: run[key], xaxis: `x${id}`, yaxis: `y${id}`,
        line: { color: colour, width: 1.7, dash: over && place_of ? "dot" : "solid" }, showlegend: false,
        hovertemplate: `%{y} <extra>${plain(names[side])}${name ? `, ${name}` : ""}</extra>` });
    }));
    const row = over ? ROWS.length + place_of : ROWS.length, id = axis(row, column);
    traces_drawn.push(connections(run, traces.members, { xaxis: `x${id}`, yaxis: `y${id}` }, plain(names[side])));
  });

  const colour = (side) => traces.looks[names[side]] || INK;
  const title = (side, extra) => `<b><span style="color:${colour(side)}">●</span> ${plain(names[side])}</b>${extra}`;
  ROWS.forEach((row, number) => heading(`${row.title}   ${marks(row.curves)}`, 0, rows[number][1] + 0.002));
  const top = rows[0][1] + 0.03;
  if (over) {
    heading(`${title("left", " solid")}     ${title("right", " dotted")}`, 0, top, 15);
    ["left", "right"].forEach((side, number) =>
      heading(`Connections, ${plain(names[side])}`, 0, rows[ROWS.length + number][1] + 0.002));
  } else {
    heading(title("left", ""), 0, top, 15);
    heading(title("right", ""), 1 - width, top, 15);
    heading("Connections", 0, rows[ROWS.length][1] + 0.002);
  }
  const height = ROW_PX * weights.reduce((sum, weight) => sum + weight, 0) + 90;
  Plotly.react(place, traces_drawn, { ...layout, annotations, shapes, height, font: FONT, hovermode: "x", paper_bgcolor: "#fff",
    plot_bgcolor: "#fff", margin: { l: 10, r: 10, t: 64, b: 10 }, hoverlabel: { font: FONT } }, CONFIG);
}

document.getElementById("loops")?.replaceChildren(...LOOPS.map(([name, colour]) => {
  const entry = document.createElement("span"), patch = document.createElement("i");
  patch.style.background = colour;
  entry.append(patch, name);
  return entry;
}));
