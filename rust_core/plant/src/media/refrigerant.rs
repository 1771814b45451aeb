//! Refrigerant properties around saturation, from tables made with CoolProp.
//!
//! `configs/refrigerants/make_table.py` writes the tables; all values are SI, temperatures in kelvin.

use super::fluid_limits::{FluidLimits, supercritical_degc};
use crate::config::kinds::REFRIGERANT;
use crate::config::{ZERO_CELSIUS_K, library};
use crate::error::{PlantError, PlantResult};
use crate::numerics::cubic_table::CubicTable;
use crate::numerics::dual::{Dual, Real};
use crate::numerics::elementary;

/// Columns of the tables, without the temperature.
const COLUMN_NAMES: [&str; COLUMNS] = [
    "vapour_enthalpy_0",
    "vapour_enthalpy_1",
    "vapour_enthalpy_2",
    "vapour_enthalpy_3",
    "vapour_density_0",
    "vapour_density_1",
    "vapour_density_2",
    "vapour_density_3",
    "vapour_entropy_0",
    "vapour_entropy_1",
    "vapour_entropy_2",
    "vapour_entropy_3",
    "pressure_pa",
    "liquid_enthalpy_0",
    "liquid_enthalpy_1",
    "liquid_enthalpy_2",
    "liquid_enthalpy_3",
    "liquid_enthalpy_4",
    "liquid_enthalpy_5",
    "dew_enthalpy",
    "dew_entropy",
    "isobar_enthalpy_2",
    "isobar_enthalpy_3",
    "isobar_enthalpy_4",
    "isobar_temperature_1",
    "isobar_temperature_2",
    "isobar_temperature_3",
    "isobar_temperature_4",
    "isobar_temperature_5",
    "isobar_temperature_6",
    "isobar_temperature_7",
    "isobar_range",
];
const COLUMNS: usize = 32;
/// Pressure, the last column of the evaporating and the first of the condensing side.
const PRESSURE: usize = 12;
const EVAPORATING_COLUMNS: usize = PRESSURE + 1;
/// Pressure, liquid, dew point and isentropic compression.
const CONDENSING_COLUMNS: usize = 12;
const ISOBAR_TEMPERATURE: usize = 24;
const ISOBAR_TEMPERATURE_COLUMNS: usize = 8;

/// Superheated vapour at the compressor inlet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuctionState<T> {
    /// Evaporating pressure [Pa].
    pub pressure_pa: T,
    /// Enthalpy [J/kg].
    pub enthalpy_j_kg: T,
    /// Density [kg/m3].
    pub density_kg_m3: T,
    /// Entropy [J/(kg K)].
    pub entropy_j_kg_k: T,
}

/// Properties on the condensing isobar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CondensingIsobar<T> {
    /// Condensing temperature, held at the ends of the table [K].
    pub temperature_k: T,
    /// Condensing pressure [Pa].
    pub pressure_pa: T,
    /// Enthalpy of dry saturated vapour [J/kg].
    pub dew_enthalpy_j_kg: T,
    /// Entropy of dry saturated vapour [J/(kg K)].
    pub dew_entropy_j_kg_k: T,
    liquid: [T; 6],
    vapour: [T; 3],
}

impl<T: Real> SuctionState<T> {
    /// The state as a function of all that the evaporating temperature depends on.
    #[inline]
    pub fn of<U: Real<Single = T>>(self, evaporating_k: U) -> SuctionState<U> {
        SuctionState {
            pressure_pa: evaporating_k.then(self.pressure_pa),
            enthalpy_j_kg: evaporating_k.then(self.enthalpy_j_kg),
            density_kg_m3: evaporating_k.then(self.density_kg_m3),
            entropy_j_kg_k: evaporating_k.then(self.entropy_j_kg_k),
        }
    }
}

impl<T: Real> CondensingIsobar<T> {
    /// The isobar as a function of all that the condensing temperature depends on.
    #[inline]
    pub fn of<U: Real<Single = T>>(self, condensing_k: U) -> CondensingIsobar<U> {
        CondensingIsobar {
            temperature_k: condensing_k.then(self.temperature_k),
            pressure_pa: condensing_k.then(self.pressure_pa),
            dew_enthalpy_j_kg: condensing_k.then(self.dew_enthalpy_j_kg),
            dew_entropy_j_kg_k: condensing_k.then(self.dew_entropy_j_kg_k),
            liquid: self.liquid.map(|coefficient| condensing_k.then(coefficient)),
            vapour: self.vapour.map(|coefficient| condensing_k.then(coefficient)),
        }
    }

