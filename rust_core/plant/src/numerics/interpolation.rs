//! Piecewise linear tables; end values are held outside the axis.

/// Piecewise linear function of one variable, with its integral.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearTable {
    axis: Vec<f64>,
    values: Vec<f64>,
    integrals: Vec<f64>,
}

impl LinearTable {
    /// A table from a rising axis and as many values.
    ///
    /// # Panics
    /// Fewer than two points or lengths that differ; configuration checks exclude both.
    #[must_use]
    pub fn new(axis: &[f64], values: &[f64]) -> Self {
        assert!(axis.len() >= 2 && axis.len() == values.len(), "table needs matching axis and values");
        let mut integrals = vec![0.0; axis.len()];
        for i in 1..axis.len() {
            integrals[i] = integrals[i - 1] + 0.5 * (values[i] + values[i - 1]) * (axis[i] - axis[i - 1]);
        }
        Self { axis: axis.to_vec(), values: values.to_vec(), integrals }
    }

    /// Value at `x`.
    #[must_use]
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        let (i, weight) = locate(&self.axis, x);
        self.values[i] + weight * (self.values[i + 1] - self.values[i])
    }

    /// Value and slope at `x`; the slope is zero outside the axis.
    #[must_use]
    pub fn with_slope(&self, x: f64) -> (f64, f64) {
        let (i, weight) = locate(&self.axis, x);
        let rise = self.values[i + 1] - self.values[i];
        let inside = x >= self.axis[0] && x <= self.axis[self.axis.len() - 1];
        let slope = if inside { rise / (self.axis[i + 1] - self.axis[i]) } else { 0.0 };
        (self.values[i] + weight * rise, slope)
    }

    /// Integral from the first point of the axis to `x`.
    #[must_use]
    pub fn integral_to(&self, x: f64) -> f64 {
        let last = self.axis.len() - 1;
        if x <= self.axis[0] {
            return self.values[0] * (x - self.axis[0]);
        }
        if x >= self.axis[last] {
            return self.integrals[last] + self.values[last] * (x - self.axis[last]);
        }
        let (i, weight) = locate(&self.axis, x);
        let value = self.values[i] + weight * (self.values[i + 1] - self.values[i]);
        self.integrals[i] + 0.5 * (self.values[i] + value) * (x - self.axis[i])
    }
}

/// Interval of a rising axis that holds `x` and the weight of its upper end, held at both ends.
#[inline]
fn locate(axis: &[f64], x: f64) -> (usize, f64) {
    let last = axis.len() - 2;
    let mut i = 0;
    while i < last && x >= axis[i + 1] {
        i += 1;
    }
    (i, ((x - axis[i]) / (axis[i + 1] - axis[i])).clamp(0.0, 1.0))
}

/// Several piecewise bilinear functions on one grid (rows: first axis, columns: second axis).
#[derive(Debug, Clone, PartialEq)]
pub struct BilinearTable<const N: usize> {
    rows: Vec<f64>,
    columns: Vec<f64>,
    values: Vec<[f64; N]>,
}

impl<const N: usize> BilinearTable<N> {
    /// A table from two rising axes and `N` functions given as rows of values.
    ///
    /// # Panics
    /// Sizes that do not match; configuration checks exclude that.
    #[must_use]
    pub fn new(rows: &[f64], columns: &[f64], functions: [&[Vec<f64>]; N]) -> Self {
        let width = columns.len();
        let values = (0..rows.len() * width)
            .map(|corner| functions.map(|table| table[corner / width][corner % width]))
            .collect();
        Self { rows: rows.to_vec(), columns: columns.to_vec(), values }
    }

    /// All functions at one point.
    #[must_use]
    #[inline]
    pub fn at(&self, row: f64, column: f64) -> [f64; N] {
        let (i, u) = locate(&self.rows, row);
        let (j, v) = locate(&self.columns, column);
        let width = self.columns.len();
        let corner = |di: usize, dj: usize| &self.values[(i + di) * width + j + dj];
        let (a, b, c, d) = (corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1));
        std::array::from_fn(|k| {
            let low = a[k] + v * (b[k] - a[k]);
            let high = c[k] + v * (d[k] - c[k]);
            low + u * (high - low)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_met_and_ends_are_held() {
        let table = LinearTable::new(&[0.0, 1.0, 3.0], &[2.0, 4.0, 0.0]);
        for (x, y) in [(-1.0, 2.0), (0.0, 2.0), (0.5, 3.0), (1.0, 4.0), (2.0, 2.0), (3.0, 0.0), (9.0, 0.0)] {
            assert_eq!(table.at(x), y, "at {x}");
        }
    }

    #[test]
    fn integral_differences_equal_the_area_below_the_segments() {
        let table = LinearTable::new(&[0.0, 1.0, 3.0], &[2.0, 4.0, 0.0]);
        assert!((table.integral_to(3.0) - 7.0).abs() < 1e-15);
        assert!((table.integral_to(2.0) - table.integral_to(0.5) - (1.75 + 3.0)).abs() < 1e-14);
        assert!((table.integral_to(-1.0) + 2.0).abs() < 1e-15);
    }

    #[test]
    fn bilinear_table_meets_its_corners_and_their_mean() {
        let values = vec![vec![1.0, 2.0], vec![3.0, 6.0]];
        let table = BilinearTable::new(&[0.0, 1.0], &[0.0, 2.0], [&values]);
        assert_eq!(table.at(0.0, 0.0), [1.0]);
        assert_eq!(table.at(1.0, 2.0), [6.0]);
        assert_eq!(table.at(0.5, 1.0), [3.0]);
        assert_eq!(table.at(7.0, -3.0), [3.0]);
    }
}
