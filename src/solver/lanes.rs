//! Four numbers at once: elementary functions with the same bits on every processor.
//!
//! Every function is a fixed sequence of additions, multiplications, divisions and selections, each of which IEEE 754
//! defines to the last bit. Nothing is contracted, and minima, maxima and roundings are comparisons and sums. So what
//! a processor offers (AVX-512, AVX2, SSE2, NEON, or nothing) decides the speed and not the result. Four, because a contact
//! is ten to twenty bristles long, of which eights would leave a third of the work to bristles that are not there.

use fearless_simd::{Level, Simd, dispatch, f64x4, prelude::*, u64x4};
use std::sync::OnceLock;

/// How many numbers are worked on at once.
pub const LANES: usize = 4;

/// The best that this processor offers, asked for once.
pub fn level() -> Level {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    *LEVEL.get_or_init(Level::new)
}

/// All that this processor offers, with names, the best first: for tests and benchmarks.
pub fn levels() -> Vec<(&'static str, Level)> {
    #[allow(unused_mut)] // other processors have one only
    let mut all = Vec::new();
    #[cfg(target_arch = "x86_64")]
    {
        let best = level();
        all.extend(best.as_avx512().map(|l| ("AVX-512", l.level())));
        all.extend(best.as_avx2().map(|l| ("AVX2", l.level())));
        all.extend(best.as_sse4_2().map(|l| ("SSE4.2", l.level())));
    }
    all.push(("baseline", Level::baseline()));
    all
}

/// Adding and taking away 1.5 * 2^52 rounds to a whole number, whose bits are then the lowest of the sum.
const ROUND: f64 = 6_755_399_441_055_744.0;
const EXPONENT_BIAS: u64 = 1023;
const MANTISSA_BITS: u32 = 52;
/// 2^f for f in [-1/2, 1/2]: Chebyshev interpolation, relative error 3.2e-16.
#[allow(clippy::approx_constant)] // the second is what interpolates best, not the logarithm of 2
const EXP2: [f64; 11] = [
    1.0,
    0.693_147_180_559_95,
    0.240_226_506_959_100_97,
    0.055_504_108_664_447_72,
    0.009_618_129_107_606_888,
    0.001_333_355_823_016_497_4,
    0.000_154_035_304_417_360_5,
    1.525_265_726_020_083_7e-5,
    1.321_544_258_792_169e-6,
    1.020_869_029_995_830_6e-7,
    7.072_585_949_269_223e-9,
];
/// asin(s) / s over s², for s² in [0, 1/4]: Chebyshev interpolation, relative error 2.6e-17.
const ASIN: [f64; 13] = [
    1.0,
    0.166_666_666_666_649_42,
    0.075_000_000_003_852_01,
    0.044_642_856_805_998_936,
    0.030_381_959_697_685_14,
    0.022_371_749_733_164_054,
    0.017_359_779_641_349_98,
    0.013_884_842_826_402_08,
    0.012_170_138_592_391_726,
    0.006_529_302_004_736_569_5,
    0.019_513_468_251_252_167,
    -0.016_187_392_271_599_134,
    0.031_879_621_400_812_84,
];

