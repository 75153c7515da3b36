//! What follows a signal late.

/// A first-order lag.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Follower {
    /// Where it is, and where what it follows was.
    at: Option<(f64, f64)>,
}

impl Follower {
    /// Where it is after `steps` of its time constants, on which the signal has gone straight to `now`: exact for that, so that
    /// it is no faster than its time constant says, whatever the steps. Begins where the signal is.
    pub fn follow(&mut self, now: f64, steps: f64) -> f64 {
        let (value, last) = self.at.unwrap_or((now, now));
        let gone = -libm::expm1(-steps);
        // of a ramp it is behind by what it rises in a time constant
        let ramp = if steps > 1e-6 { 1.0 - gone / steps } else { steps / 2.0 };
        let next = value + (last - value) * gone + (now - last) * ramp;
        self.at = Some((next, now));
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_late_by_its_time_constant_whatever_the_steps() {
        for steps in [1e-9, 1e-3, 0.1, 1.0, 7.0] {
            let mut follower = Follower::default();
            // a ramp of 1 in a time constant: y = t - 1 + exp(-t)
            let mut time = 0.0;
            follower.follow(0.0, 0.0);
            for _ in 0..200 {
                time += steps;
                let late = time - follower.follow(time, steps);
                assert!((late + libm::expm1(-time)).abs() < 1e-9 * (1.0 + time), "{steps}: {late}");
            }
        }
    }
}