    /// Enthalpy of liquid at this pressure, `subcooling_k` below saturation [J/kg].
    #[inline]
    pub fn liquid_enthalpy_j_kg(&self, subcooling_k: T) -> T {
        polynomial(&self.liquid, subcooling_k)
    }

    /// Enthalpy at this pressure and the given entropy [J/kg]; below the dew point `dh = T ds` of wet vapour.
    #[inline]
    pub fn enthalpy_at_entropy_j_kg(&self, entropy_j_kg_k: T) -> T {
        let excess = entropy_j_kg_k - self.dew_entropy_j_kg_k;
        let wet = self.dew_enthalpy_j_kg + self.temperature_k * excess;
        if excess.value() > 0.0 { wet + excess * excess * polynomial(&self.vapour, excess) } else { wet }
    }

    /// Enthalpy at this pressure and an entropy that may be far above the dew point [J/kg]; linear beyond `range_j_kg_k` above it,
    /// which is as far as the table reaches.
    pub fn enthalpy_at_any_entropy_j_kg(&self, entropy_j_kg_k: T, range_j_kg_k: f64) -> T {
        let beyond = entropy_j_kg_k - self.dew_entropy_j_kg_k - range_j_kg_k;
        if beyond.value() <= 0.0 {
            return self.enthalpy_at_entropy_j_kg(entropy_j_kg_k);
        }
        let edge_j_kg = self.enthalpy_at_entropy_j_kg(self.dew_entropy_j_kg_k + range_j_kg_k);
        edge_j_kg + self.slope_k(range_j_kg_k) * beyond
    }

    /// Entropy at this pressure and the given enthalpy [J/(kg K)], the inverse of [`Self::enthalpy_at_any_entropy_j_kg`].
    pub fn entropy_at_enthalpy_j_kg_k(&self, enthalpy_j_kg: T, range_j_kg_k: f64) -> T {
        let excess = enthalpy_j_kg - self.dew_enthalpy_j_kg;
        if excess.value() <= 0.0 {
            return self.dew_entropy_j_kg_k + excess / self.temperature_k;
        }
        let edge_j_kg = self.enthalpy_at_entropy_j_kg(self.dew_entropy_j_kg_k + range_j_kg_k);
        if enthalpy_j_kg.value() >= edge_j_kg.value() {
            let beyond = (enthalpy_j_kg - edge_j_kg) / self.slope_k(range_j_kg_k);
            return self.dew_entropy_j_kg_k + range_j_kg_k + beyond;
        }
        let [a, b, c] = self.vapour.map(Real::value);
        let temperature_k = self.temperature_k.value();
        let rise = |x: f64| x * (temperature_k + x * (a + x * (b + x * c)));
        let slope = |x: f64| temperature_k + x * (2.0 * a + x * (3.0 * b + x * 4.0 * c));
        let mut entropy = excess.value() / temperature_k;
        for _ in 0..INVERSE_ITERATIONS {
            entropy += (excess.value() - rise(entropy)) / slope(entropy);
        }
        // The last step of Newton's method carries the derivatives.
        let constant = T::constant(entropy);
        let reached =
            constant * self.temperature_k + constant * constant * polynomial(&self.vapour, constant);
        self.dew_entropy_j_kg_k + (excess - reached) / slope(entropy) + entropy
    }

    /// Rise of enthalpy with entropy at an entropy above the dew point [K].
    fn slope_k(&self, excess_j_kg_k: f64) -> T {
        let [a, b, c] = self.vapour;
        let x = excess_j_kg_k;
        self.temperature_k + (a * 2.0 + (b * 3.0 + c * (4.0 * x)) * x) * x
    }
}

/// Superheat that the polynomials cover [K], and the least entropy above the dew point [J/(kg K)]: as in `make_table.py`.
const LARGEST_SATURATION_DISTANCE_K: f64 = 10.0;
const LEAST_ENTROPY_RANGE_J_KG_K: f64 = 180.0;

/// Steps of Newton's method, beyond which round-off is all that is left.
const INVERSE_ITERATIONS: usize = 4;

/// Change of a liquid's enthalpy with pressure at constant temperature over saturation temperature [J/(kg Pa)].
#[derive(Debug, Clone, PartialEq)]
pub struct LiquidUnderPressure(CubicTable<1>);