/// (sin(r) / r - 1) / r² and (cos(r) - 1 + r²/2) / r⁴ over r², for r in [-pi/4, pi/4]: Chebyshev interpolation, error of sine
/// and cosine 2e-17.
const SIN: [f64; 6] = [
    -0.166_666_666_666_666_66,
    0.008_333_333_333_330_946,
    -0.000_198_412_698_367_549_7,
    2.755_731_610_068_303e-6,
    -2.505_113_145_542_795e-8,
    1.591_810_123_027_412e-10,
];
const COS: [f64; 6] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_739_5,
    2.480_158_729_876_343_3e-5,
    -2.755_731_727_056_032_6e-7,
    2.087_614_602_468_974_9e-9,
    -1.138_261_486_855_632_5e-11,
];
/// (atan(t) / t - 1) / t² over t², for t in [0, tan(pi/8)]: Chebyshev interpolation, relative error of the arc tangent 7e-18.
const ATAN: [f64; 11] = [
    -0.333_333_333_333_333_3,
    0.199_999_999_999_955_2,
    -0.142_857_142_846_665_42,
    0.111_111_110_152_562_92,
    -0.090_909_045_781_210_85,
    0.076_921_831_907_606_51,
    -0.066_645_114_464_602_2,
    0.058_581_489_047_951_24,
    -0.050_854_496_960_392_584,
    0.039_231_657_085_083_686,
    -0.019_176_885_636_589_053,
];
/// tan(pi/8) and tan(3 pi/8).
const TAN_EIGHTHS: [f64; 2] = [std::f64::consts::SQRT_2 - 1.0, std::f64::consts::SQRT_2 + 1.0];
/// What a quarter of a turn is more than its nearest number.
const QUARTER_REST: f64 = 6.123_233_995_736_766e-17;
/// A quarter of a turn in parts: with the first two, of 33 bits each, products of numbers up to 2^20 are exact.
const QUARTER: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
/// Up to here [`sin_cos`] goes.
pub const LARGEST_ANGLE: f64 = 1e6;

#[inline(always)]
fn polynomial<S: Simd>(simd: S, coefficients: &[f64], x: f64x4<S>) -> f64x4<S> {
    coefficients.iter().rev().fold(f64x4::splat(simd, 0.0), |sum, c| sum * x + *c)
}

/// A polynomial by pairs, pairs of pairs and so on (Estrin): what does not depend on each other goes on at the same time.
#[inline(always)]
fn polynomial_of_eleven<S: Simd>(c: &[f64; 11], x: f64x4<S>) -> f64x4<S> {
    let (x2, x4) = (x * x, (x * x) * (x * x));
    let low = (x * c[3] + c[2]) * x2 + (x * c[1] + c[0]);
    let middle = (x * c[7] + c[6]) * x2 + (x * c[5] + c[4]);
    let high = x2 * c[10] + (x * c[9] + c[8]);
    (high * x4 + middle) * x4 + low
}

/// Four of the values, from `k` on.
#[inline(always)]
pub fn lanes<S: Simd>(simd: S, values: &[f64], k: usize) -> f64x4<S> {
    f64x4::from_slice(simd, &values[k..k + LANES])
}

/// The larger one; `b` where one is not a number.
#[inline(always)]
pub fn larger<S: Simd>(a: f64x4<S>, b: f64x4<S>) -> f64x4<S> {
    a.simd_gt(b).select(a, b)
}

/// The smaller one; `b` where one is not a number.
#[inline(always)]
pub fn smaller<S: Simd>(a: f64x4<S>, b: f64x4<S>) -> f64x4<S> {
    a.simd_lt(b).select(a, b)
}

/// 2^x for x up to 1000, with a relative error of 8e-16; 2^-1000 for all that is less than -1000.
#[inline(always)]
pub fn exp2<S: Simd>(simd: S, x: f64x4<S>) -> f64x4<S> {
    let x = larger(x, f64x4::splat(simd, -1000.0));
    let whole = x + ROUND;
    let scale = f64x4::from_bits((whole.to_bits() + EXPONENT_BIAS) << MANTISSA_BITS);
    polynomial_of_eleven(&EXP2, x - (whole - ROUND)) * scale
}

