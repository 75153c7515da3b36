//! The anti-alias filter of all channels: a Bessel filter of fourth order.

/// Limit at which it halves the power in most recordings \[Hz\].
pub(crate) const LIMIT: f64 = 60.0;
/// That limit, in radians per common delay (of the polynomial s⁴ + 10 s³ + 45 s² + 105 s + 105).
const LIMIT_BY_DELAY: f64 = 2.113_917_674_904_22;

/// Delay of all slow parts with that limit, which recorders of a rig take off \[s\].
pub(crate) const DELAY: f64 = delay(LIMIT);

/// Delay of all slow parts with a limit \[Hz\] of its own \[s\].
pub(crate) const fn delay(limit: f64) -> f64 {
    LIMIT_BY_DELAY / (std::f64::consts::TAU * limit)
}

/// One channel: the delayed value and its first derivatives, in units of the delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bessel {
    state: [f64; 4],
    last: f64,
    delay: f64,
}

impl Bessel {
    /// At rest at a value, with a delay \[s\].
    pub(crate) fn new(value: f64, delay: f64) -> Self {
        Self { state: [value, 0.0, 0.0, 0.0], last: value, delay }
    }

    fn slope(x: [f64; 4], u: f64) -> [f64; 4] {
        [x[1], x[2], x[3], 105.0 * (u - x[0] - x[1]) - 45.0 * x[2] - 10.0 * x[3]]
    }

    /// Follows a value that runs straight to `to` within `dt` seconds (Kutta's classical rule; a step is some percent of
    /// the delay), and tells what comes out.
    pub(crate) fn follow(&mut self, to: f64, dt: f64) -> f64 {
        let h = dt / self.delay;
        let ahead =
            |x: [f64; 4], k: [f64; 4], h: f64| -> [f64; 4] { std::array::from_fn(|i| x[i] + h * k[i]) };
        let middle = 0.5 * (self.last + to);
        let x = self.state;
        let k1 = Self::slope(x, self.last);
        let k2 = Self::slope(ahead(x, k1, 0.5 * h), middle);
        let k3 = Self::slope(ahead(x, k2, 0.5 * h), middle);
        let k4 = Self::slope(ahead(x, k3, h), to);
        self.state = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        self.last = to;
        self.state[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_the_power_at_its_limit_and_delays_what_is_slow() {
        let dt = 1e-4;
        for (frequency, gain) in [(60.0, 0.5_f64.sqrt()), (5.0, 0.9976)] {
            let mut filter = Bessel::new(0.0, DELAY);
            let (mut largest, mut off) = (0.0_f64, 0.0_f64);
            for n in 1..20_000 {
                let t = f64::from(n) * dt;
                let y = filter.follow(libm::sin(std::f64::consts::TAU * frequency * t), dt);
                if t > 1.0 {
                    largest = largest.max(y);
                    off = off
                        .max((y - gain * libm::sin(std::f64::consts::TAU * frequency * (t - DELAY))).abs());
                }
            }
            assert!((largest - gain).abs() < 1e-3, "{frequency}: {largest}");
            assert!(frequency > 10.0 || off < 1e-3, "{off}");
        }
    }
}
