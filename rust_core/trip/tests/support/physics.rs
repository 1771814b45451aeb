//! What no step of any vehicle may break, worked out again from states, flows and parameters.

use super::{Step, TOLERANCE};
use hp_plant::architecture::declaration::Level;
use hp_plant::architecture::layout::{BranchSide, ExchangerSide};
use hp_plant::circuits::refrigeration_cycle::RefrigerationCycle;
use hp_plant::components::cabin::Ventilation;
use hp_plant::components::frost::FrostEffect;
use hp_plant::components::heat_exchanger::inlet_conductance_w_k;
use hp_plant::components::refrigerant_exchanger::{CondenserStreams, EvaporatorStreams};
use hp_plant::flows::Flow;
use hp_plant::numerics::thermal_network::Node;

/// Rounding of heat flows that are worked out in another order [W].
const ROUNDING_W: f64 = 1e-6;

/// Everything that must hold in a step of any vehicle.
pub fn check(step: &Step<'_>) {
    let entry = step.record.ledger;
    assert!(entry.relative() < TOLERANCE, "at {} s: {entry:?}", step.after.time_s);
    check_air(step);
    check_finite(step);
    check_branches(step);
    check_limits(step);
    check_exchangers(step);
    check_supply_air(step);
}

/// Water of every cabin balances, counted from states and parameters; none of it is negative.
fn check_air(step: &Step<'_>) {
    let entry = step.record.water_ledger;
    assert!(entry.relative() < TOLERANCE, "at {} s: {entry:?}", step.after.time_s);
    for (place, share) in step.plant.vehicle.cabins.iter().enumerate() {
        let (air, water) = (&step.after.cabin_air[place], &step.record.water[place]);
        assert!(air.humidity_ratio >= 0.0 && air.humidity_ratio < 1.0, "{air:?}");
        assert!(air.co2 >= 419e-6 && air.co2 < 0.01, "{air:?}");
        assert!(
            air.film_kg >= 0.0 && water.core_kg_s >= 0.0 && water.drained_kg_s >= 0.0,
            "{air:?} {water:?}"
        );
        assert!((200.0..450.0).contains(&air.windscreen_k), "{air:?}");
        let stored_kg = |air| share.parameters.air.water_kg(air);
        let gained_kg = stored_kg(air) - stored_kg(&step.before.cabin_air[place]);
        let entered_kg_s = water.fresh_kg_s + water.occupants_kg_s;
        let left_kg_s = water.exhaust_kg_s + water.core_kg_s + water.drained_kg_s;
        let residual_kg = gained_kg - (entered_kg_s - left_kg_s);
        assert!(residual_kg.abs() < 1e-9 * (gained_kg.abs() + entered_kg_s + left_kg_s + 1e-6), "{water:?}");
    }
}

fn check_finite(step: &Step<'_>) {
    let layout = step.plant.layout();
    for (node, row) in layout.nodes.iter().enumerate() {
        let value_k = step.after.temperatures_k[node];
        assert!((200.0..450.0).contains(&value_k), "{} at {value_k} K", row.stem);
    }
    for row in &layout.flows {
        assert!(step.record.flows[row.flow].is_finite(), "{}", row.column);
    }
    let view = hp_plant::signals::View {
        plant: step.plant,
        state: step.after,
        record: Some(step.record),
        disturbance: step.disturbance,
    };
    for signal in step.plant.signals.rows() {
        assert!(signal.reader.read(&view).is_finite(), "{}", signal.name);
    }
}

/// Limits of pressure and supplies while the heat pump runs, COP below Carnot.
fn check_limits(step: &Step<'_>) {
    let (vehicle, result) = (&step.plant.vehicle, &step.record.refrigeration);
    let Some(refrigeration) = vehicle.refrigeration.as_ref().filter(|_| result.running()) else {
        assert_eq!((result.condenser_heat_flow_w, result.evaporator_heat_flow_w), (0.0, 0.0));
        return;
    };
    assert!(result.condensing_pressure_pa <= (refrigeration.maximum_pressure_bar + 0.05) * 1e5);
    for (circuit, parameters) in vehicle.layout.loops.iter().zip(&vehicle.loops) {
        let Some(exchanger) = circuit.exchanger else { continue };
        let supply_k = |state: &hp_plant::state::State| state.temperatures_k[circuit.supply.index()];
        let (before_k, after_k) = (supply_k(step.before), supply_k(step.after));
        let name = &circuit.name;
        match vehicle.layout.exchangers[exchanger].level {
            Level::Condensing => {
                let highest_k = parameters.maximum_supply_degc.expect("checked when loaded").kelvin();
                assert!(after_k <= (highest_k + 0.1).max(before_k), "{name} at {after_k} K");
            }
            Level::Evaporating => {
                let lowest_k = parameters.minimum_supply_degc.expect("checked when loaded").kelvin();
                assert!(after_k >= (lowest_k - 0.1).min(before_k), "{name} at {after_k} K");
            }
        }
    }
    let lift_k = result.condensing_temperature_k - result.evaporating_temperature_k;
    let carnot = result.condensing_temperature_k / lift_k;
    assert!(result.condenser_heat_flow_w < carnot * result.electric_power_w, "COP above Carnot: {result:?}");
}

