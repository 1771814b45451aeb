//! Drive cycles: speed against time, and how steep the road is.

use crate::kinds::CYCLE;
use crate::road::Road;
use crate::trace::Trace;
use hp_plant::error::PlantResult;
use std::sync::Arc;

/// Speed at every full second. Parts of a cycle share its speeds and its road.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveCycle {
    name: Arc<str>,
    all_speeds_m_s: Arc<[f64]>,
    /// None where it is level.
    road: Option<Arc<Road>>,
    first_s: usize,
    last_s: usize,
}

impl DriveCycle {
    /// Loads a cycle by name or path.
    ///
    /// # Errors
    /// Unknown name, or a file that is no trace with a speed.
    pub fn load(name: &str) -> PlantResult<Self> {
        Self::of(&Trace::load(CYCLE, name)?)
    }

    /// Reads the text of a trace that has a speed.
    ///
    /// # Errors
    /// It is no trace (see [`Trace::from_csv`]), or has no speed.
    pub fn from_csv(name: &str, text: &str) -> PlantResult<Self> {
        Self::of(&Trace::from_csv(name, text)?)
    }

    /// The cycle of a trace; columns that tell of other things do not matter.
    ///
    /// # Errors
    /// It has no speed, or its elevations are steeper than a road can be.
    pub fn of(trace: &Trace) -> PlantResult<Self> {
        let all_speeds_m_s = trace.speeds_m_s()?;
        Ok(Self {
            name: Arc::clone(trace.name()),
            road: Road::of(trace, &all_speeds_m_s)?.map(Arc::new),
            all_speeds_m_s,
            first_s: 0,
            last_s: trace.duration_s(),
        })
    }

    /// The part between two full seconds, both within the cycle.
    ///
    /// # Panics
    /// The part is empty or reaches beyond the end.
    #[must_use]
    pub fn window(&self, first_s: usize, last_s: usize) -> Self {
        assert!(first_s < last_s && last_s <= self.duration_s(), "no such part of the cycle");
        Self { first_s: self.first_s + first_s, last_s: self.first_s + last_s, ..self.clone() }
    }

    /// Name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Speeds at full seconds from 0 on [m/s].
    #[must_use]
    pub fn speeds_m_s(&self) -> &[f64] {
        &self.all_speeds_m_s[self.first_s..=self.last_s]
    }

    /// Rise of the road over its horizontal length in the second after so many [-], where a vehicle is that is so far behind
    /// its cycle [m].
    #[must_use]
    #[inline]
    pub fn grade(&self, second: usize, behind_m: f64) -> f64 {
        match &self.road {
            Some(road) => road.grade(self.first_s + second.min(self.duration_s()), behind_m),
            None => 0.0,
        }
    }

    /// Duration [s].
    #[must_use]
    pub fn duration_s(&self) -> usize {
        self.last_s - self.first_s
    }

    /// Distance [m].
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        self.speeds_m_s().windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum()
    }
}
