//! Front-end exchangers during a control period: their air, and the fan by what is asked of them.
//!
//! The fan runs on demand. Its level follows from the conductance that the request needs: none where ram air alone passes
//! the heat, all where even the full flow does not. In between it is proportional in the flow; conductance over flow is
//! concave, so that never falls short. Exchangers in one stream of air have one fan, which follows the neediest.

use super::branches::{BranchValues, Connected};
use super::exchangers;
use crate::architecture::declaration::Level;
use crate::architecture::indices::Indices;
use crate::architecture::layout::{BranchSide, ExchangerSide, FRONT_END_PLACES};
use crate::command::Demand;
use crate::components::air_stream::Draught;
use crate::components::ambient_exchanger::{AmbientExchangerParameters, FrontAir};
use crate::components::frost::{Frost, FrostEffect};
use crate::network::shape::{Shape, each};
use crate::step_parameters::StepParameters;
use crate::surroundings::Disturbance;

/// Heat that passes a front-end exchanger per power of the compressor, so that the fan need not wait for it [-]: both ways it is
/// 2 to 4 at work.
const HEAT_PER_POWER: f64 = 3.0;

/// Smallest temperature difference that a request is divided by [K].
const SMALLEST_DIFFERENCE_K: f64 = 0.1;

/// What all front-end exchangers meet in a period.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrontAirs {
    /// Air of each exchanger.
    pub airs: [FrontAir; FRONT_END_PLACES],
    /// Power of all fans [W].
    pub fan_w: f64,
}

/// What is asked in a period.
#[derive(Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub demand: &'a Demand,
    pub connected: &'a Connected,
    /// Heat asked of each branch [W], over what temperature difference [K], and its coolant [W/K].
    pub requests_w: &'a BranchValues,
    pub differences_k: &'a BranchValues,
    pub coolant_w_k: &'a BranchValues,
    /// Power asked of the compressor [W].
    pub compressor_w: f64,
}

/// Air of all front-end exchangers with the fan as far as it is needed.
#[inline(always)]
pub(crate) fn blow<S: Shape>(
    shape: &Indices<'_>,
    parameters: &StepParameters,
    disturbance: &Disturbance,
    frosts: &[Frost; FRONT_END_PLACES],
    asked: &Asked<'_>,
) -> FrontAirs {
    let (speed_m_s, air) =
        (disturbance.frontal_air_speed_m_s(disturbance.mean_speed_m_s()), &disturbance.air);
    let (mut draughts, mut needs) = ([Draught::default(); FRONT_END_PLACES], [0.0; FRONT_END_PLACES]);
    let mut effects = [FrostEffect::NONE; FRONT_END_PLACES];
    each!(S::front_ends(shape) => |place, _| {
        let draught = parameters.air_streams[place].draught(speed_m_s);
        draughts[place] = draught;
        if frosts[place].mass_kg > 0.0 {
            effects[place] = parameters.front_ends[place].frost.effect(frosts[place].mass_kg);
        }
        if draught.full_m3_s > draught.ram_m3_s {
            let own = &parameters.front_ends[place];
            let [ram, full] = [draught.ram_m3_s, draught.full_m3_s]
                .map(|flow_m3_s| FrontAir::of(own, flow_m3_s * frosted_kg_m3(air.density_kg_m3, &effects[place]), &effects[place]));
            let approach_k = parameters.air_streams[place].fan_approach_k;
            needs[place] = of_coolant::<S>(shape, place, asked, (&ram, &full))
                .max(of_refrigerant(shape, (place, own, approach_k), air.temperature_k, asked, (&ram, &full)));
        }
    });
    share_needs::<S>(shape, &mut needs);
    let mut blown = FrontAirs::default();
    each!(S::front_ends(shape) => |place, indices| {
        let Draught { ram_m3_s, full_m3_s } = draughts[place];
        let flow_m3_s = ram_m3_s + needs[place] * (full_m3_s - ram_m3_s);
        let (own, effect) = (&parameters.front_ends[place], &effects[place]);
        blown.airs[place] = FrontAir::of(own, flow_m3_s * frosted_kg_m3(air.density_kg_m3, effect), effect);
        blown.airs[place].source_share =
            own.frost.capacity_share(air.temperature_k, disturbance.ambient_humidity_ratio);
        // One fan for all that share their air: it counts with the first.
        if indices.behind.is_none() && needs[place] > 0.0 {
            blown.fan_w += parameters.air_streams[place].fan_power_w(ram_m3_s, flow_m3_s);
        }
    });
    blown
}

