"""`hp-gym validate`: published values beside the model."""

from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from hp_gym.cli import many_runs
from hp_gym.cli.output import console, fail, print_json


def validate(
    *,
    published: Annotated[str, typer.Option(help="Name or path of a file of published values.")] = "published",
    car: Annotated[
        list[str] | None,
        typer.Option(
            "--car",
            metavar="NAME=VEHICLE",
            help="A vehicle for a car of the file; may be repeated.",
        ),
    ] = None,
    markdown: Annotated[Path | None, typer.Option(help="Write the rows to this .md file.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the rows to this .png, .svg or .pdf file.")] = None,
    threads: many_runs.Threads = None,
    json: Annotated[bool, typer.Option("--json", help="Print the rows as JSON.")] = False,
) -> None:
    """Sets rigs, chamber tests and cars beside published values, by tolerances fixed before the first run."""
    from hp_gym.files import atomic_write, require_suffix
    from hp_gym.studies.published_values import validating, validation_report

    began_s = perf_counter()
    try:
        if plot is not None:
            from hp_gym.pictures import picture_file
            from hp_gym.studies.published_values import validation_plot

            require_suffix(plot, picture_file.SUFFIXES)
        if markdown is not None:
            require_suffix(markdown, (".md",))
        file, judged = validating.validate(published, cars=_cars(car or []), threads=threads)
        if plot is not None:
            validation_plot.plot(judged, plot)
        if markdown is not None:
            with atomic_write(markdown) as temporary:
                temporary.write_text(validation_report.markdown(file, judged), encoding="utf-8")
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json({"rows": [row.to_json() for row in judged]})
        return
    console.print(validation_report.table(judged))
    for line in validation_report.closing_lines(judged):
        console.print(line, markup=False)
    console.print(f"{perf_counter() - began_s:.1f} s")
    for path in (markdown, plot):
        if path is not None:
            console.print(f"Written: {path}", markup=False, soft_wrap=True)


def _cars(texts: list[str]) -> dict[str, str]:
    """Vehicles by car, of `NAME=VEHICLE`.

    Raises:
        ValueError: A text has another form.
    """
    cars = {}
    for text in texts:
        name, sign, vehicle = text.partition("=")
        if not sign or not name or not vehicle:
            message = f"car `{text}` must have the form NAME=VEHICLE"
            raise ValueError(message)
        cars[name] = vehicle
    return cars
