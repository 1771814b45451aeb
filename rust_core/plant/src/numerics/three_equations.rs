//! Newton steps for three equations in three unknowns.

use nalgebra::Vector3;

/// Largest magnitude; not a number where one of them is none.
#[inline]
#[must_use]
pub fn largest(values: [f64; 3]) -> f64 {
    let [a, b, c] = values.map(f64::abs);
    let pair = if a > b || a.is_nan() { a } else { b };
    if pair > c || pair.is_nan() { pair } else { c }
}

/// Inverse of a matrix of three rows, by Cramer's rule.
///
/// nalgebra's `try_inverse` divides nine times instead of once and its LU searches pivots; a plant step feels both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inverse {
    columns: [Vector3<f64>; 3],
    per_determinant: f64,
}

impl Inverse {
    /// `None` for a singular matrix.
    #[inline]
    #[must_use]
    pub fn of(rows: [[f64; 3]; 3]) -> Option<Self> {
        let [a, b, c] = rows.map(Vector3::from);
        let columns = [b.cross(&c), c.cross(&a), a.cross(&b)];
        let determinant = a.dot(&columns[0]);
        (determinant != 0.0).then_some(Self { columns, per_determinant: determinant.recip() })
    }

    /// The step that makes errors vanish where the equations are straight.
    #[inline]
    #[must_use]
    pub fn step(&self, errors: [f64; 3]) -> [f64; 3] {
        let [u, v, w] = self.columns;
        (-(u * errors[0] + v * errors[1] + w * errors[2]) * self.per_determinant).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn rows() -> impl Strategy<Value = [[f64; 3]; 3]> {
        prop::array::uniform3(prop::array::uniform3(-10.0..10.0))
    }

    proptest! {
        #[test]
        fn step_makes_straight_equations_vanish(
            rows in rows(),
            errors in prop::array::uniform3(-10.0..10.0f64),
        ) {
            let inverse = Inverse::of(rows).expect("random rows are not singular");
            // Near singular rows leave round-off only.
            prop_assume!(inverse.per_determinant.abs() < 1.0);
            let step = inverse.step(errors);
            for (row, error) in rows.iter().zip(errors) {
                let left = error + row.iter().zip(step).map(|(a, x)| a * x).sum::<f64>();
                prop_assert!(left.abs() < 1e-8, "left {left}");
            }
        }
    }

    #[test]
    fn singular_rows_have_no_inverse() {
        assert_eq!(Inverse::of([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 1.0, 0.0]]), None);
    }

    #[test]
    fn largest_is_a_magnitude_and_tells_what_is_no_number() {
        assert_eq!(largest([1.0, -3.0, 2.0]), 3.0);
        for place in 0..3 {
            let mut values = [1.0; 3];
            values[place] = f64::NAN;
            assert!(largest(values).is_nan());
        }
    }
}
