//! Actuators of an architecture, a row each: what a command holds one value for.

/// How an actuator reads its normalised value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scale {
    /// One of several options, equal parts of `[-1, 1]`.
    Choice(Vec<String>),
    /// Linear between the ends of its range.
    Linear,
    /// Off below -0.9, then from lowest to highest value evenly in the logarithm.
    OffThenLogarithmic,
}

/// What an actuator acts on, by position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// Connection of a member.
    Connection(usize),
    /// Whether a heater may heat.
    Heater(usize),
    /// Valve of an exchanger of the refrigerant loop.
    ExchangerValve(usize),
    /// Power of the compressor.
    Compressor,
    /// Recirculated share of a cabin's supply air.
    Recirculation(usize),
    /// Blower of a cabin.
    Blower(usize),
    /// Share of a cabin's supply air that is blown at the windscreen.
    Windscreen(usize),
    /// Coolant flow of a loop.
    LoopFlow(usize),
    /// Heat flow requested of a member's connection.
    Request(usize),
    /// Valve of a member's branch.
    Valve(usize),
    /// Cabin temperature that heaters aim at.
    CabinSetPoint,
}

/// One actuator: a row of the command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ActuatorRow {
    /// Name used in files, tables and action spaces.
    pub name: String,
    /// Unit of the physical value.
    pub unit: &'static str,
    /// How the normalised value is read.
    pub scale: Scale,
    /// What it does.
    pub description: String,
    /// What it acts on.
    pub purpose: Purpose,
}

impl ActuatorRow {
    /// A choice between options.
    pub fn choice(
        name: impl Into<String>,
        options: Vec<String>,
        purpose: Purpose,
        description: String,
    ) -> Self {
        Self { name: name.into(), unit: "-", scale: Scale::Choice(options), description, purpose }
    }

    /// A level between the ends of a range.
    pub fn level(name: impl Into<String>, unit: &'static str, purpose: Purpose, description: String) -> Self {
        Self { name: name.into(), unit, scale: Scale::Linear, description, purpose }
    }

    /// Whether it moves heat: connections, heaters, valves of exchangers, compressor.
    #[must_use]
    pub fn moves_heat(&self) -> bool {
        matches!(
            self.purpose,
            Purpose::Connection(_) | Purpose::Heater(_) | Purpose::ExchangerValve(_) | Purpose::Compressor
        )
    }

    /// Whether agents control it unless they say otherwise: what moves heat, and the air of cabins.
    #[must_use]
    pub fn by_default(&self) -> bool {
        let air =
            matches!(self.purpose, Purpose::Recirculation(_) | Purpose::Blower(_) | Purpose::Windscreen(_));
        self.moves_heat() || air
    }

    /// Options of a choice; none for a level.
    #[must_use]
    pub fn options(&self) -> &[String] {
        match &self.scale {
            Scale::Choice(options) => options,
            Scale::Linear | Scale::OffThenLogarithmic => &[],
        }
    }
}
