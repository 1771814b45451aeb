"""Ambient bands, and training trips in each."""

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import tomlkit


@dataclass(frozen=True)
class Band:
    """A range of ambient temperatures.

    Attributes:
        low_degc: Coldest [degC].
        high_degc: Hottest [degC], belongs to the band.
    """

    low_degc: float
    high_degc: float

    @property
    def title(self) -> str:
        """Name for people."""
        return f"{self.low_degc:g} to {self.high_degc:g} °C"


BANDS: Final = (Band(-20, -10), Band(-10, 0), Band(0, 10), Band(10, 20), Band(20, 40))
"""All of the training distribution, cut where the benchmark cuts; an edge belongs to the colder band here."""


@contextmanager
def training_distribution(band: Band) -> Generator[Path]:
    """Gives a file with the trips of `train-v2` in a band."""
    document = tomlkit.document()
    document["base"] = "train-v2"
    document["description"] = f"Training trips, {band.title}"
    document["ranges"] = {
        "ambient_low_degc": float(band.low_degc),
        "ambient_high_degc": float(band.high_degc),
    }
    with TemporaryDirectory() as folder:
        path = Path(folder) / "band.toml"
        path.write_text(tomlkit.dumps(document), encoding="utf-8")
        yield path
