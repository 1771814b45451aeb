"""`hp-gym vehicle`: every value of a car, and what it rests on."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from hp_gym.cli.output import console, fail, print_json

if TYPE_CHECKING:
    from rich.table import Table

    from hp_gym.vehicle_values import VehicleSheet, VehicleValue

_NOT_STATED = "not stated"


def vehicle(
    name: Annotated[str, typer.Argument(help="Name of a vehicle, or the path of its file.")],
    *,
    json: Annotated[bool, typer.Option("--json", help="Print the values as JSON.")] = False,
) -> None:
    """Prints every value of a vehicle with its unit, what it rests on, and the file it comes from."""
    from hp_gym import ConfigurationError
    from hp_gym.messages import FileError
    from hp_gym.vehicle_values import sheet

    try:
        found = sheet(name)
    except (ConfigurationError, FileError, OSError) as error:
        fail(error)
    if json:
        print_json(_as_json(found))
    else:
        _print(found)


def _as_json(sheet: "VehicleSheet") -> dict[str, Any]:
    """The shape of `--json`, which docs/vehicles.md tells."""
    return {
        "vehicle": sheet.name,
        "description": sheet.description,
        "architecture": sheet.architecture,
        "files": list(sheet.files),
        "pack_energy_kwh": sheet.pack_energy_kwh,
        "values": [_row(value) for value in sheet.values],
    }


def _row(value: "VehicleValue") -> dict[str, Any]:
    said = value.provenance
    return {
        "key": value.key,
        "value": value.value,
        "unit": value.unit,
        "status": said.status if said else None,
        "source": said.source if said else None,
        "range": None if said is None or said.low is None else [said.low, said.high],
        "range_of_factors": said is not None and said.factors,
        "file": value.file,
    }


def _print(sheet: "VehicleSheet") -> None:
    from collections import Counter

    from rich.markup import escape

    counts = Counter(value.provenance.status if value.provenance else _NOT_STATED for value in sheet.values)
    told = ", ".join(f"{number} {status}" for status, number in sorted(counts.items()))
    console.print(f"{escape(sheet.name)}: {escape(sheet.description)}")
    console.print(f"Architecture {escape(sheet.architecture)}; files: {escape(', '.join(sheet.files))}")
    console.print(f"Pack: {sheet.pack_energy_kwh:.1f} kWh, charge times open-circuit voltage at 25 °C")
    console.print(f"{len(sheet.values)} values: {told}\n")
    console.print(_table(sheet))


def _table(sheet: "VehicleSheet") -> "Table":
    """A row for each value, under the name of its section."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=None, header_style="bold", pad_edge=False)
    for column in ("Key", "Value", "Unit", "Status", "Range", "Source or reason", "File"):
        table.add_column(column, overflow="fold", justify="right" if column == "Value" else "left")
    last = ""
    for value in sheet.values:
        section, _, leaf = value.key.rpartition(".")
        if section != last:
            table.add_row(f"[cyan]{escape(section)}[/cyan]")
        last, said = section, value.provenance
        status, source = (said.status, said.source) if said else (_NOT_STATED, "")
        cells = (leaf, _short(value.value), value.unit, status, _range(value), source, value.file)
        table.add_row(*(escape(cell) for cell in cells))
    return table


def _short(value: Any) -> str:
    """A value in few characters: a long list as its size and its ends."""
    from hp_gym.provenance import numbers

    if not isinstance(value, list):
        return f"{value:g}" if isinstance(value, float) else str(value)
    if len(found := list(numbers(value))) <= 2:
        return ", ".join(f"{number:g}" for number in found)
    rows = f"{len(value)} x {len(value[0])}" if isinstance(value[0], list) else str(len(value))
    return f"{rows} values, {min(found):g}..{max(found):g}"


def _range(value: "VehicleValue") -> str:
    said = value.provenance
    if said is None or said.low is None or said.high is None:
        return ""
    return f"{'times ' if said.factors else ''}{said.low:g}..{said.high:g}"