/// Property table of one refrigerant.
#[derive(Debug, Clone, PartialEq)]
pub struct RefrigerantTable {
    name: String,
    table: CubicTable<COLUMNS>,
    limits: Option<FluidLimits>,
}

/// Lowest temperature at which a fluid must be able to condense [degC]; the table of one that cannot ends below, near its
/// critical point.
const LEAST_CONDENSING_DEGC: f64 = 50.0;

/// Columns that rise with saturation temperature, up to their values near the critical point.
const RISING: [&str; 3] = ["pressure_pa", "vapour_density_0", "liquid_enthalpy_0"];

/// Why there is no refrigerant of a name, as "must be ..."; `None` where there is one, or it is the path of a table.
#[must_use]
pub fn refusal(name: &str) -> Option<String> {
    let known = library::names(REFRIGERANT);
    if known.iter().any(|known| known.eq_ignore_ascii_case(name)) || name.ends_with(".csv") {
        return None;
    }
    let others = format!("{}, or the path of a .csv file", known.join(", "));
    Some(match supercritical_degc(name) {
        Some(degc) => format!(
            "must be a fluid that condenses below its critical point, which this one has at {degc} degC: supercritical \
             cycles are not modelled; one of {others}"
        ),
        None => format!("must be one of {others}"),
    })
}

impl RefrigerantTable {
    /// Loads a refrigerant by name, in upper or lower case, or by the path of its table.
    ///
    /// # Errors
    /// No table of this name, a fluid that would be supercritical, or a file that is no table.
    pub fn load(name: &str) -> PlantResult<Self> {
        Self::from_csv(name, &Self::text(name)?)
    }

    /// Critical point and usual limits of a refrigerant by name or path; `None` where its table gives none.
    ///
    /// # Errors
    /// As [`RefrigerantTable::load`], as far as the header is concerned.
    pub fn limits_of(name: &str) -> PlantResult<Option<FluidLimits>> {
        FluidLimits::from_table(&file_word(name), &Self::text(name)?)
    }

