//! The scalar that physics is written in: `f64`, or a dual number that carries exact derivatives.
//!
//! The elementary functions of `f64` come from the `libm` crate, or are [our own](super::lanes), and not from the system: a C library
//! picks other code on other processors and versions, and with it other last bits. That is also why
//! this is a trait of our own.

use super::lanes;
use nalgebra::{ClosedAddAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number, possibly with derivatives. Comparisons look at the value only.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + PartialOrd
    + From<f64>
    + Zero
    + One
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + Neg<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + 'static
{
    /// The value without derivatives.
    fn value(self) -> f64;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// Square root.
    fn sqrt(self) -> Self;
    /// Arc cosine.
    fn acos(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// 2 to this power, for exponents up to 1000; 2^-1000 for all that is less than -1000.
    fn exp2(self) -> Self;
    /// The logarithm to base 2 of a normal positive number.
    fn log2(self) -> Self;

    /// The power of a base that is not negative, with a relative error of 2e-16 for each power of two in it.
    #[inline]
    fn pow(self, exponent: Self) -> Self {
        if self.value() == 0.0 { Self::zero() } else { (self.log2() * exponent).exp2() }
    }

    /// The absolute value.
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }

    /// The larger of the two.
    fn or_at_least(self, least: f64) -> Self {
        if self.value() < least { least.into() } else { self }
    }
}

impl Real for f64 {
    #[inline]
    fn value(self) -> f64 {
        self
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        // Correctly rounded everywhere, by IEEE 754.
        f64::sqrt(self)
    }
    #[inline]
    fn acos(self) -> Self {
        libm::acos(self)
    }
    #[inline]
    fn exp(self) -> Self {
        libm::exp(self)
    }
    #[inline]
    fn ln(self) -> Self {
        libm::log(self)
    }
    #[inline]
    fn exp2(self) -> Self {
        lanes::exp2_of(self)
    }
    #[inline]
    fn log2(self) -> Self {
        lanes::log2_of(self)
    }
}

/// A value with its derivatives by N variables.
#[derive(Debug, Clone, Copy)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives.
    pub gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable number `index`: derivative 1 by itself.
    pub fn variable(value: f64, index: usize) -> Self {
        let mut gradient = [0.0; N];
        gradient[index] = 1.0;
        Self { value, gradient }
    }

    /// f(self), given the value of f and its derivative there.
    #[inline]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient.map(|g| slope * g) }
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    #[inline]
    fn from(value: f64) -> Self {
        Self { value, gradient: [0.0; N] }
    }
}

impl<const N: usize> PartialEq for Dual<N> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<const N: usize> PartialOrd for Dual<N> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

/// Binary operators from the value and the two partial derivatives, for dual and plain right sides.
macro_rules! operator {
    ($trait:ident $method:ident, $assign:ident $assign_method:ident, |$a:ident, $b:ident| $value:expr, $by_a:expr, $by_b:expr) => {
        #[allow(clippy::suspicious_arithmetic_impl)] // partial derivatives use other operators
        impl<const N: usize> $trait for Dual<N> {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                let ($a, $b) = (self.value, other.value);
                let (by_a, by_b) = ($by_a, $by_b);
                let gradient = std::array::from_fn(|i| by_a * self.gradient[i] + by_b * other.gradient[i]);
                Self { value: $value, gradient }
            }
        }
        #[allow(clippy::suspicious_arithmetic_impl)]
        impl<const N: usize> $trait<f64> for Dual<N> {
            type Output = Self;
            #[inline]
            fn $method(self, $b: f64) -> Self {
                let $a = self.value;
                self.chain($value, $by_a)
            }
        }
        impl<const N: usize> $assign for Dual<N> {
            #[inline]
            fn $assign_method(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
    };
}

operator!(Add add, AddAssign add_assign, |a, b| a + b, 1.0, 1.0);
operator!(Sub sub, SubAssign sub_assign, |a, b| a - b, 1.0, -1.0);
operator!(Mul mul, MulAssign mul_assign, |a, b| a * b, b, a);
operator!(Div div, DivAssign div_assign, |a, b| a / b, 1.0 / b, -a / (b * b));

impl<const N: usize> Zero for Dual<N> {
    fn zero() -> Self {
        0.0.into()
    }
    fn is_zero(&self) -> bool {
        self.value == 0.0
    }
}

impl<const N: usize> One for Dual<N> {
    fn one() -> Self {
        1.0.into()
    }
}

impl<const N: usize> Real for Dual<N> {
    fn value(self) -> f64 {
        self.value
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Real::sin_cos(self.value);
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        // At zero the slope is infinite; 0 * infinity would poison variables it does not depend on.
        self.chain(root, if root == 0.0 { 0.0 } else { 0.5 / root })
    }
    fn acos(self) -> Self {
        let sine = (1.0 - self.value * self.value).sqrt();
        self.chain(Real::acos(self.value), if sine == 0.0 { 0.0 } else { -1.0 / sine })
    }
    fn exp(self) -> Self {
        let value = Real::exp(self.value);
        self.chain(value, value)
    }
    fn ln(self) -> Self {
        self.chain(Real::ln(self.value), 1.0 / self.value)
    }
    fn exp2(self) -> Self {
        let value = Real::exp2(self.value);
        self.chain(value, value * std::f64::consts::LN_2)
    }
    fn log2(self) -> Self {
        self.chain(Real::log2(self.value), std::f64::consts::LOG2_E / self.value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every operation of the trait in one formula.
    fn formula<T: Real>(x: T, y: T) -> T {
        let (sin, cos) = (x * 0.7 + y).sin_cos();
        let power = (x * x + 0.3).pow(y.abs() + 0.5);
        let quotient = (x - y * 2.0) / (y * y + 1.5) - sin / 3.0;
        power * cos + quotient.exp() + (x * x + 1.0).sqrt().ln() + (sin * 0.9).acos() - -x
    }

    proptest! {
        #[test]
        fn derivatives_agree_with_differences(x in -2.0..2.0f64, y in 0.1..2.0f64) {
            let exact = formula(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
            prop_assert_eq!(exact.value, formula(x, y));
            let step = 1e-5;
            let by_x = (formula(x + step, y) - formula(x - step, y)) / (2.0 * step);
            let by_y = (formula(x, y + step) - formula(x, y - step)) / (2.0 * step);
            for (exact, difference) in exact.gradient.into_iter().zip([by_x, by_y]) {
                prop_assert!((exact - difference).abs() < 1e-7 * (1.0 + exact.abs()), "{} {}", exact, difference);
            }
        }
    }
}
