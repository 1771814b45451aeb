//! How steep a road is, by the way along it: a vehicle that falls behind its cycle still has each hill before it.

use crate::pace::ARRIVAL_TOLERANCE_M;
use crate::trace::Trace;
use crate::trace::columns::Quantity;
use hp_plant::error::{PlantError, PlantResult};
use hp_plant::numerics::interpolation::LinearTable;

/// Steepest road, up or down [-]; the same for grades that a trace gives and for those that its elevations amount to.
const STEEPEST: f64 = 0.4;

/// The grade of elevations is that over so much of the way around a place, or at either end of it [m]: receivers of satellites are meters off from one
/// second to the next, roads are not.
const WINDOW_M: f64 = 100.0;

/// Grades along the way of a cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Road {
    /// Way driven at each full second [m].
    ways_m: Box<[f64]>,
    /// Rise over horizontal length in the second after each, the last one's at the end [-].
    grades: Box<[f64]>,
}

impl Road {
    /// The road of a trace that is driven with speeds at full seconds; none where the trace says nothing of it.
    ///
    /// # Errors
    /// Its elevations are steeper than a road can be.
    pub fn of(trace: &Trace, speeds_m_s: &[f64]) -> PlantResult<Option<Self>> {
        let ways_m = ways_m(speeds_m_s);
        let grades = match (trace.values(Quantity::Grade), trace.values(Quantity::Elevation)) {
            (Some(grades_pct), _) => of_grades(grades_pct),
            (None, Some(elevations_m)) => of_elevations(&ways_m, elevations_m)
                .map_err(|message| PlantError::Syntax { file: trace.name().to_string(), message })?,
            (None, None) => return Ok(None),
        };
        Ok(Some(Self { ways_m: ways_m.into(), grades: grades.into() }))
    }

    /// Grade in the second after so many, where a vehicle is that is so far behind its cycle [m].
    #[must_use]
    pub fn grade(&self, second: usize, behind_m: f64) -> f64 {
        let last = self.grades.len() - 1;
        if behind_m < ARRIVAL_TOLERANCE_M {
            return self.grades[second.min(last)];
        }
        let way_m = self.ways_m[second.min(last)] - behind_m;
        self.grades[self.ways_m.partition_point(|&other_m| other_m <= way_m).saturating_sub(1)]
    }
}

/// Way driven at each full second [m].
fn ways_m(speeds_m_s: &[f64]) -> Vec<f64> {
    let mut way_m = 0.0;
    let driven = speeds_m_s.windows(2).map(|pair| {
        way_m += 0.5 * (pair[0] + pair[1]);
        way_m
    });
    std::iter::once(0.0).chain(driven).collect()
}

/// Mean grades of the seconds between grades at full seconds.
fn of_grades(grades_pct: &[f64]) -> Vec<f64> {
    let between = grades_pct.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) / 100.0);
    between.chain(grades_pct.last().map(|last| last / 100.0)).collect()
}

