//! Parameters of body, regeneration, motor and transmission.

use super::Celsius;
use crate::parameters;

parameters! {
    /// Longitudinal dynamics.
    pub struct BodyParameters {
        /// Mass with driver [kg].
        mass_kg: f64 = 300.0 .. 40000.0,
        /// Rotating inertia as a share of the mass [-].
        rotating_mass_share: f64 = 0.0 .. 0.3,
        /// Drag coefficient times frontal area [m2].
        drag_area_m2: f64 = 0.1 .. 10.0,
        /// Rolling resistance coefficient [-].
        rolling_resistance_coefficient: f64 = 0.001 .. 0.05,
    }
}

parameters! {
    /// Regenerative braking at the wheels; the battery's charge limit comes on top.
    pub struct RegenerationParameters {
        /// Largest share of the braking power that the motor takes [-].
        maximum_share: f64 = 0.0 .. 1.0,
        /// Largest braking power of the motor, at the wheels [W].
        maximum_wheel_power_w: f64 = 0.0 .. 500000.0,
        /// Speed below which recuperation fades linearly to zero [m/s].
        fade_speed_m_s: f64 = 0.1 .. 10.0,
    }
}

parameters! {
    /// Motor and inverter: losses, one thermal mass.
    pub struct MotorParameters {
        /// Loss whenever the vehicle moves [W].
        constant_loss_w: f64 = 0.0 .. 5000.0,
        /// Loss per vehicle speed [W/(m/s)].
        speed_loss_w_s_m: f64 = 0.0 .. 500.0,
        /// Loss per shaft power [-].
        proportional_loss: f64 = 0.0 .. 0.5,
        /// Loss per squared shaft power [1/W].
        quadratic_loss_per_w: f64 = 0.0 .. 0.00001,
        /// Heat capacity of motor and inverter [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 1000000.0,
        /// Conductance to ambient at standstill [W/K].
        ambient_conductance_w_k: f64 = 0.0 .. 200.0,
        /// Its increase with vehicle speed [W/K per m/s].
        ambient_conductance_per_speed_w_s_k_m: f64 = 0.0 .. 20.0,
        /// Coolant jacket conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 5000.0,
    }
}

parameters! {
    /// Transmission and driveline: losses that depend on the oil temperature, one thermal mass.
    pub struct TransmissionParameters {
        /// Load-proportional (mesh) loss [-].
        mesh_loss_share: f64 = 0.0 .. 0.2,
        /// Spin-loss force at the wheels at the reference oil temperature [N].
        spin_loss_force_n: f64 = 0.0 .. 500.0,
        /// Oil temperature of that force [degC].
        spin_loss_reference_degc: Celsius = 0.0 .. 100.0,
        /// Temperature rise that divides the spin loss by e [K].
        viscosity_temperature_k: f64 = 5.0 .. 200.0,
        /// Heat capacity of housing, gears and oil [J/K].
        heat_capacity_j_k: f64 = 1000.0 .. 1000000.0,
        /// Conductance to ambient at standstill [W/K].
        ambient_conductance_w_k: f64 = 0.0 .. 200.0,
        /// Its increase with vehicle speed [W/K per m/s].
        ambient_conductance_per_speed_w_s_k_m: f64 = 0.0 .. 20.0,
        /// Oil-cooler conductance [W/K].
        coolant_ua_w_k: f64 = 1.0 .. 5000.0,
    }
}
