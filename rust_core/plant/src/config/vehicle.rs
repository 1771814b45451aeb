//! One complete vehicle: its architecture, and a section of numbers for each part of it.

use super::initial::WINDSCREEN;
use super::kinds::{ARCHITECTURE, FLUID_LIMITS, VEHICLE};
use super::library::{self, Override};
use super::{Validate, Violation, check_range, deserialized, orders};
use crate::architecture::declaration::{Declaration, MemberKind, VEHICLE_SECTIONS};
use crate::architecture::flaw::{Flaw, among};
use crate::architecture::flows::FlowRow;
use crate::architecture::layout::{BranchSide, ExchangerSide, Layout};
use crate::circuits::refrigeration_cycle::RefrigerationParameters;
use crate::components::air_stream::AirStreamParameters;
use crate::components::ambient_exchanger::AmbientExchangerParameters;
use crate::components::battery::BatteryParameters;
use crate::components::body::BodyParameters;
use crate::components::cabin::CabinParameters;
use crate::components::coolant_loop::LoopParameters;
use crate::components::heater::HeaterParameters;
use crate::components::liquid_plate::LiquidPlateParameters;
use crate::components::motor::MotorParameters;
use crate::components::pid::PidParameters;
use crate::components::powertrain::RegenerationParameters;
use crate::components::thermal_mass::ThermalMass;
use crate::components::thermal_switch::SwitchParameters;
use crate::components::transmission::TransmissionParameters;
use crate::error::{PlantError, PlantResult};
use crate::media::refrigerant::{self, RefrigerantTable};
use crate::parameters;
use crate::signals::SignalTable;
use std::sync::{Arc, OnceLock};
use toml::{Table, Value};

/// Architecture of a vehicle that names none.
const DEFAULT_ARCHITECTURE: &str = "jeffs2019";

/// Part of a front-end exchanger's section: its air, where it shares that with no other.
const AIR: &str = "air";

/// Conductances that an exchanger of the refrigerant loop may have [W/K].
const EXCHANGER_UA_RANGE_W_K: (f64, f64) = (10.0, 10_000.0);

/// All parameters of a vehicle. Lists are in the order of the architecture's layout.
#[derive(Debug, Clone, PartialEq)]
pub struct VehicleParameters {
    /// What this vehicle is, in a sentence.
    pub description: String,
    /// Name or path of its architecture.
    pub architecture: String,
    /// What follows from that.
    pub layout: Arc<Layout>,
    /// Name or path of the refrigerant table; none without a refrigerant loop.
    pub refrigerant: Option<String>,
    /// Longitudinal dynamics.
    pub body: BodyParameters,
    /// Regenerative braking.
    pub regeneration: RegenerationParameters,
    /// Motor and inverter.
    pub motor: MotorParameters,
    /// Transmission.
    pub transmission: TransmissionParameters,
    /// Battery.
    pub battery: BatteryParameters,
    /// Cabins.
    pub cabins: Vec<CabinShare>,
    /// Coolant loops.
    pub loops: Vec<LoopParameters>,
    /// Heaters.
    pub heaters: Vec<HeaterParameters>,
    /// Stores and whatever else is a mass without heat of its own, in the order of their masses.
    pub stores: Vec<ThermalMass>,
    /// Front-end exchangers.
    pub front_ends: Vec<AmbientExchangerParameters>,
    /// Air of each front-end exchanger; the same for those that share it.
    pub air_streams: Vec<AirStreamParameters>,
    /// Plates by the position of their member.
    pub plates: Vec<Option<LiquidPlateParameters>>,
    /// Refrigerant loop.
    pub refrigeration: Option<RefrigerationParameters>,
    /// Conductance of each exchanger of the refrigerant loop; that of a front-end exchanger is its own [W/K].
    pub exchanger_ua_w_k: Vec<f64>,
    /// The plant's own controls.
    pub controls: PlantControlParameters,
}

/// A cabin with its share of sun and people.
#[derive(Debug, Clone, PartialEq)]
pub struct CabinShare {
    /// Cabin.
    pub parameters: CabinParameters,
    /// Share of the solar heat that it gets [-].
    pub solar_share: f64,
    /// Share of the people that sit in it [-].
    pub occupant_share: f64,
}

