//! Actuators: a row of the command each.

use super::Builder;
use crate::architecture::layout::{HeaterLayout, LoopLayout, MemberLayout};
use crate::architecture::rows::{ActuatorRow, Purpose, Scale};

impl Builder<'_> {
    pub(super) fn add_actuators(&mut self) {
        let members: Vec<usize> = (0..self.layout.members.len())
            .filter(|&member| !self.layout.members[member].options.is_empty())
            .collect();
        for &member in &members {
            let MemberLayout { name, label, options, .. } = self.layout.members[member].clone();
            let loops = options
                .iter()
                .map(|&branch| self.layout.loops[self.layout.branches[branch].circuit].name.clone());
            let options: Vec<String> = std::iter::once("isolated".to_owned()).chain(loops).collect();
            let text = format!("connection of {label}");
            let row = self.row(ActuatorRow::choice(name, options, Purpose::Connection(member), text));
            self.layout.members[member].connection_row = Some(row);
        }
        for heater in 0..self.layout.heaters.len() {
            let HeaterLayout { name, label, .. } = self.layout.heaters[heater].clone();
            let options = ["off", "allowed"].map(str::to_owned).to_vec();
            let text = format!("{label} under its own PID on the cabin temperature");
            self.layout.heaters[heater].row =
                self.row(ActuatorRow::choice(name, options, Purpose::Heater(heater), text));
        }
        for place in 0..self.declaration.exchangers.len() {
            if self.declaration.exchangers[place].valve {
                let name = self.layout.exchangers[place].name.clone();
                let options = ["closed", "open"].map(str::to_owned).to_vec();
                let text = format!("refrigerant valve of the {}", name.replace('_', " "));
                let row = self.row(ActuatorRow::choice(name, options, Purpose::ExchangerValve(place), text));
                self.layout.exchangers[place].valve_row = Some(row);
            }
        }
        if self.layout.refrigerates() {
            let row = self.row(ActuatorRow {
                name: "compressor_power".to_owned(),
                unit: "W",
                scale: Scale::OffThenLogarithmic,
                description: "electrical power demand of the compressor".to_owned(),
                purpose: Purpose::Compressor,
            });
            self.layout.compressor_row = Some(row);
        }
        self.add_levels(&members);
    }

    fn add_levels(&mut self, members: &[usize]) {
        self.for_each_member(|builder, kind, member| (kind.add_levels)(builder, member));
        for circuit in 0..self.layout.loops.len() {
            let LoopLayout { name, label, .. } = self.layout.loops[circuit].clone();
            let text = format!("coolant flow demand of the {label}");
            self.layout.loops[circuit].flow_row = self.row(ActuatorRow::level(
                format!("{name}_flow"),
                "kg/s",
                Purpose::LoopFlow(circuit),
                text,
            ));
        }
        for &member in members {
            let MemberLayout { name, label, .. } = self.layout.members[member].clone();
            let text = format!("heat flow requested between {label} and its loop");
            let row =
                self.row(ActuatorRow::level(format!("{name}_request"), "W", Purpose::Request(member), text));
            self.layout.members[member].request_row = Some(row);
        }
        for &member in members {
            let MemberLayout { name, label, .. } = self.layout.members[member].clone();
            let text = format!("valve of the branch of {label}: share of its open position");
            let row =
                self.row(ActuatorRow::level(format!("{name}_valve"), "-", Purpose::Valve(member), text));
            self.layout.members[member].valve_row = Some(row);
        }
        if !self.layout.heaters.is_empty() {
            let text = "cabin temperature that the heaters' PIDs aim at".to_owned();
            let row = self.row(ActuatorRow::level("cabin_set_point", "K", Purpose::CabinSetPoint, text));
            self.layout.set_point_row = Some(row);
        }
        for place in 0..self.layout.cabins.len() {
            let name = format!("{}windscreen_share", self.prefix(self.layout.cabins[place].member));
            let text =
                "share of the supply air that is blown at the windscreen, the rest at the feet".to_owned();
            self.layout.cabins[place].windscreen_row =
                self.row(ActuatorRow::level(name, "-", Purpose::Windscreen(place), text));
        }
    }
}