/// The logarithm to base 2 of normal positive numbers, with an error of 2e-16 of the larger of it and 1; about -1023 for 0.
#[inline(always)]
pub fn log2<S: Simd>(simd: S, x: f64x4<S>) -> f64x4<S> {
    let bits = x.to_bits();
    // the exponent in the lowest bits of 2^52, and what it multiplies, in [1, 2)
    let exponent = f64x4::from_bits((bits >> MANTISSA_BITS) | 4_841_369_599_423_283_200_u64)
        - (4_503_599_627_370_496.0 + 1023.0);
    let mantissa_mask: u64x4<S> = u64x4::splat(simd, (1 << MANTISSA_BITS) - 1);
    let m = f64x4::from_bits((bits & mantissa_mask) | 4_607_182_418_800_017_408_u64);
    // to around 1: 2 atanh((m - 1) / (m + 1)) as a series
    let is_large = m.simd_gt(std::f64::consts::SQRT_2);
    let m = is_large.select(m * 0.5, m);
    let exponent = is_large.select(exponent + 1.0, exponent);
    let s = (m - 1.0) / (m + 1.0);
    const SERIES: [f64; 11] = {
        let mut series = [0.0; 11];
        let mut n = 0;
        while n < 11 {
            series[n] = 2.0 * std::f64::consts::LOG2_E / (2.0 * n as f64 + 1.0);
            n += 1;
        }
        series
    };
    exponent + s * polynomial_of_eleven(&SERIES, s * s)
}

/// [`exp2`] of one number.
#[inline]
pub fn exp2_of(x: f64) -> f64 {
    if x.is_nan() { x } else { dispatch!(Level::baseline(), simd => exp2(simd, f64x4::splat(simd, x))[0]) }
}

/// [`log2`] of one number.
#[inline]
pub fn log2_of(x: f64) -> f64 {
    if x.is_nan() { x } else { dispatch!(Level::baseline(), simd => log2(simd, f64x4::splat(simd, x))[0]) }
}

/// The same power of four positive numbers, with a relative error of 2e-16 for each power of two in it.
#[inline]
pub fn powers(bases: [f64; 4], exponent: f64) -> [f64; 4] {
    dispatch!(Level::baseline(), simd => {
        exp2(simd, log2(simd, f64x4::simd_from(simd, bases)) * exponent).into()
    })
}

/// The arc cosine for x in [1/2, 1], with a relative error of 8e-16.
#[inline(always)]
pub fn acos_near_one<S: Simd>(simd: S, x: f64x4<S>) -> f64x4<S> {
    let z = (-x + 1.0) * 0.5;
    z.sqrt() * polynomial(simd, &ASIN, z) * 2.0
}

/// Sine and cosine of angles up to [`LARGEST_ANGLE`], with an error of 1.2e-16.
#[inline(always)]
pub fn sin_cos<S: Simd>(simd: S, x: f64x4<S>) -> (f64x4<S>, f64x4<S>) {
    let whole = x * std::f64::consts::FRAC_2_PI + ROUND;
    let (quarters, turn) = (whole - ROUND, whole.to_bits());
    let r = ((x - quarters * QUARTER[0]) - quarters * QUARTER[1]) - quarters * QUARTER[2];
    let z = r * r;
    let sin = r * z * polynomial(simd, &SIN, z) + r;
    let cos = (z * z * polynomial(simd, &COS, z) - z * 0.5) + 1.0;
    // each quarter of a turn makes cosine of sine and minus sine of cosine
    let is_odd = (turn & 1).simd_eq(u64x4::splat(simd, 1));
    let (sin, cos) = (is_odd.select(cos, sin), is_odd.select(sin, cos));
    let sign = |turn: u64x4<S>| (turn & 2) << 62;
    (f64x4::from_bits(sin.to_bits() ^ sign(turn)), f64x4::from_bits(cos.to_bits() ^ sign(turn + 1)))
}

