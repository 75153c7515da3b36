//! What lags behind by a way: a deflection of the contact that rolling takes away.

/// A deflection after `dt` seconds of du/dt = sliding − |speed| u / length: the exact solution for constant speeds. At standstill it
/// is a spring.
pub(super) fn follow(u: f64, sliding: f64, speed: f64, length: f64, dt: f64) -> f64 {
    let way = speed.abs() * dt / length;
    // exp(-way) - 1
    let decay = libm::expm1(-way);
    // (1 − exp(−way)) / way, which is 1 for no way
    let mean = if way > 0.0 { -decay / way } else { 1.0 };
    u + u * decay + sliding * dt * mean
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u' = s − |v| u / L has the solution L s / |v| + (u0 − L s / |v|) exp(−|v| t / L).
    #[test]
    fn a_deflection_follows_its_equation_in_any_partition_and_at_rest() {
        let (u, sliding, length, time) = (0.003, -0.4, 0.6, 0.05_f64);
        for speed in [-20.0, 3.0] {
            let end = length * sliding / f64::abs(speed);
            let expected = end + (u - end) * (-f64::abs(speed) * time / length).exp();
            for parts in [1, 9] {
                let mut now = u;
                for _ in 0..parts {
                    now = follow(now, sliding, speed, length, time / f64::from(parts));
                }
                assert!((now - expected).abs() < 1e-15, "{speed} {parts}: {now} {expected}");
            }
        }
        assert_eq!(follow(u, sliding, 0.0, length, time), u + sliding * time);
    }
}
