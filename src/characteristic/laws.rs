//! Curves through points: laws of force over deflection, and power laws over load and speed, with intervals.

use crate::fit::{Options, Problem, Unknown, least_squares};
use crate::stats::chance::student_beyond;
use crate::stats::{about_mean, redundancy};
use crate::{Error, Result};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// A number with half the width of its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Known {
    /// The number.
    pub value: f64,
    /// Half the width of its interval, in its unit; infinite (null) where nothing tells it.
    pub half_width: f64,
}

impl Known {
    /// A number that is as it is.
    pub fn exactly(value: f64) -> Self {
        Self { value, half_width: 0.0 }
    }

    /// The same times a factor that is known.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, half_width: self.half_width * factor.abs() }
    }

    /// Half the width over the number.
    pub fn share(self) -> f64 {
        self.half_width / self.value.abs()
    }
}

/// A form of the force over the deflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// F = a e^b
    Power,
    /// F = a e / (b - e)
    Hyperbola,
    /// F = a e + b e^2
    Polynomial,
}

impl Form {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Power, Self::Hyperbola, Self::Polynomial];

    /// The force at a deflection.
    pub fn at(self, [a, b]: [f64; 2], e: f64) -> f64 {
        match self {
            Self::Power => a * e.max(0.0).powf(b),
            Self::Hyperbola => a * e / (b - e),
            Self::Polynomial => (a + b * e) * e,
        }
    }

    /// Its slope.
    pub fn slope(self, [a, b]: [f64; 2], e: f64) -> f64 {
        match self {
            Self::Power => a * b * e.max(0.0).powf(b - 1.0),
            Self::Hyperbola => a * b / ((b - e) * (b - e)),
            Self::Polynomial => a + 2.0 * b * e,
        }
    }
}

/// A form that was fitted to a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FormFit {
    /// What was fitted.
    pub form: Form,
    /// a and b: N/m^b and 1, N and m, N/m and N/m^2.
    pub coefficients: [Known; 2],
    /// Root mean square of what is left \[N\].
    pub rmse: f64,
    /// Share of the variance about the mean that is explained.
    pub r2: f64,
}

impl FormFit {
    /// The force at a deflection.
    pub fn at(&self, e: f64) -> f64 {
        self.form.at(self.coefficients.map(|c| c.value), e)
    }
}

/// The residuals of a form. Its unknowns, over their scales: of a polynomial the coefficients; of the others the force in the middle of
/// the curve in place of the factor, which changes by orders with the second coefficient.
struct Curve<'a> {
    form: Form,
    middle: f64,
    scale: [f64; 2],
    deflection: &'a [f64],
    force: &'a [f64],
}

impl Curve<'_> {
    fn unknowns(&self, coefficients: [f64; 2]) -> [f64; 2] {
        match self.form {
            Form::Polynomial => coefficients,
            _ => [self.form.at(coefficients, self.middle), coefficients[1]],
        }
    }

    fn coefficients(&self, [force, b]: [f64; 2]) -> [f64; 2] {
        match self.form {
            Form::Power => [force / self.middle.powf(b), b],
            Form::Hyperbola => [force * (b - self.middle) / self.middle, b],
            Form::Polynomial => [force, b],
        }
    }
}

impl Problem for Curve<'_> {
    fn residuals(&self, points: &[Vec<f64>]) -> Vec<Option<Vec<f64>>> {
        let one = |point: &Vec<f64>| {
            let coefficients = self.coefficients([point[0] * self.scale[0], point[1] * self.scale[1]]);
            let left = self.deflection.iter().zip(self.force);
            let left: Vec<f64> = left.map(|(e, f)| self.form.at(coefficients, *e) - f).collect();
            left.iter().all(|r| r.is_finite()).then_some(left)
        };
        points.iter().map(one).collect()
    }
}