/// The arc tangent: within 4.5e-16 of it that of libm.
#[inline(always)]
pub fn atan<S: Simd>(simd: S, x: f64x4<S>) -> f64x4<S> {
    let sign = x.to_bits() & (1 << 63);
    let size = f64x4::from_bits(x.to_bits() ^ sign);
    // of a tangent of 1 or of infinity the arc tangent is known, and of how far it is from that it is a short series
    let (past_first, past_third) = (size.simd_gt(TAN_EIGHTHS[0]), size.simd_gt(TAN_EIGHTHS[1]));
    let (zero, one) = (f64x4::splat(simd, 0.0), f64x4::splat(simd, 1.0));
    let over = past_third.select(-one, past_first.select(size - 1.0, size));
    let under = past_third.select(size, past_first.select(size + 1.0, one));
    let eighths = past_third.select(one, past_first.select(one * 0.5, zero));
    let t = over / under;
    let z = t * t;
    let rest = t * z * polynomial_of_eleven(&ATAN, z) + eighths * QUARTER_REST;
    let angle = eighths * std::f64::consts::FRAC_PI_2 + (t + rest);
    f64x4::from_bits(angle.to_bits() ^ sign)
}

/// [`atan`] of four numbers.
#[inline]
pub fn atans(x: [f64; 4]) -> [f64; 4] {
    dispatch!(level(), simd => atan(simd, f64x4::simd_from(simd, x)).into())
}

/// Sines and cosines of four angles of any size.
#[inline]
pub fn sines_and_cosines(x: [f64; 4]) -> ([f64; 4], [f64; 4]) {
    if x.iter().any(|x| x.abs() > LARGEST_ANGLE) {
        return (x.map(libm::sin), x.map(libm::cos));
    }
    dispatch!(level(), simd => {
        let (sin, cos) = sin_cos(simd, f64x4::simd_from(simd, x));
        (sin.into(), cos.into())
    })
}

