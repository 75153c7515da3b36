//! The classical Runge-Kutta step, with inputs that are held over it.

/// The state one step of length `h` later.
pub fn rk4<const N: usize>(x: [f64; N], h: f64, slope: impl Fn([f64; N]) -> [f64; N]) -> [f64; N] {
    let moved = |k: [f64; N], by: f64| std::array::from_fn(|i| x[i] + by * k[i]);
    let a = slope(x);
    let b = slope(moved(a, 0.5 * h));
    let c = slope(moved(b, 0.5 * h));
    let d = slope(moved(c, h));
    std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_of_fourth_order() {
        // a swing of half a turn
        let error = |count: i32| {
            let h = std::f64::consts::PI / f64::from(count);
            let [x, v] = (0..count).fold([1.0, 0.0], |x, _| rk4(x, h, |[x, v]| [v, -x]));
            (x + 1.0).hypot(v)
        };
        let ratio = error(20) / error(40);
        assert!((ratio - 16.0).abs() < 1.0, "{ratio}");
    }
}