    fn text(name: &str) -> PlantResult<String> {
        if let Some(allowed) = refusal(name) {
            let value = format!("`{name}`");
            return Err(PlantError::InvalidArgument { what: "refrigerant".to_owned(), value, allowed });
        }
        let same = |(known, _): &&(&'static str, _)| known.eq_ignore_ascii_case(name);
        let known = REFRIGERANT.files.iter().find(same).map_or(name, |(known, _)| known);
        library::text(REFRIGERANT, known)
    }

    /// Reads a table as `make_table.py` writes it.
    ///
    /// # Errors
    /// Other columns, a field that is no number, a temperature grid that is not uniform, a property that does not rise with
    /// temperature, a fluid that would be supercritical.
    pub fn from_csv(name: &str, text: &str) -> PlantResult<Self> {
        let limits = FluidLimits::from_table(&file_word(name), text)?;
        let fault = |message: String| PlantError::Syntax { file: file_word(name), message };
        let mut lines =
            text.lines().enumerate().filter(|(_, line)| !line.starts_with('#') && !line.is_empty());
        let (_, header) = lines.next().ok_or_else(|| fault("the table is empty".to_owned()))?;
        let expected = || std::iter::once("temperature_k").chain(COLUMN_NAMES);
        if !header.split(',').map(str::trim).eq(expected()) {
            return Err(fault(format!("columns must be {}", expected().collect::<Vec<_>>().join(","))));
        }
        let (mut grid, mut rows, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
        for (number, line) in lines {
            let bad = || fault(format!("line {} does not hold {} finite numbers", number + 1, COLUMNS + 1));
            let mut row = [0.0; COLUMNS + 1];
            let mut fields = line.split(',');
            for value in &mut row {
                let field = fields.next().ok_or_else(bad)?;
                *value = field.trim().parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(bad)?;
            }
            if fields.next().is_some() {
                return Err(bad());
            }
            grid.push(row[0]);
            rows.push(std::array::from_fn(|k| row[k + 1]));
            numbers.push(number + 1);
        }
        check_rows(&rows, &numbers).map_err(fault)?;
        let table = CubicTable::new(&grid, &rows)
            .map_err(|_| fault("temperature_k must rise in equal steps, at least four rows".to_owned()))?;
        let highest_degc = table.last() - ZERO_CELSIUS_K;
        if highest_degc < LEAST_CONDENSING_DEGC {
            return Err(fault(format!(
                "temperature_k ends at {highest_degc:.1} degC, but must reach {LEAST_CONDENSING_DEGC} degC: a heat pump \
                 with a fluid that cannot condense there is supercritical"
            )));
        }
        Ok(Self { name: name.to_owned(), table, limits })
    }

    /// Critical point and usual limits, where the table gives them.
    #[must_use]
    pub fn limits(&self) -> Option<&FluidLimits> {
        self.limits.as_ref()
    }

    /// Name of the refrigerant.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Lowest saturation temperature of the table [K].
    #[must_use]
    pub fn lowest_saturation_k(&self) -> f64 {
        self.table.first()
    }

    /// Highest saturation temperature of the table, a few kelvin below the critical point [K].
    #[must_use]
    pub fn highest_saturation_k(&self) -> f64 {
        self.table.last()
    }

    /// Saturation pressure [Pa].
    pub fn saturation_pressure_pa<T: Real>(&self, temperature_k: T) -> T {
        let [pressure] = self.table.evaluate::<T, PRESSURE, 1>(temperature_k);
        pressure
    }

    /// Saturation temperature [K]; held at the ends of the table.
    #[must_use]
    pub fn saturation_temperature_k(&self, pressure_pa: f64) -> f64 {
        let (mut low, mut high) = (self.table.first(), self.table.last());
        // Bisection: exact to the last bit, and needed only when a loop is built or reported.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.saturation_pressure_pa(middle) < pressure_pa {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// Saturation temperature at a pressure within the table, with its derivatives [K]; `guess_k` is near it.
    pub fn saturation_near_k<T: Real>(&self, pressure_pa: T, guess_k: f64) -> T {
        let at = |temperature_k: f64| self.saturation_pressure_pa(Dual::variable(temperature_k));
        let mut temperature_k = guess_k.clamp(self.table.first(), self.table.last());
        for _ in 0..INVERSE_ITERATIONS {
            let pressure = at(temperature_k);
            // The logarithm of pressure is nearly a straight line over the reciprocal of temperature.
            let change = elementary::ln(pressure_pa.value() / pressure.value) * pressure.value
                / (pressure.gradient * temperature_k * temperature_k);
            temperature_k =
                (temperature_k.recip() - change).recip().clamp(self.table.first(), self.table.last());
        }
        let pressure = at(temperature_k);
        (pressure_pa - pressure.value) / pressure.gradient + temperature_k
    }

    /// Entropy above the dew point as far as the polynomials of all isobars reach [J/(kg K)], by the rule of `make_table.py`.
    #[must_use]
    pub fn entropy_range_j_kg_k(&self) -> f64 {
        let lowest = self.suction_state(self.table.first(), LARGEST_SATURATION_DISTANCE_K).entropy_j_kg_k;
        let highest = self.condensing_isobar(self.table.last()).dew_entropy_j_kg_k;
        (lowest - highest).max(LEAST_ENTROPY_RANGE_J_KG_K)
    }

    /// What pressure adds to the enthalpy of liquid.
    ///
    /// Along saturation `dh/dT = c_p + (dh/dp)_T dp/dT`, and `c_p` is the table's first coefficient of subcooling.
    #[must_use]
    pub fn liquid_under_pressure(&self) -> LiquidUnderPressure {
        let nodes = self.table.nodes();
        let slope = |temperature_k: &f64| {
            let [pressure, enthalpy, per_subcooling] =
                self.table.evaluate::<_, PRESSURE, 3>(Dual::variable(*temperature_k));
            [(enthalpy.gradient + per_subcooling.value) / pressure.gradient]
        };
        let rows: Vec<[f64; 1]> = nodes.iter().map(slope).collect();
        LiquidUnderPressure(CubicTable::new(&nodes, &rows).expect("the grid of a table that was built"))
    }

    /// Enthalpy of liquid at a temperature and a pressure above that of saturation there [J/kg].
    pub fn liquid_at_pressure_j_kg<T: Real>(
        &self,
        liquid: &LiquidUnderPressure,
        temperature_k: T,
        pressure_pa: T,
    ) -> T {
        let alone = temperature_k.alone();
        let [saturation_pa, enthalpy_j_kg] =
            self.table.evaluate::<_, PRESSURE, 2>(alone).map(|value| temperature_k.then(value));
        let [slope] = liquid.0.evaluate::<_, 0, 1>(alone).map(|value| temperature_k.then(value));
        enthalpy_j_kg + slope * (pressure_pa - saturation_pa)
    }

    /// Enthalpy of vapour `superheat_k` above saturation [J/kg].
    pub fn superheated_enthalpy_j_kg<T: Real>(&self, saturation_k: T, superheat_k: T) -> T {
        let coefficients = self.table.evaluate::<_, 0, 4>(saturation_k.alone());
        polynomial(&coefficients.map(|coefficient| saturation_k.then(coefficient)), superheat_k)
    }

    /// Vapour that leaves the evaporator.
    #[inline(always)]
    pub fn suction_state<T: Real>(&self, evaporating_k: T, superheat_k: T) -> SuctionState<T> {
        let c = self.table.evaluate::<T, 0, EVAPORATING_COLUMNS>(evaporating_k);
        SuctionState {
            pressure_pa: c[PRESSURE],
            enthalpy_j_kg: polynomial(&c[..4], superheat_k),
            density_kg_m3: polynomial(&c[4..8], superheat_k),
            entropy_j_kg_k: polynomial(&c[8..12], superheat_k),
        }
    }

    /// The isobar of a condensing temperature.
    #[inline(always)]
    pub fn condensing_isobar<T: Real>(&self, condensing_k: T) -> CondensingIsobar<T> {
        let c = self.table.evaluate::<T, PRESSURE, CONDENSING_COLUMNS>(condensing_k);
        // Held at the ends like everything else, so that duties stay bounded for a solver that strays.
        let ends = [self.table.first(), self.table.last()].map(T::constant);
        CondensingIsobar {
            temperature_k: condensing_k.max(ends[0]).min(ends[1]),
            pressure_pa: c[0],
            liquid: [c[1], c[2], c[3], c[4], c[5], c[6]],
            dew_enthalpy_j_kg: c[7],
            dew_entropy_j_kg_k: c[8],
            vapour: [c[9], c[10], c[11]],
        }
    }

    /// Temperature on the isobar at the given enthalpy [K]; saturation below the dew point, linear beyond the
    /// range of the table.
    #[inline]
    pub fn discharge_temperature_k<T: Real>(&self, isobar: &CondensingIsobar<T>, enthalpy_j_kg: T) -> T {
        let excess = enthalpy_j_kg - isobar.dew_enthalpy_j_kg;
        if excess.value() <= 0.0 {
            return isobar.temperature_k;
        }
        let c = self
            .table
            .evaluate::<T::Single, ISOBAR_TEMPERATURE, ISOBAR_TEMPERATURE_COLUMNS>(
                isobar.temperature_k.alone(),
            )
            .map(|coefficient| isobar.temperature_k.then(coefficient));
        let [coefficients @ .., range] = c;
        let inside = excess.min(range);
        let rise = inside * polynomial(&coefficients, inside);
        if excess.value() <= range.value() {
            return isobar.temperature_k + rise;
        }
        let mut slopes = coefficients;
        for (k, slope) in slopes.iter_mut().enumerate() {
            *slope = *slope * (k + 1) as f64;
        }
        isobar.temperature_k + rise + polynomial(&slopes, inside) * (excess - inside)
    }
}

/// What an error says of a table: that of a built-in fluid has no file of its own.
fn file_word(name: &str) -> String {
    format!("refrigerant {name}")
}

/// Checks what no fluid contradicts: positive pressures, densities and heats of evaporation; what must rise does.
fn check_rows(rows: &[[f64; COLUMNS]], numbers: &[usize]) -> Result<(), String> {
    let column = |name: &str| COLUMN_NAMES.iter().position(|known| *known == name).expect("a column");
    let (dew, liquid, range) = (column("dew_enthalpy"), column("liquid_enthalpy_0"), column("isobar_range"));
    for (place, (row, number)) in rows.iter().zip(numbers).enumerate() {
        let fault = |name: &str, value: f64, allowed: &str| {
            Err(format!("line {number}: `{name}` is {value}, but {allowed}"))
        };
        for name in ["pressure_pa", "vapour_density_0"] {
            if row[column(name)] <= 0.0 {
                return fault(name, row[column(name)], "must be above 0");
            }
        }
        if row[dew] <= row[liquid] {
            return fault(
                "dew_enthalpy",
                row[dew],
                &format!("must be above liquid_enthalpy_0 ({})", row[liquid]),
            );
        }
        if row[range] <= 0.0 {
            return fault("isobar_range", row[range], "must be above 0");
        }
        let Some(before) = place.checked_sub(1).map(|last| &rows[last]) else { continue };
        for name in RISING {
            let (value, last) = (row[column(name)], before[column(name)]);
            if value <= last {
                return fault(
                    name,
                    value,
                    &format!("must rise with temperature_k; the row before has {last}"),
                );
            }
        }
    }
    Ok(())
}

/// `c[0] + c[1] x + ...`
#[inline]
fn polynomial<T: Real>(coefficients: &[T], x: T) -> T {
    let Some((last, lower)) = coefficients.split_last() else { return T::constant(0.0) };
    lower.iter().rev().fold(*last, |sum, coefficient| sum.times_plus(x, *coefficient))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saturation_temperature_inverts_pressure() -> PlantResult<()> {
        for name in library::names(REFRIGERANT) {
            let table = RefrigerantTable::load(name)?;
            for temperature in [220.0, 273.15, 350.0] {
                let pressure = table.saturation_pressure_pa(temperature);
                assert!((table.saturation_temperature_k(pressure) - temperature).abs() < 1e-9);
            }
        }
        Ok(())
    }

    /// The table of R290 without its header, with rows changed.
    fn r290(change: impl Fn(&mut [f64], usize)) -> String {
        let text = library::text(REFRIGERANT, "r290").expect("built in");
        let mut lines: Vec<String> =
            text.lines().filter(|line| !line.starts_with("#:")).map(str::to_owned).collect();
        let first =
            lines.iter().position(|line| line.starts_with(|c: char| c.is_ascii_digit())).expect("rows");
        for (place, line) in lines[first..].iter_mut().enumerate() {
            let mut row: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
            change(&mut row, place);
            *line = row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        }
        lines.join("\n")
    }

    #[test]
    fn faulty_tables_are_refused_with_the_reason() {
        let header = format!("temperature_k,{}", COLUMN_NAMES.join(","));
        for (text, reason) in [
            (String::new(), "empty"),
            ("temperature_k,b".to_owned(), "columns must be"),
            (format!("{header}\n1,2"), "line 2"),
            (header, "four rows"),
            (
                r290(|row, place| {
                    if place == 40 {
                        row[13] = 1e3
                    }
                }),
                "line 53: `pressure_pa` is 1000, but must rise",
            ),
            (
                r290(|row, place| {
                    if place == 0 {
                        row[5] = -1.0
                    }
                }),
                "`vapour_density_0` is -1, but must be above 0",
            ),
            (
                r290(|row, place| {
                    if place == 3 {
                        row[20] = 0.0
                    }
                }),
                "`dew_enthalpy` is 0, but must be above liquid",
            ),
            (r290(|row, _| row[0] -= 60.0), "temperature_k ends at 29"),
        ] {
            let message = RefrigerantTable::from_csv("x", &text).expect_err("a faulty table").to_string();
            assert!(message.contains(reason), "{message}");
        }
    }

    #[test]
    fn refrigerants_are_found_in_any_case_and_by_path() {
        let pressure_pa = |name: &str| {
            let table = RefrigerantTable::load(name).unwrap_or_else(|error| panic!("{error}"));
            table.saturation_pressure_pa(280.0)
        };
        let r1234yf = library::text(REFRIGERANT, "r1234yf").expect("built in");
        let file = tempfile::Builder::new().suffix(".csv").tempfile().expect("a temporary file");
        std::fs::write(file.path(), r1234yf).expect("written");
        let path = file.path().to_str().expect("plain name");
        assert_eq!(pressure_pa("R1234yf"), pressure_pa(path));
        assert_eq!(pressure_pa("R134A"), pressure_pa("r134a"));
        assert_ne!(pressure_pa("R134a"), pressure_pa(path));
        let message = RefrigerantTable::load("R744").expect_err("none").to_string();
        assert!(
            ["R744", "31 degC", "supercritical", "r134a", "r152a", ".csv"]
                .iter()
                .all(|part| message.contains(part)),
            "{message}"
        );
        let message = RefrigerantTable::load("R999").expect_err("none").to_string();
        assert!(["R999", "r134a", "r290", ".csv"].iter().all(|part| message.contains(part)), "{message}");
    }
}
