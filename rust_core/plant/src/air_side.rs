//! The air side of a step: what condenses on cooling cores, once a control period, and the balances of the cabins' air.

use crate::architecture::layout::{CABIN_PLACES, CabinLayout, HeaterTarget};
use crate::components::cabin_air::AirConditions;
use crate::components::heat_exchanger::inlet_conductance_w_k;
use crate::components::wet_core::Core;
use crate::controls::{Period, Sight};
use crate::ledger::WaterEntry;
use crate::media::air::SPECIFIC_HEAT_J_KG_K;
use crate::media::moist_air::latent_heat_j_kg;
use crate::network::shape::{Shape, each};
use crate::plant::StepRecord;
use crate::state::State;

/// Temperature at which heat of condensation is taken: between 0 and 20 degC it changes by 1 % only [K].
const CONDENSING_K: f64 = 283.15;

/// Length and mean air speed along the vehicle of a piece of a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    pub step_s: f64,
    pub air_speed_m_s: f64,
}

/// Air at the inlet of the cores [kg/kg].
#[inline(always)]
fn inlet_ratio(sight: Sight<'_>, state: &State, period: &Period, place: usize) -> f64 {
    let recirculation = period.ventilation[place].recirculation;
    (1.0 - recirculation) * sight.disturbance.ambient_humidity_ratio
        + recirculation * state.cabin_air[place].humidity_ratio
}

/// Finds the cooling cores on which water condenses, and takes from their conductance what that costs of sensible heat.
#[inline(always)]
pub(crate) fn wet_cores<S: Shape>(sight: Sight<'_>, state: &State, period: &mut Period) {
    let shape = sight.shape;
    each!(S::cabins(shape) => |place, cabin| {
        if cabin.latent_flow.is_some() {
            let inlet_ratio = inlet_ratio(sight, state, period, place);
            let air_w_k = period.ventilation[place].supply_rate_w_k;
            let core = |dry_w_k: f64, coolant_k: f64| Core {
                air_kg_s: air_w_k / SPECIFIC_HEAT_J_KG_K,
                air_w_k,
                air_ua_w_k: sight.parameters.core_air_ua_w_k[place],
                dry_w_k,
                inlet_k: period.core_inlet_k[place],
                inlet_ratio,
                coolant_k,
                latent_j_kg: latent_heat_j_kg(CONDENSING_K),
            };
            period.wet_cores[place] = match cabin.cooler {
                Some(cooler) => {
                    let supply = shape.loops[usize::from(shape.branches[cooler].circuit)].supply;
                    let coolant_k = state.temperatures_k[supply.index()];
                    let wet = core(period.branches_w_k[cooler], coolant_k).wet();
                    if let Some(wet) = &wet {
                        period.branches_w_k[cooler] *= wet.sensible_share;
                    }
                    wet
                }
                None => refrigerant_k(sight, state, period, place, cabin).and_then(|refrigerant_k| {
                    let ua_w_k = sight.parameters.evaporator_ua_w_k[place];
                    core(inlet_conductance_w_k(air_w_k, ua_w_k), refrigerant_k).wet()
                }),
            };
        }
    });
}

/// Refrigerant in the evaporator of a cabin's supply air, as it was in the last step [K]; none where it is closed or at rest.
#[inline]
fn refrigerant_k(
    sight: Sight<'_>,
    state: &State,
    period: &Period,
    place: usize,
    cabin: &CabinLayout,
) -> Option<f64> {
    let exchanger = &sight.shape.exchangers[cabin.evaporator?];
    let open = exchanger.valve_row.is_none_or(|row| period.demand.0[usize::from(row)] > 0.5);
    let distance_k = state.refrigeration.evaporator_distance_k().filter(|_| open)?;
    Some(period.core_inlet_k[place] - distance_k)
}

/// Supply air behind the cores, the blower and heaters in it [K]: what is blown at the windscreen.
#[inline(always)]
fn supply_k(sight: Sight<'_>, state: &State, period: &Period, place: usize, cabin: &CabinLayout) -> f64 {
    let (shape, air) = (sight.shape, &period.ventilation[place]);
    let inlet_k = period.core_inlet_k[place];
    let mut heat_w = air.blower_power_w;
    for core in [cabin.heater, cabin.cooler].into_iter().flatten() {
        let supply = shape.loops[usize::from(shape.branches[core].circuit)].supply;
        heat_w += period.branches_w_k[core] * (state.temperatures_k[supply.index()] - inlet_k);
    }
    if shape.heaters.iter().any(|heater| heater.target == HeaterTarget::Mass(cabin.air)) {
        heat_w += state.heater_power_w;
    }
    inlet_k + heat_w / air.supply_rate_w_k
}

/// Steps the air of all cabins, enters what condensation brings to their cores; returns what air blown at the windscreens adds to
/// the panels' conductance [W/K].
#[inline(always)]
pub(crate) fn step<S: Shape>(
    sight: Sight<'_>,
    state: &mut State,
    period: &Period,
    moment: Moment,
    record: &mut StepRecord,
) -> [f64; CABIN_PLACES] {
    let disturbance = sight.disturbance;
    let mut extra_w_k = [0.0; CABIN_PLACES];
    record.water_ledger = WaterEntry::default();
    each!(S::cabins(sight.shape) => |place, cabin| {
        let parameters = &sight.parameters.cabins[place];
        let air = &period.ventilation[place];
        let supply_kg_s = air.supply_rate_w_k / SPECIFIC_HEAT_J_KG_K;
        let blown_kg_s = period.demand.0[cabin.windscreen_row] * supply_kg_s;
        let windscreen = parameters.windscreen.conditions(blown_kg_s, moment.air_speed_m_s);
        let cabin_k = state.temperatures_k[cabin.air.index()];
        let blown_k = if windscreen.blown_share > 0.0 {
            supply_k(sight, state, period, place, cabin)
        } else {
            cabin_k
        };
        let now = AirConditions {
            supply_kg_s,
            recirculation: air.recirculation,
            ambient_ratio: disturbance.ambient_humidity_ratio,
            occupants: disturbance.occupants * sight.parameters.occupant_shares[place],
            wet: period.wet_cores[place],
            windscreen_air_k: cabin_k + windscreen.blown_share * (blown_k - cabin_k),
            ambient_k: disturbance.air.temperature_k,
            windscreen,
        };
        let own = &mut state.cabin_air[place];
        let before_kg = parameters.air.water_kg(own);
        let water = parameters.air.step(&parameters.windscreen, own, &now, moment.step_s);
        let entry = WaterEntry::balance(&water, parameters.air.water_kg(own) - before_kg, moment.step_s);
        if place == 0 || entry.relative() > record.water_ledger.relative() {
            record.water_ledger = entry;
        }
        if let Some(latent) = cabin.latent_flow {
            record.flows[latent] = water.core_kg_s * latent_heat_j_kg(CONDENSING_K);
        }
        record.water[place] = water;
        if place == 0 {
            record.supply_air_kg_s = supply_kg_s;
        }
        extra_w_k[place] = windscreen.extra_w_k;
    });
    extra_w_k
}
