// Figures that the drop-downs do not change.
function draw_figure(place, figure) {
  const layout = merged({
    font: FONT, paper_bgcolor: "#fff", plot_bgcolor: "#fff", height: 430,
    margin: { l: 10, r: 10, t: 44, b: 10 },
    title: { x: 0, xref: "paper", font: { size: 15 } },
    legend: { orientation: "h", y: -0.26, yanchor: "top", x: 0, font: { size: 12 } },
    hoverlabel: { font: FONT },
    xaxis: AXIS, yaxis: AXIS,
  }, figure.layout);
  Plotly.newPlot(place, figure.data, layout, CONFIG);
}

const figures = data("figures");
for (const place of document.querySelectorAll("[data-figure]")) draw_figure(place, figures[place.dataset.figure]);
