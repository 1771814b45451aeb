//! Heat that flows bring into nodes besides links.

use super::Builder;
use crate::architecture::declaration::Level;
use crate::architecture::flows::Flow;
use crate::architecture::layout::{
    BranchSide, ExchangerLayout, ExchangerSide, FLOW_PLACES, HeaterLayout, HeaterTarget, LoopLayout,
    MassLayout,
};
use crate::architecture::wiring::{HeatSource, Inlet, SERIES_PLACES, SeriesPlace};

/// What an inlet carries that is asked about only: the last place of flows, which nothing else has.
const NOTHING: Flow = Flow((FLOW_PLACES - 1) as u8);

impl Builder<'_> {
    /// Heat that flows bring into nodes besides links.
    pub(super) fn add_sources(&mut self) {
        for place in 0..self.layout.exchangers.len() {
            let ExchangerLayout { level, side, flow, .. } = self.layout.exchangers[place];
            let out = level == Level::Evaporating;
            match side {
                ExchangerSide::Loop(circuit) => {
                    let inlet = self.inlet(circuit, flow, out);
                    self.layout.inlets.push(inlet);
                }
                ExchangerSide::Cabin(cabin) => {
                    let node = self.layout.cabins[cabin].air;
                    self.layout.sources.push(HeatSource { flow, node, out });
                }
                ExchangerSide::FrontEnd(_) => {}
            }
        }
        for heater in 0..self.layout.heaters.len() {
            let HeaterLayout { target, flow, .. } = self.layout.heaters[heater];
            let node = match target {
                HeaterTarget::Loop(circuit) => {
                    let asked = self.layout.inlets.iter().any(|inlet| usize::from(inlet.circuit) == circuit);
                    if !asked {
                        let inlet = self.inlet(circuit, NOTHING, false);
                        self.layout.inlets.push(inlet);
                    }
                    self.layout.loops[circuit].supply
                }
                HeaterTarget::Mass(node) => node,
            };
            self.layout.sources.push(HeatSource { flow, node, out: false });
        }
        for circuit in 0..self.layout.loops.len() {
            let LoopLayout { back, pump_flow, .. } = self.layout.loops[circuit];
            self.layout.sources.push(HeatSource { flow: pump_flow, node: back, out: false });
        }
        self.add_losses();
        self.for_each_member(|builder, kind, member| (kind.add_sources)(builder, member));
    }

    /// Losses of machines warm their masses; in the order of the flows.
    fn add_losses(&mut self) {
        let loss = |mass: &MassLayout| {
            let flow = self.layout.members[mass.member].kind.data().loss?;
            Some(HeatSource { flow, node: mass.node, out: false })
        };
        let mut losses: Vec<HeatSource> = self.layout.masses.iter().filter_map(loss).collect();
        losses.sort_by_key(|source| source.flow);
        self.layout.sources.extend(losses);
    }

    fn inlet(&self, circuit: usize, flow: Flow, out: bool) -> Inlet {
        let mut series = [None; SERIES_PLACES];
        for (place, &branch) in series.iter_mut().zip(&self.layout.loops[circuit].series) {
            let layout = self.layout.branches[branch];
            if let BranchSide::Mass(node) = layout.side {
                let (branch, out_of_loop) = (branch as u8, layout.out_of_loop);
                *place = Some(SeriesPlace { branch, node, flow: layout.flow, out_of_loop });
            }
        }
        Inlet { flow, out, supply: self.layout.loops[circuit].supply, circuit: circuit as u8, series }
    }
}
