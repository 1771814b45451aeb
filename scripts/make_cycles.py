"""Writes configs/cycles/*.csv from the packages that carry the published speed schedules.

The packages pin old dependencies, and one has wheels for older versions of Python only, but nothing of them
is run; so without dependencies, in a folder of their own:

    uv pip install --no-deps --python-version 3.10 --target out/cycle-packages \
        fastsim==2.1.2 wltp==0.1.2a0 carculator_utils==1.3.5
    PYTHONPATH=out/cycle-packages python scripts/make_cycles.py
"""

import csv
import hashlib
import os
import runpy
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import distribution, version
from pathlib import Path

CYCLES = Path(__file__).resolve().parents[1] / "configs" / "cycles"

KM_H_PER_MPH = 1.609344
KM_H_PER_M_S = 3.6

GTR_2 = "UN Global Technical Regulation No. 2, Annex 5, parts 1, 2 and 3 for class 3"
GTR_15 = "UN Global Technical Regulation No. 15, Annex 1"
WLTC_PHASES = "low, medium, high and extra-high phases of 589, 433, 455 and 323 s"
R83 = "UN Regulation No. 83, type I test: four ECE 15 cycles and one EUDC"
EPA = "US EPA dynamometer schedule, 0.1 mph steps"
ARTEMIS = "Andre 2004, The ARTEMIS European driving cycles, doi:10.1016/j.scitotenv.2004.04.070"

FACTS = "the speeds are facts of the regulation; the package is"


@dataclass(frozen=True)
class Cycle:
    """A speed at every second from 0, and where it comes from."""

    id: str
    title: str
    published_in: str
    package: str
    licence: str
    speed_km_h: Sequence[float]
    decimals: int

    def speed_lines(self) -> list[str]:
        """The speed column as it is written: the regulation's own resolution where it has one."""
        return [f"{speed:.{self.decimals}f}" for speed in self.speed_km_h]

    def csv(self) -> str:
        """The whole file: provenance, column names, one row a second."""
        speeds = self.speed_lines()
        header = [
            f"# {self.title}",
            f"# published in: {self.published_in}",
            f"# taken from: PyPI {self.package} {version(self.package)}, by scripts/make_cycles.py",
            f"# licence: {self.licence}",
            f"# points: {len(speeds)}",
            f"# distance: {trapezoid_km([float(speed) for speed in speeds]):.3f} km",
            f"# sha256 of the speed column, one value a line: {checksum(speeds)}",
            "time_s,speed_km_h",
        ]
        rows = [f"{second},{speed}" for second, speed in enumerate(speeds)]
        return "\n".join(header + rows) + "\n"


def trapezoid_km(speed_km_h: Sequence[float]) -> float:
    """Distance with the speed linear between the whole seconds."""
    return (sum(speed_km_h) - (speed_km_h[0] + speed_km_h[-1]) / 2) / 3600


def checksum(speeds: Sequence[str]) -> str:
    """SHA-256 of the written speeds, each ended by a newline."""
    return hashlib.sha256("".join(f"{speed}\n" for speed in speeds).encode()).hexdigest()


def packaged_file(package: str, path: str) -> Path:
    """A file of an installed package, found without importing the package and its dependencies."""
    return Path(str(distribution(package).locate_file(path)))


def wltc(vehicle_class: str, file: str, function: str) -> Cycle:
    """A WLTC: class 3b for cars above 34 W/kg that reach 120 km/h, class 2 for those of 22 to 34 W/kg."""
    data = runpy.run_path(str(packaged_file("wltp", f"wltp/cycles/{file}.py")))[function]()
    return Cycle(
        id=f"wltc-class{vehicle_class}",
        title=f"WLTC class {vehicle_class}: {WLTC_PHASES}",
        published_in=f"{GTR_15}, class {vehicle_class}",
        package="wltp",
        licence=f"{FACTS} EUPL 1.1+",
        speed_km_h=data["cycle"],
        decimals=1,
    )


