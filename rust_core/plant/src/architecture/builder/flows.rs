//! Flows in the order of their columns, those of links left out.

use super::Builder;
use crate::architecture::flows::{Crossing, Flow, FlowRow, OF_EVERY_VEHICLE};
use crate::architecture::layout::LoopLayout;

impl Builder<'_> {
    /// Flows in the order of their columns.
    pub(super) fn add_flows(&mut self) {
        for flow in [
            Flow::DRAG,
            Flow::ROLLING,
            Flow::KINETIC,
            Flow::CLIMB,
            Flow::WHEEL,
            Flow::FRICTION_BRAKE,
            Flow::TRACTION,
            Flow::UNSERVED,
            Flow::MOTOR_LOSS,
            Flow::TRANSMISSION_LOSS,
            Flow::AUXILIARY,
        ] {
            self.fixed(flow);
        }
        self.layout.base_loads.push(Flow::AUXILIARY);
        for circuit in 0..self.layout.loops.len() {
            let LoopLayout { name, label, .. } = &self.layout.loops[circuit];
            let (column, text) =
                (format!("{name}_pump_power_w"), format!("Pump of the {label}; warms its coolant."));
            let flow = self.flow(column, text, Crossing::Inside);
            self.layout.loops[circuit].pump_flow = flow;
            self.layout.base_loads.push(flow);
        }
        self.for_each_member(|builder, kind, member| (kind.add_loads)(builder, member));
        self.fixed(Flow::FAN);
        self.layout.base_loads.push(Flow::FAN);
        self.add_machine_flows();
        for flow in [Flow::BATTERY, Flow::CHEMICAL, Flow::BATTERY_LOSS] {
            self.fixed(flow);
        }
        self.for_each_member(|builder, kind, member| (kind.add_gains)(builder, member));
    }

    pub(super) fn fixed(&mut self, flow: Flow) {
        let row = &OF_EVERY_VEHICLE[flow.index()];
        let (column, description) = (row.column.to_owned(), row.description.to_owned());
        self.layout.flows.push(FlowRow { flow, column, description, crossing: row.crossing });
    }
}