/// Air of a cabin during a step, and the temperature at which it reaches the cores [K].
pub fn cabin_air(step: &Step<'_>, cabin: usize, state: &hp_plant::state::State) -> (Ventilation, f64) {
    let (layout, share) = (&step.plant.vehicle.layout.cabins[cabin], &step.plant.vehicle.cabins[cabin]);
    let demand = step.plant.ranges.decode(step.command);
    let occupants = step.disturbance.occupants * share.occupant_share;
    let (mut level, recirculation) = (demand[layout.blower_row], demand[layout.recirculation_row]);
    if step.before.short_of_power {
        level = 0.0;
    }
    let air = share.parameters.ventilation(level, recirculation, occupants);
    let (fresh, recirculated) = (1.0 - air.recirculation, air.recirculation);
    let cabin_k = state.temperatures_k[layout.air.index()];
    (air, fresh * step.disturbance.air.temperature_k + recirculated * cabin_k)
}

/// Air at a front-end exchanger: ambient, warmed in the second before by the exchangers before it and by frost that grows [K].
pub fn front_end_air_k(step: &Step<'_>, front_end: usize) -> f64 {
    let vehicle = &step.plant.vehicle;
    let mut air_k = step.disturbance.air.temperature_k + step.before.frosts[front_end].rise_k;
    let mut before = vehicle.layout.front_ends[front_end].behind;
    while let Some(other) = before {
        air_k += step.before.front_end_rise_k[other];
        before = vehicle.layout.front_ends[other].behind;
    }
    air_k
}

/// Air flow of a front-end exchanger [kg/s], by the power of the fan; none where several fans are at work.
pub fn front_end_flow_kg_s(step: &Step<'_>, front_end: usize) -> Option<f64> {
    let vehicle = &step.plant.vehicle;
    let stream = &vehicle.air_streams[front_end];
    let face_m_s =
        stream.ram_air_share * step.disturbance.frontal_air_speed_m_s(step.disturbance.mean_speed_m_s());
    let ram_m3_s = stream.core_area_m2 * face_m_s.hypot(0.1);
    let fan_w = step.record.flows[Flow::FAN];
    let fans = vehicle.layout.front_ends.iter().filter(|end| end.behind.is_none()).count();
    let level = if fan_w > 0.0 { (fan_w / stream.fan_power_w).cbrt() } else { 0.0 };
    let flow_m3_s = ram_m3_s.hypot(level * stream.fan_air_flow_m3_s);
    let frosted = frost_effect(step, front_end).flow_share;
    (fans == 1 || fan_w == 0.0).then_some(flow_m3_s * frosted * step.disturbance.air.density_kg_m3)
}

fn frost_effect(step: &Step<'_>, front_end: usize) -> FrostEffect {
    step.plant.vehicle.front_ends[front_end].frost.effect(step.before.frosts[front_end].mass_kg)
}

/// No branch carries heat from cold to hot, by the temperatures at the end of the step.
fn check_branches(step: &Step<'_>) {
    let layout = step.plant.layout();
    let end_k = |node: Node| step.after.temperatures_k[node.index()];
    for branch in layout.branches.iter().filter(|branch| !branch.series) {
        let supply_k = end_k(layout.loops[branch.circuit].supply);
        let other_k = match branch.side {
            BranchSide::Mass(node) => end_k(node),
            BranchSide::Ambient(front_end) => front_end_air_k(step, front_end),
            BranchSide::Core(cabin) => cabin_air(step, cabin, step.after).1,
            BranchSide::Plate(from) => end_k(layout.loops[from].back),
        };
        let difference_k = if branch.out_of_loop { supply_k - other_k } else { other_k - supply_k };
        let heat_w = step.record.flows[branch.flow];
        let member = &layout.members[branch.member].name;
        // With several sub-steps flows are means, so their sign is that of one sub-step only where there is one.
        assert!(
            heat_w * difference_k >= -1e-9 * (1.0 + heat_w.abs()),
            "{heat_w} W over {difference_k} K at {member} in {}",
            layout.loops[branch.circuit].name
        );
    }
}

