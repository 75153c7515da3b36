//! Probabilities of chance: tails of distributions, and the correction for many looks.

/// Probability that Student's t with `dof` degrees of freedom is farther from 0 than `t`.
pub fn student(t: f64, dof: f64) -> f64 {
    incomplete_beta(dof / 2.0, 0.5, dof / (dof + t * t))
}

/// The `t` beyond which Student's t with `dof` degrees of freedom is with a probability: by how much a standard error is to be
/// multiplied for half an interval. Up to 1000, which is more than anything of 1 % has.
pub fn student_beyond(probability: f64, dof: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e3);
    for _ in 0..60 {
        let t = 0.5 * (low + high);
        if student(t, dof) > probability { low = t } else { high = t }
    }
    0.5 * (low + high)
}

/// Probability that a ratio of mean squares with `above` and `below` degrees of freedom exceeds `ratio`.
pub fn fisher(ratio: f64, above: f64, below: f64) -> f64 {
    incomplete_beta(below / 2.0, above / 2.0, below / (below + above * ratio.max(0.0)))
}

/// Probability that `n` independent segments of unrelated signals are as coherent as this.
pub fn coherent(coherence: f64, n: f64) -> f64 {
    (1.0 - coherence.clamp(0.0, 1.0)).powf((n - 1.0).max(0.0))
}

/// Corrects for the number of looks (Holm 1979): each probability is then that of one as small among all,
/// if nothing is there. What was not tested stays so.
pub fn holm(p: &mut [Option<f64>]) {
    let mut order: Vec<usize> = (0..p.len()).filter(|i| p[*i].is_some()).collect();
    order.sort_by(|a, b| p[*a].unwrap_or(1.0).total_cmp(&p[*b].unwrap_or(1.0)));
    let mut least = 0.0_f64;
    for (rank, i) in order.iter().enumerate() {
        least = least.max(p[*i].unwrap_or(1.0) * (order.len() - rank) as f64).min(1.0);
        p[*i] = Some(least);
    }
}

/// The regularized incomplete beta function, by its continued fraction (DLMF 8.17.22).
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x.is_nan() {
        return 1.0;
    }
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // the fraction converges fast on this side only
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let log = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * x.ln() + b * (-x).ln_1p();
    let away = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let (mut c, mut d) = (1.0, 1.0 / away(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in 1..500 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            fraction *= c * d;
        }
        if (fraction - before).abs() <= 1e-14 * fraction.abs() {
            break;
        }
    }
    (log.exp() * fraction / a).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-4 * expected, "{value} {expected}");
    }

    #[test]
    fn tails_are_those_of_the_tables() {
        near(student(2.228_139, 10.0), 0.05);
        near(student(-4.586_894, 10.0), 0.001);
        near(student(12.7062, 1.0), 0.05);
        near(student(0.0, 7.0), 1.0);
        // a table's
        assert!((student_beyond(0.05, 10.0) - 2.228_139).abs() < 1e-6);
        assert!((student_beyond(0.1, 4.0) - 2.131_847).abs() < 1e-6);
        assert!((student_beyond(0.05, 1.0) - 12.706_205).abs() < 1e-6);
        near(fisher(3.325_835, 5.0, 10.0), 0.05);
        near(fisher(5.636_3, 5.0, 10.0), 0.01);
        // one degree above is Student's
        near(fisher(9.0, 1.0, 8.0), student(3.0, 8.0));
        near(coherent(0.5, 5.0), 0.0625);
    }

    #[test]
    fn many_looks_cost() {
        let mut p = [Some(0.02), None, Some(0.001), Some(0.3), Some(0.025)];
        holm(&mut p);
        assert_eq!(p, [Some(0.06), None, Some(0.004), Some(0.3), Some(0.06)]);
    }
}
