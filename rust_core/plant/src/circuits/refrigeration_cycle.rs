//! Equations of the quasi-steady vapour-compression cycle, for given saturation temperatures and speed.

use super::refrigeration_loop::LoopBoundary;
use super::vapour_injection::{Between, Injected, InjectionParameters, VapourInjection};
use crate::components::compressor::{CompressorParameters, soft_floor};
use crate::components::refrigerant_exchanger::approach_limited_k;
use crate::config::{Celsius, Violation};
use crate::media::refrigerant::{CondensingIsobar, RefrigerantTable, SuctionState};
use crate::numerics::dual::Real;
use crate::parameters;

/// Isentropic work below which the cycle is continued smoothly [J/kg]; far below the lowest pressure ratio.
const WORK_KNEE_J_KG: f64 = 500.0;

const PASCAL_PER_BAR: f64 = 1e5;

parameters! {
    /// Refrigerant loop: compressor, condenser, expansion, evaporator.
    pub struct RefrigerationParameters {
        /// Superheat that the expansion valve holds where the coolant allows it [K].
        superheat_k: f64 = 0.5 .. 10.0,
        /// Subcooling at the condenser outlet where the coolant allows it [K].
        subcooling_k: f64 = 0.0 .. 10.0,
        /// Condensing pressure that must not be exceeded [bar] (paper section 2.3: 30 bar).
        maximum_pressure_bar: f64 = 5.0 .. 45.0,
        /// Suction pressure that must not be undercut [bar], the low-pressure guard of the evaporator.
        minimum_suction_pressure_bar: f64 = 0.2 .. 3.0,
        ;
        /// The electrically driven compressor.
        compressor: CompressorParameters,
        /// Vapour injection into the compressor; none where the section is absent.
        injection: Option<InjectionParameters>,
    }
}

/// Parameters and property table, with the limits as saturation temperatures.
#[derive(Debug, Clone, PartialEq)]
pub struct RefrigerationCycle {
    pub(super) parameters: RefrigerationParameters,
    pub(super) table: RefrigerantTable,
    /// Condensing temperature at the highest pressure [K].
    pub(super) highest_condensing_k: f64,
    /// Evaporating temperature at the lowest suction pressure [K].
    pub(super) lowest_evaporating_k: f64,
    /// Highest discharge temperature [K].
    pub(super) highest_discharge_k: f64,
    displacement_m3: f64,
    /// Electrical power per power of compression [-].
    electric_per_shaft: f64,
    injection: Option<VapourInjection>,
    /// Heat and work that the gas takes up per work of compression [-]: with what it gets of the losses.
    gas_per_compression: f64,
}

/// Coolants as the cycle meets them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CoolantSides {
    pub hot_inlet_k: f64,
    pub cold_inlet_k: f64,
    /// Inlets that leave subcooling and superheat the least room.
    hottest_inlet_k: f64,
    coldest_inlet_k: f64,
    /// Duty per distance between coolant inlet and saturation [W/K].
    pub hot_conductance_w_k: f64,
    pub cold_conductance_w_k: f64,
    /// Their reciprocals [K/W].
    hot_resistance_k_w: f64,
    cold_resistance_k_w: f64,
}

/// The cycle at one pair of saturation temperatures and one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CyclePoint<T> {
    pub evaporating_k: T,
    pub condensing_k: T,
    pub speed_rev_s: T,
    pub superheat_k: T,
    pub subcooling_k: T,
    pub evaporating_pressure_pa: T,
    /// Flow through suction and evaporator [kg/s].
    pub mass_flow_kg_s: T,
    /// Injected flow per suction flow; the condenser has both [-].
    pub injected_share: T,
    pub suction_enthalpy_j_kg: T,
    pub discharge_enthalpy_j_kg: T,
    pub liquid_enthalpy_j_kg: T,
    /// Liquid at the evaporator's valve; that of the condenser where nothing is injected [J/kg].
    pub evaporator_inlet_j_kg: T,
    pub isobar: CondensingIsobar<T>,
    pub evaporator_w: T,
    pub condenser_w: T,
    pub electric_w: T,
    /// Distance from the balance of the evaporator, as temperature [K].
    pub cold_residual_k: T,
    /// Distance from the balance of the condenser, as temperature [K].
    pub hot_residual_k: T,
}

