//! Columns that a trace may have: name with unit, quantity, allowed values.

/// What a column tells of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Time.
    Time,
    /// Speed of the vehicle.
    Speed,
    /// Slope of the road.
    Grade,
    /// Height of the road.
    Elevation,
    /// Temperature of ambient air.
    Ambient,
    /// Relative humidity of ambient air.
    Humidity,
    /// Irradiance of the sun.
    Sun,
    /// Wind against the vehicle.
    Headwind,
    /// Cabin temperature that the driver asks for.
    CabinSetPoint,
    /// Blower level that the driver asks for.
    Blower,
    /// Recirculated share that the driver asks for.
    Recirculation,
    /// People in the cabin.
    Occupants,
    /// Measured power of the battery, positive while discharging.
    BatteryPower,
    /// Measured power of the heater.
    HeaterPower,
    /// Measured temperature of the cabin.
    CabinTemperature,
    /// Measured temperature of the battery.
    BatteryTemperature,
}

/// A column that a trace may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Name with its unit.
    pub name: &'static str,
    /// What it tells of; a trace has each quantity once.
    pub quantity: Quantity,
    /// Lowest value allowed, in its unit.
    pub low: f64,
    /// Highest value allowed.
    pub high: f64,
}

const fn column(name: &'static str, quantity: Quantity, low: f64, high: f64) -> Column {
    Column { name, quantity, low, high }
}

/// Span of a trace's time, at most [s].
pub const LONGEST_S: f64 = 1e6;

/// All columns. Speeds end at 300 km/h; ambient, set points and occupants have the ranges of their keys in scenarios.
pub const COLUMNS: &[Column] = &[
    column("time_s", Quantity::Time, f64::NEG_INFINITY, f64::INFINITY),
    column("speed_km_h", Quantity::Speed, 0.0, 300.0),
    column("speed_m_s", Quantity::Speed, 0.0, 83.4),
    column("speed_mph", Quantity::Speed, 0.0, 186.5),
    column("grade_pct", Quantity::Grade, -40.0, 40.0),
    column("elevation_m", Quantity::Elevation, -500.0, 9000.0),
    column("ambient_degc", Quantity::Ambient, -50.0, 60.0),
    column("relative_humidity_pct", Quantity::Humidity, 0.0, 100.0),
    column("solar_w_m2", Quantity::Sun, 0.0, 1500.0),
    column("wind_m_s", Quantity::Headwind, -60.0, 60.0),
    column("cabin_set_point_degc", Quantity::CabinSetPoint, 10.0, 30.0),
    column("blower_level", Quantity::Blower, 0.0, 1.0),
    column("recirculation", Quantity::Recirculation, 0.0, 1.0),
    column("occupants", Quantity::Occupants, 0.0, 9.0),
    column("measured_battery_power_w", Quantity::BatteryPower, -1e6, 1e6),
    column("measured_heater_power_w", Quantity::HeaterPower, -1e3, 1e5),
    column("measured_cabin_temperature_degc", Quantity::CabinTemperature, -60.0, 100.0),
    column("measured_battery_temperature_degc", Quantity::BatteryTemperature, -60.0, 100.0),
];

/// Quantities of which a trace may have one only: both say how steep the road is.
pub const EITHER_OR: (Quantity, Quantity) = (Quantity::Grade, Quantity::Elevation);

/// Unit of a speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpeedUnit {
    /// Kilometres an hour.
    KmH,
    /// Metres a second.
    MS,
    /// Miles an hour.
    Mph,
}

impl SpeedUnit {
    /// A speed of this unit [m/s].
    #[must_use]
    pub fn m_s(self, speed: f64) -> f64 {
        match self {
            Self::KmH => speed / 3.6,
            Self::MS => speed,
            // A mile has 1609.344 m.
            Self::Mph => speed * 0.447_04,
        }
    }
}

/// Columns of speed with their units.
pub const SPEEDS: &[(SpeedUnit, &str)] =
    &[(SpeedUnit::KmH, "speed_km_h"), (SpeedUnit::MS, "speed_m_s"), (SpeedUnit::Mph, "speed_mph")];
