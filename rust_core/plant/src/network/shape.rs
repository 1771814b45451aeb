//! A vehicle's shape as a step sees it: positions and network, compiled or planned.

use super::conditions::{Conditions, Constants};
use super::planned::PlannedWiring;
use super::{Forecast, INLET_PLACES};
use crate::architecture::indices::{
    BranchIndices, ExchangerIndices, FrontEndIndices, HeaterIndices, Indices, LoopIndices,
};
use crate::architecture::layout::CabinLayout;
use crate::architecture::wiring::{Inlet, Link, SeriesPlace};
use crate::flows::{Flow, Flows};
use crate::numerics::thermal_network::NodeValues;

/// What a step is given.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a> {
    /// Heat capacities of the nodes [J/K].
    pub capacities_j_k: &'a NodeValues,
    /// What links depend on at all times.
    pub constants: &'a Constants,
    /// What they depend on now.
    pub now: &'a Conditions<'a>,
    /// Temperatures at the beginning [K].
    pub start_k: &'a NodeValues,
}

/// Where a step looks things up. Both kinds do the same operations in the same order, so they agree to the last bit.
pub trait Shape {
    /// Whether it is known while compiling.
    const COMPILED: bool;

    /// A factorised step.
    type Factors;

    /// Positions: constants, or those of the vehicle. A reference, since the compiler looks through one to a constant, while it
    /// forgets what it knows of a copy as soon as a function that is not inlined gets to see it.
    fn indices<'a>(own: &'a Indices<'a>) -> &'a Indices<'a>;

    /// Entry number `N` of [`Indices::loops`], if there is one.
    fn circuit_at<const N: usize>(shape: &Indices<'_>) -> Option<LoopIndices>;

    /// Entry number `N` of [`Indices::branches`], if there is one.
    fn branch_at<const N: usize>(shape: &Indices<'_>) -> Option<BranchIndices>;

    /// Entry number `N` of [`Indices::cabins`], if there is one.
    fn cabin_at<const N: usize>(shape: &Indices<'_>) -> Option<CabinLayout>;

    /// Entry number `N` of [`Indices::front_ends`], if there is one.
    fn front_end_at<const N: usize>(shape: &Indices<'_>) -> Option<FrontEndIndices>;

    /// Entry number `N` of [`Indices::exchangers`], if there is one.
    fn exchanger_at<const N: usize>(shape: &Indices<'_>) -> Option<ExchangerIndices>;

    /// Entry number `N` of [`Indices::heaters`], if there is one.
    fn heater_at<const N: usize>(shape: &Indices<'_>) -> Option<HeaterIndices>;

    /// Entry number `N` of [`Indices::base_loads`], if there is one.
    fn base_load_at<const N: usize>(shape: &Indices<'_>) -> Option<Flow>;

    /// Assembles and factorises a step; tells what is known of the supplies that heat enters.
    fn begin(
        planned: Option<&PlannedWiring>,
        given: &Given<'_>,
        step_s: f64,
        flows: &Flows,
    ) -> ([Forecast; INLET_PLACES], Self::Factors);

    /// Temperatures at the end of the step [K]; enters the heat flows of all links.
    fn finish(
        planned: Option<&PlannedWiring>,
        factors: &Self::Factors,
        given: &Given<'_>,
        flows: &mut Flows,
    ) -> NodeValues;
}

/// Does something for each entry of a list of a shape, for a compiled one written out for each position, so that it knows its
/// entry while compiling: `each!(S::loops(shape) => |place, indices| { ... })`.
macro_rules! each {
    ($s:ident::loops($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block) => {
        each!(@ $s, $shape.loops, $s::circuit_at($shape) => |$place, $entry| $body; 0 1 2 3)
    };
    ($s:ident::branches($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block) => {
        each!(@ $s, $shape.branches, $s::branch_at($shape) => |$place, $entry| $body; 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15)
    };
    ($s:ident::cabins($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block) => {
        each!(@ $s, $shape.cabins, $s::cabin_at($shape) => |$place, $entry| $body; 0 1)
    };
    ($s:ident::front_ends($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block) => {
        each!(@ $s, $shape.front_ends, $s::front_end_at($shape) => |$place, $entry| $body; 0 1 2)
    };
    ($s:ident::exchangers($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block) => {
        each!(@ $s, $shape.exchangers, $s::exchanger_at($shape) => |$place, $entry| $body; 0 1 2 3 4 5)
    };
    ($s:ident::heaters($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block) => {
        each!(@ $s, $shape.heaters, $s::heater_at($shape) => |$place, $entry| $body; 0 1 2 3)
    };
    ($s:ident::base_loads($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block) => {
        each!(@ $s, $shape.base_loads, $s::base_load_at($shape) => |$place, $entry| $body; 0 1 2 3 4 5 6 7)
    };
    (@ $t:ident, $list:expr, $s:ident::$at:ident($shape:expr) => |$place:pat_param, $entry:pat_param| $body:block;
        $($n:literal)*) => {
        if $t::COMPILED {
            $(
                if let Some($entry) = &$s::$at::<$n>($shape) {
                    let $place: usize = $n;
                    $body
                }
            )*
        } else {
            for ($place, $entry) in $list.iter().enumerate() {
                $body
            }
        }
    };
}
pub(crate) use each;

/// Share of the heat entering a loop that each branch of its series takes, the rest is what is left in the end. Written out
/// place by place: a loop would still look at run time whether a compiled inlet has one.
#[inline(always)]
fn share_out(inlet: &Inlet, now: &Conditions<'_>, mut give: impl FnMut(&SeriesPlace, f64)) -> f64 {
    let [first, second, third] = &inlet.series;
    let mut left = 1.0;
    let mut take = |place: &Option<SeriesPlace>| {
        if let Some(place) = place {
            let conductance_w_k = now.branches_w_k[usize::from(place.branch)];
            let share = left * (conductance_w_k / now.rates_w_k[usize::from(inlet.circuit)]);
            give(place, share);
            left -= share;
        }
    };
    take(first);
    take(second);
    take(third);
    left
}

/// Brings heat that enters a loop where it ends up: in its supply and, in part, in the series behind the exchanger.
///
/// A branch in series sees coolant that is warmer by `Q / C`; that part of its link is a fixed flow, entered here.
#[inline(always)]
pub(super) fn bring(inlet: &Inlet, heat_w: f64, now: &Conditions<'_>, sources_w: &mut NodeValues) {
    let left = share_out(inlet, now, |place, share| sources_w[place.node.index()] += heat_w * share);
    sources_w[inlet.supply.index()] += heat_w * left;
}

/// Takes the same part from the flows of the branches in series.
#[inline(always)]
pub(super) fn settle(inlet: &Inlet, heat_w: f64, now: &Conditions<'_>, flows: &mut Flows) {
    share_out(inlet, now, |place, share| {
        let given_w = heat_w * share;
        flows[place.flow] += if place.out_of_loop { given_w } else { -given_w };
    });
}

/// Heat of an inlet's flow, positive into the loop [W].
#[inline(always)]
pub(super) fn entering_w(inlet: &Inlet, flows: &Flows) -> f64 {
    if inlet.out { -flows[inlet.flow] } else { flows[inlet.flow] }
}

/// Whether no link before carries the same flow.
pub(super) const fn is_first(links: &[Link], place: usize) -> bool {
    let mut before = 0;
    while before < place && place < links.len() {
        if links[before].flow.0 == links[place].flow.0 {
            return false;
        }
        before += 1;
    }
    true
}
