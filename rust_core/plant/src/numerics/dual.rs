//! Forward-mode dual numbers: equations are written once over [`Real`], Newton gets exact derivatives.

use crate::numerics::elementary;
use std::ops::{Add, Div, Mul, Neg, Sub};
use wide::f64x4;

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

    /// `self * factor + addend`.
    #[must_use]
    #[inline]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
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
        let exponential = elementary::exp(self.value());
        self.chain(exponential, exponential)
    }

    /// Natural logarithm.
    #[must_use]
    #[inline]
    fn ln(self) -> Self {
        self.chain(elementary::ln(self.value()), self.value().recip())
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

    #[inline]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        elementary::fused(self, factor, addend)
    }
}

/// Derivatives of a number: one, or those with respect to several variables side by side.
pub trait Gradient: Copy + Add<Output = Self> + Mul<f64, Output = Self> {
    /// Derivatives of a constant.
    const NONE: Self;

    /// `self * factor + addend`.
    #[must_use]
    fn times_plus(self, factor: f64, addend: Self) -> Self;
}

impl Gradient for f64 {
    const NONE: Self = 0.0;

    #[inline]
    fn times_plus(self, factor: f64, addend: Self) -> Self {
        elementary::fused(self, factor, addend)
    }
}

/// Derivatives with respect to three variables, in one vector register; the fourth lane is idle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Three(f64x4);

impl Three {
    /// One derivative for each variable.
    #[must_use]
    #[inline]
    pub fn array(self) -> [f64; 3] {
        let [a, b, c, _] = self.0.to_array();
        [a, b, c]
    }
}

impl Add for Three {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Mul<f64> for Three {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self(self.0 * f64x4::splat(factor))
    }
}

impl Gradient for Three {
    const NONE: Self = Self(f64x4::ZERO);

    #[inline]
    fn times_plus(self, factor: f64, addend: Self) -> Self {
        Self(self.0.mul_add(f64x4::splat(factor), addend.0))
    }
}

/// A value with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<G> {
    /// The number itself.
    pub value: f64,
    /// Its derivatives.
    pub gradient: G,
}

impl Dual<f64> {
    /// The one independent variable.
    #[must_use]
    pub fn variable(value: f64) -> Self {
        Self { value, gradient: 1.0 }
    }
}

/// Three independent variables.
#[must_use]
#[inline]
pub fn variables(values: [f64; 3]) -> [Dual<Three>; 3] {
    std::array::from_fn(|k| {
        let mut gradient = [0.0; 4];
        gradient[k] = 1.0;
        Dual { value: values[k], gradient: Three(f64x4::new(gradient)) }
    })
}

impl<G: Gradient> Real for Dual<G> {
    type Single = Dual<f64>;

    #[inline]
    fn alone(self) -> Dual<f64> {
        Dual { value: self.value, gradient: 1.0 }
    }

    #[inline]
    fn then(self, function: Dual<f64>) -> Self {
        self.chain(function.value, function.gradient)
    }

    #[inline]
    fn constant(value: f64) -> Self {
        Self { value, gradient: G::NONE }
    }

    #[inline]
    fn value(self) -> f64 {
        self.value
    }

    #[inline]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient * slope }
    }

    #[inline]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        let by_factor = factor.gradient.times_plus(self.value, addend.gradient);
        Self {
            value: elementary::fused(self.value, factor.value, addend.value),
            gradient: self.gradient.times_plus(factor.value, by_factor),
        }
    }
}

impl<G: Gradient> Neg for Dual<G> {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<G: Gradient> Add for Dual<G> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, gradient: self.gradient + other.gradient }
    }
}

impl<G: Gradient> Sub for Dual<G> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<G: Gradient> Mul for Dual<G> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            gradient: self.gradient.times_plus(other.value, other.gradient * self.value),
        }
    }
}

impl<G: Gradient> Div for Dual<G> {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let inverse = other.value.recip();
        let quotient = self.value * inverse;
        Self {
            value: quotient,
            gradient: self.gradient.times_plus(inverse, other.gradient * (-quotient * inverse)),
        }
    }
}

impl<G: Gradient> Add<f64> for Dual<G> {
    type Output = Self;

    #[inline]
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl<G: Gradient> Sub<f64> for Dual<G> {
    type Output = Self;

    #[inline]
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl<G: Gradient> Mul<f64> for Dual<G> {
    type Output = Self;

    #[inline]
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl<G: Gradient> Div<f64> for Dual<G> {
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
        let [x, y, _] = variables([2.3, 1.7, 0.0]);
        let z = x * y;
        let apart = z.then(z.alone().exp() * z.alone().sqrt() + z.alone());
        let whole = z.exp() * z.sqrt() + z;
        assert!((apart.value - whole.value).abs() < 1e-12);
        for (one, other) in apart.gradient.array().into_iter().zip(whole.gradient.array()) {
            assert!((one - other).abs() < 1e-11);
        }
    }

    #[test]
    fn gradient_agrees_with_central_differences() {
        let (x, y, step) = (2.3, 1.7, 1e-6);
        let [dual_x, dual_y, _] = variables([x, y, 0.0]);
        let dual = formula(dual_x, dual_y);
        let [to_x, to_y, to_none] = dual.gradient.array();
        let by_x = (formula(x + step, y) - formula(x - step, y)) / (2.0 * step);
        let by_y = (formula(x, y + step) - formula(x, y - step)) / (2.0 * step);
        assert!((dual.value - formula(x, y)).abs() < 1e-14);
        assert!((to_x - by_x).abs() < 1e-8, "{dual:?} {by_x}");
        assert!((to_y - by_y).abs() < 1e-8, "{dual:?} {by_y}");
        assert_eq!(to_none, 0.0);
    }
}
