//! Parameters that a step reads, by position in arrays of a fixed length: positions that are known while compiling need no
//! check.

use crate::architecture::layout::{CABIN_PLACES, FRONT_END_PLACES, HEATER_PLACES, LOOP_PLACES, MASS_PLACES};
use crate::components::air_stream::AirStreamParameters;
use crate::components::ambient_exchanger::AmbientExchangerParameters;
use crate::components::cabin::CabinParameters;
use crate::components::heater::HeaterParameters;
use crate::components::pid::ResetGains;
use crate::components::pump::PumpParameters;
use crate::config::vehicle::VehicleParameters;
use crate::surroundings::CONTROL_PERIOD_S;
use std::array::from_fn;

/// Parameters by position; places that a vehicle does not have hold nothing of use.
#[derive(Debug, Clone)]
pub(crate) struct StepParameters {
    /// Pump of each loop.
    pub pumps: [PumpParameters; LOOP_PLACES],
    /// Specific heat of each coolant [J/(kg K)].
    pub specific_heats_j_kg_k: [f64; LOOP_PLACES],
    /// Cabins.
    pub cabins: [CabinParameters; CABIN_PLACES],
    /// Conductance of the air side of the cooling core or evaporator of each cabin [W/K].
    pub core_air_ua_w_k: [f64; CABIN_PLACES],
    /// Conductance of an evaporator in the supply air of each cabin [W/K].
    pub evaporator_ua_w_k: [f64; CABIN_PLACES],
    /// Share of the sun of each cabin [-].
    pub solar_shares: [f64; CABIN_PLACES],
    /// Share of the people of each cabin [-].
    pub occupant_shares: [f64; CABIN_PLACES],
    /// Heaters.
    pub heaters: [HeaterParameters; HEATER_PLACES],
    /// Gains of their controllers.
    pub heater_gains: [ResetGains; HEATER_PLACES],
    /// Front-end exchangers.
    pub front_ends: [AmbientExchangerParameters; FRONT_END_PLACES],
    /// Air of each; the same for those that share it.
    pub air_streams: [AirStreamParameters; FRONT_END_PLACES],
    /// Conductance of each mass to ambient at rest, where nothing else is said [W/K].
    pub masses_w_k: [f64; MASS_PLACES],
}

/// The first entries of a list, in an array.
fn padded<T: Clone + Default, const N: usize>(mut entry: impl FnMut(usize) -> Option<T>) -> [T; N] {
    from_fn(|place| entry(place).unwrap_or_default())
}

fn evaporator_ua_w_k(vehicle: &VehicleParameters, place: usize) -> Option<f64> {
    let evaporator = vehicle.layout.cabins.get(place)?.evaporator?;
    vehicle.exchanger_ua_w_k.get(evaporator).copied()
}

fn core_air_ua_w_k(vehicle: &VehicleParameters, place: usize) -> Option<f64> {
    let cabin = &vehicle.cabins.get(place)?.parameters;
    let cooler = vehicle.layout.cabins.get(place)?.cooler.map(|_| cabin.cooling_core_ua_w_k);
    let ua_w_k = cooler.or_else(|| evaporator_ua_w_k(vehicle, place))?;
    Some(ua_w_k / cabin.air.cooling_core_air_share)
}

impl StepParameters {
    /// Those of a vehicle.
    #[must_use]
    pub fn of(vehicle: &VehicleParameters) -> Self {
        let circuit = |place: usize| vehicle.loops.get(place).map(|parameters| &parameters.circuit);
        let gains = |heater: &HeaterParameters| ResetGains::new(&heater.pid, CONTROL_PERIOD_S);
        // Battery, motor and transmission come before the stores and depend on speed.
        let store = |place: usize| vehicle.stores.get(place.checked_sub(3)?);
        Self {
            pumps: padded(|place| circuit(place).map(|circuit| circuit.pump.clone())),
            specific_heats_j_kg_k: padded(|place| {
                circuit(place).map(|circuit| circuit.coolant_specific_heat_j_kg_k)
            }),
            cabins: padded(|place| vehicle.cabins.get(place).map(|cabin| cabin.parameters.clone())),
            core_air_ua_w_k: padded(|place| core_air_ua_w_k(vehicle, place)),
            evaporator_ua_w_k: padded(|place| evaporator_ua_w_k(vehicle, place)),
            solar_shares: padded(|place| vehicle.cabins.get(place).map(|cabin| cabin.solar_share)),
            occupant_shares: padded(|place| vehicle.cabins.get(place).map(|cabin| cabin.occupant_share)),
            heaters: padded(|place| vehicle.heaters.get(place).cloned()),
            heater_gains: padded(|place| vehicle.heaters.get(place).map(gains)),
            front_ends: padded(|place| vehicle.front_ends.get(place).cloned()),
            air_streams: padded(|place| vehicle.air_streams.get(place).cloned()),
            masses_w_k: padded(|place| store(place).map(|store| store.ambient_conductance_w_k)),
        }
    }
}
