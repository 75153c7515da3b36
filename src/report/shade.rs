//! A colour for how much there is of something.

use std::f64::consts::PI;

/// Red, green and blue for a share of the most: even steps of lightness in Oklab (Ottosson 2020), from nearly white through green to blue.
pub fn shade(share: f64) -> [u8; 3] {
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    let lightness = 0.965 - 0.565 * share;
    let chroma = 0.02 + 0.11 * (share * (1.4 - 0.55 * share));
    let (sin, cos) = ((130.0 + 130.0 * share) * PI / 180.0).sin_cos();
    let (a, b) = (chroma * cos, chroma * sin);
    let cube = |c: [f64; 2]| (lightness + c[0] * a + c[1] * b).powi(3);
    let l = cube([0.396_337_777_4, 0.215_803_757_3]);
    let m = cube([-0.105_561_345_8, -0.063_854_172_8]);
    let s = cube([-0.089_484_177_5, -1.291_485_548]);
    let rgb = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701 * s,
    ];
    let byte = |linear: f64| {
        let linear = linear.clamp(0.0, 1.0);
        let encoded =
            if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    };
    rgb.map(byte)
}
