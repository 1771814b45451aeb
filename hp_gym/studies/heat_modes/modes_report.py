"""Compared modes as tables."""

from rich.table import Table

from hp_gym.studies.heat_modes.comparing import COMFORT_K, Compared

_HEADINGS = ("Ambient", "Energy", "Discomfort", "Comfortable", "PTC alone")


def best_table(compared: Compared) -> Table:
    """The best mode at each ambient temperature, beside the best without a heat pump."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in _HEADINGS:
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("Best mode at comfort")
    energy_kwh = compared.energy_at_comfort_kwh
    resistive = [number for number, mode in enumerate(compared.modes) if not mode.heat_pump]
    for place, ambient_degc in enumerate(compared.ambients_degc):
        best = compared.ranking(place)[0]
        others = [energy_kwh[number, place] for number in resistive if compared.comfortable[number, place]]
        table.add_row(
            f"{ambient_degc:.1f} °C",
            f"{energy_kwh[best, place]:.3f} kWh",
            f"{compared.discomfort_k[best, place]:.2f} K",
            str(int(compared.comfortable[:, place].sum())),
            f"{min(others):.3f} kWh" if others else "-",
            compared.modes[best].name,
        )
    return table


def overall_table(compared: Compared, most: int) -> Table:
    """Modes that are comfortable most often, with their mean energy beyond the best."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in ("Rank", "Comfortable at", "Beyond the best"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("Mode")
    comfortable, excess_pct = compared.comfortable, compared.excess_pct
    for rank, mode in enumerate(compared.overall()[:most], start=1):
        own = excess_pct[mode][comfortable[mode]]
        share = f"{len(own)} of {len(compared.ambients_degc)}"
        table.add_row(
            str(rank), share, f"{own.mean():+.1f} %" if len(own) else "-", compared.modes[mode].name
        )
    return table


def closing_line(compared: Compared, wall_s: float) -> str:
    """What was driven, and what comfortable means."""
    runs = compared.energy_kwh.size
    return (
        f"{len(compared.modes)} modes x {len(compared.ambients_degc)} ambient temperatures = {runs:,} trips "
        f"in {wall_s:.1f} s; "
        f"comfortable: at most {COMFORT_K:g} K more discomfort than the best at that ambient temperature."
    )
