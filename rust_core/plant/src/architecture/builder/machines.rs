//! Exchangers of the refrigerant loop and heaters, with the flows that they carry.

use super::{Builder, label};
use crate::architecture::declaration::{HeaterDeclaration, Level};
use crate::architecture::flows::{Crossing, Flow};
use crate::architecture::layout::{BranchSide, ExchangerLayout, ExchangerSide, HeaterLayout, HeaterTarget};

impl Builder<'_> {
    pub(super) fn add_machines(&mut self) {
        let declaration = self.declaration;
        let alone =
            |level: Level| declaration.exchangers.iter().filter(|other| other.level == level).count() == 1;
        for (place, declared) in declaration.exchangers.iter().enumerate() {
            let side = match (&declared.circuit, &declared.air) {
                (Some(name), _) => ExchangerSide::Loop(declaration.circuit(name).unwrap_or(0)),
                (None, air) => {
                    let member = air.as_ref().and_then(|name| declaration.member(name)).unwrap_or(0);
                    match self.branch_side(member) {
                        BranchSide::Ambient(front_end) => ExchangerSide::FrontEnd(front_end),
                        BranchSide::Core(cabin) => ExchangerSide::Cabin(cabin),
                        BranchSide::Mass(_) | BranchSide::Plate(_) => ExchangerSide::Cabin(0),
                    }
                }
            };
            if let ExchangerSide::Loop(circuit) = side {
                self.layout.loops[circuit].exchanger = Some(place);
            }
            let total = if declared.level == Level::Condensing { Flow::CONDENSER } else { Flow::EVAPORATOR };
            // The only one on its level, facing coolant, carries the level's flow.
            let own = alone(declared.level) && matches!(side, ExchangerSide::Loop(_));
            self.layout.exchangers.push(ExchangerLayout {
                name: declared.name.clone(),
                level: declared.level,
                side,
                valve_row: None,
                flow: if own { total } else { Flow::AUXILIARY },
            });
        }
        for declared in &declaration.heaters {
            let target = self.heater_target(declared);
            self.layout.heaters.push(HeaterLayout {
                name: declared.name.clone(),
                label: label(declared.label.as_ref(), &declared.name),
                target,
                row: 0,
                flow: Flow::AUXILIARY,
            });
        }
    }

    fn heater_target(&self, heater: &HeaterDeclaration) -> HeaterTarget {
        match self.declaration.circuit(&heater.heats) {
            Some(circuit) => HeaterTarget::Loop(circuit),
            None => {
                let member = self.declaration.member(&heater.heats).unwrap_or(0);
                HeaterTarget::Mass(self.layout.members[member].node.unwrap_or(self.layout.battery))
            }
        }
    }

    pub(super) fn add_machine_flows(&mut self) {
        for heater in 0..self.layout.heaters.len() {
            let HeaterLayout { name, label, .. } = &self.layout.heaters[heater];
            let (column, text) =
                (format!("{name}_power_w"), format!("Power of the {label}, all of it heat."));
            self.layout.heaters[heater].flow = self.flow(column, text, Crossing::Inside);
        }
        if !self.layout.refrigerates() {
            return;
        }
        for flow in [Flow::COMPRESSOR, Flow::COMPRESSOR_LOSS, Flow::CONDENSER, Flow::EVAPORATOR] {
            self.fixed(flow);
        }
        for place in 0..self.layout.exchangers.len() {
            let ExchangerLayout { name, level, side, flow, .. } = &self.layout.exchangers[place];
            if *flow != Flow::AUXILIARY {
                continue;
            }
            let crossing = match (side, level) {
                (ExchangerSide::FrontEnd(_), Level::Condensing) => Crossing::Leaves,
                (ExchangerSide::FrontEnd(_), Level::Evaporating) => Crossing::Enters,
                _ => Crossing::Inside,
            };
            let column = format!("{name}_heat_flow_w");
            let text = match level {
                Level::Condensing => {
                    format!("Heat from the condensing refrigerant in {}.", name.replace('_', " "))
                }
                Level::Evaporating => {
                    format!("Heat into the evaporating refrigerant in {}.", name.replace('_', " "))
                }
            };
            self.layout.exchangers[place].flow = self.flow(column, text, crossing);
        }
    }
}
