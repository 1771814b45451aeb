"""The report as one HTML file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import jinja2
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from hp_gym.files import atomic_write
from hp_gym.json_text import plain
from hp_gym.studies.benchmark.report import band_charts, claim_sentences, headline, kpi_rows, layout, traces
from hp_gym.studies.benchmark.report.palette import styles
from hp_gym.studies.benchmark.report.pareto import HIDDEN, pareto

if TYPE_CHECKING:
    import plotly.graph_objects as go

    from hp_gym.studies.benchmark.results import Benchmark

_TEMPLATES: Final = Path(__file__).parent / "templates"
_FAVOURITES: Final = ("hpcu-tuned-strict", "hpcu-tuned", "hpcu-best-mode", "ptc-only")


def write_report(benchmark: Benchmark, path: Path) -> None:
    """Writes a benchmark as one HTML file that opens offline; the same benchmark gives the same bytes.

    Args:
        benchmark: Results; learned controllers, fronts, trajectories and ablations may be missing.
        path: File to write; one that stood there stays as it was if it cannot be written.

    Raises:
        KeyError: The summary or a table lacks what docs/benchmark.md lists.
        OSError: The file cannot be written.
    """
    text = render(benchmark)
    with atomic_write(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def render(benchmark: Benchmark) -> str:
    """Returns the report as text; see `write_report`."""
    facts = layout.Layout(plain(benchmark.summary))
    front_families = benchmark.fronts["family"].unique().tolist()
    looks = styles(
        [*facts.controllers, *(family for family in front_families if family not in facts.controllers)]
    )
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters |= {"json": _json, "band_title": layout.band_title}
    return environment.get_template("report.html").render(
        facts=facts,
        summary=facts.summary,
        data=facts.summary.data,
        layout=layout,
        claims=claim_sentences,
        headline=headline,
        kpis=kpi_rows,
        looks=looks,
        hidden=[name for name in facts.controllers if name in HIDDEN],
        figures={name: _compact(figure) for name, figure in _figures(benchmark, facts, looks).items()},
        traces=traces.pack(benchmark.trajectories) | {"pair": _pair(benchmark), "looks": _colours(looks)},
        style=Markup(_text("report.css")),
        scripts=[Markup(get_plotlyjs()), Markup(_script())],
    )


def _figures(benchmark: Benchmark, facts: layout.Layout, looks: Any) -> dict[str, go.Figure]:
    return {
        "pareto-0": pareto(facts, benchmark.runs, benchmark.fronts, 0.0, looks),
        "pareto-half": pareto(facts, benchmark.runs, benchmark.fronts, 0.5, looks),
        "bands-energy": band_charts.bars(
            facts, "attributable_energy_kwh_per_100_km", "Attributable energy", "kWh/100 km", looks
        ),
        "bands-discomfort": band_charts.bars(facts, "discomfort_k", "Mean discomfort", "K", looks),
        "difference-energy": band_charts.differences(facts, band_charts.ENERGY, looks),
        "difference-discomfort": band_charts.differences(facts, band_charts.DISCOMFORT, looks),
    }


def _compact(figure: go.Figure) -> dict[str, Any]:
    """Data and layout without plotly's default template, which the page's own style replaces."""
    figure.update_layout(template="none")
    made: dict[str, Any] = json.loads(figure.to_json())
    made["layout"].pop("template", None)
    return made


def _pair(benchmark: Benchmark) -> list[str]:
    """Controllers that are shown first: the paper's rules and what was learned, or else the best rules."""
    runs = next(iter(benchmark.trajectories.values()), {})
    learned = [key.rpartition("_vs_")[0] for key in benchmark.summary["gains"]]
    wanted = [name for name in runs if name.replace("-", "_") in learned]
    wanted += [name for name in (*_FAVOURITES, *runs) if name in runs and name not in wanted]
    left = layout.PAPER if layout.PAPER in runs else next(iter(wanted), "")
    return [left, next((name for name in wanted if name != left), left)]


def _colours(looks: Any) -> dict[str, str]:
    return {name: look.colour for name, look in looks.items()}


def _json(data: object) -> Markup:
    """JSON for a script block: nothing in it can end the block."""
    text = json.dumps(plain(data), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _script() -> str:
    return "\n".join(_text(f"{name}.js") for name in ("style", "figures", "pair", "energy", "choice"))


def _text(name: str) -> str:
    return (_TEMPLATES / name).read_text(encoding="utf-8")