impl RefrigerationCycle {
    /// Checks what the single ranges cannot: limits against each other and against the property table.
    ///
    /// # Errors
    /// The first parameter that does not fit.
    pub fn new(parameters: RefrigerationParameters, table: RefrigerantTable) -> Result<Self, Violation> {
        let compressor = &parameters.compressor;
        let violation = |key: &str, value: f64, allowed: String| Err(Violation::new(key, value, allowed));
        let lowest_pa = table.saturation_pressure_pa(table.lowest_saturation_k());
        let highest_pa = table.saturation_pressure_pa(table.highest_saturation_k());
        let (low_pa, high_pa) = (
            parameters.minimum_suction_pressure_bar * PASCAL_PER_BAR,
            parameters.maximum_pressure_bar * PASCAL_PER_BAR,
        );
        if high_pa > highest_pa {
            let critical = table.limits().map_or(String::new(), |limits| {
                format!(", whose critical point is at {} bar", limits.critical_pressure_bar)
            });
            let allowed =
                format!("must be at most {:.2} for {}{critical}", highest_pa / PASCAL_PER_BAR, table.name());
            return violation("maximum_pressure_bar", parameters.maximum_pressure_bar, allowed);
        }
        if low_pa < lowest_pa {
            let allowed = format!("must be at least {:.3} for {}", lowest_pa / PASCAL_PER_BAR, table.name());
            return violation(
                "minimum_suction_pressure_bar",
                parameters.minimum_suction_pressure_bar,
                allowed,
            );
        }
        if compressor.minimum_speed_rev_s >= compressor.maximum_speed_rev_s {
            let allowed = format!("must be below maximum_speed_rev_s ({})", compressor.maximum_speed_rev_s);
            return violation("compressor.minimum_speed_rev_s", compressor.minimum_speed_rev_s, allowed);
        }
        Ok(Self {
            highest_condensing_k: table.saturation_temperature_k(high_pa),
            lowest_evaporating_k: table.saturation_temperature_k(low_pa),
            highest_discharge_k: Celsius(compressor.maximum_discharge_temperature_degc).kelvin(),
            displacement_m3: compressor.displacement_m3(),
            electric_per_shaft: compressor.electrical_efficiency.recip(),
            injection: parameters.injection.clone().map(|injection| VapourInjection::new(injection, &table)),
            gas_per_compression: 1.0
                + compressor.loss_to_gas_share * (compressor.electrical_efficiency.recip() - 1.0),
            parameters,
            table,
        })
    }

    /// Parameters in use.
    #[must_use]
    pub fn parameters(&self) -> &RefrigerationParameters {
        &self.parameters
    }

    /// Property table in use.
    #[must_use]
    pub fn table(&self) -> &RefrigerantTable {
        &self.table
    }

    #[inline]
    pub(super) fn coolant_sides(boundary: &LoopBoundary) -> CoolantSides {
        CoolantSides {
            hot_inlet_k: boundary.hot_return_k,
            cold_inlet_k: boundary.cold_return_k,
            hottest_inlet_k: boundary.hottest_inlet_k,
            coldest_inlet_k: boundary.coldest_inlet_k,
            hot_conductance_w_k: boundary.hot_conductance_w_k,
            cold_conductance_w_k: boundary.cold_conductance_w_k,
            hot_resistance_k_w: boundary.hot_conductance_w_k.recip(),
            cold_resistance_k_w: boundary.cold_conductance_w_k.recip(),
        }
    }