/// Fits a form to a curve of positive deflections \[m\] and their forces \[N\].
///
/// # Errors
/// Fewer than four points, or a curve that the form cannot follow.
pub fn fit_form(form: Form, deflection: &[f64], force: &[f64]) -> Result<FormFit> {
    let positive: Vec<(f64, f64)> =
        deflection.iter().copied().zip(force.iter().copied()).filter(|(e, _)| *e > 0.0).collect();
    let (deflection, force): (Vec<f64>, Vec<f64>) = positive.into_iter().unzip();
    let n = deflection.len();
    if n < 4 {
        return Err(Error::numeric(format!(
            "a law of two coefficients needs at least four points of positive deflection; there are {n}"
        )));
    }
    let (most, load) = (deflection[n - 1], force[n - 1]);
    let start = match form {
        Form::Power => [load / most.powf(1.2), 1.2],
        Form::Hyperbola => [2.0 * load, 3.0 * most],
        Form::Polynomial => [0.7 * load / most, 0.3 * load / (most * most)],
    };
    let mut problem =
        Curve { form, middle: 0.5 * most, scale: [1.0; 2], deflection: &deflection, force: &force };
    problem.scale = problem.unknowns(start);
    let scale = problem.scale;
    // a hyperbola has its pole beyond all points, and far away if the curve is nearly straight
    let bounds = match form {
        Form::Power => [[1e-6, 1e6], [0.1 / scale[1], 10.0 / scale[1]]],
        Form::Hyperbola => [[1e-6, 1e6], [1.001 * most / scale[1], 1e6]],
        Form::Polynomial => [[-1e3, 1e3]; 2],
    };
    let unknown = |i: usize| Unknown {
        start: 1.0,
        mean: 1.0,
        low: bounds[i][0],
        high: bounds[i][1],
        step: 1e-6,
        prior: f64::INFINITY,
        reach: f64::INFINITY,
    };
    let unknowns = [unknown(0), unknown(1)];
    let options = Options { iterations: 200, tolerance: 1e-12, ..Options::default() };
    let fit = least_squares(&problem, &unknowns, options)?;
    let found = [fit.x[0] * scale[0], fit.x[1] * scale[1]];
    let covariance = fit.covariance(&unknowns, redundancy(&fit.residuals));
    // the variance is that over n, less than what two unknowns leave
    let widen = (n as f64 / (n as f64 - 2.0)).sqrt();
    let coefficients = problem.coefficients(found);
    let half = |i: usize| widen * covariance.half_width(i) * scale[i].abs();
    // what the factor's error is made of: that of the force in the middle, and of the other one
    let by = |i: usize| {
        let mut moved = found;
        let step = half(i).min(1e-3 * found[i].abs()).max(1e-9 * found[i].abs());
        moved[i] += step;
        (problem.coefficients(moved)[0] - coefficients[0]) / step
    };
    let correlation = covariance.correlation(0, 1);
    let correlation = if correlation.is_finite() { correlation } else { 0.0 };
    let (one, other) = (by(0) * half(0), by(1) * half(1));
    let half_width = (one * one + other * other + 2.0 * correlation * one * other).max(0.0).sqrt();
    let total = about_mean(&force);
    Ok(FormFit {
        form,
        coefficients: [
            Known { value: coefficients[0], half_width },
            Known { value: coefficients[1], half_width: half(1) },
        ],
        rmse: (fit.cost / n as f64).sqrt(),
        r2: if total > 0.0 { 1.0 - fit.cost / total } else { f64::NAN },
    })
}

/// The factor by which a standard error of `dof` degrees of freedom is half a 95 % interval (Student).
pub fn student_factor(dof: f64) -> f64 {
    if dof < 1.0 { f64::INFINITY } else { student_beyond(0.05, dof) }
}

/// The mean of values with half its 95 % interval; without one for a single value.
pub fn mean_of(values: &[f64]) -> Known {
    let n = values.len() as f64;
    let value = values.iter().sum::<f64>() / n;
    let error = (about_mean(values) / (n - 1.0).max(0.0) / n).sqrt();
    let half_width = if values.len() > 1 { student_factor(n - 1.0) * error } else { f64::INFINITY };
    Known { value, half_width }
}

