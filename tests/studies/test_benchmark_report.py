import copy
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import hp_gym
from hp_gym import _core, vehicle_layout
from hp_gym.agents.controllers import resolve
from hp_gym.agents.controllers.rule_based import rules
from hp_gym.json_text import plain
from hp_gym.studies.benchmark import benchmark_plan, grid, matched
from hp_gym.studies.benchmark.report import claim_sentences, energy_flows, headline, traces, write_report
from hp_gym.studies.benchmark.report.layout import Layout
from hp_gym.studies.benchmark.report.page import render
from hp_gym.studies.benchmark.report.pareto import hull
from hp_gym.studies.benchmark.report.shown import decimal

NASTY = '<b onmouseover="alert(1)">bold</b></script><script>alert(2)</script> & "co"'
COOLER_HTC = {"controller.htc_set_point_degc": 60.0}
TABLES = {
    "description": "A few trips",
    "scenario": "ours/commute-minus5",
    "cycles": [{"name": "hwfet"}],
    "ambient_temperatures_degc": [-10, 5, 30],
    "shown": ["5-hwfet-dark"],
    "variants": [
        {"name": "dark", "occupants": 1, "state_of_charge_pct": 90.0},
        {"name": "full", "occupants": 4, "state_of_charge_pct": 80.0},
    ],
    "bands": [
        {"name": "-20..0", "low_degc": -20.0, "headline": True},
        {"name": "0..20", "low_degc": 0.0, "headline": True},
        {"name": "above 20", "low_degc": 20.0, "headline": False},
    ],
    "fronts": [{"family": "hpcu", "cabin_offsets_k": [-4, -2, 0], "htc_offsets_k": [0, -20]}],
}