def nedc() -> Cycle:
    """The NEDC with the regulation's gear-change plateaus of a manual gearbox.

    The package lists the ends of seconds 1 to 1180; standstill at 0 s comes first, so that the cycle's
    operations begin at the regulation's times (first start at 11 s, EUDC at 780 s).
    """
    data = runpy.run_path(str(packaged_file("wltp", "wltp/cycles/nedc.py")))["cycle_data"]()
    return Cycle(
        id="nedc",
        title="NEDC: urban part of 780 s, extra-urban part of 400 s",
        published_in=R83,
        package="wltp",
        licence=f"{FACTS} EUPL 1.1+",
        speed_km_h=[0.0, *data["cycle"]],
        decimals=3,
    )


def epa(cycle_id: str, title: str) -> Cycle:
    """A US schedule: back to its tenths of mph, which fastsim holds as rounded m/s, then to km/h."""
    speed_mph = [round(speed * KM_H_PER_M_S / KM_H_PER_MPH, 1) for speed in fastsim_m_s(cycle_id)]
    return Cycle(
        id=cycle_id,
        title=title,
        published_in=EPA,
        package="fastsim",
        licence="public domain (US government); the package is Apache-2.0",
        speed_km_h=[speed * KM_H_PER_MPH for speed in speed_mph],
        decimals=3,
    )


def wmtc(cycle_id: str, title: str, speed_m_s: Sequence[float]) -> Cycle:
    """A cycle of large motorcycles, up to 125 km/h."""
    return Cycle(
        id=cycle_id,
        title=title,
        published_in=GTR_2,
        package="fastsim",
        licence=f"{FACTS} Apache-2.0",
        speed_km_h=[speed * KM_H_PER_M_S for speed in speed_m_s],
        decimals=1,
    )


def fastsim_m_s(name: str) -> list[float]:
    """Speeds of a cycle that fastsim carries."""
    with packaged_file("fastsim", f"fastsim/resources/cycles/{name}.csv").open(encoding="utf-8-sig") as file:
        return [float(row["cycMps"]) for row in csv.DictReader(file)]


def artemis(cycle_id: str, title: str, column: str) -> Cycle:
    """A Common Artemis Driving Cycle."""
    table = packaged_file("carculator_utils", "carculator_utils/data/driving_cycles/car.csv")
    with table.open(encoding="utf-8-sig", newline="") as file:
        cells = [row[column] for row in csv.DictReader(file, delimiter=";")]
    return Cycle(
        id=cycle_id,
        title=title,
        published_in=ARTEMIS,
        package="carculator_utils",
        licence="the speeds are published facts; the package is BSD-3-Clause",
        speed_km_h=[float(cell) for cell in cells if cell],
        decimals=1,
    )


def write(cycle: Cycle) -> Path:
    """Writes beside the target and renames, so that a reader never sees half a file."""
    target = CYCLES / f"{cycle.id}.csv"
    temporary = target.with_suffix(f".{os.getpid()}.tmp")
    try:
        temporary.write_text(cycle.csv(), encoding="utf-8", newline="\n")
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
    return target


def main() -> None:
    """Writes all cycles."""
    CYCLES.mkdir(parents=True, exist_ok=True)
    motorway = fastsim_m_s("wmtc_part3")
    for cycle in (
        wltc("3b", "class3", "class_data_b"),
        wltc("2", "class2", "class_data"),
        nedc(),
        epa("udds", "UDDS: urban dynamometer driving schedule"),
        epa("hwfet", "HWFET: highway fuel economy test"),
        epa("us06", "US06: hard driving, mostly on a motorway"),
        wmtc("wmtc-class3", "WMTC class 3: parts 1, 2 and 3 of 600 s each", fastsim_m_s("wmtc_all")),
        # Motorway alone, as long as a drive to work; such cycles for cars are held out.
        wmtc("wmtc-part3-twice", "WMTC part 3-2, motorway, driven twice", motorway + motorway[1:]),
        artemis("artemis-urban", "Artemis urban cycle", "CADC Urban"),
        artemis("artemis-road", "Artemis rural road cycle", "CADC Road"),
        artemis("artemis-motorway-130", "Artemis motorway cycle, 130 km/h version", "CADC Motorway 130"),
        artemis("artemis-motorway-150", "Artemis motorway cycle, 150 km/h version", "CADC Motorway"),
    ):
        print(write(cycle))


if __name__ == "__main__":
    main()
