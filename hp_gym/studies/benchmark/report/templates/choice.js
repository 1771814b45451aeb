// Which pair is shown: the drop-downs and the address say the same, #scenario=...&left=...&right=...&view=...
const traces = data("traces");
const chosen = (id) => document.getElementById(id).value;

function fill(id, options, wanted) {
  const select = document.getElementById(id);
  select.replaceChildren(...options.map((name) => new Option(name, name)));
  select.value = options.includes(wanted) ? wanted : options[0];
}

function read_address() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const scenarios = Object.keys(traces.scenarios);
  fill("scenario", scenarios, asked.get("scenario"));
  const controllers = Object.keys(traces.scenarios[chosen("scenario")]);
  const side = (name, usual) => fill(name, controllers, controllers.includes(asked.get(name)) ? asked.get(name) : usual);
  side("left", traces.pair[0]);
  side("right", traces.pair[1]);
  document.getElementById("view").value = asked.get("view") === "over" ? "over" : "side";
}

function show() {
  const section = document.getElementById("runs"), scenario = chosen("scenario");
  const names = { left: chosen("left"), right: chosen("right") };
  const runs = Object.fromEntries(Object.entries(names).map(([side, name]) => [side, traces.scenarios[scenario][name]]));
  const narrow = section.clientWidth < NARROW_PX;
  draw_pair("plot-pair", traces, runs, names, narrow || chosen("view") === "over", narrow);
  for (const side of ["left", "right"]) {
    draw_energy(`plot-electricity-${side}`, runs[side].electricity, `Electricity: ${plain(names[side])}`, 330);
    draw_energy(`plot-heat-${side}`, runs[side].heat, `Heat: ${plain(names[side])}`, 420);
  }
  Object.assign(section.dataset, { scenario, left: names.left, right: names.right, narrow });
}

function choose() {
  const choice = ["scenario", "left", "right", "view"].map((id) => [id, chosen(id)]);
  history.replaceState(null, "", `#${new URLSearchParams(choice)}`);
  read_address();
  show();
}

if (document.getElementById("runs")) {
  read_address();
  show();
  for (const id of ["scenario", "left", "right", "view"]) document.getElementById(id).addEventListener("change", choose);
  // An address with #runs or another section is left to the browser.
  addEventListener("hashchange", () => { if (location.hash.includes("=")) { read_address(); show(); } });
  addEventListener("resize", () => {
    const narrow = document.getElementById("runs").clientWidth < NARROW_PX;
    if (String(narrow) !== document.getElementById("runs").dataset.narrow) show();
  });
}