class Page(HTMLParser):
    """What a browser would find: elements, marked figures, texts of table cells, blocks of JSON."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.figures, self.cells, self.blocks = [], [], [], {}
        self._open = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.elements.append((tag, attributes))
        if tag not in {"meta", "link"}:
            self._open.append((tag, attributes))
        if tag == "td":
            self.cells.append((attributes, ""))

    def handle_endtag(self, tag):
        while self._open and self._open.pop()[0] != tag:
            pass

    def handle_data(self, data):
        tag, attributes = self._open[-1] if self._open else ("", {})
        if tag == "data":
            self.figures.append((attributes["data-summary"], attributes["value"], data))
        elif tag == "td":
            self.cells[-1] = (self.cells[-1][0], self.cells[-1][1] + data)
        elif tag == "script" and attributes.get("type") == "application/json":
            self.blocks[attributes["id"]] = self.blocks.get(attributes["id"], "") + data

    def block(self, name):
        return json.loads(self.blocks[name])


def benchmark_of(controllers, folder):
    small = grid.parse("small", copy.deepcopy(TABLES))
    return benchmark_plan.run(
        benchmark_plan.Plan(small, controllers, "hp-gym benchmark --grid small", resamples=40), folder
    )[0]


@pytest.fixture(scope="module")
def benchmark(tmp_path_factory):
    """Real trips: rules, and rules with a cooler HTC in the place of learned controllers."""
    seeds = [
        replace(
            rules("thrifty", "hpcu", COOLER_HTC | {"controller.cabin_set_point_degc": cabin_degc}), seed=seed
        )
        for seed, cabin_degc in enumerate((21.0, 20.0))
    ]
    learned = [replace(each, learned=True) for each in [*seeds, rules(NASTY, "hpcu", COOLER_HTC)]]
    first = [each for name in ("off", "ptc-only", "hpcu", "hpcu-modern") for each in resolve(name)]
    return benchmark_of([*first, *learned], tmp_path_factory.mktemp("benchmark"))


@pytest.fixture(scope="module")
def text(benchmark):
    return render(benchmark)


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


@pytest.fixture(scope="module")
def only_rules(tmp_path_factory):
    return benchmark_of([*resolve("hpcu"), *resolve("hpcu-modern")], tmp_path_factory.mktemp("rules"))


def resolve_pointer(data, pointer):
    for part in pointer.split("/")[1:]:
        key = part.replace("~1", "/").replace("~0", "~")
        data = data[int(key)] if isinstance(data, list) else data[key]
    return data


def as_number(shown):
    return float(shown.replace("\N{NARROW NO-BREAK SPACE}", "").replace("\N{MINUS SIGN}", "-"))


def test_every_figure_in_the_text_is_that_of_the_summary_rounded(page, benchmark):
    summary = json.loads(json.dumps(plain(benchmark.summary)))
    assert page.block("summary") == summary
    assert len(page.figures) > 100
    for pointer, exact, shown in page.figures:
        value = resolve_pointer(summary, pointer)
        assert float(exact) == value, pointer
        decimals = len(shown.partition(".")[2])
        assert abs(as_number(shown) - value) <= 0.5 * 10.0**-decimals + 1e-12, pointer


def test_tables_hold_no_number_that_is_not_from_the_summary(page):
    loose = [words for attributes, words in page.cells if "class" not in attributes]
    assert len(loose) > 50
    assert not [words for words in loose if re.search(r"\d", words)]


def test_points_of_controllers_lie_where_the_summary_says(page, benchmark):
    for credit, name in ((0.0, "pareto-0"), (0.5, "pareto-half")):
        curves = {curve["name"]: curve for curve in page.block("figures")[name]["data"]}
        for controller in ("hpcu", "thrifty", "ptc-only"):
            kpis = benchmark.summary["controllers"][controller]
            net_kwh = kpis["attributable_energy_kwh"] - credit * kpis["heat_left_kwh"]
            assert curves[controller]["x"] == [pytest.approx(kpis["discomfort_k"], abs=1e-4)]
            assert curves[controller]["y"] == [pytest.approx(net_kwh, abs=1e-4)]


def test_points_of_seeds_have_the_controllers_mean_energy(page, benchmark):
    curves = {curve["name"]: curve for curve in page.block("figures")["pareto-0"]["data"]}
    seeds_kwh = curves["thrifty, one seed"]["y"]
    assert len(seeds_kwh) == 2
    expected = benchmark.summary["controllers"]["thrifty"]["attributable_energy_kwh"]
    assert np.mean(seeds_kwh) == pytest.approx(expected, abs=1e-4)


def test_nothing_is_loaded_from_elsewhere(page, text):
    for tag, attributes in page.elements:
        for name in ("src", "href", "srcset", "data", "action", "poster"):
            assert attributes.get(name, "").partition(":")[0] in {"", "data"}, (tag, name)
    for css in re.findall(r"<style>(.*?)</style>", text, re.DOTALL):
        assert "@import" not in css
        assert "url(" not in css
    own_script = text.rpartition("<script>")[2]
    assert "draw_pair" in own_script
    assert not re.search(r"https?:|fetch\(|XMLHttpRequest|import\(", own_script)
    assert text.count("plotly.js v") == 1


def test_the_same_benchmark_gives_the_same_bytes(benchmark, text, tmp_path):
    path = tmp_path / "report.html"
    write_report(copy.deepcopy(benchmark), path)
    assert path.read_bytes() == text.encode()
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_a_report_that_cannot_be_made_leaves_the_earlier_one(benchmark, tmp_path):
    path = tmp_path / "report.html"
    path.write_text("earlier")
    with pytest.raises(KeyError):
        write_report(replace(benchmark, summary={}), path)
    assert path.read_text() == "earlier"


def test_names_of_users_are_text_and_nothing_else(page, text):
    assert NASTY not in text
    assert not [tag for tag, attributes in page.elements if tag == "b" or "onmouseover" in attributes]
    scripts = [attributes for tag, attributes in page.elements if tag == "script"]
    assert len(scripts) == 5
    assert NASTY in page.block("summary")["controllers"]
    assert NASTY in page.block("traces")["scenarios"]["5-hwfet-dark"]
    drawn = [curve["name"] for figure in page.block("figures").values() for curve in figure["data"]]
    assert not [name for name in drawn if "<" in name]


def test_without_learned_controllers_the_headline_says_so(only_rules):
    bare = replace(only_rules, trajectories={}, fronts=only_rules.fronts.iloc[:0])
    for each in (only_rules, bare):
        page = Page(render(each))
        ids = {attributes.get("id") for _, attributes in page.elements}
        assert "gains" not in ids
        assert "ablations" not in ids
        assert ("runs" in ids) == bool(each.trajectories)
    assert "No learned controller took part" in render(bare)


def test_the_page_claims_what_the_headline_claims_and_nothing_else(benchmark):
    told = {
        "best_rule": "careful",
        "learned": "thrifty",
        "learned_vs_best_rule": None,
        "best_rule_vs_hpcu": {"attributable_energy_pct": -7.5, "ci95": [-9.0, -6.0], "passed_pct": 98.0},
        "reasons": {"learned_vs_best_rule": "`thrifty` passes too few trips", "best_rule_vs_hpcu": None},
        "rests_on": {
            "learned_vs_best_rule": None,
            "best_rule_vs_hpcu": {"pairs": 12, "bands_without_pairs": ["-20..0"]},
        },
    }
    learned, rule = claim_sentences.sentences(Layout(benchmark.summary | {"headline": told}))
    assert "no claim</strong>, because thrifty passes too few trips." in learned
    assert "%" not in learned
    assert "/headline/best_rule_vs_hpcu/attributable_energy_pct" in rule
    assert "None of these trips is in -20..0" in rule
    assert learned in render(replace(benchmark, summary=benchmark.summary | {"headline": told}))


def test_ablations_stand_in_a_section_of_their_own(benchmark):
    gain = benchmark.summary["gains"]["thrifty_vs_hpcu"]
    of_ablation = copy.deepcopy(benchmark.summary["controllers"]["thrifty"])
    summary = benchmark.summary | {
        "ablations": {"ablation/no-preview_vs_hpcu": gain},
        "controllers": benchmark.summary["controllers"] | {"ablation/no-preview": of_ablation},
    }
    page = Page(render(replace(benchmark, summary=summary)))
    assert "ablations" in {attributes.get("id") for _, attributes in page.elements}
    places = [pointer for pointer, _, _ in page.figures]
    assert "/ablations/ablation~1no-preview_vs_hpcu/by_credit/0/attributable_energy_pct" in places
    assert not [place for place in places if place.startswith("/controllers/ablation")]


@pytest.mark.parametrize(
    ("intervals", "verdict"),
    [
        ({"0": [-5.0, -1.0], "0.5": [-4.0, -0.5]}, headline.WINS),
        ({"0": [-5.0, -1.0], "0.5": [-4.0, 0.5]}, headline.OPEN),
        ({"0": [-5.0, -1.0], "0.5": [0.5, 4.0]}, headline.OPEN),
        ({"0": [-5.0, None], "0.5": [-4.0, None]}, headline.OPEN),
        ({"0": [1.0, 5.0], "0.5": [0.5, None]}, headline.LOSES),
    ],
)
def test_a_gain_is_claimed_only_where_both_credits_exclude_zero(benchmark, intervals, verdict):
    gain = copy.deepcopy(benchmark.summary["gains"]["thrifty_vs_hpcu"])
    for credit, ci95 in intervals.items():
        gain["by_credit"][credit] |= {"attributable_energy_pct": 1.0, "ci95": ci95}
    facts = Layout(benchmark.summary | {"gains": {"thrifty_vs_hpcu": gain}})
    (comparison,) = facts.comparisons()
    assert headline.verdict(facts, comparison) == verdict
    assert verdict in headline.sentence(facts, comparison)


def test_stranded_trips_are_given_as_the_reason_for_no_gain(benchmark):
    gain = {
        "attributable_energy_pct": None,
        "ci95": None,
        "discomfort_k": None,
        "stranded_trips": {"controller": 3, "rules": 0},
    }
    facts = Layout(benchmark.summary | {"gains": {"thrifty_vs_hpcu": gain}})
    (sentence,) = headline.sentences(facts)
    assert "cannot be compared" in sentence
    assert ">3</data> of its own" in sentence


def energy_of(table, diagram):
    return {(source, target): kwh for source, target, kwh in energy_flows.links(table, diagram)}


CARS = ["jeffs2019", *(name for name in hp_gym.names("vehicle") if name.startswith("jeffs2019-"))]
SCENARIOS = ["jeffs2019/case1-1", "ours/hot-soak-plus35", "ours/ptc-only-minus7"]


@pytest.mark.parametrize(
    ("scenario", "vehicle"),
    [("ours/thermal-battery", "jeffs2019"), *((scenario, car) for scenario in SCENARIOS for car in CARS)],
)
def test_inner_places_of_the_diagrams_give_away_what_they_take_in(scenario, vehicle):
    trajectory = hp_gym.simulate(scenario, vehicle=vehicle)
    table = trajectory.to_pandas()
    layout = vehicle_layout.of_table(table)
    # Stores close by a link of their own, which could hide a forgotten flow; these must close without.
    electricity, heat = energy_flows.electricity(layout), energy_flows.heat(layout)
    for diagram, places in ((electricity, ("High-voltage bus", "Traction")), (heat, ("Refrigerant",))):
        energy = energy_of(table, diagram)
        for place in places:
            left_out = len(diagram.flows) * energy_flows.SMALLEST_KWH
            assert abs(energy_flows.balance(energy, place)) < left_out
        assert min(energy.values()) > 0.0
        assert not places_on_a_circle(energy)
    drawn = sum(kwh for source, _, kwh in energy_flows.links(table, electricity) if source == "Cells")
    assert drawn == pytest.approx(trajectory.summary["battery_chemical_energy_kwh"], abs=0.005)


@pytest.mark.parametrize("vehicle", CARS)
def test_heat_kept_by_coolant_is_what_its_warming_takes(vehicle, monkeypatch):
    monkeypatch.setattr(energy_flows, "SMALLEST_KWH", 0.0)
    table = hp_gym.simulate("jeffs2019/case1-1", vehicle=vehicle).to_pandas()
    layout = vehicle_layout.of_table(table)
    diagram = energy_flows.heat(layout)
    stores = {place: names for place, *names in diagram.stores}
    for loop in layout["loops"]:
        kept, given = stores[vehicle_layout.capitalised(loop["label"])]
        per_k = []
        for until_s in (200, 600, 1000, len(table) - 1):
            part = table.iloc[: until_s + 1]
            energy = energy_of(part, diagram)
            kept_kwh = sum(
                (target == kept) * kwh - (source == given) * kwh for (source, target), kwh in energy.items()
            )
            warmed_k = sum(
                part[loop[side]].iloc[-1] - part[loop[side]].iloc[0] for side in ("supply", "return")
            )
            per_k.append(kept_kwh / warmed_k)
        # Half of the loop's heat capacity, whatever it did meanwhile.
        assert per_k == pytest.approx([per_k[0]] * len(per_k), rel=1e-3)
        assert per_k[0] > 1e3 / energy_flows.JOULE_PER_KWH


def expected_places(layout):
    """Names that the diagrams of a vehicle must be able to show, apart from those of every vehicle."""
    loops = {vehicle_layout.capitalised(loop["label"]) for loop in layout["loops"]}
    heaters = {heater["label"] for heater in layout["heaters"]}
    return loops | heaters | ({"Refrigerant", "Compressor"} if layout["refrigerates"] else set())


@pytest.mark.parametrize("vehicle", CARS)
def test_the_diagrams_show_what_a_vehicle_has_and_nothing_else(vehicle):
    layout = _core.vehicle_layout(vehicle)
    columns = {row["flow"] for row in layout["flows"]}
    flows = [*energy_flows.electricity(layout).flows, *energy_flows.heat(layout).flows]
    drawn = {flow.column for flow in flows}
    assert drawn <= columns
    for part, key in (
        ("branches", "flow"),
        ("exchangers", "flow"),
        ("heaters", "power"),
        ("loops", "pump_power"),
    ):
        assert {each[key] for each in layout[part]} <= drawn
    shown = {place for flow in flows for place in (flow.source, flow.target)}
    assert expected_places(layout) <= shown
    others = set().union(*(expected_places(_core.vehicle_layout(car)) for car in CARS))
    assert not (others - expected_places(layout)) & shown


def test_vehicles_of_one_page_share_timelines_and_say_what_they_lack():
    tables = {
        car: hp_gym.simulate("jeffs2019/case1-1", vehicle=f"jeffs2019{car}").to_pandas()
        for car in ("", "-ptc-only", "-direct")
    }
    packed = traces.pack({"trip": tables})
    assert [label for label, _ in packed["loops"]] == ["HTC", "chiller loop", "radiator loop"]
    runs = packed["scenarios"]["trip"]
    motor = packed["members"].index("motor")
    assert set(runs["-ptc-only"]["connections"][motor]) == {"0", "3"}
    assert set("".join(runs["-direct"]["connections"])) == {traces.NOT_THERE}
    assert "compressor_kw" not in runs["-ptc-only"]
    keys = {key for some in packed["curves"].values() for key, _ in some}
    assert {"htc_supply_degc", "radiator_loop_supply_degc", "compressor_kw", "ptc_kw", "cabin_degc"} <= keys


def places_on_a_circle(energy):
    """Places that lead back to themselves, which the diagram could not draw."""
    targets = {source: {target for start, target in energy if start == source} for source, _ in energy}

    def reachable(start):
        seen, todo = set(), list(targets.get(start, ()))
        while todo:
            place = todo.pop()
            if place not in seen:
                seen.add(place)
                todo += targets.get(place, ())
        return seen

    return {place for place in targets if place in reachable(place)}


def test_heat_kept_by_the_cabin_air_is_what_its_warming_takes():
    table = hp_gym.simulate("jeffs2019/case1-1").to_pandas()
    heat = energy_flows.heat(vehicle_layout.of_table(table))
    kept = {target: kwh for _, target, kwh in energy_flows.links(table, heat)}["Air, warmed"]
    for until_s in (300, 900):
        part = table.iloc[: until_s + 1]
        so_far = {target: kwh for _, target, kwh in energy_flows.links(part, heat)}["Air, warmed"]
        warmed_k = part["cabin_temperature_degc"].iloc[-1] - table["cabin_temperature_degc"].iloc[0]
        all_k = table["cabin_temperature_degc"].iloc[-1] - table["cabin_temperature_degc"].iloc[0]
        assert so_far / kept == pytest.approx(warmed_k / all_k, rel=0.01)


def test_thinned_powers_keep_their_energy(benchmark):
    tables = benchmark.trajectories["5-hwfet-dark"]
    packed = traces.pack({"trip": tables})
    for name, table in tables.items():
        run_drawn = packed["scenarios"]["trip"][name]
        hours = np.diff(run_drawn["time_min"], prepend=0.0) / 60.0
        for power, column in (("compressor_kw", "compressor_power_w"), ("ptc_kw", "ptc_power_w")):
            exact_kwh = table[column].sum() / 3.6e6
            assert np.dot(run_drawn[power], hours) == pytest.approx(exact_kwh, abs=1e-3)
        assert {len(text) for text in run_drawn["connections"]} == {len(run_drawn["time_min"])}
        assert run_drawn["cells_kwh"][-1] == pytest.approx(
            table["battery_chemical_power_w"].sum() / 3.6e6, abs=1e-4
        )


@given(st.lists(st.integers(60, 4000), max_size=200))
def test_more_trajectories_are_thinned_further(lengths_s):
    step_s = traces.thinning(lengths_s)
    assert step_s == traces.STEPS_S[-1] or sum(lengths_s) <= step_s * traces.POINTS


settings_of_rules = st.lists(
    st.tuples(st.integers(0, 100).map(lambda k: k / 10), st.integers(1, 200).map(lambda kwh: kwh / 10)),
    min_size=1,
    max_size=12,
)


@given(settings_of_rules, st.floats(0.0, 1.0))
def test_the_front_drawn_is_the_front_reckoned_with(points, share):
    corners = hull(points)
    assert all(one[0] < other[0] and one[1] > other[1] for one, other in pairwise(corners))
    discomfort_k, energy_kwh = np.array(points).T
    wanted_k = np.array([discomfort_k.min() + share * np.ptp(discomfort_k)])
    reckoned = matched.front_energy_kwh(wanted_k, discomfort_k[None], energy_kwh[None])
    drawn = np.interp(wanted_k, *np.array(corners).T)
    assert drawn == pytest.approx(reckoned, abs=1e-9)


@given(st.floats(-1e7, 1e7), st.integers(0, 3), st.booleans())
def test_numbers_can_be_read_back(value, decimals, signed):
    shown = decimal(value, decimals, signed=signed)
    assert as_number(shown) == pytest.approx(value, abs=0.5 * 10.0**-decimals + 1e-9)
    assert "-" not in shown
    if as_number(shown) == 0.0:
        assert shown == f"{0:.{decimals}f}"
