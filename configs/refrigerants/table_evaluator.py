"""Reference evaluation of the refrigerant tables in NumPy/SciPy; the Rust code follows it."""

from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline


class RefrigerantTable:
    """Properties as functions of saturation temperature [K] and distance from saturation; SI units."""

    def __init__(self, path: Path) -> None:
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        names = lines[0].split(",")
        data = np.array([[float(field) for field in line.split(",")] for line in lines[1:]])
        spline = CubicSpline(data[:, 0], data[:, 1:], bc_type="not-a-knot")
        self._column = {name: k for k, name in enumerate(names[1:])}
        self._spline = spline
        self.lowest_k, self.highest_k = data[0, 0], data[-1, 0]

    def _values(self, temperature_k: np.ndarray, name: str) -> np.ndarray:
        return self._spline(temperature_k)[..., self._column[name]]

    def _polynomial(self, temperature_k: np.ndarray, name: str, powers: range, x: np.ndarray) -> np.ndarray:
        values = self._spline(temperature_k)
        return sum(values[..., self._column[f"{name}_{k}"]] * x**k for k in powers)

    def pressure_pa(self, temperature_k: np.ndarray) -> np.ndarray:
        """Saturation pressure."""
        return self._values(temperature_k, "pressure_pa")

    def suction(self, evaporating_k: np.ndarray, superheat_k: np.ndarray) -> tuple[np.ndarray, ...]:
        """Enthalpy, density and entropy of superheated vapour."""
        return tuple(
            self._polynomial(evaporating_k, f"vapour_{name}", range(4), superheat_k)
            for name in ("enthalpy", "density", "entropy")
        )

    def liquid_enthalpy(self, condensing_k: np.ndarray, subcooling_k: np.ndarray) -> np.ndarray:
        """Enthalpy of subcooled liquid at condensing pressure."""
        return self._polynomial(condensing_k, "liquid_enthalpy", range(6), subcooling_k)

    def isobar_enthalpy(self, condensing_k: np.ndarray, entropy: np.ndarray) -> np.ndarray:
        """Enthalpy at condensing pressure and the given entropy; two-phase below the dew point."""
        sigma = entropy - self._values(condensing_k, "dew_entropy")
        dry = self._polynomial(condensing_k, "isobar_enthalpy", range(2, 5), np.maximum(sigma, 0.0))
        return self._values(condensing_k, "dew_enthalpy") + condensing_k * sigma + dry

    def isobar_temperature_k(self, condensing_k: np.ndarray, enthalpy: np.ndarray) -> np.ndarray:
        """Temperature at condensing pressure and the given enthalpy.

        Saturation below the dew point, linear beyond the range of the polynomial.
        """
        excess = np.maximum(enthalpy - self._values(condensing_k, "dew_enthalpy"), 0.0)
        inside = np.minimum(excess, self._values(condensing_k, "isobar_range"))
        values = self._spline(condensing_k)
        coefficients = [values[..., self._column[f"isobar_temperature_{k}"]] for k in range(1, 8)]
        rise = sum(c * inside**k for k, c in enumerate(coefficients, start=1))
        slope = sum(k * c * inside ** (k - 1) for k, c in enumerate(coefficients, start=1))
        return condensing_k + rise + slope * (excess - inside)
