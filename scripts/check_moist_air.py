"""Oracle of the air side: the figures that Rust tests compare with, printed from CoolProp and PsychroLib.

With CoolProp and PsychroLib: `uv run --with coolprop --with psychrolib scripts/check_moist_air.py`.
"""

import math

import psychrolib
from CoolProp.CoolProp import HAPropsSI, PropsSI

PRESSURE_PA = 101325.0
AIR_J_KG_K = 1006.0
LATENT_J_KG = 2.501e6 - 2370.0 * 10.0


def kelvin(degc: float) -> float:
    """Returns a temperature [degC] in kelvin."""
    return degc + 273.15


def saturated(degc: float) -> float:
    """Returns the humidity ratio of saturated air [kg/kg]."""
    return float(HAPropsSI("W", "T", kelvin(degc), "P", PRESSURE_PA, "R", 1.0))


def print_moist_air() -> None:
    """Prints saturation pressures, humidity ratios, dew points and heat of condensation."""
    for degc in (-40.0, -20.0, -10.0, 0.0, 0.01, 10.0, 20.0, 25.0, 35.0, 50.0, 70.0):
        print(f"saturation {degc} degC: {psychrolib.GetSatVapPres(degc):.9g} Pa")
    for degc, relative in ((20.0, 0.5), (35.0, 0.4), (-5.0, 0.8), (22.0, 0.3)):
        real = HAPropsSI("W", "T", kelvin(degc), "P", PRESSURE_PA, "R", relative)
        dew = HAPropsSI("D", "T", kelvin(degc), "P", PRESSURE_PA, "R", relative) - 273.15
        ideal = psychrolib.GetHumRatioFromRelHum(degc, relative, PRESSURE_PA)
        ideal_dew = psychrolib.GetTDewPointFromRelHum(degc, relative)
        print(f"{degc} degC {relative}: {ideal:.7g} {real:.7g} kg/kg, {ideal_dew:.7g} {dew:.7g} degC")
    for degc in (0.01, 25.0, 50.0):
        vapour, water = (PropsSI("H", "T", kelvin(degc), "Q", quality, "Water") for quality in (1, 0))
        print(f"heat of condensation {degc} degC: {vapour - water:.6g} J/kg")


def wet_core(inlet_degc: float, relative: float, coolant_degc: float) -> tuple[float, float, float]:
    """Bisects the surface of a cooling core: 0.1 kg/s, air side 250/0.7 W/K, 80 W/K while dry.

    Args:
        inlet_degc: Air at the inlet [degC].
        relative: Its relative humidity [-].
        coolant_degc: Coolant at its inlet [degC].

    Returns:
        Surface [degC], sensible and latent heat [W].
    """
    capacity_w_k = 0.1 * AIR_J_KG_K
    contact = 1.0 - math.exp(-250.0 / 0.7 / capacity_w_k)
    air_w_k = contact * capacity_w_k
    coolant_w_k = 1.0 / (1.0 / 80.0 - 1.0 / air_w_k)
    ratio = HAPropsSI("W", "T", kelvin(inlet_degc), "P", PRESSURE_PA, "R", relative)

    def heats_w(surface_degc: float) -> tuple[float, float]:
        latent_w = contact * 0.1 * max(ratio - saturated(surface_degc), 0.0) * LATENT_J_KG
        return air_w_k * (inlet_degc - surface_degc), latent_w

    low, high = coolant_degc, inlet_degc
    for _ in range(60):
        middle = 0.5 * (low + high)
        if sum(heats_w(middle)) > coolant_w_k * (middle - coolant_degc):
            low = middle
        else:
            high = middle
    return (low, *heats_w(low))


def main() -> None:
    """Prints everything."""
    psychrolib.SetUnitSystem(psychrolib.SI)
    print_moist_air()
    for case in ((35.0, 0.4, 3.0), (25.0, 0.5, 3.0), (30.0, 0.9, 5.0)):
        surface_degc, sensible_w, latent_w = wet_core(*case)
        print(
            f"wet core {case}: {surface_degc:.3f} degC, {sensible_w:.1f} W sensible, {latent_w:.1f} W latent"
        )


if __name__ == "__main__":
    main()
