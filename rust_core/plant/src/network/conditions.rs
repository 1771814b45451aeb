//! What the links depend on during a step, and what each law makes of it.

use crate::architecture::layout::{
    BRANCH_PLACES, CABIN_PLACES, FRONT_END_PLACES, LOOP_PLACES, MASS_PLACES, WEIGHT_PLACES,
};
use crate::architecture::wiring::Law;
use crate::components::cabin::Ventilation;
use crate::components::exhaust_recovery::ExhaustRecovery;
use crate::numerics::thermal_network::LinkState;

/// What links depend on besides the moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Constants {
    /// Conductance of half of each loop's hoses [W/K].
    pub half_hoses_w_k: [f64; LOOP_PLACES],
    /// Conductance between air and soft furnishings of each cabin [W/K].
    pub soft_w_k: [f64; CABIN_PLACES],
    /// Conductance between air and hard furnishings [W/K].
    pub hard_w_k: [f64; CABIN_PLACES],
}

/// A cabin during a step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CabinConditions {
    /// Air flows.
    pub ventilation: Ventilation,
    /// Exhaust recovery.
    pub recovery: ExhaustRecovery,
    /// Conductance of the panels [W/K].
    pub panel_w_k: f64,
}

/// What the links depend on during a step, by position.
#[derive(Debug, Clone, Copy)]
pub struct Conditions<'a> {
    /// Coolant capacity rate of each loop [W/K].
    pub rates_w_k: &'a [f64; LOOP_PLACES],
    /// Conductance of each branch, its switch applied [W/K].
    pub branches_w_k: &'a [f64; BRANCH_PLACES],
    /// Conductance between each mass and ambient [W/K].
    pub masses_w_k: [f64; MASS_PLACES],
    /// Cabins.
    pub cabins: [CabinConditions; CABIN_PLACES],
    /// Weights of branches in series [-].
    pub weights: [f64; WEIGHT_PLACES],
    /// Air that each front-end exchanger gets [K].
    pub front_end_air_k: &'a [f64; FRONT_END_PLACES],
    /// Ambient temperature [K].
    pub ambient_k: f64,
}

/// State of a link during a step.
#[must_use]
#[inline(always)]
pub fn state(law: Law, now: &Conditions<'_>, constants: &Constants) -> LinkState {
    let at = usize::from;
    match law {
        Law::Advection(circuit) => LinkState::conductance(now.rates_w_k[at(circuit)]),
        Law::Hose(circuit) => LinkState::to_fixed(constants.half_hoses_w_k[at(circuit)], now.ambient_k),
        Law::Branch(branch) => LinkState::conductance(now.branches_w_k[at(branch)]),
        Law::BranchToAir(branch, end) => {
            LinkState::to_fixed(now.branches_w_k[at(branch)], now.front_end_air_k[at(end)])
        }
        Law::BranchFromAir(branch, end) => {
            LinkState::from_fixed(now.branches_w_k[at(branch)], now.front_end_air_k[at(end)])
        }
        // Cabin cores see a mixture of fresh and recirculated air.
        Law::HeaterCore(branch, cabin) => {
            let recirculation = now.cabins[at(cabin)].ventilation.recirculation;
            LinkState {
                conductance_w_k: now.branches_w_k[at(branch)],
                hot_weight: 1.0,
                cold_weight: recirculation,
                offset_k: -((1.0 - recirculation) * now.ambient_k),
            }
        }
        Law::CoolingCore(branch, cabin) => {
            let recirculation = now.cabins[at(cabin)].ventilation.recirculation;
            LinkState {
                conductance_w_k: now.branches_w_k[at(branch)],
                hot_weight: recirculation,
                cold_weight: 1.0,
                offset_k: (1.0 - recirculation) * now.ambient_k,
            }
        }
        Law::SeriesReturn(branch, weight, out_of_loop) => series(now, branch, 1.0, weight, out_of_loop),
        Law::SeriesBefore(branch, weight, out_of_loop) => series(now, branch, 0.0, weight, out_of_loop),
        Law::RecoveryFromAmbient(cabin) => now.cabins[at(cabin)].recovery.from_ambient(now.ambient_k),
        Law::RecoveryFromLoop(cabin) => now.cabins[at(cabin)].recovery.from_loop(),
        Law::MassToAmbient(mass) => LinkState::to_fixed(now.masses_w_k[at(mass)], now.ambient_k),
        Law::Panel(cabin) => LinkState::to_fixed(now.cabins[at(cabin)].panel_w_k, now.ambient_k),
        Law::Soft(cabin) => LinkState::conductance(constants.soft_w_k[at(cabin)]),
        Law::Hard(cabin) => LinkState::conductance(constants.hard_w_k[at(cabin)]),
        Law::Exhaust(cabin) => {
            LinkState::to_fixed(now.cabins[at(cabin)].ventilation.fresh_rate_w_k, now.ambient_k)
        }
    }
}

/// A branch in series: driven by its member (weight `own`) and by a node before it in the loop, with the weight that this
/// has in the coolant that arrives.
#[inline(always)]
fn series(now: &Conditions<'_>, branch: u8, own: f64, weight: u8, out_of_loop: bool) -> LinkState {
    let before = now.weights[usize::from(weight)];
    let (hot_weight, cold_weight) = if out_of_loop { (before, own) } else { (own, before) };
    LinkState {
        conductance_w_k: now.branches_w_k[usize::from(branch)],
        hot_weight,
        cold_weight,
        offset_k: 0.0,
    }
}