/// Air behind the coolant core of a cabin at the beginning of a step [K]: the core's conductance follows from its heat and the
/// temperatures at the end.
fn behind_core_k(step: &Step<'_>, cabin: usize, rate_w_k: f64, inlet_k: f64) -> f64 {
    let layout = step.plant.layout();
    let own = &layout.cabins[cabin];
    [own.heater, own.cooler].into_iter().flatten().fold(inlet_k, |air_k, core| {
        let branch = &layout.branches[core];
        let supply = layout.loops[branch.circuit].supply.index();
        let heat_w = step.record.flows[branch.flow];
        if heat_w == 0.0 {
            return air_k;
        }
        let end_k = step.after.temperatures_k[supply] - cabin_air(step, cabin, step.after).1;
        let conductance_w_k = heat_w.abs() / end_k.abs();
        air_k + conductance_w_k / rate_w_k * (step.before.temperatures_k[supply] - inlet_k)
    })
}

/// What heats the supply air of a cabin, core and condenser, leaves it no warmer than the hotter of both; the same the other
/// way round for what cools it.
fn check_supply_air(step: &Step<'_>) {
    let layout = step.plant.layout();
    let result = &step.record.refrigeration;
    for (place, cabin) in layout.cabins.iter().enumerate() {
        for (level, core) in [(Level::Condensing, cabin.heater), (Level::Evaporating, cabin.cooler)] {
            let own =
                layout.exchangers.iter().find(|e| e.level == level && e.side == ExchangerSide::Cabin(place));
            let (Some(exchanger), Some(core)) = (own, core) else { continue };
            let branch = &layout.branches[core];
            let heats_w = (step.record.flows[exchanger.flow], step.record.flows[branch.flow]);
            if heats_w.0 <= 0.0 || heats_w.1 <= 0.0 {
                continue;
            }
            let (air, inlet_k) = cabin_air(step, place, step.before);
            let change_k = (heats_w.0 + heats_w.1) / air.supply_rate_w_k;
            let supply = layout.loops[branch.circuit].supply.index();
            let supplies_k = [step.before.temperatures_k[supply], step.after.temperatures_k[supply]];
            // A step's core heat is that of its end, the air that the exchanger meets that of its beginning.
            let room_k = match level {
                Level::Condensing => {
                    supplies_k[0].max(supplies_k[1]).max(result.condensing_temperature_k)
                        - (inlet_k + change_k)
                }
                Level::Evaporating => {
                    inlet_k
                        - change_k
                        - supplies_k[0].min(supplies_k[1]).min(result.evaporating_temperature_k)
                }
            };
            assert!(room_k > -2.0, "supply air {room_k} K beyond what heats or cools it: {heats_w:?} W");
        }
    }
}

/// Coolant or air at an exchanger of the refrigerant loop: inlet [K], capacity rate and conductance [W/K], where they are known.
pub fn stream(step: &Step<'_>, place: usize) -> Option<(f64, f64, f64)> {
    let vehicle = &step.plant.vehicle;
    let exchanger = &vehicle.layout.exchangers[place];
    let ua_w_k = vehicle.exchanger_ua_w_k[place];
    Some(match exchanger.side {
        ExchangerSide::Loop(circuit) => {
            let flow_kg_s = step.after.pumps[circuit].flow_kg_s;
            let rate_w_k = flow_kg_s * vehicle.loops[circuit].circuit.coolant_specific_heat_j_kg_k;
            let inlet_k = step.before.temperatures_k[vehicle.layout.loops[circuit].back.index()];
            (inlet_k, rate_w_k, inlet_conductance_w_k(rate_w_k, ua_w_k))
        }
        ExchangerSide::Cabin(cabin) => {
            let (air, inlet_k) = cabin_air(step, cabin, step.before);
            let inlet_k = behind_core_k(step, cabin, air.supply_rate_w_k, inlet_k);
            (inlet_k, air.supply_rate_w_k, inlet_conductance_w_k(air.supply_rate_w_k, ua_w_k))
        }
        ExchangerSide::FrontEnd(front_end) => {
            let flow_kg_s = front_end_flow_kg_s(step, front_end)?;
            let (own, frost) = (&vehicle.front_ends[front_end], frost_effect(step, front_end));
            let clean_w_k = own.ua_w_k * flow_kg_s.powf(0.6) * frost.air_share;
            let (rate_w_k, ua_w_k) = (1006.0 * flow_kg_s, 1.0 / (1.0 / clean_w_k + frost.layer_k_w));
            let disturbance = step.disturbance;
            let share = match exchanger.level {
                Level::Condensing => 1.0,
                Level::Evaporating => own
                    .frost
                    .capacity_share(disturbance.air.temperature_k, disturbance.ambient_humidity_ratio),
            };
            let conductance_w_k = share * inlet_conductance_w_k(rate_w_k, ua_w_k);
            (front_end_air_k(step, front_end), rate_w_k, conductance_w_k)
        }
    })
}