/// Mass of air that passes per volume that would pass without frost [kg/m3].
#[inline(always)]
fn frosted_kg_m3(density_kg_m3: f64, frost: &FrostEffect) -> f64 {
    density_kg_m3 * frost.flow_share
}

/// Share of what the fan adds that a conductance needs [-].
#[inline(always)]
fn share(wanted_w_k: f64, ram_w_k: f64, full_w_k: f64) -> f64 {
    let share = (wanted_w_k - ram_w_k) / (full_w_k - ram_w_k);
    if full_w_k > ram_w_k { share.clamp(0.0, 1.0) } else { 0.0 }
}

/// Need of the connected coolant branches of an exchanger [-].
#[inline(always)]
fn of_coolant<S: Shape>(
    shape: &Indices<'_>,
    place: usize,
    asked: &Asked<'_>,
    (ram, full): (&FrontAir, &FrontAir),
) -> f64 {
    let mut need: f64 = 0.0;
    each!(S::branches(shape) => |i, branch| {
        if branch.side == BranchSide::Ambient(place) && asked.connected[i] && asked.requests_w[i] > 0.0 {
            let wanted_w_k = asked.requests_w[i] / asked.differences_k[i].max(SMALLEST_DIFFERENCE_K);
            let [ram_w_k, full_w_k] = [ram, full].map(|air| air.to_coolant_w_k(asked.coolant_w_k[i]));
            need = need.max(share(wanted_w_k, ram_w_k, full_w_k));
        }
    });
    need
}

/// Need of an exchanger that refrigerant passes: the difference to the air is to stay at the approach [-].
#[inline(always)]
fn of_refrigerant(
    shape: &Indices<'_>,
    (place, own, approach_k): (usize, &AmbientExchangerParameters, f64),
    ambient_k: f64,
    asked: &Asked<'_>,
    (ram, full): (&FrontAir, &FrontAir),
) -> f64 {
    if !shape.front_ends[place].refrigerant || asked.compressor_w <= 0.0 {
        return 0.0;
    }
    let open = shape.exchangers.iter().any(|exchanger| {
        exchanger.side == ExchangerSide::FrontEnd(place)
            && exchangers::is_open(exchanger, asked.demand)
            && (exchanger.level == Level::Condensing || !own.is_locked(ambient_k))
    });
    let wanted_w_k = HEAT_PER_POWER * asked.compressor_w / approach_k;
    if open { share(wanted_w_k, ram.to_refrigerant_w_k(), full.to_refrigerant_w_k()) } else { 0.0 }
}

/// Gives all exchangers of a stream the need of the neediest.
#[inline(always)]
fn share_needs<S: Shape>(shape: &Indices<'_>, needs: &mut [f64; FRONT_END_PLACES]) {
    each!(S::front_ends(shape) => |place, indices| {
        if indices.shares_air {
            let mut chain = [false; FRONT_END_PLACES];
            let (mut most, mut next): (f64, _) = (0.0, Some(place as u8));
            while let Some(other) = next {
                chain[usize::from(other)] = true;
                most = most.max(needs[usize::from(other)]);
                next = shape.front_ends[usize::from(other)].behind;
            }
            for other in 0..FRONT_END_PLACES {
                if chain[other] {
                    needs[other] = needs[other].max(most);
                }
            }
        }
    });
}
