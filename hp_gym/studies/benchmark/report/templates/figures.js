// Figures that the drop-downs do not change.
function draw_figure(place, figure) {
  const layout = merged({
    font: FONT, paper_bgcolor: "#fff", plot_bgcolor: "#fff", height: 400,
    margin: { l: 10, r: 10, t: 44, b: 10 },
    title: { x: 0, xref: "paper", font: { size: 15 } },
    showlegend: false,
    hoverlabel: { font: FONT },
    xaxis: AXIS, yaxis: AXIS,
  }, figure.layout);
  Plotly.newPlot(place, figure.data, layout, CONFIG);
}

// One legend for all figures of a section; a click shows or hides a controller in each of them.
function draw_legend(place) {
  const plots = [...place.closest("section").querySelectorAll("[data-figure]")];
  const groups = new Map();
  for (const trace of plots.flatMap((plot) => plot.data)) {
    const drawn = trace.visible !== "legendonly", known = groups.get(trace.legendgroup);
    const colour = trace.mode === "lines" ? trace.line.color : trace.marker.color;
    groups.set(trace.legendgroup, { colour, line: trace.mode === "lines", drawn: drawn || Boolean(known && known.drawn) });
  }
  for (const [name, { colour, line, drawn }] of groups) {
    const entry = document.createElement("button"), patch = document.createElement("i");
    patch.style.background = colour;
    patch.className = line ? "line" : "";
    entry.type = "button";
    entry.setAttribute("aria-pressed", drawn);
    entry.append(patch, name);
    entry.addEventListener("click", () => {
      const visible = entry.getAttribute("aria-pressed") !== "true";
      entry.setAttribute("aria-pressed", visible);
      for (const plot of plots) {
        const traces = plot.data.flatMap((trace, number) => (trace.legendgroup === name ? [number] : []));
        if (traces.length) Plotly.restyle(plot, { visible }, traces);
      }
    });
    place.append(entry);
  }
}

const figures = data("figures");
for (const place of document.querySelectorAll("[data-figure]")) draw_figure(place, figures[place.dataset.figure]);
for (const place of document.querySelectorAll(".legend")) draw_legend(place);
