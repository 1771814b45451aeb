"""`hp-gym run`: one scenario from start to arrival."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from hp_gym.cli.output import console, fail, print_json

if TYPE_CHECKING:
    from rich.table import Table

    from hp_gym import Trajectory

# What the table shows of the totals, where the vehicle has them; `--json` has all of them.
GROUPS: Final = {
    "Trip": ("duration_s", "delay_s", "distance_km", "energy_kwh", "energy_kwh_per_100_km"),
    "Battery": ("final_soc_pct", "final_charge_soc_pct", "mean_voltage_v", "battery_loss_energy_kwh"),
    "Comfort": ("time_to_comfort_s", "comfortable_share", "discomfort_k"),
    "Electrical energy": (
        "traction_energy_kwh",
        "compressor_energy_kwh",
        "ptc_energy_kwh",
        "low_voltage_energy_kwh",
        "blower_energy_kwh",
        "fan_energy_kwh",
        "htc_pump_energy_kwh",
        "chiller_pump_energy_kwh",
        "unserved_energy_kwh",
    ),
    "Heat pump": (
        "condenser_energy_kwh",
        "evaporator_energy_kwh",
        "heat_pump_cop",
        "compressor_starts",
        "protection_trips",
        "loads_shed_s",
    ),
    "Limits": (
        "highest_pressure_bar",
        "highest_htc_supply_degc",
        "lowest_chiller_supply_degc",
        "limit_breaches",
        "worst_relative_residual",
    ),
}


def run(
    scenario: Annotated[str, typer.Argument(help="Name (see `hp-gym scenarios`) or path of a scenario.")],
    *,
    controller: Annotated[
        str | None, typer.Option(help="Name or path of a controller; the scenario's own by default.")
    ] = None,
    vehicle: Annotated[
        str | None, typer.Option(help="Name or path of a vehicle; the scenario's own by default.")
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change a value, for example scenario.climate.ambient_temperature_degc=-7. "
            "A key begins with scenario., vehicle. or controller.; may be repeated.",
        ),
    ] = None,
    overrides: Annotated[
        Path | None, typer.Option(help="A .toml file of changes, as `calibrate` and `optimise` write.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Write all signals, second by second, to this .csv or .parquet file.")
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the run to this .png, .svg or .pdf file.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the totals as JSON.")] = False,
) -> None:
    """Runs a scenario and shows its totals."""
    from hp_gym import simulate
    from hp_gym.overrides import assignments

    try:
        changes = [*assignments(overrides), *(changes or [])]
        trajectory = simulate(scenario, controller, changes, vehicle=vehicle)
        if out is not None:
            trajectory.save(out)
        if plot is not None:
            _plot(trajectory, plot)
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json(
            {
                "scenario": trajectory.scenario,
                "controller": trajectory.controller,
                "vehicle": vehicle,
                "overrides": changes,
                "end_reason": trajectory.end_reason,
                "limits": trajectory.limits,
                "summary": trajectory.summary,
            }
        )
        return
    console.print(_table(trajectory, vehicle))
    for path in (out, plot):
        if path is not None:
            console.print(f"Written: {path}", markup=False, soft_wrap=True)


def _plot(trajectory: "Trajectory", path: Path) -> None:
    from hp_gym.pictures import plotting
    from hp_gym.terminal import progress_console

    with progress_console.status("Drawing"):
        plotting.plot(trajectory, path)


def _table(trajectory: "Trajectory", vehicle: str | None) -> "Table":
    from rich.table import Table
    from rich.text import Text

    from hp_gym.cli.units import label, quantity

    end = trajectory.end_reason.replace("_", " ")
    driven = trajectory.scenario if vehicle is None else f"{trajectory.scenario}, {vehicle}"
    title = Text(f"{driven} with {trajectory.controller}: {end}", style="bold")
    table = Table(box=None, show_header=False, pad_edge=False, title=title, title_justify="left")
    table.add_column(no_wrap=True)
    table.add_column(justify="right", no_wrap=True)
    table.add_column(no_wrap=True, style="dim")
    for group, names in GROUPS.items():
        present = [name for name in names if name in trajectory.summary]
        if not present:
            continue
        table.add_row()
        table.add_row(Text(group, style="bold cyan"))
        for name in present:
            value, unit = quantity(name, trajectory.summary[name])
            table.add_row(f"  {label(name)}", value, unit)
    return table
