//! Piecewise linear tables; end values are held outside the axis.

/// A straight piece of a function, with the integral up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Where it begins; the last point of the axis for what lies beyond, the first for what lies before.
    from: f64,
    /// Where it ends.
    to: f64,
    value: f64,
    /// Slope; zero outside the axis.
    pub slope: f64,
    integral: f64,
}

impl Segment {
    /// Value at `x`.
    #[must_use]
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        self.value + self.slope * (x - self.from)
    }

    /// Integral from the first point of the axis to `x`.
    #[must_use]
    #[inline]
    pub fn integral_to(&self, x: f64) -> f64 {
        let length = x - self.from;
        self.integral + length * (self.value + 0.5 * self.slope * length)
    }

    /// Whether `x` lies on the straight piece inside the axis.
    #[must_use]
    #[inline]
    pub fn holds(&self, x: f64) -> bool {
        x >= self.from && x <= self.to
    }
}

/// Piecewise linear function of one variable, with its integral.
#[derive(Debug, Clone)]
pub struct LinearTable {
    /// All points of the axis but the last.
    points: Points,
    last: f64,
    /// What lies before the axis, its intervals, what lies beyond.
    segments: Vec<Segment>,
}

impl LinearTable {
    /// A table from a rising axis and as many values.
    ///
    /// # Panics
    /// Fewer than two points or lengths that differ; configuration checks exclude both.
    #[must_use]
    pub fn new(axis: &[f64], values: &[f64]) -> Self {
        assert!(axis.len() >= 2 && axis.len() == values.len(), "table needs matching axis and values");
        let last = axis.len() - 1;
        let flat = |k: usize, integral: f64| Segment {
            from: axis[k],
            to: axis[k],
            value: values[k],
            slope: 0.0,
            integral,
        };
        let mut segments = vec![flat(0, 0.0)];
        let mut integral = 0.0;
        for i in 0..last {
            let (from, to, value) = (axis[i], axis[i + 1], values[i]);
            let segment = Segment { from, to, value, slope: (values[i + 1] - value) / (to - from), integral };
            integral = segment.integral_to(to);
            segments.push(segment);
        }
        segments.push(flat(last, integral));
        Self { points: Points::new(&axis[..last]), last: axis[last], segments }
    }

    /// The straight piece that holds `x`.
    #[must_use]
    #[inline]
    pub fn segment(&self, x: f64) -> &Segment {
        &self.segments[self.points.passed_by(x) + usize::from(x > self.last)]
    }

    /// Value at `x`.
    #[must_use]
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        self.segment(x).at(x)
    }

    /// Integral from the first point of the axis to `x`.
    #[must_use]
    #[inline]
    pub fn integral_to(&self, x: f64) -> f64 {
        self.segment(x).integral_to(x)
    }
}

/// Points to be compared with, four at a time; the last four are filled up with what compares with nothing.
///
/// All are counted, without a branch: many vehicles take turns, so where a search ends cannot be foreseen.
#[derive(Debug, Clone)]
struct Points(Vec<[f64; 4]>);

impl Points {
    fn new(points: &[f64]) -> Self {
        let four = |some: &[f64]| std::array::from_fn(|k| some.get(k).copied().unwrap_or(f64::NAN));
        Self(points.chunks(4).map(four).collect())
    }

    /// How many points `x` has reached.
    #[inline]
    fn passed_by(&self, x: f64) -> usize {
        let count = |four: &[f64; 4]| four.map(|point| u64::from(x >= point)).iter().sum::<u64>();
        self.0.iter().map(count).sum::<u64>() as usize
    }
}

/// A rising axis, prepared for look-ups.
#[derive(Debug, Clone)]
struct Axis {
    inner: Points,
    /// Where each interval begins and the reciprocal of its length.
    intervals: Vec<(f64, f64)>,
}

impl Axis {
    fn new(points: &[f64]) -> Self {
        Self {
            inner: Points::new(&points[1..points.len() - 1]),
            intervals: points.windows(2).map(|pair| (pair[0], (pair[1] - pair[0]).recip())).collect(),
        }
    }

    /// Interval that holds `x` and the weight of its upper end, held at both ends.
    #[inline]
    fn locate(&self, x: f64) -> (usize, f64) {
        let i = self.inner.passed_by(x);
        let (from, per_length) = self.intervals[i];
        (i, ((x - from) * per_length).clamp(0.0, 1.0))
    }
}

/// Several piecewise bilinear functions on one grid (rows: first axis, columns: second axis).
#[derive(Debug, Clone)]
pub struct BilinearTable<const N: usize> {
    rows: Axis,
    columns: Axis,
    /// Per cell: coefficients of 1, the column's weight, the row's weight and their product.
    cells: Vec<[[f64; N]; 4]>,
}

impl<const N: usize> BilinearTable<N> {
    /// A table from two rising axes and `N` functions given as rows of values.
    ///
    /// # Panics
    /// Sizes that do not match; configuration checks exclude that.
    #[must_use]
    pub fn new(rows: &[f64], columns: &[f64], functions: [&[Vec<f64>]; N]) -> Self {
        let cell = |i: usize, j: usize| {
            let corners = functions.map(|f| [f[i][j], f[i][j + 1], f[i + 1][j], f[i + 1][j + 1]]);
            [
                corners.map(|[a, _, _, _]| a),
                corners.map(|[a, b, _, _]| b - a),
                corners.map(|[a, _, c, _]| c - a),
                corners.map(|[a, b, c, d]| (d - c) - (b - a)),
            ]
        };
        let width = columns.len() - 1;
        Self {
            rows: Axis::new(rows),
            columns: Axis::new(columns),
            cells: (0..(rows.len() - 1) * width).map(|k| cell(k / width, k % width)).collect(),
        }
    }

    /// All functions at one point.
    #[must_use]
    #[inline(always)]
    pub fn at(&self, row: f64, column: f64) -> [f64; N] {
        let (i, u) = self.rows.locate(row);
        let (j, v) = self.columns.locate(column);
        let [a, b, c, d] = &self.cells[i * self.columns.intervals.len() + j];
        std::array::from_fn(|k| a[k] + v * b[k] + u * (c[k] + v * d[k]))
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