parameters! {
    /// Controls that belong to the plant itself.
    pub struct PlantControlParameters {
        /// Constant 12 V load without pumps, blower and fan [W].
        auxiliary_power_w: f64 = 0.0 .. 5000.0,
        ;
        /// Thermal switches.
        thermal_switch: SwitchParameters,
        /// Compressor power against condensing pressure (`PID_pressureControl`), W per bar.
        pressure_pid: PidParameters,
    }
}

/// Reads the architecture of a name or path.
///
/// # Errors
/// There is none, or it has a flaw.
pub fn architecture(name: &str) -> PlantResult<Layout> {
    let table = library::table(ARCHITECTURE, name, &[])?;
    let declaration: Declaration = deserialized(name, "", Value::Table(table))?;
    let layout = Layout::of(&declaration).map_err(|flaw| in_file(flaw, name))?;
    check_names(&layout).map_err(|flaw| in_file(flaw, name))?;
    Ok(layout)
}

fn in_file(flaw: Flaw, name: &str) -> PlantError {
    Violation { key: flaw.key, value: flaw.value, allowed: flaw.allowed }.in_file(name)
}

/// Checks that no two actuators, and no two columns or energies, have the same name.
fn check_names(layout: &Layout) -> Result<(), Flaw> {
    let signals = SignalTable::of(layout);
    let columns = signals.rows().iter().map(|signal| signal.name.clone());
    let energies = layout.flows.iter().map(FlowRow::energy_column);
    let actuators = layout.actuators.iter().map(|actuator| actuator.name.clone());
    let groups: [(&str, Vec<String>); 3] =
        [("actuator", actuators.collect()), ("column", columns.collect()), ("total", energies.collect())];
    for (what, names) in groups {
        let again = names.iter().enumerate().find(|(place, name)| names[..*place].contains(name));
        if let Some((_, name)) = again {
            let allowed = format!(
                "no two may have the same {what}: one of those that it is made of needs another name"
            );
            return Err(Flaw::new(what, format!("`{name}` twice"), allowed));
        }
    }
    Ok(())
}

/// Names of the members of all built-in architectures.
#[must_use]
pub fn built_in_members() -> &'static [String] {
    static MEMBERS: OnceLock<Vec<String>> = OnceLock::new();
    MEMBERS.get_or_init(|| {
        let layouts = library::names(ARCHITECTURE).into_iter().filter_map(|name| architecture(name).ok());
        let mut members: Vec<String> =
            layouts.flat_map(|layout| layout.members.into_iter().map(|member| member.name)).collect();
        members.sort_unstable();
        members.dedup();
        members
    })
}

/// Names of all that may have a temperature of its own at the start in a layout: members, loops, nodes, the windscreen.
#[must_use]
pub fn masses(layout: &Layout) -> Vec<&str> {
    let members = layout.members.iter().filter(|member| member.node.is_some());
    let mut names: Vec<&str> = members.map(|member| member.name.as_str()).collect();
    names.extend(layout.loops.iter().map(|circuit| circuit.name.as_str()));
    names.extend(layout.nodes.iter().map(|node| node.stem.as_str()));
    names.push(WINDSCREEN);
    names.sort_unstable();
    names.dedup();
    names
}

/// Names of the masses of all built-in architectures.
#[must_use]
pub fn built_in_masses() -> &'static [String] {
    static MASSES: OnceLock<Vec<String>> = OnceLock::new();
    MASSES.get_or_init(|| {
        let layouts = library::names(ARCHITECTURE).into_iter().filter_map(|name| architecture(name).ok());
        let mut names: Vec<String> = layouts
            .flat_map(|layout| masses(&layout).into_iter().map(str::to_owned).collect::<Vec<_>>())
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    })
}

impl VehicleParameters {
    /// Loads a vehicle by name or path.
    ///
    /// # Errors
    /// Anything wrong in its file, its architecture or an override.
    pub fn load(name: &str, overrides: &[Override]) -> PlantResult<Self> {
        let table = library::table(VEHICLE, name, overrides)?;
        let own = library::own_table(VEHICLE, name, overrides)?;
        Reader { file: name, table, own }.read()
    }