/// Each exchanger carries `G |T - inlet|` or nothing, never backwards, and no stream crosses in any of them.
fn check_exchangers(step: &Step<'_>) {
    let (Some(cycle), result) = (&step.plant.refrigeration, &step.record.refrigeration) else { return };
    if !result.running() {
        return;
    }
    let mut totals_w = [0.0; 2];
    for (place, exchanger) in step.plant.layout().exchangers.iter().enumerate() {
        let heat_w = step.record.flows[exchanger.flow];
        let hot = exchanger.level == Level::Condensing;
        totals_w[usize::from(!hot)] += heat_w;
        assert!(heat_w >= 0.0, "{} runs backwards: {heat_w} W", exchanger.name);
        if heat_w == 0.0 {
            continue;
        }
        let Some((inlet_k, rate_w_k, conductance_w_k)) = stream(step, place) else { continue };
        let room_k = if hot {
            result.condensing_temperature_k - inlet_k
        } else {
            inlet_k - result.evaporating_temperature_k
        };
        let expected_w = conductance_w_k * room_k;
        assert!(
            (heat_w - expected_w).abs() < 0.1 + 1e-6 * expected_w,
            "{}: {heat_w}, {expected_w}",
            exchanger.name
        );
        let margins = margins_k(cycle, step, hot, (inlet_k, rate_w_k, heat_w));
        assert!(margins.iter().all(|&margin| margin >= -1e-6), "{}: {margins:?} {result:?}", exchanger.name);
        let open = exchanger.valve_row.is_none_or(|row| step.plant.ranges.decode(step.command)[row] == 1.0);
        assert!(open, "{} is closed but carries {heat_w} W", exchanger.name);
        if let (ExchangerSide::Cabin(cabin), false) = (exchanger.side, hot) {
            let coldest_k = step.plant.vehicle.cabins[cabin].parameters.minimum_cooled_air_degc.kelvin();
            assert!(inlet_k - heat_w / rate_w_k > coldest_k - 1e-3, "{} ices up", exchanger.name);
        }
    }
    let expected = [result.condenser_heat_flow_w, result.evaporator_heat_flow_w];
    for (sum_w, expected_w) in totals_w.into_iter().zip(expected) {
        assert!((sum_w - expected_w).abs() < ROUNDING_W * (1.0 + expected_w), "{totals_w:?} {expected:?}");
    }
}

/// Temperature differences along one exchanger, which gets the refrigerant in proportion to its heat.
fn margins_k(
    cycle: &RefrigerationCycle,
    step: &Step<'_>,
    hot: bool,
    (coolant_inlet_k, capacity_rate_w_k, heat_w): (f64, f64, f64),
) -> Vec<f64> {
    let (result, table) = (&step.record.refrigeration, cycle.table());
    let isobar = table.condensing_isobar(result.condensing_temperature_k);
    let liquid_j_kg = isobar.liquid_enthalpy_j_kg(result.subcooling_k);
    let suction = table.suction_state(result.evaporating_temperature_k, result.superheat_k);
    let dew_j_kg = table.suction_state(result.evaporating_temperature_k, 0.0).enthalpy_j_kg;
    if !hot {
        let share = heat_w / result.evaporator_heat_flow_w * result.mass_flow_kg_s;
        let streams = EvaporatorStreams {
            coolant_inlet_k,
            capacity_rate_w_k,
            evaporating_k: result.evaporating_temperature_k,
            superheat_k: result.superheat_k,
            evaporation_w: share * (dew_j_kg - liquid_j_kg),
            superheating_w: share * (suction.enthalpy_j_kg - dew_j_kg),
        };
        return streams.margins_k().to_vec();
    }
    let share = heat_w / result.condenser_heat_flow_w * result.mass_flow_kg_s;
    let discharge_j_kg = liquid_j_kg + result.condenser_heat_flow_w / result.mass_flow_kg_s;
    let bubble_j_kg = isobar.liquid_enthalpy_j_kg(0.0);
    let streams = CondenserStreams {
        coolant_inlet_k,
        capacity_rate_w_k,
        discharge_k: result.discharge_temperature_k,
        condensing_k: result.condensing_temperature_k,
        subcooling_k: result.subcooling_k,
        desuperheating_w: share * (discharge_j_kg - isobar.dew_enthalpy_j_kg).max(0.0),
        condensation_w: share * (discharge_j_kg.min(isobar.dew_enthalpy_j_kg) - bubble_j_kg),
        subcooling_w: share * (bubble_j_kg - liquid_j_kg),
    };
    streams.margins_k().to_vec()
}
