//! Parameters of the cabin.

use super::Celsius;
use crate::parameters;

parameters! {
    /// Cabin: large and small air volume, soft and hard furnishings, panels, ventilation.
    pub struct CabinParameters {
        /// Heat capacity of the large air volume with light trim [J/K].
        air_heat_capacity_j_k: f64 = 500.0 .. 200000.0,
        /// Heat capacity of the small exhaust volume [J/K].
        exhaust_heat_capacity_j_k: f64 = 10.0 .. 20000.0,
        /// Heat capacity of the soft furnishings [J/K].
        soft_heat_capacity_j_k: f64 = 1000.0 .. 2000000.0,
        /// Conductance air to soft furnishings [W/K].
        soft_conductance_w_k: f64 = 0.1 .. 1000.0,
        /// Heat capacity of the hard furnishings [J/K].
        hard_heat_capacity_j_k: f64 = 1000.0 .. 2000000.0,
        /// Conductance air to hard furnishings [W/K].
        hard_conductance_w_k: f64 = 0.1 .. 1000.0,
        /// Panel conductance to ambient at standstill [W/K].
        panel_conductance_w_k: f64 = 0.0 .. 500.0,
        /// Its increase with vehicle speed [W/K per m/s].
        panel_conductance_per_speed_w_s_k_m: f64 = 0.0 .. 20.0,
        /// Air mass flow at full blower level [kg/s].
        maximum_air_flow_kg_s: f64 = 0.01 .. 1.0,
        /// Smallest air mass flow while the blower runs [kg/s].
        minimum_air_flow_kg_s: f64 = 0.001 .. 0.5,
        /// Electrical power of the blower at full level; it warms the supply air [W].
        maximum_blower_power_w: f64 = 0.0 .. 2000.0,
        /// Heater-core conductance [W/K].
        heater_core_ua_w_k: f64 = 1.0 .. 2000.0,
        /// Cooling-core conductance [W/K].
        cooling_core_ua_w_k: f64 = 1.0 .. 2000.0,
        /// Fresh air that each occupant (at least one) must have [kg/s] (ours).
        minimum_fresh_air_per_occupant_kg_s: f64 = 0.0 .. 0.05,
        /// Largest recirculated share of the supply air [-] (ours).
        maximum_recirculation: f64 = 0.0 .. 0.95,
        /// Air temperature below which the cooling core is not driven, because it would ice up [degC] (ours).
        minimum_cooled_air_degc: Celsius = -5.0 .. 15.0,
        /// Share of the exhaust heat that can be recovered (paper section 2.2: up to 30 %) [-].
        exhaust_recovery_share: f64 = 0.0 .. 0.95,
        /// Sensible heat of one occupant [W].
        occupant_heat_w: f64 = 0.0 .. 300.0,
    }
}
