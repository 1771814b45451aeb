//! Several columns over one uniform grid, interpolated with C2 cubic splines.

use crate::numerics::dual::Real;
use crate::numerics::elementary::fused;

/// Why a table cannot be built.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TableFault {
    /// Splines without end conditions need four nodes.
    TooFewRows,
    /// The first column does not rise in equal steps.
    NotUniform,
}

/// `COLUMNS` functions of one variable; outside the grid the end values are held.
///
/// One lookup finds the interval once and evaluates a block of neighbouring columns.
#[derive(Debug, Clone, PartialEq)]
pub struct CubicTable<const COLUMNS: usize> {
    first: f64,
    last: f64,
    per_step: f64,
    /// Per interval: coefficients of the local coordinate's powers 0 to 3, each a row of columns.
    intervals: Vec<[[f64; COLUMNS]; 4]>,
}

impl<const COLUMNS: usize> CubicTable<COLUMNS> {
    /// Not-a-knot splines through `rows` at the nodes `grid`.
    ///
    /// # Errors
    /// Fewer than four rows or a grid that is not uniform.
    pub fn new(grid: &[f64], rows: &[[f64; COLUMNS]]) -> Result<Self, TableFault> {
        if grid.len() < 4 || grid.len() != rows.len() {
            return Err(TableFault::TooFewRows);
        }
        let (first, last) = (grid[0], grid[grid.len() - 1]);
        let step = (last - first) / (grid.len() - 1) as f64;
        let uniform =
            grid.iter().enumerate().all(|(k, node)| (node - first - k as f64 * step).abs() < 1e-6 * step);
        if !(step > 0.0 && uniform) {
            return Err(TableFault::NotUniform);
        }
        let mut intervals = vec![[[0.0; COLUMNS]; 4]; grid.len() - 1];
        for column in 0..COLUMNS {
            let values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
            let slopes = not_a_knot_slopes(&values);
            for (k, interval) in intervals.iter_mut().enumerate() {
                let (rise, left, right) = (values[k + 1] - values[k], slopes[k], slopes[k + 1]);
                interval[0][column] = values[k];
                interval[1][column] = left;
                interval[2][column] = 3.0 * rise - 2.0 * left - right;
                interval[3][column] = left + right - 2.0 * rise;
            }
        }
        Ok(Self { first, last, per_step: step.recip(), intervals })
    }

    /// Lowest node.
    #[must_use]
    pub fn first(&self) -> f64 {
        self.first
    }

    /// Highest node.
    #[must_use]
    pub fn last(&self) -> f64 {
        self.last
    }

    /// All nodes.
    #[must_use]
    pub fn nodes(&self) -> Vec<f64> {
        let count = self.intervals.len();
        (0..=count).map(|k| self.first + (self.last - self.first) * k as f64 / count as f64).collect()
    }

    /// The columns `START .. START + LENGTH` at `x`.
    #[inline]
    pub fn evaluate<T: Real, const START: usize, const LENGTH: usize>(&self, x: T) -> [T; LENGTH] {
        let inside = x.value().clamp(self.first, self.last);
        let position = (inside - self.first) * self.per_step;
        let index = (position as usize).min(self.intervals.len() - 1);
        let u = position - index as f64;
        // Held end values have no slope.
        let scale = if inside == x.value() { self.per_step } else { 0.0 };
        let powers = self.intervals[index].each_ref().map(columns::<COLUMNS, START, LENGTH>);
        // Values and slopes apart, so that several columns are worked out at once.
        let mut values = [0.0; LENGTH];
        let mut slopes = [0.0; LENGTH];
        for k in 0..LENGTH {
            let [a, b, c, d] = powers.map(|row| row[k]);
            // Horner's scheme, and once more over what it leaves for the slope.
            let quadratic = fused(u, d, c);
            let linear = fused(u, quadratic, b);
            values[k] = fused(u, linear, a);
            slopes[k] = scale * fused(u, fused(u, d, quadratic), linear);
        }
        std::array::from_fn(|k| x.chain(values[k], slopes[k]))
    }
}

/// Neighbouring columns of a row.
#[inline]
fn columns<const COLUMNS: usize, const START: usize, const LENGTH: usize>(
    row: &[f64; COLUMNS],
) -> &[f64; LENGTH] {
    const { assert!(START + LENGTH <= COLUMNS, "the table has no such columns") };
    row[START..].first_chunk().expect("the columns exist")
}

/// Slopes per step at the nodes of the C2 spline whose third derivative is continuous at the second and the
/// last but one node (SciPy `CubicSpline`, not-a-knot), by elimination of the tridiagonal system.
fn not_a_knot_slopes(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    let rise = |k: usize| values[k + 1] - values[k];
    // Row k: lower[k] m[k-1] + diagonal[k] m[k] + upper[k] m[k+1] = right[k].
    let mut diagonal = vec![4.0; last + 1];
    let mut upper = vec![1.0; last + 1];
    let mut lower = vec![1.0; last + 1];
    let inner = |k: usize| if k == 0 || k == last { 0.0 } else { 3.0 * (rise(k - 1) + rise(k)) };
    let mut right: Vec<f64> = (0..=last).map(inner).collect();
    (diagonal[0], upper[0], right[0]) = (1.0, 2.0, 2.5 * rise(0) + 0.5 * rise(1));
    (lower[last], diagonal[last]) = (2.0, 1.0);
    right[last] = 2.5 * rise(last - 1) + 0.5 * rise(last - 2);
    for k in 1..=last {
        let factor = lower[k] / diagonal[k - 1];
        diagonal[k] -= factor * upper[k - 1];
        right[k] -= factor * right[k - 1];
    }
    right[last] /= diagonal[last];
    for k in (0..last).rev() {
        right[k] = (right[k] - upper[k] * right[k + 1]) / diagonal[k];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dual::Dual;

    fn table() -> CubicTable<2> {
        let grid: Vec<f64> = (0..9).map(|k| 1.0 + 0.5 * f64::from(k)).collect();
        let rows: Vec<[f64; 2]> = grid.iter().map(|x| [x.powi(3) - 2.0 * x, x.sin()]).collect();
        CubicTable::new(&grid, &rows).expect("a uniform grid")
    }

    #[test]
    fn cubics_are_reproduced_with_their_slope() {
        for x in [1.0, 1.2, 2.9, 4.99, 5.0] {
            let [cubic, sine] = table().evaluate::<_, 0, 2>(Dual::variable(x));
            assert!((cubic.value - (x.powi(3) - 2.0 * x)).abs() < 1e-12, "{x}");
            assert!((cubic.gradient - (3.0 * x * x - 2.0)).abs() < 1e-11, "{x}");
            assert!((sine.value - x.sin()).abs() < 2e-3, "{x}");
        }
    }

    #[test]
    fn end_values_are_held() {
        let [cubic] = table().evaluate::<_, 0, 1>(Dual::variable(7.0));
        assert!((cubic.value - 115.0).abs() < 1e-12 && cubic.gradient == 0.0);
    }

    #[test]
    fn unequal_steps_are_refused() {
        assert_eq!(CubicTable::new(&[0.0, 1.0, 2.0, 4.0], &[[0.0]; 4]), Err(TableFault::NotUniform));
    }
}