/// The sum, always in the same order.
#[inline(always)]
pub fn sum<S: Simd>(v: f64x4<S>) -> f64 {
    let [a, b, c, d]: [f64; LANES] = v.into();
    (a + c) + (b + d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::dispatch;

    /// A function at one point, on the best and on every other level, which have to agree to the bit.
    macro_rules! each {
        ($f:ident, $x:expr) => {{
            let x: f64 = $x;
            let at = |level: Level| -> [f64; LANES] {
                dispatch!(level, simd => $f(simd, f64x4::splat(simd, x)).into())
            };
            let best = at(level());
            for (name, other) in levels() {
                assert_eq!(at(other).map(f64::to_bits), best.map(f64::to_bits), "{name} at {x}");
            }
            assert!(best.iter().all(|y| y.to_bits() == best[0].to_bits()));
            best[0]
        }};
    }

    fn shares(n: u32) -> impl Iterator<Item = f64> {
        // a golden-ratio sequence: it meets no multiples of anything
        (0..n).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract())
    }

    #[test]
    fn exp2_is_that_of_libm() {
        for x in shares(20_000).map(|u| 40.0 * u - 30.0).chain([0.0, -0.5, 0.5, -1.0, -999.5, 10.0]) {
            let (y, exact) = (each!(exp2, x), libm::exp2(x));
            assert!((y / exact - 1.0).abs() <= 8e-16, "{x}: {y} for {exact}");
        }
        assert_eq!(each!(exp2, -1e9), libm::exp2(-1000.0));
        assert_eq!(each!(exp2, f64::NEG_INFINITY), libm::exp2(-1000.0));
    }

    #[test]
    fn log2_is_that_of_libm() {
        let near_one = shares(5000).map(|u| 0.9 + 0.2 * u);
        for x in shares(20_000).map(|u| libm::exp2(60.0 * u - 55.0)).chain(near_one) {
            let (y, exact) = (each!(log2, x), libm::log2(x));
            assert!((y - exact).abs() <= 4e-16 * exact.abs().max(1.0), "{x}: {y} for {exact}");
        }
        assert_eq!(each!(log2, 1.0), 0.0);
        assert!(each!(log2, 0.0) < -1000.0);
    }

    #[test]
    fn acos_is_that_of_libm() {
        for x in shares(20_000).map(|u| 1.0 - 0.5 * u * u).chain([1.0, 0.5, 1.0 - 1e-15]) {
            let (y, exact) = (each!(acos_near_one, x), libm::acos(x));
            assert!((y - exact).abs() <= 8e-16 * exact, "{x}: {y} for {exact}");
        }
    }

    #[test]
    fn arc_tangent_is_that_of_libm() {
        let sizes = shares(20_000).map(|u| (2.0 * u - 1.0) * libm::pow(10.0, 40.0 * (u - 0.5)));
        let around_one = shares(20_000).map(|u| 6.0 * u - 3.0);
        let corners = [0.0, 1.0, -1.0, TAN_EIGHTHS[0], TAN_EIGHTHS[1], 1e300, f64::MAX, 1e-300];
        for x in sizes.chain(around_one).chain(corners) {
            let (y, exact) = (each!(atan, x), libm::atan(x));
            assert!((y - exact).abs() <= 4.5e-16 * exact.abs(), "{x}: {y} for {exact}");
            assert_eq!(each!(atan, -x), -y, "odd at {x}");
        }
        assert_eq!(each!(atan, f64::INFINITY), std::f64::consts::FRAC_PI_2);
        assert!(atans([f64::NAN, 1.0, 0.0, -0.0])[0].is_nan());
        assert!(atans([0.0, 0.0, 0.0, -0.0])[3].is_sign_negative());
    }

    #[test]
    fn angles_of_any_size_have_sines_and_cosines() {
        let x = [1e6, -1e9, 0.5, f64::NAN];
        let (sin, cos) = sines_and_cosines(x);
        for (x, (sin, cos)) in x.into_iter().zip(sin.into_iter().zip(cos)).take(3) {
            assert!((sin - libm::sin(x)).abs() < 3e-16 && (cos - libm::cos(x)).abs() < 3e-16, "{x}");
        }
        assert!(sin[3].is_nan() && cos[3].is_nan());
        assert!(sines_and_cosines([0.1, 0.2, 0.3, f64::NAN]).0[3].is_nan());
    }

    #[test]
    fn sine_and_cosine_are_those_of_libm() {
        fn sin<S: Simd>(simd: S, x: f64x4<S>) -> f64x4<S> {
            sin_cos(simd, x).0
        }
        fn cos<S: Simd>(simd: S, x: f64x4<S>) -> f64x4<S> {
            sin_cos(simd, x).1
        }
        let quarters = (-9..9).map(|n| f64::from(n) * std::f64::consts::FRAC_PI_4);
        let sizes = shares(20_000).map(|u| (2.0 * u - 1.0) * libm::pow(10.0, 9.0 * u.sqrt() - 3.0));
        for x in sizes.chain(quarters).chain([0.0, LARGEST_ANGLE, -LARGEST_ANGLE]) {
            assert!((each!(sin, x) - libm::sin(x)).abs() <= 2.3e-16, "sine of {x}");
            assert!((each!(cos, x) - libm::cos(x)).abs() <= 2.3e-16, "cosine of {x}");
        }
    }

    /// The bristles' pressure is 1 - u^g with u^g = 2^(g (log2 x - log2 l)).
    #[test]
    fn a_power_of_a_quotient_is_that_of_libm() {
        let (mut worst, mut relative) = (0.0_f64, 0.0_f64);
        for (u, v) in shares(20_000).zip(shares(20_011).skip(11)) {
            let (half, g) = (0.02 + 0.1 * v, 1.0 + 19.0 * u);
            let x = half * (7.0 * u + 3.0 * v).fract();
            let y = each!(exp2, g * (each!(log2, x) - each!(log2, half)));
            let exact = libm::pow(x / half, g);
            worst = worst.max((y - exact).abs());
            if exact > 1e-12 {
                relative = relative.max((y / exact - 1.0).abs());
            }
        }
        // g times the rounding of logarithms of about 6
        assert!(worst <= 1.5e-14 && relative <= 1e-13, "{worst} {relative}");
        println!("u^g: error {worst:.1e}, relative {relative:.1e}");
    }
}
