"""Spin loss of a single-speed reducer from its parts, against the law of the plant.

    python scripts/check_gearbox_losses.py [VEHICLE]      # a vehicle's file with its own [transmission]

Bearings: load-independent moment of Palmgren, 1e-7 f0 (nu n)^(2/3) d^3 N mm. Seals: ISO/TR 14179-2.
Churning of the final gear in the sump: Changenet and Velex 2007, low Froude numbers. Viscosity: ASTM D341
through two points. The reducer's dimensions are those of a usual car's, assumed: ratios 9 and 3.1, a wheel
of 0.33 m, six bearings, three seals.
"""

import math
import sys
import tomllib
from pathlib import Path

SPEED_KM_H = 60.0
WHEEL_RADIUS_M = 0.33
OIL_DENSITY_KG_M3 = 830.0
# Speed over that of the wheels, mean diameter [mm], f0 and number of the bearings.
BEARINGS = ((9.0, 53.5, 2.0, 2), (3.1, 58.0, 2.0, 2), (1.0, 85.0, 3.0, 2))
# Speed over that of the wheels, shaft diameter [mm] and number of the seals.
SEALS = ((9.0, 35.0, 1), (1.0, 45.0, 2))
# Final gear: radius, immersion, width [m]; oil [m3].
GEAR_M = (0.105, 0.040, 0.035)
OIL_M3 = 0.0012
# Kinematic viscosity at 40 and 100 degC [mm2/s]: fluid for electric drives, thin one, Dexron VI.
FLUIDS = {"24 / 5.2": (24.0, 5.2), "18 / 4.3": (18.0, 4.3), "29.5 / 6.0": (29.5, 6.0)}
TEMPERATURES_DEGC = (-20.0, -10.0, 0.0, 20.0, 40.0, 60.0, 80.0)


def viscosity_mm2_s(fluid: tuple[float, float], degc: float) -> float:
    """ASTM D341: the double logarithm is linear in the logarithm of the temperature."""
    ends = [math.log10(math.log10(value + 0.7)) for value in fluid]
    logarithms = [math.log10(temperature + 273.15) for temperature in (40.0, 100.0, degc)]
    slope = (ends[1] - ends[0]) / (logarithms[1] - logarithms[0])
    return float(10.0 ** (10.0 ** (ends[0] + slope * (logarithms[2] - logarithms[0]))) - 0.7)


def bearing_loss_w(viscosity: float, wheel_rpm: float) -> float:
    """Of all bearings."""
    loss_w = 0.0
    for ratio, diameter_mm, factor, count in BEARINGS:
        rpm = ratio * wheel_rpm
        moment_n_mm = 1e-7 * factor * max(viscosity * rpm, 2000.0) ** (2.0 / 3.0) * diameter_mm**3
        loss_w += count * moment_n_mm / 1000.0 * rpm * math.pi / 30.0
    return loss_w


def seal_loss_w(viscosity_at_40_degc: float, degc: float, wheel_rpm: float) -> float:
    """Of all seals; the law is held at its values for 0 and 100 degC."""
    at_40 = 350.0 * math.log10(math.log10(viscosity_at_40_degc + 0.8))
    factor = 145.0 - 1.6 * min(max(degc, 0.0), 100.0) + at_40
    return sum(count * factor * 1e-7 * diameter**2 * ratio * wheel_rpm for ratio, diameter, count in SEALS)


def churning_loss_w(viscosity: float, wheel_rpm: float) -> float:
    """Of the final gear."""
    radius_m, immersion_m, width_m = GEAR_M
    speed = wheel_rpm * math.pi / 30.0
    angle = math.acos(1.0 - immersion_m / radius_m)
    wetted_m2 = (
        2.0 * radius_m**2 * (angle - math.sin(angle) * math.cos(angle)) + 2.0 * width_m * radius_m * angle
    )
    reynolds = speed * radius_m**2 / (viscosity * 1e-6)
    froude = speed**2 * radius_m / 9.81
    diameter_m = 2.0 * radius_m
    moment = 1.366 * (immersion_m / diameter_m) ** 0.45 * (OIL_M3 / diameter_m**3) ** 0.1
    moment *= froude**-0.6 * reynolds**-0.21
    loss_w: float = 0.5 * OIL_DENSITY_KG_M3 * speed**3 * radius_m**3 * wetted_m2 * moment
    return loss_w


def force_n(fluid: tuple[float, float], degc: float) -> float:
    """All parts, as a force at the wheels."""
    speed_m_s = SPEED_KM_H / 3.6
    rpm = speed_m_s / WHEEL_RADIUS_M * 30.0 / math.pi
    viscosity = viscosity_mm2_s(fluid, degc)
    parts_w = (
        bearing_loss_w(viscosity, rpm) + seal_loss_w(fluid[0], degc, rpm) + churning_loss_w(viscosity, rpm)
    )
    return parts_w / speed_m_s


def main() -> None:
    """Prints forces at the wheels."""
    print("degC   " + "".join(f"{name:>12s}" for name in FLUIDS) + "         law  [N at the wheels]")
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else None
    law = tomllib.loads(file.read_text())["transmission"] if file else None
    for degc in TEMPERATURES_DEGC:
        row = f"{degc:5.0f}  " + "".join(f"{force_n(fluid, degc):12.1f}" for fluid in FLUIDS.values())
        if law:
            above = degc - law.get("spin_loss_reference_degc", 40.0)
            row += f"{law['spin_loss_force_n'] * math.exp(-above / law['viscosity_temperature_k']):12.1f}"
        print(row)


if __name__ == "__main__":
    main()
