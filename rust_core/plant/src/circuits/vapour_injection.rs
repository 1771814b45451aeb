//! Vapour injection: a second stream of gas enters the compressor at an intermediate pressure.
//!
//! Liquid from the condenser is cooled before it goes to the evaporator, and what cools it evaporates at the intermediate
//! pressure and is injected: in an economiser (a heat exchanger; whether its line branches off before or behind it makes no
//! difference to the balance) or in a flash tank. The machine compresses in two stages, which without injection would be
//! together what it is at its whole pressure ratio; between them the injected gas mixes with that of the first stage.

use crate::components::compressor::soft_floor;
use crate::components::refrigerant_exchanger::approach_limited_k;
use crate::media::refrigerant::{CondensingIsobar, LiquidUnderPressure, RefrigerantTable, SuctionState};
use crate::numerics::dual::Real;
use crate::parameters;

/// Isentropic work of a stage below which it is continued smoothly [J/kg].
const STAGE_WORK_KNEE_J_KG: f64 = 250.0;
/// Distance between liquid and injected gas below which injection fades [K].
const TEMPERATURE_KNEE_K: f64 = 0.5;
/// Enthalpy that a flash tank takes out of the liquid, below which injection fades [J/kg].
const FLASH_KNEE_J_KG: f64 = 300.0;
/// Enthalpy that injected liquid takes up, below which nothing physical lies [J/kg].
const EVAPORATION_KNEE_J_KG: f64 = 2000.0;

/// Each leaves about a twentieth of the error of the stages' efficiency, which begins at half a per cent.
const STAGE_ITERATIONS: usize = 2;

parameters! {
    /// Vapour injection into the compressor: from an economiser, or from a flash tank where there is none.
    pub struct InjectionParameters {
        /// Place of the intermediate pressure between suction (0) and condensing (1) on a logarithmic scale [-]; 0.5 is the
        /// geometric mean.
        pressure_position: f64 = 0.2 .. 0.8,
        ;
        /// Heat exchanger between the liquid and the injection line.
        economiser: Option<EconomiserParameters>,
    }
}

parameters! {
    /// Heat exchanger between the liquid from the condenser and the injection line.
    pub struct EconomiserParameters {
        /// Cooling of the liquid over its distance from the intermediate saturation temperature [-].
        effectiveness: f64 = 0.0 .. 0.98,
        /// Superheat of the injected gas where the liquid allows it [K].
        superheat_k: f64 = 0.0 .. 10.0,
    }
}

/// Injection ready to be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct VapourInjection {
    parameters: InjectionParameters,
    liquid: LiquidUnderPressure,
    entropy_range_j_kg_k: f64,
}

/// The sides of the cycle that injection lies between.
pub(super) struct Between<'a, T> {
    pub table: &'a RefrigerantTable,
    pub evaporating_k: T,
    pub suction: &'a SuctionState<T>,
    pub isobar: &'a CondensingIsobar<T>,
    pub subcooling_k: T,
    pub liquid_enthalpy_j_kg: T,
    pub isentropic_efficiency: T,
}

/// What a compressor with injection does.
pub(super) struct Injected<T> {
    /// Injected flow per suction flow [-].
    pub share: T,
    /// Enthalpy of the liquid at the evaporator's valve [J/kg].
    pub evaporator_inlet_j_kg: T,
    /// Work of both stages per suction flow [J/kg].
    pub work_j_kg: T,
    /// Enthalpy at the outlet [J/kg].
    pub discharge_enthalpy_j_kg: T,
}

/// Efficiency of each of two stages that are together one of `whole`; `stages_j_kg` is the isentropic work of both were the first
/// as efficient as the whole.
fn stage_efficiency<T: Real>(whole: T, whole_j_kg: T, stages_j_kg: T) -> T {
    // What the second stage takes more is proportional to the losses of the first.
    let more = stages_j_kg / whole_j_kg - 1.0;
    let loss = whole.recip() - 1.0;
    let mut efficiency = whole * (more + 1.0);
    for _ in 0..STAGE_ITERATIONS {
        efficiency = whole * (more * ((efficiency.recip() - 1.0) / loss) + 1.0);
    }
    efficiency
}

impl VapourInjection {
    pub fn new(parameters: InjectionParameters, table: &RefrigerantTable) -> Self {
        Self {
            parameters,
            liquid: table.liquid_under_pressure(),
            entropy_range_j_kg_k: table.entropy_range_j_kg_k(),
        }
    }