/// Grades of the seconds between elevations at full seconds.
fn of_elevations(ways_m: &[f64], elevations_m: &[f64]) -> Result<Vec<f64>, String> {
    // Where the vehicle stands the mean of what was measured there counts.
    let (mut places_m, mut heights_m): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut first = 0;
    for stand in ways_m.chunk_by(|one, other| one == other) {
        let here = &elevations_m[first..first + stand.len()];
        places_m.push(stand[0]);
        heights_m.push(here.iter().sum::<f64>() / here.len() as f64);
        first += stand.len();
    }
    if places_m.len() < 2 {
        return Ok(vec![0.0; ways_m.len()]);
    }
    let (heights, whole_m) = (LinearTable::new(&places_m, &heights_m), ways_m[ways_m.len() - 1]);
    let after = |second: usize| 0.5 * (ways_m[second] + ways_m[(second + 1).min(ways_m.len() - 1)]);
    (0..ways_m.len())
        .map(|second| {
            let from_m = (after(second) - 0.5 * WINDOW_M).clamp(0.0, (whole_m - WINDOW_M).max(0.0));
            let to_m = (from_m + WINDOW_M).min(whole_m);
            let rise_m = heights.at(to_m) - heights.at(from_m);
            // What is driven is the slope's length.
            let level_m = ((to_m - from_m).powi(2) - rise_m * rise_m).max(0.0).sqrt();
            if rise_m.abs() <= STEEPEST * level_m {
                return Ok(if rise_m == 0.0 { 0.0 } else { rise_m / level_m });
            }
            Err(format!(
                "column `elevation_m`: around {second} s after the first row it changes by {rise_m:.1} m on {:.1} m of way, \
                 but must by at most {:.0} %",
                to_m - from_m,
                100.0 * STEEPEST
            ))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::drive_cycle::DriveCycle;

    fn text(column: &str, at: impl Fn(f64) -> f64) -> String {
        let rows = (0..=60).map(|second| format!("{second},20,{}\n", at(20.0 * f64::from(second))));
        format!("time_s,speed_m_s,{column}\n{}", rows.collect::<String>())
    }

    fn cycle(column: &str, at: impl Fn(f64) -> f64) -> DriveCycle {
        DriveCycle::from_csv("mine.csv", &text(column, at)).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn elevations_and_grades_of_one_slope_say_the_same() {
        // 6 % are 6 m on 100 m of map, and on 100.18 m of road.
        let rise = 0.06 / 1.0036_f64.sqrt();
        let (by_height, by_grade) =
            (cycle("elevation_m", |way| 100.0 + rise * way), cycle("grade_pct", |_| 6.0));
        for second in [0, 1, 30, 59, 60, 100] {
            assert!((by_height.grade(second, 0.0) - 0.06).abs() < 1e-9, "{second}");
            assert!((by_grade.grade(second, 0.0) - 0.06).abs() < 1e-12);
        }
    }

    #[test]
    fn noise_of_a_receiver_is_no_hill() {
        let noisy = cycle("elevation_m", |way| 200.0 + if (way / 20.0) as i32 % 2 == 0 { 2.0 } else { -2.0 });
        let steepest = (0..60).map(|second| noisy.grade(second, 0.0).abs()).fold(0.0, f64::max);
        assert!(steepest <= 0.041, "{steepest}");
        let standing = "time_s,speed_m_s,elevation_m\n0,0,90\n1,0,95\n2,0,100\n";
        let standing = DriveCycle::from_csv("mine.csv", standing).expect("a cycle");
        assert_eq!(standing.grade(1, 0.0), 0.0);
    }

    #[test]
    fn a_wall_is_refused_with_second_rise_and_rule() {
        let text = text("elevation_m", |way| if way < 500.0 { 0.0 } else { 80.0 });
        let message = DriveCycle::from_csv("mine.csv", &text).expect_err("a wall").to_string();
        for part in ["mine.csv: ", "`elevation_m`", "around 22 s", "80.0 m on 100.0 m", "at most 40 %"] {
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn a_vehicle_that_is_late_has_the_hill_before_it_all_the_same() {
        let hill = cycle("grade_pct", |way| if way >= 600.0 { 8.0 } else { 0.0 });
        // The cycle is on the hill from 600 m on, after 30 s; a vehicle that is 200 m behind 10 s later, and so on.
        for (second, behind_m, grade) in [
            (29, 0.0, 0.04),
            (30, 0.0, 0.08),
            (35, 0.5, 0.08),
            (35, 200.0, 0.0),
            (41, 200.0, 0.08),
            (70, 700.0, 0.0),
        ] {
            assert_eq!(hill.grade(second, behind_m), grade, "{second} s, {behind_m} m behind");
        }
        let part = hill.window(20, 60);
        assert_eq!((part.grade(5, 0.0), part.grade(10, 0.0), part.grade(15, 200.0)), (0.0, 0.08, 0.0));
    }
}