/// y = sum of coefficients times columns, by least squares with a half width for each y: coefficients with half widths by what
/// the half widths of y say, or by what is left where that is more. `None` if the columns do not tell all coefficients.
pub fn linear(columns: &[Vec<f64>], y: &[Known]) -> Option<Vec<Known>> {
    let (n, m) = (y.len(), columns.len());
    if n < m || m == 0 {
        return None;
    }
    // one that claims to be exact counts as the best of the others; if all do, all count alike
    let least =
        y.iter().map(|y| y.half_width).filter(|w| w.is_finite() && *w > 0.0).fold(f64::INFINITY, f64::min);
    let claims = least.is_finite();
    let width = |y: &Known| match (claims, y.half_width.is_finite()) {
        (false, _) => 1.0,
        // nothing is known of how well it is known: as badly as the worst
        (true, false) => y_worst(least),
        (true, true) => y.half_width.max(least),
    };
    let rows = DMatrix::from_fn(n, m, |i, j| columns[j][i] / width(&y[i]));
    let right = DVector::from_fn(n, |i, _| y[i].value / width(&y[i]));
    let normal = rows.tr_mul(&rows);
    let scale: Vec<f64> = (0..m).map(|j| normal[(j, j)].sqrt()).collect();
    if scale.iter().any(|s| s.is_nan() || *s <= 0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(m, m, |i, j| normal[(i, j)] / scale[i] / scale[j]);
    // columns that are the same but for a ten-thousandth tell one coefficient only
    if scaled.clone().symmetric_eigenvalues().min() < 1e-8 {
        return None;
    }
    let inverse = scaled.try_inverse()?;
    let inverse = DMatrix::from_fn(m, m, |i, j| inverse[(i, j)] / scale[i] / scale[j]);
    let x = &inverse * rows.tr_mul(&right);
    let left = (&rows * &x - &right).norm_squared();
    let dof = (n - m) as f64;
    let scatter = if n > m { student_factor(dof) * (left / dof).sqrt() } else { 0.0 };
    let factor = if claims { scatter.max(1.0) } else { scatter };
    let factor = if n == m && !claims { f64::INFINITY } else { factor };
    let known = |j: usize| Known { value: x[j], half_width: factor * inverse[(j, j)].max(0.0).sqrt() };
    Some((0..m).map(known).collect())
}

/// Half the width that a number of unknown width is given beside others: ten times the best of them.
fn y_worst(least: f64) -> f64 {
    10.0 * least
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::SplitMix64;

    #[test]
    fn each_form_is_found_again_within_its_intervals() {
        let mut random = SplitMix64::new(3);
        for (form, truth) in
            [(Form::Power, [4.0e6, 1.45]), (Form::Hyperbola, [30e3, 0.06]), (Form::Polynomial, [350e3, 12e6])]
        {
            let e: Vec<f64> = (1..=60).map(|k| 4e-4 * f64::from(k)).collect();
            let exact: Vec<f64> = e.iter().map(|e| form.at(truth, *e)).collect();
            let fit = fit_form(form, &e, &exact).unwrap();
            for (found, truth) in fit.coefficients.iter().zip(truth) {
                assert!((found.value / truth - 1.0).abs() < 1e-5, "{fit:?}");
            }
            assert!(fit.r2 > 1.0 - 1e-9);
            let (mut inside, runs) = ([0; 2], 100);
            for _ in 0..runs {
                let noisy: Vec<f64> = exact.iter().map(|f| f + 80.0 * random.normal()).collect();
                let fit = fit_form(form, &e, &noisy).unwrap();
                assert!((fit.rmse - 80.0).abs() < 30.0, "{fit:?}");
                for i in 0..2 {
                    let found = fit.coefficients[i];
                    inside[i] += i32::from((found.value - truth[i]).abs() < found.half_width);
                }
            }
            // 95 of 100, give or take three standard deviations
            assert!(inside.iter().all(|i| (88..=100).contains(i)), "{form:?} {inside:?}");
            let slope = (form.at(truth, 0.0101) - form.at(truth, 0.0099)) / 2e-4;
            assert!((form.slope(truth, 0.01) / slope - 1.0).abs() < 1e-3);
        }
        assert!(fit_form(Form::Power, &[1e-3; 3], &[1.0; 3]).is_err());
    }

    #[test]
    fn plane_of_few_points_has_the_interval_of_its_points_and_more_where_they_scatter() {
        let known = |value| Known { value, half_width: 0.1 };
        let ones = vec![1.0; 3];
        let fit =
            linear(&[ones.clone(), vec![-1.0, 0.0, 1.0]], &[known(1.0), known(2.0), known(3.0)]).unwrap();
        assert!((fit[0].value - 2.0).abs() < 1e-12 && (fit[1].value - 1.0).abs() < 1e-12);
        assert!((fit[1].half_width - 0.1 / 2_f64.sqrt()).abs() < 1e-12);
        let fit =
            linear(&[ones.clone(), vec![-1.0, 0.0, 1.0]], &[known(1.0), known(5.0), known(3.0)]).unwrap();
        assert!(fit[1].half_width > 3.0);
        assert_eq!(linear(&[ones.clone(), ones], &[known(1.0); 3]), None);
        assert!((student_factor(4.0) - 2.776).abs() < 1e-3 && (student_factor(1.0) - 12.706).abs() < 1e-3);
    }
}
