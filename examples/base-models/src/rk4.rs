//! The classical Runge-Kutta step, with inputs that run straight over it.

/// Where an input is at the share `at` of a step, on its way from `from` to `to`.
pub fn between(from: f64, to: f64, at: f64) -> f64 {
    from + (to - from) * at
}

/// The state one step of length `h` later. `slope` gets the share of the step that has passed (0, 1/2, 1).
pub fn rk4<const N: usize>(x: [f64; N], h: f64, slope: impl Fn(f64, &[f64; N]) -> [f64; N]) -> [f64; N] {
    let moved = |k: &[f64; N], by: f64| std::array::from_fn(|i| x[i] + by * k[i]);
    let a = slope(0.0, &x);
    let b = slope(0.5, &moved(&a, 0.5 * h));
    let c = slope(0.5, &moved(&b, 0.5 * h));
    let d = slope(1.0, &moved(&c, h));
    std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]))
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use latsch::model::{Model, Native, Settings, Slave};

    /// A slave of the model, started with these values.
    pub fn started<M: Model>(values: &[(&str, f64)]) -> Native<M> {
        let mut slave = Native::new(&Settings::default()).unwrap();
        set(&mut slave, values);
        slave.start(0.0, None).unwrap();
        slave.finish_start().unwrap();
        slave
    }

    pub fn set(slave: &mut dyn Slave, values: &[(&str, f64)]) {
        for (name, value) in values {
            let index = slave.find(name).unwrap();
            slave.set(index, *value).unwrap();
        }
    }

    pub fn rate(slave: &mut dyn Slave, name: &str, value: f64) {
        let index = slave.find(name).unwrap();
        slave.set_rate(index, value).unwrap();
    }

    pub fn get(slave: &mut dyn Slave, name: &str) -> f64 {
        let index = slave.find(name).unwrap();
        slave.get(index).unwrap()
    }

    #[track_caller]
    pub fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value - expected).abs() <= tolerance, "{value} instead of {expected}");
    }

    #[test]
    fn is_exact_for_cubics_and_of_fourth_order() {
        // x' = 4 t^3 over [0, 2]: x = 16
        assert!((rk4([0.0], 2.0, |s, _| [4.0 * (2.0 * s) * (2.0 * s) * (2.0 * s)])[0] - 16.0).abs() < 1e-12);
        let error = |n: u32| {
            let h = 1.0 / f64::from(n);
            let end = (0..n).fold([1.0], |x, _| rk4(x, h, |_, x| [-x[0]]));
            (end[0] - (-1.0_f64).exp()).abs()
        };
        let order = (error(8) / error(16)).log2();
        assert!((order - 4.0).abs() < 0.15, "{order}");
    }
}
