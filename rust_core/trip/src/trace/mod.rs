//! Traces: quantities against time, read by the names of their columns.
//!
//! A trace is a CSV file whose first line that is no comment names the columns, each with its unit ([`columns`]). One reader
//! ([`reading`]) serves drive cycles, climates and a driver's settings; each takes the columns that it has a use for.

pub mod columns;
mod reading;
mod resampling;

use self::columns::Quantity;
use self::reading::Rows;
use hp_plant::config::library::{self, Kind};
use hp_plant::error::{PlantError, PlantResult};
use std::sync::Arc;

/// Quantities at full seconds from 0 on.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    name: Arc<str>,
    duration_s: usize,
    columns: Vec<(&'static columns::Column, Arc<[f64]>)>,
}

impl Trace {
    /// Loads a trace of a kind by name or path.
    ///
    /// # Errors
    /// Unknown name, or a file that is no trace.
    pub fn load(kind: Kind, name: &str) -> PlantResult<Self> {
        Self::from_csv(name, &library::text(kind, name)?)
    }

    /// Reads the text of a trace; `name` is the file that an error names.
    ///
    /// Time counts from the first row. What was sampled faster than once a second is averaged, anything else interpolated.
    ///
    /// # Errors
    /// The first thing that is wrong, with line or column, value and rule: see [`reading`].
    pub fn from_csv(name: &str, text: &str) -> PlantResult<Self> {
        let refused = |message: String| PlantError::Syntax { file: name.to_owned(), message };
        let Rows { times_s, columns } = reading::rows(text).map_err(refused)?;
        let seconds = resampling::Seconds::of(&times_s);
        if seconds.last_s() == 0 {
            let span_s = times_s[times_s.len() - 1];
            return Err(refused(format!("a trace of {span_s} s has no full second")));
        }
        Ok(Self {
            name: name.into(),
            duration_s: seconds.last_s(),
            columns: columns
                .into_iter()
                .map(|(column, values)| (column, seconds.resampled(&times_s, &values).into()))
                .collect(),
        })
    }

    /// Name or path.
    #[must_use]
    pub fn name(&self) -> &Arc<str> {
        &self.name
    }

    /// Full seconds that it covers [s].
    #[must_use]
    pub fn duration_s(&self) -> usize {
        self.duration_s
    }

    /// Columns besides time in the order of the file, with their values at full seconds in their own unit.
    #[must_use]
    pub fn columns(&self) -> &[(&'static columns::Column, Arc<[f64]>)] {
        &self.columns
    }

    /// Values of a quantity at full seconds in the unit of its column; none where no column has it.
    #[must_use]
    pub fn values(&self, quantity: Quantity) -> Option<&Arc<[f64]>> {
        let found = self.columns.iter().find(|(column, _)| column.quantity == quantity);
        found.map(|(_, values)| values)
    }

    /// Checks that it can serve as a series of quantities on a trip.
    ///
    /// # Errors
    /// It ends before the trip.
    pub fn check_length(&self, cycle: &str, duration_s: usize) -> PlantResult<()> {
        if self.duration_s >= duration_s {
            return Ok(());
        }
        Err(PlantError::Syntax {
            file: self.name.to_string(),
            message: format!(
                "column `time_s` ends {} s after its first row, but the cycle `{cycle}` lasts {duration_s} s: a series must \
                 last as long as its trip",
                self.duration_s
            ),
        })
    }

    /// Checks that it has at least one of some quantities.
    ///
    /// # Errors
    /// It has none.
    pub fn check_has_any(&self, quantities: &[Quantity]) -> PlantResult<()> {
        if quantities.iter().any(|&quantity| self.values(quantity).is_some()) {
            return Ok(());
        }
        let known = columns::COLUMNS.iter().filter(|column| quantities.contains(&column.quantity));
        let names: Vec<&str> = known.map(|column| column.name).collect();
        Err(PlantError::Syntax {
            file: self.name.to_string(),
            message: format!("there is no column of use here, but there must be one of {}", names.join(", ")),
        })
    }

    /// Speed at full seconds [m/s].
    ///
    /// # Errors
    /// No column has it.
    pub fn speeds_m_s(&self) -> PlantResult<Arc<[f64]>> {
        for &(unit, name) in columns::SPEEDS {
            if let Some((_, values)) = self.columns.iter().find(|(column, _)| column.name == name) {
                return Ok(values.iter().map(|&speed| unit.m_s(speed)).collect());
            }
        }
        let names: Vec<&str> = columns::SPEEDS.iter().map(|&(_, name)| name).collect();
        Err(PlantError::Syntax {
            file: self.name.to_string(),
            message: format!(
                "there is no column of speed, but a cycle must have one of {}",
                names.join(", ")
            ),
        })
    }
}