    /// Parameters of the cabin that counts for comfort.
    #[must_use]
    pub fn cabin(&self) -> &CabinParameters {
        &self.cabins[0].parameters
    }
}

/// A vehicle's table while it is taken apart.
struct Reader<'a> {
    file: &'a str,
    table: Table,
    /// What the file itself and overrides give, that of its base left out.
    own: Table,
}

impl Reader<'_> {
    fn read(mut self) -> PlantResult<VehicleParameters> {
        let description = self.text("description")?;
        let architecture_name = match self.table.remove("architecture") {
            None => DEFAULT_ARCHITECTURE.to_owned(),
            Some(value) => deserialized(self.file, "architecture", value)?,
        };
        let layout = self.architecture(&architecture_name)?;
        let cabins = self.cabins(&layout)?;
        let refrigerant = self.refrigerant(&layout)?;
        let (refrigeration, exchanger_ua_w_k) = self.refrigeration(&layout, refrigerant.as_deref())?;
        let parameters = VehicleParameters {
            description,
            architecture: architecture_name,
            refrigerant,
            body: self.section("body")?,
            regeneration: self.section("regeneration")?,
            battery: self.section("battery")?,
            controls: self.section("controls")?,
            motor: self.one(&layout, MemberKind::Motor)?,
            transmission: self.one(&layout, MemberKind::Transmission)?,
            cabins,
            loops: self.loops(&layout)?,
            heaters: layout
                .heaters
                .iter()
                .map(|heater| self.section(&heater.name))
                .collect::<PlantResult<_>>()?,
            stores: self.passive_masses(&layout)?,
            air_streams: self.air_streams(&layout)?,
            front_ends: self.each(&layout, MemberKind::FrontEnd)?,
            plates: self.plates(&layout)?,
            refrigeration,
            exchanger_ua_w_k,
            layout: Arc::new(layout),
        };
        self.nothing_left(&architecture_name_of(&parameters), &parameters.layout)?;
        parameters.check().map_err(|violation| violation.in_file(self.file))?;
        Ok(parameters)
    }

    /// The architecture of a name or path; one that is not known is an error of this file.
    fn architecture(&self, name: &str) -> PlantResult<Layout> {
        architecture(name).map_err(|error| match error {
            PlantError::Unknown { .. } => {
                let allowed =
                    format!("{}, or be the path of a .toml file", among(&library::names(ARCHITECTURE), name));
                Violation::new("architecture", format!("`{name}`"), allowed).in_file(self.file)
            }
            error => error.named_by(self.file),
        })
    }

    fn text(&mut self, key: &str) -> PlantResult<String> {
        let value = library::take(self.file, &mut self.table, key)?;
        deserialized(self.file, key, value)
    }

    fn section<T: serde::de::DeserializeOwned + Validate>(&mut self, section: &str) -> PlantResult<T> {
        library::read_section(self.file, &mut self.table, section)
    }

    /// Sections of all members of a kind, in the layout's order.
    fn each<T: serde::de::DeserializeOwned + Validate>(
        &mut self,
        layout: &Layout,
        kind: MemberKind,
    ) -> PlantResult<Vec<T>> {
        let members = layout.members.iter().filter(|member| member.kind == kind);
        members.map(|member| self.section(&member.section)).collect()
    }

    /// Numbers of the masses that produce no heat, in the layout's order.
    fn passive_masses(&mut self, layout: &Layout) -> PlantResult<Vec<ThermalMass>> {
        let mut masses = Vec::new();
        for mass in &layout.masses {
            let member = &layout.members[mass.member];
            if let Some(read) = member.kind.data().read {
                let value = library::take(self.file, &mut self.table, &member.section)?;
                masses.push(read(self.file, &member.section, value)?);
            }
        }
        Ok(masses)
    }

    fn one<T: serde::de::DeserializeOwned + Validate>(
        &mut self,
        layout: &Layout,
        kind: MemberKind,
    ) -> PlantResult<T> {
        let section = layout.members.iter().find(|member| member.kind == kind).map(|member| &member.section);
        self.section(section.map_or("", String::as_str))
    }

    fn loops(&mut self, layout: &Layout) -> PlantResult<Vec<LoopParameters>> {
        let mut loops = Vec::with_capacity(layout.loops.len());
        for (place, circuit) in layout.loops.iter().enumerate() {
            self.drop_inherited_shares(layout, place);
            let parameters: LoopParameters = self.section(&circuit.name)?;
            let parallel = |member: &str| {
                let own = |branch: &&crate::architecture::layout::BranchLayout| {
                    branch.circuit == place && !branch.series && layout.members[branch.member].name == member
                };
                layout.branches.iter().find(own).is_some()
            };
            if let Some(other) =
                parameters.circuit.branch_shares.shares.keys().find(|member| !parallel(member))
            {
                let members =
                    layout.branches.iter().filter(|branch| branch.circuit == place && !branch.series);
                let names: Vec<&str> =
                    members.map(|branch| layout.members[branch.member].name.as_str()).collect();
                let key = format!("{}.circuit.branch_shares", circuit.name);
                return Err(
                    Violation::new(key, format!("for `{other}`"), among(&names, other)).in_file(self.file)
                );
            }
            loops.push(parameters);
        }
        Ok(loops)
    }

    /// Shares of branches that the base has and this architecture does not, unless the file itself gives them.
    fn drop_inherited_shares(&mut self, layout: &Layout, place: usize) {
        let circuit = &layout.loops[place];
        let shares_of = |section: &Value| section.get("circuit")?.get("branch_shares")?.as_table().cloned();
        let own = self.own.get(&circuit.name).and_then(shares_of).unwrap_or_default();
        let shares = self
            .table
            .get_mut(&circuit.name)
            .and_then(|section| section.get_mut("circuit")?.get_mut("branch_shares")?.as_table_mut());
        if let Some(shares) = shares {
            shares.retain(|member, _| {
                member == "closed_branches"
                    || own.contains_key(member)
                    || layout.branches.iter().any(|branch| {
                        branch.circuit == place
                            && !branch.series
                            && layout.members[branch.member].name == *member
                    })
            });
        }
    }

    fn cabins(&mut self, layout: &Layout) -> PlantResult<Vec<CabinShare>> {
        let mut cabins = Vec::with_capacity(layout.cabins.len());
        for (place, cabin) in layout.cabins.iter().enumerate() {
            let section = layout.members[cabin.member].section.clone();
            let mut share = |key: &str| -> PlantResult<f64> {
                // That of the cabin that counts for comfort follows from the others'; there the key is unknown.
                let others = if place > 0 { self.table.get_mut(&section) } else { None };
                let value = others.and_then(|section| section.as_table_mut()?.remove(key));
                let Some(value) = value else { return Ok(0.0) };
                let path = format!("{section}.{key}");
                let share: f64 = deserialized(self.file, &path, value)?;
                check_range(&path, share, 0.0, 1.0).map_err(|violation| violation.in_file(self.file))?;
                Ok(share)
            };
            let (solar_share, occupant_share) = (share("solar_share")?, share("occupant_share")?);
            cabins.push(CabinShare { parameters: self.section(&section)?, solar_share, occupant_share });
        }
        // The one that counts for comfort has what the others leave.
        let others = |read: fn(&CabinShare) -> f64| cabins[1..].iter().map(read).sum::<f64>();
        (cabins[0].solar_share, cabins[0].occupant_share) =
            (1.0 - others(|cabin| cabin.solar_share), 1.0 - others(|cabin| cabin.occupant_share));
        Ok(cabins)
    }

    /// Air of each front-end exchanger: in the section of the stream that it shares, or in a part `air` of its own section.
    fn air_streams(&mut self, layout: &Layout) -> PlantResult<Vec<AirStreamParameters>> {
        let mut read: Vec<(String, AirStreamParameters)> = Vec::new();
        let mut streams = Vec::with_capacity(layout.front_ends.len());
        for front_end in &layout.front_ends {
            let section = &layout.members[front_end.member].section;
            let parts = self.table.get_mut(section).and_then(Value::as_table_mut);
            let own = parts.and_then(|parts| parts.remove(AIR));
            let path = format!("{section}.{AIR}");
            let Some(name) = &front_end.stream else {
                let message = format!("`{path}` is missing");
                let own = own.ok_or_else(|| PlantError::Syntax { file: self.file.to_owned(), message })?;
                let air: AirStreamParameters = deserialized(self.file, &path, own)?;
                air.validate().map_err(|violation| violation.within(&path).in_file(self.file))?;
                streams.push(air);
                continue;
            };
            // What only the base has is of no use here.
            let given = self.own.get(section).and_then(|section| section.get(AIR));
            if given.is_some() {
                let allowed = format!("must stand in `{name}`, the air that `{section}` shares");
                return Err(Violation::new(path, "given", allowed).in_file(self.file));
            }
            if !read.iter().any(|(known, _)| known == name) {
                let parameters = self.section(name)?;
                read.push((name.clone(), parameters));
            }
            streams.extend(read.iter().find(|(known, _)| known == name).map(|(_, stream)| stream.clone()));
        }
        Ok(streams)
    }

    fn plates(&mut self, layout: &Layout) -> PlantResult<Vec<Option<LiquidPlateParameters>>> {
        let plate = |member: &crate::architecture::layout::MemberLayout| match member.kind {
            MemberKind::Plate => self.section(&member.section).map(Some),
            _ => Ok(None),
        };
        layout.members.iter().map(plate).collect()
    }

    /// Name or path of the refrigerant, if the architecture has use for one.
    fn refrigerant(&mut self, layout: &Layout) -> PlantResult<Option<String>> {
        if !layout.refrigerates() {
            return Ok(None);
        }
        let name = self.text("refrigerant")?;
        match refrigerant::refusal(&name) {
            None => Ok(Some(name)),
            Some(allowed) => {
                Err(Violation::new("refrigerant", format!("`{name}`"), allowed).in_file(self.file))
            }
        }
    }

    /// Gives the section those limits of the fluid that it does not have itself.
    fn add_fluid_limits(&self, section: &mut Table, refrigerant: &str) -> PlantResult<()> {
        let holds = |keys: &[&str]| {
            let (last, sections) = keys.split_last()?;
            let inner = sections.iter().try_fold(&*section, |table, key| table.get(*key)?.as_table());
            inner?.get(*last)
        };
        let Some(keys) = FLUID_LIMITS.iter().find(|keys| holds(&keys[1..]).is_none()) else { return Ok(()) };
        let limits = RefrigerantTable::limits_of(refrigerant).map_err(|error| error.named_by(self.file))?;
        let Some(limits) = limits else {
            let allowed = format!(
                "must be given: the table of refrigerant `{refrigerant}` has no limits in its header (make_table.py writes them)"
            );
            return Err(Violation::new(keys.join("."), "missing", allowed).in_file(self.file));
        };
        let mut whole = limits.section();
        library::merge(&mut whole, std::mem::take(section));
        *section = whole;
        Ok(())
    }

    fn refrigeration(
        &mut self,
        layout: &Layout,
        refrigerant: Option<&str>,
    ) -> PlantResult<(Option<RefrigerationParameters>, Vec<f64>)> {
        let Some(refrigerant) = refrigerant else { return Ok((None, Vec::new())) };
        let value = library::take(self.file, &mut self.table, "refrigeration")?;
        let Value::Table(mut section) = value else {
            return Err(Violation::new("refrigeration", value, "must be a section").in_file(self.file));
        };
        self.add_fluid_limits(&mut section, refrigerant)?;
        let mut conductances_w_k = Vec::with_capacity(layout.exchangers.len());
        for exchanger in &layout.exchangers {
            let key = format!("{}_ua_w_k", exchanger.name);
            let path = format!("refrigeration.{key}");
            if matches!(exchanger.side, ExchangerSide::FrontEnd(_)) {
                conductances_w_k.push(0.0);
                continue;
            }
            let value = section.remove(&key).ok_or_else(|| PlantError::Syntax {
                file: self.file.to_owned(),
                message: format!("`{path}` is missing"),
            })?;
            let conductance_w_k: f64 = deserialized(self.file, &path, value)?;
            let (low, high) = EXCHANGER_UA_RANGE_W_K;
            check_range(&path, conductance_w_k, low, high)
                .map_err(|violation| violation.in_file(self.file))?;
            conductances_w_k.push(conductance_w_k);
        }
        // Conductances of exchangers that only the base has.
        let own = self.own.get("refrigeration").and_then(Value::as_table);
        section.retain(|key, _| !key.ends_with("_ua_w_k") || own.is_some_and(|own| own.contains_key(key)));
        let parameters: RefrigerationParameters =
            deserialized(self.file, "refrigeration", Value::Table(section))?;
        let checked = parameters.validate().map_err(|violation| violation.within("refrigeration"));
        checked.map_err(|violation| violation.in_file(self.file))?;
        Ok((Some(parameters), conductances_w_k))
    }

    /// What the file itself gives beyond what its architecture has is an error; what its base has is left out.
    fn nothing_left(&self, architecture: &str, layout: &Layout) -> PlantResult<()> {
        let Some(key) = self.table.keys().find(|key| self.own.contains_key(*key)) else { return Ok(()) };
        let mut known: Vec<String> = VEHICLE_SECTIONS.iter().map(|&section| section.to_owned()).collect();
        known.extend(["description", "refrigerant", "architecture", "base"].map(str::to_owned));
        known.extend(layout.sections());
        known.dedup();
        let names: Vec<&str> = known.iter().map(String::as_str).collect();
        let message = format!(
            "`{key}` is given, but architecture `{architecture}` has no such part: {}",
            among(&names, key)
        );
        Err(PlantError::Syntax { file: self.file.to_owned(), message })
    }
}