    /// Compression in two stages with injection between them.
    ///
    /// Kept out of line: vehicles without injection pay for a branch only.
    #[cold]
    #[inline(never)]
    pub fn compress<T: Real>(&self, between: &Between<'_, T>) -> Injected<T> {
        let Between { table, suction, isobar, liquid_enthalpy_j_kg, isentropic_efficiency, .. } = *between;
        let position = self.parameters.pressure_position;
        let ratio = (isobar.pressure_pa / suction.pressure_pa).ln();
        let pressure_pa = suction.pressure_pa * (ratio * position).exp();
        let (low_k, high_k) = (between.evaporating_k.value(), isobar.temperature_k.value());
        let guess_k = 1.0 / ((1.0 - position) / low_k + position / high_k);
        let middle_k = table.saturation_near_k(pressure_pa, guess_k);
        let middle = table.condensing_isobar(middle_k.alone()).of(middle_k);
        let (cooling_j_kg, gas_j_kg) = self.cooled(between, middle_k, &middle);

        let evaporation_j_kg = soft_floor(gas_j_kg - liquid_enthalpy_j_kg, EVAPORATION_KNEE_J_KG);
        let share = cooling_j_kg / evaporation_j_kg;
        let isentropic = |from_j_kg: T, to_j_kg: T| soft_floor(to_j_kg - from_j_kg, STAGE_WORK_KNEE_J_KG);
        let range = self.entropy_range_j_kg_k;
        let second = |from_j_kg: T| {
            let entropy = middle.entropy_at_enthalpy_j_kg_k(from_j_kg, range);
            isentropic(from_j_kg, isobar.enthalpy_at_any_entropy_j_kg(entropy, range))
        };
        let first_j_kg =
            isentropic(suction.enthalpy_j_kg, middle.enthalpy_at_entropy_j_kg(suction.entropy_j_kg_k));
        // The losses of the first stage heat the gas of the second. The machine's efficiency has that in it, so each stage's is
        // larger by as much as makes both together, without injection, the machine that it is.
        let whole_j_kg = soft_floor(
            isobar.enthalpy_at_entropy_j_kg(suction.entropy_j_kg_k) - suction.enthalpy_j_kg,
            2.0 * STAGE_WORK_KNEE_J_KG,
        );
        let unmixed_j_kg = second(suction.enthalpy_j_kg + first_j_kg / isentropic_efficiency);
        let efficiency = stage_efficiency(isentropic_efficiency, whole_j_kg, first_j_kg + unmixed_j_kg);

        let first_j_kg = first_j_kg / efficiency;
        let mixed_j_kg = (suction.enthalpy_j_kg + first_j_kg + share * gas_j_kg) / (share + 1.0);
        let second_j_kg = second(mixed_j_kg) / efficiency;
        Injected {
            share,
            evaporator_inlet_j_kg: liquid_enthalpy_j_kg - cooling_j_kg,
            work_j_kg: first_j_kg + (share + 1.0) * second_j_kg,
            discharge_enthalpy_j_kg: mixed_j_kg + second_j_kg,
        }
    }

    /// Enthalpy that leaves each kilogram of liquid on its way to the evaporator, and that of the injected gas [J/kg].
    fn cooled<T: Real>(&self, between: &Between<'_, T>, middle_k: T, middle: &CondensingIsobar<T>) -> (T, T) {
        let Some(economiser) = &self.parameters.economiser else {
            let above = between.liquid_enthalpy_j_kg - middle.liquid_enthalpy_j_kg(T::constant(0.0));
            return (soft_floor(above, FLASH_KNEE_J_KG), middle.dew_enthalpy_j_kg);
        };
        let liquid_k = between.isobar.temperature_k - between.subcooling_k;
        let distance_k = soft_floor(liquid_k - middle_k, TEMPERATURE_KNEE_K);
        let superheat_k = approach_limited_k(economiser.superheat_k, distance_k);
        let enthalpy = |temperature_k: T| {
            between.table.liquid_at_pressure_j_kg(&self.liquid, temperature_k, between.isobar.pressure_pa)
        };
        let cooled_k = liquid_k - distance_k * economiser.effectiveness;
        let gas_j_kg = between.table.superheated_enthalpy_j_kg(middle_k, superheat_k);
        (enthalpy(liquid_k) - enthalpy(cooled_k), gas_j_kg)
    }
}