    /// All quantities of the cycle and both balances.
    ///
    /// What depends on one saturation temperature alone is evaluated with that one derivative.
    #[inline(always)]
    pub(super) fn evaluate<T: Real>(&self, sides: &CoolantSides, unknowns: [T; 3]) -> CyclePoint<T> {
        let [evaporating_k, condensing_k, speed_rev_s] = unknowns;
        let parameters = &self.parameters;
        let (evaporating, condensing) = (evaporating_k.alone(), condensing_k.alone());
        let superheat_k = approach_limited_k(parameters.superheat_k, -(evaporating - sides.coldest_inlet_k));
        let subcooling_k = approach_limited_k(parameters.subcooling_k, condensing - sides.hottest_inlet_k);
        let suction = self.table.suction_state(evaporating, superheat_k).of(evaporating_k);
        let isobar = self.table.condensing_isobar(condensing);
        let liquid_enthalpy_j_kg = condensing_k.then(isobar.liquid_enthalpy_j_kg(subcooling_k));
        let isobar = isobar.of(condensing_k);

        let efficiency =
            parameters.compressor.efficiency(isobar.pressure_pa / suction.pressure_pa, speed_rev_s);
        let Injected { share: injected_share, evaporator_inlet_j_kg, work_j_kg, discharge_enthalpy_j_kg } =
            if let Some(injection) = &self.injection {
                self.injected(
                    injection,
                    &Between {
                        table: &self.table,
                        evaporating_k,
                        suction: &suction,
                        isobar: &isobar,
                        subcooling_k: condensing_k.then(subcooling_k),
                        liquid_enthalpy_j_kg,
                        isentropic_efficiency: efficiency.isentropic,
                    },
                )
            } else {
                self.in_one_stage(&suction, &isobar, liquid_enthalpy_j_kg, efficiency.isentropic)
            };
        let mass_flow_kg_s =
            efficiency.volumetric * suction.density_kg_m3 * speed_rev_s * self.displacement_m3;

        let compression_w = mass_flow_kg_s * work_j_kg;
        let evaporator_w = mass_flow_kg_s * (suction.enthalpy_j_kg - evaporator_inlet_j_kg);
        let condenser_w = evaporator_w + compression_w * self.gas_per_compression;
        CyclePoint {
            evaporating_k,
            condensing_k,
            speed_rev_s,
            superheat_k: evaporating_k.then(superheat_k),
            subcooling_k: condensing_k.then(subcooling_k),
            evaporating_pressure_pa: suction.pressure_pa,
            mass_flow_kg_s,
            injected_share,
            suction_enthalpy_j_kg: suction.enthalpy_j_kg,
            discharge_enthalpy_j_kg,
            liquid_enthalpy_j_kg,
            evaporator_inlet_j_kg,
            isobar,
            evaporator_w,
            condenser_w,
            electric_w: compression_w * self.electric_per_shaft,
            cold_residual_k: -(evaporating_k - sides.cold_inlet_k) - evaporator_w * sides.cold_resistance_k_w,
            hot_residual_k: condensing_k - sides.hot_inlet_k - condenser_w * sides.hot_resistance_k_w,
        }
    }

    /// Compression without injection.
    #[inline(always)]
    fn in_one_stage<T: Real>(
        &self,
        suction: &SuctionState<T>,
        isobar: &CondensingIsobar<T>,
        liquid_enthalpy_j_kg: T,
        isentropic_efficiency: T,
    ) -> Injected<T> {
        let isentropic_j_kg = isobar.enthalpy_at_entropy_j_kg(suction.entropy_j_kg_k) - suction.enthalpy_j_kg;
        let work_j_kg = soft_floor(isentropic_j_kg, WORK_KNEE_J_KG) / isentropic_efficiency;
        Injected {
            share: T::constant(0.0),
            evaporator_inlet_j_kg: liquid_enthalpy_j_kg,
            work_j_kg,
            discharge_enthalpy_j_kg: suction.enthalpy_j_kg + work_j_kg * self.gas_per_compression,
        }
    }

    /// Compression with injection; the losses heat all gas, the injected too.
    #[inline]
    fn injected<T: Real>(&self, injection: &VapourInjection, between: &Between<'_, T>) -> Injected<T> {
        let mut injected = injection.compress(between);
        let loss_j_kg = injected.work_j_kg * (self.gas_per_compression - 1.0);
        injected.discharge_enthalpy_j_kg =
            injected.discharge_enthalpy_j_kg + loss_j_kg / (injected.share + 1.0);
        injected
    }

    /// All quantities of the cycle and both balances, without derivatives.
    pub(super) fn point(&self, sides: &CoolantSides, unknowns: [f64; 3]) -> CyclePoint<f64> {
        self.evaluate(sides, unknowns)
    }

    /// Gas temperature at the compressor outlet [K].
    pub(super) fn discharge_k<T: Real>(&self, point: &CyclePoint<T>) -> T {
        self.table.discharge_temperature_k(&point.isobar, point.discharge_enthalpy_j_kg)
    }
}

impl<T: Real> CyclePoint<T> {
    /// Evaporating temperature, condensing temperature and speed.
    pub fn unknowns(&self) -> [T; 3] {
        [self.evaporating_k, self.condensing_k, self.speed_rev_s]
    }

    pub fn pressure_ratio(&self) -> f64 {
        self.isobar.pressure_pa.value() / self.evaporating_pressure_pa.value()
    }
}
