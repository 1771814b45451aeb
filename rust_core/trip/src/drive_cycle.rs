//! Drive cycles: speed against time.

use crate::kinds::CYCLE;
use hp_plant::config::library;
use hp_plant::error::{PlantError, PlantResult};
use std::sync::Arc;

/// Speed at every full second. Parts of a cycle share its speeds.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveCycle {
    name: Arc<str>,
    all_speeds_m_s: Arc<[f64]>,
    first_s: usize,
    last_s: usize,
}

/// Latest time of a cycle [s].
const LATEST_S: f64 = 1e6;

/// Highest speed that a cycle may ask for [km/h].
const HIGHEST_SPEED_KM_H: f64 = 300.0;

impl DriveCycle {
    /// Loads a cycle by name or path.
    ///
    /// # Errors
    /// Unknown name, or a file that is no cycle.
    pub fn load(name: &str) -> PlantResult<Self> {
        Self::from_csv(name, &library::text(CYCLE, name)?)
    }

    /// Reads `time_s,speed_km_h` rows (comment lines start with `#`) and interpolates to full seconds.
    ///
    /// # Errors
    /// A row that is not two numbers, times that do not rise from 0 or go too far, speeds out of range, less than a second.
    pub fn from_csv(name: &str, text: &str) -> PlantResult<Self> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        let lines =
            text.lines().enumerate().filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty());
        for (number, line) in lines.skip(1) {
            let syntax = |what: String| PlantError::Syntax {
                file: name.to_owned(),
                message: format!("line {}: {what}", number + 1),
            };
            let (time, speed) = line
                .split_once(',')
                .and_then(|(time, speed)| Some((time.trim().parse().ok()?, speed.trim().parse().ok()?)))
                .ok_or_else(|| syntax(format!("`{line}` is not `time_s,speed_km_h`")))?;
            let expected = points.last().map_or(time == 0.0, |&(last, _): &(f64, f64)| time > last);
            if !expected {
                return Err(syntax(format!("time {time} s must be 0 in the first row and rise from there")));
            }
            if time > LATEST_S {
                return Err(syntax(format!("time {time} s must be at most {LATEST_S}")));
            }
            if !(0.0..=HIGHEST_SPEED_KM_H).contains(&speed) {
                return Err(syntax(format!("speed {speed} km/h must be between 0 and {HIGHEST_SPEED_KM_H}")));
            }
            points.push((time, speed));
        }
        if points.len() < 2 {
            return Err(PlantError::Syntax {
                file: name.to_owned(),
                message: "a cycle needs at least two rows of `time_s,speed_km_h`".into(),
            });
        }
        let (times, speeds): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        let end_s = times[times.len() - 1].floor() as usize;
        if end_s == 0 {
            return Err(PlantError::Syntax {
                file: name.to_owned(),
                message: format!("a cycle of {} s has no full second", times[times.len() - 1]),
            });
        }
        let table = hp_plant::numerics::interpolation::LinearTable::new(&times, &speeds);
        Ok(Self {
            name: name.into(),
            all_speeds_m_s: (0..=end_s).map(|second| table.at(second as f64) / 3.6).collect(),
            first_s: 0,
            last_s: end_s,
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
