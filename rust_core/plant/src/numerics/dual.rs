//! Forward-mode dual numbers: equations are written once over [`Real`], Newton gets exact derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers that the steady equations can be evaluated with: `f64`, or [`Dual`] where derivatives are needed.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// A function of one of these numbers alone, with at most one derivative.
    type Single: Real;

    /// A number without derivatives.
    fn constant(value: f64) -> Self;

    /// The number as the one variable of functions that depend on nothing else.
    fn alone(self) -> Self::Single;

    /// A function that was evaluated at `self.alone()`, as a function of what `self` depends on.
    #[must_use]
    fn then(self, function: Self::Single) -> Self;

    /// The number without its derivatives.
    fn value(self) -> f64;

    /// A function of `self` that has this value and this derivative at `self` (the chain rule).
    #[must_use]
    fn chain(self, value: f64, slope: f64) -> Self;

    /// Square root.
    #[must_use]
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain(root, 0.5 / root)
    }

    /// Integer power.
    #[must_use]
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        let lower = self.value().powi(exponent - 1);
        self.chain(lower * self.value(), f64::from(exponent) * lower)
    }

    /// 1 / self.
    #[must_use]
    #[inline]
    fn recip(self) -> Self {
        let inverse = self.value().recip();
        self.chain(inverse, -inverse * inverse)
    }

    /// Exponential function.
    #[must_use]
    #[inline]
    fn exp(self) -> Self {
        let exponential = self.value().exp();
        self.chain(exponential, exponential)
    }

    /// Natural logarithm.
    #[must_use]
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value().ln(), self.value().recip())
    }

    /// The larger by value.
    #[must_use]
    #[inline]
    fn max(self, other: Self) -> Self {
        if self.value() >= other.value() { self } else { other }
    }

    /// The smaller by value.
    #[must_use]
    #[inline]
    fn min(self, other: Self) -> Self {
        if self.value() <= other.value() { self } else { other }
    }
}

impl Real for f64 {
    type Single = Self;

    #[inline]
    fn alone(self) -> Self {
        self
    }

    #[inline]
    fn then(self, function: Self) -> Self {
        function
    }

    #[inline]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn chain(self, value: f64, _slope: f64) -> Self {
        value
    }
}

/// A value with its derivatives with respect to `N` variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    /// The number itself.
    pub value: f64,
    /// Its derivatives.
    pub gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The independent variable number `index`.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut gradient = [0.0; N];
        gradient[index] = 1.0;
        Self { value, gradient }
    }

    #[inline]
    fn combine(value: f64, left: &Self, left_slope: f64, right: &Self, right_slope: f64) -> Self {
        let mut gradient = [0.0; N];
        for (k, slope) in gradient.iter_mut().enumerate() {
            *slope = left_slope * left.gradient[k] + right_slope * right.gradient[k];
        }
        Self { value, gradient }
    }
}

impl<const N: usize> Real for Dual<N> {
    type Single = Dual<1>;

    #[inline]
    fn alone(self) -> Dual<1> {
        Dual { value: self.value, gradient: [1.0] }
    }

    #[inline]
    fn then(self, function: Dual<1>) -> Self {
        self.chain(function.value, function.gradient[0])
    }

    #[inline]
    fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N] }
    }

    #[inline]
    fn value(self) -> f64 {
        self.value
    }

    #[inline]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient.map(|derivative| slope * derivative) }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::combine(self.value + other.value, &self, 1.0, &other, 1.0)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::combine(self.value - other.value, &self, 1.0, &other, -1.0)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::combine(self.value * other.value, &self, other.value, &other, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let inverse = other.value.recip();
        let quotient = self.value * inverse;
        Self::combine(quotient, &self, inverse, &other, -quotient * inverse)
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;

    #[inline]
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;

    #[inline]
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;

    #[inline]
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl<const N: usize> Div<f64> for Dual<N> {
    type Output = Self;

    #[inline]
    fn div(self, other: f64) -> Self {
        self.chain(self.value / other, other.recip())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula<T: Real>(x: T, y: T) -> T {
        ((x * y + x / y).sqrt() * x.ln() - y.powi(3) * 0.1 + x.exp() * 0.01 - y.recip()).max(x) / 2.0 + y
    }

    #[test]
    fn functions_of_one_variable_give_the_same_gradient() {
        let (x, y) = (Dual::<2>::variable(2.3, 0), Dual::variable(1.7, 1));
        let z = x * y;
        let apart = z.then(z.alone().exp() * z.alone().sqrt() + z.alone());
        let whole = z.exp() * z.sqrt() + z;
        assert!((apart.value - whole.value).abs() < 1e-12);
        for k in 0..2 {
            assert!((apart.gradient[k] - whole.gradient[k]).abs() < 1e-11);
        }
    }

    #[test]
    fn gradient_agrees_with_central_differences() {
        let (x, y, step) = (2.3, 1.7, 1e-6);
        let dual = formula(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        let by_x = (formula(x + step, y) - formula(x - step, y)) / (2.0 * step);
        let by_y = (formula(x, y + step) - formula(x, y - step)) / (2.0 * step);
        assert!((dual.value - formula(x, y)).abs() < 1e-14);
        assert!((dual.gradient[0] - by_x).abs() < 1e-8, "{dual:?} {by_x}");
        assert!((dual.gradient[1] - by_y).abs() < 1e-8, "{dual:?} {by_y}");
    }
}