fn architecture_name_of(parameters: &VehicleParameters) -> String {
    parameters.architecture.clone()
}

impl VehicleParameters {
    /// What single ranges cannot tell.
    fn check(&self) -> Result<(), Violation> {
        orders::check(self)?;
        let switch = &self.controls.thermal_switch;
        if switch.opening_difference_k > switch.closing_difference_k {
            return Err(Violation::new(
                "controls.thermal_switch.opening_difference_k",
                switch.opening_difference_k,
                format!("must not exceed closing_difference_k ({})", switch.closing_difference_k),
            ));
        }
        if self.motor.derating_end_degc <= self.motor.derating_start_degc {
            return Err(Violation::new(
                "motor.derating_end_degc",
                self.motor.derating_end_degc.0,
                format!("must be above derating_start_degc ({})", self.motor.derating_start_degc.0),
            ));
        }
        for (circuit, parameters) in self.layout.loops.iter().zip(&self.loops) {
            let Some(exchanger) = circuit.exchanger else { continue };
            let (key, limit) = match self.layout.exchangers[exchanger].level {
                crate::architecture::declaration::Level::Condensing => {
                    ("maximum_supply_degc", parameters.maximum_supply_degc)
                }
                crate::architecture::declaration::Level::Evaporating => {
                    ("minimum_supply_degc", parameters.minimum_supply_degc)
                }
            };
            if limit.is_none() {
                let name = &self.layout.exchangers[exchanger].name;
                let allowed = format!("must be given: it is the limit that `{name}` keeps");
                return Err(Violation::new(format!("{}.{key}", circuit.name), "missing", allowed));
            }
        }
        let battery = &self.battery;
        for (section, limit) in [
            ("battery.charge_limit", &battery.charge_limit),
            ("battery.discharge_limit", &battery.discharge_limit),
        ] {
            let checked = limit.check_memory(battery.rate_memory_s);
            checked.map_err(|violation| violation.within(section))?;
        }
        let shared = self.cabins[0].solar_share.min(self.cabins[0].occupant_share);
        if shared < 0.0 {
            let allowed =
                "must not add up to more than 1 in the cabins besides the one that counts for comfort";
            return Err(Violation::new(
                "solar_share, occupant_share",
                format!("{} in sum", 1.0 - shared),
                allowed,
            ));
        }
        for branch in self.layout.branches.iter().filter(|branch| matches!(branch.side, BranchSide::Plate(_)))
        {
            debug_assert!(self.plates[branch.member].is_some(), "each plate has a section");
        }
        Ok(())
    }
}
